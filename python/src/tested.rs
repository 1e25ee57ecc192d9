//! What is evaluated: a policy, with or without a map, or a classical driver. A driver is passed as its RON text, so that a task
//! for another machine needs no file.

use std::path::Path;
use std::sync::Arc;

use pyo3::exceptions::PyRuntimeError;
use pyo3::prelude::*;
use wayfield::cli::TestDriver;
use wayfield::drivers::DrivingPolicy;
use wayfield::scenario::to_ron;

use crate::env_options::{TEXT, is_text};
use crate::errors::{file_error, run_error};
use crate::policy::NativePolicy;

/// A policy, or the RON text of a classical driver.
#[derive(FromPyObject)]
pub enum Tested<'py> {
    Policy(PyRef<'py, NativePolicy>),
    Driver(String),
}

/// The same as [`Tested`], as a value to return to Python.
#[derive(IntoPyObject)]
pub enum Loaded {
    Policy(NativePolicy),
    Driver(String),
}

/// Loads the policy or the classical driver `wanted`: a shipped name or a file's path (with `+map` appended for a policy with a
/// map), or the RON text of a driver.
#[pyfunction]
pub fn load_tested(wanted: &str) -> PyResult<Loaded> {
    let driver = match is_text(wanted) {
        true => TestDriver::parse(wanted, Path::new(TEXT)).map_err(run_error),
        false => TestDriver::load(Path::new(wanted)).map_err(|error| file_error(wanted, error)),
    };
    match driver? {
        TestDriver::Policy(policy) => NativePolicy::try_from(policy).map(Loaded::Policy),
        TestDriver::PolicyWithMap(DrivingPolicy { policy, .. }) => {
            let policy = NativePolicy::try_from(Arc::unwrap_or_clone(policy))?;
            Ok(Loaded::Policy(policy.given_map(true)))
        }
        TestDriver::Classical(config) => {
            to_ron(&config).map(Loaded::Driver).map_err(|error| PyRuntimeError::new_err(error.to_string()))
        }
    }
}

impl Tested<'_> {
    /// The driver for a test.
    pub fn driver(&self) -> PyResult<TestDriver> {
        match self {
            Self::Policy(policy) => {
                let driver = TestDriver::Policy(policy.policy.clone());
                if policy.with_map { driver.with_map(Path::new(TEXT)).map_err(run_error) } else { Ok(driver) }
            }
            Self::Driver(text) => TestDriver::parse(text, Path::new(TEXT)).map_err(run_error),
        }
    }
}
