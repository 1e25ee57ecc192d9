//! The mode `--import`: makes scenarios from maps, images and other simulators' worlds.

use std::fs;
use std::io::Write as _;
use std::path::{Path, PathBuf};

use clap::Args;
use serde_json::{Value, json};

use super::output::{print_json, print_stdout};
use super::shared::SharedArgs;
use super::values;
use crate::import::limits::{LIDAR_HEIGHT_M, MAX_CELLS, RESOLUTION_M, TOLERANCE_M};
use crate::import::{ImportOptions, Imported, implied_robot, import, import_worlds, is_file_of_worlds};
use crate::run::output_file::{check_writable, is_stdout, is_stream, write_atomic};
use crate::run::progress::print_stderr;
use crate::run::{RunError, shipped};
use crate::scenario::{Scenario, printable_path};

/// The options of `--import`.
#[derive(Args, Debug)]
#[command(next_help_heading = "Options of --import")]
pub struct ImportArgs {
    /// The side of a pixel of a plain image in m; a map's file states its own. Also with --draw and --over
    #[arg(long, value_name = "M", value_parser = values::metres(RESOLUTION_M), allow_negative_numbers = true)]
    pub resolution: Option<f64>,

    /// How far the walls may be from the cells of a map, in m; with 0, every cell is kept [default: the side of a cell plus
    /// 0.01]
    #[arg(long, value_name = "M", value_parser = values::metres(TOLERANCE_M), allow_negative_numbers = true)]
    tolerance: Option<f64>,

    /// Treat specks of up to N cells of a map, such as a scanner's noise, as floor [default: 0]
    #[arg(long, value_name = "N", value_parser = values::whole::<usize>(0..=MAX_CELLS as u64), allow_negative_numbers = true)]
    specks: Option<usize>,

    /// The height of the LIDAR above the ground in m, at which the shapes of an SDF world are cut [default: 0.18]
    #[arg(long, value_name = "M", value_parser = values::metres(LIDAR_HEIGHT_M), allow_negative_numbers = true)]
    lidar_height: Option<f64>,

    /// A folder with the models that an SDF world includes; may be repeated
    #[arg(long, value_name = "DIR")]
    models: Vec<PathBuf>,

    /// The number of the world in a file of BARN worlds, or of the stage in a file of stages
    #[arg(long, value_name = "N", value_parser = values::whole::<u32>(0..=u64::from(u32::MAX)), allow_negative_numbers = true)]
    world: Option<u32>,

    /// Take robot, LIDAR and rules from this scenario, a file or a shipped one by name; --set changes single fields
    /// [default: the robot of scenario-1; in a BARN world or a stage, its own]
    #[arg(long, value_name = "SCENARIO")]
    robot: Option<String>,
}

/// Imports `file` into the scenario file that `--out` names, and prints its path; prints on stderr what was not imported.
/// If `--out` names a folder, imports all worlds of a `.json` file into it, and prints their paths.
///
/// # Errors
/// `--out` is missing or is also the output of `--json`, `file` cannot be imported, or a scenario file cannot be written.
pub fn run(file: &Path, args: &ImportArgs, shared: &SharedArgs) -> Result<(), RunError> {
    let Some(out) = &shared.out else {
        return Err(RunError::InvalidInput(
            "--import needs an output file; help: add --out SCENARIO.ron".into(),
        ));
    };
    let is_file = is_stream(out) || out.extension() == Some("ron".as_ref());
    if !is_file && is_file_of_worlds(file) && args.world.is_none() {
        return all_worlds(file, &options(file, args, shared)?, out, shared.json);
    }
    if !is_file {
        return Err(RunError::invalid_input(out, "not a scenario file; help: give a name that ends in .ron"));
    }
    if shared.json && is_stdout(out) {
        return Err(RunError::InvalidInput(
            "--json and the scenario would both go to standard output; help: give --out a file".into(),
        ));
    }
    check_writable(out)?;
    let imported = import(file, &options(file, args, shared)?)?;
    write(out, &imported)?;
    print_findings(file, &imported);
    if shared.json {
        return print_json(&summary(out, &imported));
    }
    if is_stream(out) { Ok(()) } else { print_stdout(&format!("{}\n", out.display())) }
}

/// Imports all worlds in `file` into `folder`. Prints the paths, and on stderr what was not imported.
fn all_worlds(file: &Path, options: &ImportOptions, folder: &Path, as_json: bool) -> Result<(), RunError> {
    let worlds = import_worlds(file, options)?;
    fs::create_dir_all(folder)
        .map_err(|error| RunError::not_writable(folder, format!("{error}; help: choose another folder")))?;
    let (mut paths, mut summaries) = (String::new(), Vec::new());
    for (name, imported) in worlds {
        let path = folder.join(format!("{name}.ron"));
        write(&path, &imported)?;
        print_findings(&path, &imported);
        paths += &format!("{}\n", path.display());
        summaries.push(summary(&path, &imported));
    }
    if as_json { print_json(&summaries) } else { print_stdout(&paths) }
}

/// Prints on stderr what the import left out or changed, with the name of `file`: the imported file or, if all worlds in
/// it are imported, the written scenario.
fn print_findings(file: &Path, imported: &Imported) {
    for finding in &imported.findings {
        print_stderr(&format!("note: {}: {finding}", printable_path(file)));
    }
}

/// The result of an import for `--json`.
fn summary(scenario: &Path, imported: &Imported) -> Value {
    let Imported { deviation_m, path_length_m, findings, .. } = imported;
    // A path that is not UTF-8 has no JSON form, and `json!` would panic.
    let scenario = scenario.to_string_lossy();
    json!({ "scenario": scenario, "deviation_m": deviation_m, "path_length_m": path_length_m, "findings": findings })
}

fn write(path: &Path, imported: &Imported) -> Result<(), RunError> {
    let text = imported.text();
    write_atomic(path, |file| file.write_all(text.as_bytes()))
        .map_err(|error| RunError::not_written(path, error))
}

fn options(file: &Path, args: &ImportArgs, shared: &SharedArgs) -> Result<ImportOptions, RunError> {
    let defaults = ImportOptions::default();
    Ok(ImportOptions {
        resolution_m: args.resolution,
        tolerance_m: args.tolerance,
        speck_cells: args.specks.unwrap_or(defaults.speck_cells),
        lidar_height_m: args.lidar_height.unwrap_or(defaults.lidar_height_m),
        models: args.models.clone(),
        world: args.world,
        robot_from: robot_from(file, args, shared)?,
    })
}

/// The scenario with the robot of `--robot`, or else the one that `file` implies, changed by `--set`. `None` without either
/// flag.
fn robot_from(file: &Path, args: &ImportArgs, shared: &SharedArgs) -> Result<Option<Scenario>, RunError> {
    let settings = shared.settings();
    if args.robot.is_none() && settings.is_empty() {
        return Ok(None);
    }
    let mut scenario = args.robot.as_deref().map_or_else(|| implied_robot(file), shipped::scenario)?;
    settings.apply_to_scenario(&mut scenario)?;
    Ok(Some(scenario))
}
