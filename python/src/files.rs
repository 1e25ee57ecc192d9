//! Shipped files, checks, drawings, and the command line.

use std::ffi::OsString;
use std::path::PathBuf;
use std::time::Instant;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use wayfield::cli;
use wayfield::run::image_file::{self, ImageSize};
use wayfield::run::{scenario_image, shipped};
use wayfield::simulation::Extensions;

use crate::env_options::{self, scenario as find_scenario};
use crate::errors::{detached, run_error, setting_errors};

/// The shipped scenarios: name and description.
#[pyfunction]
pub fn scenarios() -> Vec<(&'static str, String)> {
    shipped::scenarios().map(|(name, scenario)| (name, scenario.about)).collect()
}

/// The shipped presets: name and description.
#[pyfunction]
pub fn presets() -> Vec<(&'static str, String)> {
    shipped::presets().map(|(name, preset)| (name, preset.about)).collect()
}

/// The RON text of the shipped scenario `name`.
#[pyfunction]
pub fn scenario_text(name: &str) -> Option<&'static str> {
    shipped::scenario_text(name)
}

/// The report of `wayfield --check --json` on files and folders.
#[pyfunction]
pub fn check(py: Python<'_>, paths: Vec<PathBuf>) -> PyResult<String> {
    detached(py, || {
        serde_json::to_string(&cli::check_files(&paths)).map_err(|e| PyRuntimeError::new_err(e.to_string()))
    })
}

/// Draws the scenario `wanted`, changed by settings, into the SVG, PNG or PDF file `path`; if plain, without name, legend and
/// axes.
#[pyfunction]
pub fn draw(
    py: Python<'_>,
    wanted: &str,
    settings: Vec<(String, String)>,
    path: PathBuf,
    is_plain: bool,
) -> PyResult<()> {
    let mut scenario = find_scenario(wanted)?;
    let settings = env_options::settings(settings);
    settings.apply_to_scenario(&mut scenario).map_err(setting_errors)?;
    detached(py, || {
        let (svg, size) = if is_plain {
            (scenario_image::thumbnail(&scenario), ImageSize::Screen)
        } else {
            (scenario_image::figure(&scenario), ImageSize::Print)
        };
        let svg = svg.map_err(|error| PyRuntimeError::new_err(error.to_string()))?;
        image_file::write(svg, size, &path).map_err(run_error)
    })
}

/// The version of wayfield.
#[pyfunction]
pub fn version() -> &'static str {
    env!("CARGO_PKG_VERSION")
}

/// Runs the command line with the arguments `words`, of which the first is the program's name. Returns the exit status.
#[pyfunction]
pub fn main(py: Python<'_>, words: Vec<OsString>) -> PyResult<u8> {
    detached(py, || Ok(cli::run_words(words, Instant::now(), Extensions::default())))
}
