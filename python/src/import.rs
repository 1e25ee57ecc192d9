//! Imports of maps and worlds.

use std::path::{Path, PathBuf};

use pyo3::prelude::*;
use wayfield::import::{ImportOptions, implied_robot, import};
use wayfield::scenario::Scenario;

use crate::env_options::{scenario as find_scenario, settings};
use crate::errors::{detached, file_error, setting_errors};

/// The options of an import, not yet checked.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct ImportArguments {
    resolution_m: Option<f64>,
    tolerance_m: Option<f64>,
    speck_cells: usize,
    lidar_height_m: f64,
    models: Vec<PathBuf>,
    world: Option<u32>,
    /// The scenario whose robot, LIDAR and rules are used: a shipped name, a path or RON text.
    robot: Option<String>,
    /// Settings of that scenario (the one that the file implies if `robot` is `None`): pairs of a field's path and its value as
    /// RON.
    settings: Vec<(String, String)>,
}

/// Imports the file `path`. Returns the scenario's RON text, the largest deviation of a wall in m, the length of a shortest
/// path in m if it is known, and the findings: what was left out or changed.
#[pyfunction]
pub fn import_scenario(
    py: Python<'_>,
    path: PathBuf,
    options: ImportArguments,
) -> PyResult<(String, f64, Option<f64>, Vec<String>)> {
    let robot_from = robot_from(&path, options.robot.as_deref(), options.settings)?;
    let options = ImportOptions {
        resolution_m: options.resolution_m,
        tolerance_m: options.tolerance_m,
        speck_cells: options.speck_cells,
        lidar_height_m: options.lidar_height_m,
        models: options.models,
        world: options.world,
        robot_from,
    };
    detached(py, || {
        let found = import(&path, &options).map_err(|error| file_error(&path.to_string_lossy(), error))?;
        Ok((found.text(), found.deviation_m, found.path_length_m, found.findings))
    })
}

/// The scenario whose robot, LIDAR and rules are used: the one that the user has named (or the one that the file `path` implies),
/// with the user's settings. `None` for the importer's default, if the user has given neither.
fn robot_from(path: &Path, robot: Option<&str>, pairs: Vec<(String, String)>) -> PyResult<Option<Scenario>> {
    if robot.is_none() && pairs.is_empty() {
        return Ok(None);
    }
    let implied = || implied_robot(path).map_err(|error| file_error(&path.to_string_lossy(), error));
    let mut scenario = robot.map_or_else(implied, find_scenario)?;
    settings(pairs).apply_to_scenario(&mut scenario).map_err(setting_errors)?;
    Ok(Some(scenario))
}
