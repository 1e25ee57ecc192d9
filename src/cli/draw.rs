//! The mode `--draw`: a figure of a scenario, of levels of a generator, of the scenarios of a set, or of the learning curves of
//! a run, as an SVG, PNG or PDF file. `figure.rs` draws all but the last.

mod figure;

pub use figure::ScenarioFigure;

use std::path::{Path, PathBuf};

use clap::Args;

use super::output::print_stdout;
use super::shared::SharedArgs;
use super::values;
use crate::run::folder::RunFolder;
use crate::run::image_file::{self, ImageFormat, ImageSize};
use crate::run::output_file::{check_writable, is_stream};
use crate::run::shipped::Source;
use crate::run::{RunError, run_image};

/// The options of `--draw`.
#[derive(Args, Debug)]
#[command(next_help_heading = "Options of --draw")]
pub struct DrawArgs {
    /// Draw the learning curves of the run in DIR, which may still be in progress, instead of a scenario
    #[arg(long, value_name = "DIR", conflicts_with_all = ["scenario", "set", "seed", "resolution"])]
    run: Option<PathBuf>,

    /// Draw the scenario without its name, the legend and the axes; by default 480x360 pixels
    #[arg(long, conflicts_with = "run")]
    plain: bool,

    /// The number of levels on the contact sheet of a level generator, 1 to 100, with consecutive seeds from --seed on
    #[arg(long, value_name = "N", value_parser = values::levels, conflicts_with_all = ["run", "plain", "over"])]
    levels: Option<u64>,

    /// Mark what is occupied in the map (.yaml) or image (with --resolution) from which the scenario was imported
    #[arg(long, value_name = "MAP", conflicts_with_all = ["run", "plain"])]
    over: Option<PathBuf>,
}

/// Draws the figure into `file` and prints the path, unless the figure itself goes to a device or a pipe.
///
/// # Errors
/// The scenario or the run is invalid, a resolution is given without a map, or the file cannot be written.
pub fn run(
    file: &Path,
    args: &DrawArgs,
    resolution_m: Option<f64>,
    shared: &SharedArgs,
) -> Result<(), RunError> {
    if resolution_m.is_some() && args.over.is_none() {
        let why =
            "--resolution is for --over with an image; help: add --over IMAGE, or leave out --resolution";
        return Err(RunError::InvalidInput(why.into()));
    }
    ImageFormat::of(file)?;
    check_writable(file)?;
    let svg = match &args.run {
        Some(folder) => run_figure(folder)?,
        None => {
            let figure = ScenarioFigure {
                name: shared.scenario(),
                settings: &shared.settings(),
                is_plain: args.plain,
                levels: args.levels,
                seed: shared.seed,
                over: args.over.as_deref(),
                resolution_m,
            };
            figure.svg(Source::load(figure.name)?)?
        }
    };
    let default = if args.plain { ImageSize::Screen } else { ImageSize::Print };
    let size = shared.size.map_or(default, |(width, height)| ImageSize::Pixels(width.into(), height.into()));
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
