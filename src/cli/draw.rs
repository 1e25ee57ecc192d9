//! The mode `--draw`: a figure of a scenario, of levels of a generator, or of the learning curves of a run, as an SVG, PNG or
//! PDF file.

use std::path::{Path, PathBuf};

use clap::Args;

use super::output::print_stdout;
use super::shared::SharedArgs;
use super::values;
use crate::run::folder::RunFolder;
use crate::run::image_file::{self, ImageFormat, ImageSize};
use crate::run::output_file::{check_writable, is_stream};
use crate::run::shipped::Source;
use crate::run::{RunError, run_image, scenario_image};
use crate::scenario::LevelGenerator;

/// Number of levels on a contact sheet.
const DEFAULT_LEVELS: u64 = 12;

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

    /// The number of levels on the contact sheet of a level generator, 1 to 100, from the seed --seed on
    #[arg(long, value_name = "N", value_parser = values::levels, conflicts_with_all = ["run", "plain"])]
    levels: Option<u64>,
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
        None => scenario_figure(args, shared)?,
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

fn scenario_figure(args: &DrawArgs, shared: &SharedArgs) -> Result<String, RunError> {
    let name = shared.scenario();
    let seed = args.levels.map(|_| "--levels").or(shared.seed.map(|_| "--seed"));
    match (Source::load(name)?, seed) {
        (Source::Levels(generator), _) if !args.plain => contact_sheet(&generator, args, shared),
        (Source::Scenario(_), Some(flag)) => Err(RunError::invalid_input(
            Path::new(name),
            format!("is a scenario, and {flag} is for level generators; help: leave it out"),
        )),
        (source, _) => {
            let mut scenario = source.into_scenario(name)?;
            shared.settings().apply_to_scenario(&mut scenario)?;
            let draw = if args.plain { scenario_image::thumbnail } else { scenario_image::figure };
            draw(&scenario).map_err(|error| RunError::failed(Path::new(name), error))
        }
    }
}

/// The figure of levels with consecutive seeds.
fn contact_sheet(
    generator: &LevelGenerator,
    args: &DrawArgs,
    shared: &SharedArgs,
) -> Result<String, RunError> {
    let path = Path::new(shared.scenario());
    let mut levels = Vec::new();
    for k in 0..args.levels.unwrap_or(DEFAULT_LEVELS) {
        let seed = shared.seed().saturating_add(k);
        let level = generator.level(seed);
        let mut level = level.map_err(|error| RunError::invalid_input(path, error))?;
        shared.settings().apply_to_scenario(&mut level)?;
        levels.push(level);
    }
    scenario_image::contact_sheet(&generator.name, &levels).map_err(|error| RunError::failed(path, error))
}
