//! The mode `--draw`: a figure of a scenario, of levels of a generator, of the scenarios of a set, or of the learning curves of a run, as an SVG, PNG or
//! PDF file.

use std::path::{Path, PathBuf};

use bevy::math::DVec2;
use clap::Args;

use super::output::print_stdout;
use super::shared::SharedArgs;
use super::values;
use crate::import::{Frame, ImportOptions, backdrop};
use crate::run::folder::RunFolder;
use crate::run::image_file::{self, ImageFormat, ImageSize};
use crate::run::output_file::{check_writable, is_stream};
use crate::run::shipped::Source;
use crate::run::{RunError, run_image, scenario_image};
use crate::scenario::{LevelGenerator, Scenario, ScenarioSet};

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

    /// Mark what is occupied in a map (.yaml) or a picture (with --resolution), from which the scenario was imported
    #[arg(long, value_name = "MAP", conflicts_with_all = ["run", "plain"])]
    over: Option<PathBuf>,
}

/// Draws the figure into `file` and prints the path, unless the figure itself goes to a device or a pipe.
///
/// # Errors
/// The scenario or the run is invalid, or the file cannot be written.
pub fn run(
    file: &Path,
    args: &DrawArgs,
    resolution_m: Option<f64>,
    shared: &SharedArgs,
) -> Result<(), RunError> {
    ImageFormat::of(file)?;
    check_writable(file)?;
    let svg = match &args.run {
        Some(folder) => run_figure(folder)?,
        None => scenario_figure(shared, args, resolution_m)?,
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

fn scenario_figure(
    shared: &SharedArgs,
    args: &DrawArgs,
    resolution_m: Option<f64>,
) -> Result<String, RunError> {
    let name = shared.scenario();
    let mut scenario =
        match (Source::load(name)?, args.levels.map(|_| "--levels").or(shared.seed.map(|_| "--seed"))) {
            (Source::Levels(generator), _) if !args.plain && args.over.is_none() => {
                return contact_sheet(&generator, args, shared);
            }
            (Source::Set(_, set), None) if !args.plain && args.over.is_none() => {
                return sheet_of_set(&set, shared);
            }
            (Source::Scenario(_), Some(flag)) => return Err(only_for_levels(name, "scenario", flag)),
            (Source::Set(..), Some(flag)) => return Err(only_for_levels(name, "set of scenarios", flag)),
            (source, _) => source.into_scenario(name)?,
        };
    shared.settings().apply_to_scenario(&mut scenario)?;
    let svg = match &args.over {
        Some(map) => {
            let areas = occupied_areas(map, resolution_m, name, &scenario)?;
            scenario_image::figure_over(&scenario, areas)
        }
        None if args.plain => scenario_image::thumbnail(&scenario),
        None => scenario_image::figure(&scenario),
    };
    svg.map_err(|error| RunError::failed(Path::new(name), error))
}

fn only_for_levels(name: &str, kind: &str, flag: &str) -> RunError {
    let why = format!("is a {kind}, and {flag} is for level generators; help: leave it out");
    RunError::invalid_input(Path::new(name), why)
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

/// The figure of the scenarios of a set; of a level generator, the first level.
fn sheet_of_set(set: &ScenarioSet, shared: &SharedArgs) -> Result<String, RunError> {
    let path = Path::new(shared.scenario());
    let mut scenarios = Vec::new();
    for member in &set.members {
        let first = member.source.first().map_err(|error| RunError::invalid_input(path, error))?;
        let mut scenario = Scenario { name: member.name.clone(), ..first };
        shared.settings().apply_to_scenario(&mut scenario)?;
        scenarios.push(scenario);
    }
    scenario_image::contact_sheet(&set.name, &scenarios).map_err(|error| RunError::failed(path, error))
}

/// The occupied areas of `map`, in m, in the frame of the scenario `name` that was imported from it: those inside its enclosure.
fn occupied_areas(
    map: &Path,
    resolution_m: Option<f64>,
    name: &str,
    scenario: &Scenario,
) -> Result<Vec<Vec<(f64, f64)>>, RunError> {
    let frame = Frame::find(&scenario.about).ok_or_else(|| {
        let why = "its `about` does not say where it lies in a map; help: import it from the map (--import)";
        RunError::invalid_input(Path::new(name), why)
    })?;
    let backdrop = backdrop(map, &ImportOptions { resolution_m, ..ImportOptions::default() })?;
    let (low, high) = scenario.enclosure.bounds_m();
    let is_inside = |corners: &Vec<(f64, f64)>| {
        let any = |is_beyond: &dyn Fn(&(f64, f64)) -> bool| corners.iter().any(is_beyond);
        any(&|at| at.0 > f64::from(low.x))
            && any(&|at| at.0 < f64::from(high.x))
            && any(&|at| at.1 > f64::from(low.y))
            && any(&|at| at.1 < f64::from(high.y))
    };
    let in_scenario = |corners: &[DVec2; 4]| corners.map(|corner| frame.to_scenario(corner).into()).to_vec();
    Ok(backdrop.areas_m.iter().map(in_scenario).filter(is_inside).collect())
}
