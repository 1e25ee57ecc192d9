//! Tests in suites, as by `wayfield --eval --suite`.

use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Mutex, PoisonError};

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use serde_json::json;
use wayfield::cli::TestDriver;
use wayfield::run::suite::{Suite, SuiteDriver, SuiteEpisodes, SuiteTest};
use wayfield::simulation::Extensions;

use crate::env_options;
use crate::errors::{check_ctrl_c, detached, run_error};
use crate::tested::Tested;

/// The options of a test in a suite.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct SuiteOptions {
    names: Vec<String>,
    suite: String,
    settings: Vec<(String, String)>,
    seed: u64,
    episodes: Option<u64>,
    optimum: bool,
}

/// Tests `drivers` in the same episodes of all scenarios of a suite. Returns JSON: the suite's name, the drivers' classes, and
/// the results of each driver by family.
#[pyfunction]
pub fn evaluate_suite(py: Python<'_>, drivers: Vec<Tested<'_>>, options: SuiteOptions) -> PyResult<String> {
    let drivers = drivers.iter().map(Tested::driver).collect::<PyResult<Vec<TestDriver>>>()?;
    detached(py, || {
        let settings = env_options::settings(options.settings.clone());
        let suite = Suite::load(&options.suite, &settings, options.episodes).map_err(run_error)?;
        suite.check_count(drivers.len()).map_err(run_error)?;
        let episodes = run_test(&suite, &drivers, &options)?;
        let results: Vec<_> = episodes.iter().map(|of_driver| suite.results(of_driver)).collect();
        let classes: Vec<_> = drivers.iter().map(|driver| driver.evaluated().class()).collect();
        let text = json!({ "suite": suite.name, "classes": classes, "results": results });
        serde_json::to_string(&text).map_err(|error| PyRuntimeError::new_err(error.to_string()))
    })
}

/// Runs the test. Returns the episodes of each driver in each scenario.
fn run_test<'d>(
    suite: &Suite,
    drivers: &'d [TestDriver],
    options: &SuiteOptions,
) -> PyResult<Vec<Vec<SuiteEpisodes>>> {
    let (stop, raised) = (AtomicBool::new(false), Mutex::new(None));
    let under_test = |(name, driver): (&String, &'d TestDriver)| SuiteDriver {
        name: name.clone(),
        evaluated: driver.evaluated(),
    };
    let drivers: Vec<SuiteDriver<'_>> = options.names.iter().zip(drivers).map(under_test).collect();
    let test = SuiteTest {
        suite,
        seed: options.seed,
        optimum: options.optimum,
        extensions: &Extensions::default(),
        threads: 0,
        stop: Some(&stop),
        store: None,
        progress: &|_, _| {
            // Python reports Ctrl-C only to its main thread, which is one of the workers.
            if let Err(error) = check_ctrl_c() {
                raised.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
                stop.store(true, Ordering::Relaxed);
            }
        },
    };
    let episodes = test.run(&drivers);
    match raised.into_inner().unwrap_or_else(PoisonError::into_inner) {
        Some(error) => Err(error),
        None => episodes.map_err(run_error),
    }
}
