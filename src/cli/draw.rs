//! The mode `--draw`: a figure of a scenario as an SVG or PNG file.

use std::path::Path;

use super::output::print_stdout;
use super::shared::SharedArgs;
use crate::run::image_file::ImageFormat;
use crate::run::output_file::{check_writable, is_stream};
use crate::run::{RunError, scenario_image, shipped};

/// Draws the scenario into `file` and prints the path, unless the figure itself goes to a device or a pipe.
///
/// # Errors
/// The scenario is invalid, or the file cannot be written.
pub fn run(file: &Path, shared: &SharedArgs) -> Result<(), RunError> {
    ImageFormat::of(file)?;
    check_writable(file)?;
    let mut scenario = shipped::scenario(shared.scenario())?;
    shared.settings().apply_to_scenario(&mut scenario)?;
    scenario_image::draw(&scenario, file)?;
    if is_stream(file) {
        return Ok(());
    }
    print_stdout(&format!("{}\n", file.display()))
}
