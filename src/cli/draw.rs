//! The mode `--draw`: a figure of a scenario as an SVG or PNG file.

use std::path::Path;

use super::output::print_stdout;
use super::shared::SharedArgs;
use crate::run::{RunError, scenario_image, shipped};

/// Draws the scenario into `file` and prints the path.
///
/// # Errors
/// The scenario is invalid, or the file cannot be written.
pub fn run(file: &Path, shared: &SharedArgs) -> Result<(), RunError> {
    let scenario = shipped::scenario(shared.scenario())?;
    scenario_image::draw(&scenario, file)?;
    print_stdout(&format!("{}\n", file.display()))
}
