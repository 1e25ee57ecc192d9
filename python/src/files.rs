//! Shipped files, checks, drawings, and the command line.

use std::ffi::OsString;
use std::path::{Path, PathBuf};
use std::time::Instant;

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use wayfield::cli::{self, ScenarioFigure, parse_size};
use wayfield::limits::MAX_SHEET_LEVELS;
use wayfield::run::folder::RunFolder;
use wayfield::run::image_file::{self, ImageSize};
use wayfield::run::run_image;
use wayfield::run::shipped::{self, Source};
use wayfield::simulation::Extensions;

use crate::env_options::{self, TEXT};
use crate::errors::{detached, file_error, run_error};

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

/// How a scenario, a level generator or a set of scenarios is drawn.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct DrawOptions {
    settings: Vec<(String, String)>,
    is_plain: bool,
    levels: Option<u64>,
    seed: Option<u64>,
    over: Option<PathBuf>,
    resolution_m: Option<f64>,
    /// Width and height in pixels, as `640x480`.
    size: Option<String>,
}

impl DrawOptions {
    fn image_size(&self) -> PyResult<ImageSize> {
        let Some(text) = &self.size else {
            return Ok(if self.is_plain { ImageSize::Screen } else { ImageSize::Print });
        };
        let invalid = |why| PyValueError::new_err(format!("size is {text}; help: {why}"));
        let (width, height) = parse_size(text).map_err(invalid)?;
        Ok(ImageSize::Pixels(width.into(), height.into()))
    }

    /// The number of levels on the contact sheet; `None` for no contact sheet.
    fn levels(&self) -> PyResult<Option<u64>> {
        match self.levels {
            Some(_) if self.is_plain || self.over.is_some() => Err(PyValueError::new_err(
                "levels are drawn as a contact sheet; help: leave out plain and over",
            )),
            Some(levels) if !(1..=MAX_SHEET_LEVELS).contains(&levels) => Err(PyValueError::new_err(format!(
                "levels is {levels}; help: give a number from 1 to {MAX_SHEET_LEVELS}"
            ))),
            levels => Ok(levels),
        }
    }
}

/// Draws the scenario, level generator or set of scenarios `wanted` into the SVG, PNG or PDF file `path`.
#[pyfunction]
pub fn draw(py: Python<'_>, wanted: &str, path: PathBuf, options: DrawOptions) -> PyResult<()> {
    let source = match env_options::is_text(wanted) {
        true => Source::parse(wanted, Path::new(TEXT)).map_err(|error| run_error(error.into()))?,
        false => Source::load(wanted).map_err(|error| file_error(wanted, error))?,
    };
    let (size, levels) = (options.image_size()?, options.levels()?);
    let figure = ScenarioFigure {
        name: if env_options::is_text(wanted) { TEXT } else { wanted },
        settings: &env_options::settings(options.settings),
        is_plain: options.is_plain,
        levels,
        seed: options.seed,
        over: options.over.as_deref(),
        resolution_m: options.resolution_m,
    };
    detached(py, || {
        let svg = figure.svg(source).map_err(run_error)?;
        image_file::write(svg, size, &path).map_err(run_error)
    })
}

/// Draws the learning curves of the run in `folder`, which may still be in progress, into the SVG, PNG or PDF file `path`.
#[pyfunction]
pub fn draw_run(py: Python<'_>, folder: PathBuf, path: PathBuf) -> PyResult<()> {
    detached(py, || {
        let (folder, config) = RunFolder::open(&folder).map_err(run_error)?;
        let svg = run_image::figure(&folder, &config).map_err(run_error)?;
        image_file::write(svg, ImageSize::Print, &path).map_err(run_error)
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
