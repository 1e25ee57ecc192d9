//! The mode `--draw`: a figure of a scenario, or of the learning curves of a run, as an SVG, PNG or PDF file.

use std::path::{Path, PathBuf};

use clap::Args;

use super::output::print_stdout;
use super::shared::SharedArgs;
use crate::run::folder::RunFolder;
use crate::run::image_file::{self, ImageFormat, ImageSize};
use crate::run::output_file::{check_writable, is_stream};
use crate::run::{RunError, run_image, scenario_image, shipped};

/// The options of `--draw`.
#[derive(Args, Debug)]
#[command(next_help_heading = "Options of --draw")]
pub struct DrawArgs {
    /// Draw the learning curves of the run in DIR, which may still be in progress, instead of a scenario
    #[arg(long, value_name = "DIR", conflicts_with_all = ["scenario", "set"])]
    run: Option<PathBuf>,

    /// Draw the scenario without its name, the legend and the axes; by default 480x360 pixels
    #[arg(long, conflicts_with = "run")]
    plain: bool,
}

/// Draws the figure into `file` and prints the path, unless the figure itself goes to a device or a pipe.
///
/// # Errors
/// The scenario or the run is invalid, or the file cannot be written.
pub fn run(file: &Path, args: &DrawArgs, shared: &SharedArgs) -> Result<(), RunError> {
    ImageFormat::of(file)?;
    check_writable(file)?;
    let svg = match &args.run {
        Some(folder) => run_figure(folder)?,
        None => scenario_figure(shared, args.plain)?,
    };
    let own = if args.plain { ImageSize::Screen } else { ImageSize::Print };
    let size = shared.size.map_or(own, |(width, height)| ImageSize::Pixels(width.into(), height.into()));
    image_file::write(svg, size, file)?;
    if is_stream(file) {
        return Ok(());
    }
    print_stdout(&format!("{}\n", file.display()))
}

fn run_figure(folder: &Path) -> Result<String, RunError> {
    let (folder, config) = RunFolder::open(folder)?;
    run_image::figure(&folder, &config)
}

fn scenario_figure(shared: &SharedArgs, is_plain: bool) -> Result<String, RunError> {
    let name = shared.scenario();
    let mut scenario = shipped::scenario(name)?;
    shared.settings().apply_to_scenario(&mut scenario)?;
    let draw = if is_plain { scenario_image::thumbnail } else { scenario_image::figure };
    draw(&scenario).map_err(|error| RunError::failed(Path::new(name), error))
}
