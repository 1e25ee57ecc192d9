//! Exceptions: converts wayfield's errors and panics to Python exceptions.

use std::any::Any;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use pyo3::exceptions::{PyFileNotFoundError, PyKeyboardInterrupt, PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use wayfield::env::VecEnvError;
use wayfield::run::RunError;
use wayfield::run::settings::SettingError;

/// The exception for an error of a run.
pub fn run_error(error: RunError) -> PyErr {
    match error {
        RunError::InvalidInput(message) => PyValueError::new_err(message),
        RunError::Failed(message) => PyRuntimeError::new_err(message),
        RunError::Stopped(message) => PyKeyboardInterrupt::new_err(message),
    }
}

/// The exception for an error in the file `wanted`: `FileNotFoundError` if there is no such file.
pub fn file_error(wanted: &str, error: impl Into<RunError>) -> PyErr {
    match error.into() {
        RunError::InvalidInput(message) if !Path::new(wanted).exists() => {
            PyFileNotFoundError::new_err(message)
        }
        error => run_error(error),
    }
}

/// The exception for invalid settings, one line per problem.
pub fn setting_errors(errors: Vec<SettingError>) -> PyErr {
    let lines: Vec<String> = errors.iter().map(ToString::to_string).collect();
    PyValueError::new_err(lines.join("\n"))
}

/// The exception for an error of an environment.
pub fn env_error(error: VecEnvError) -> PyErr {
    match error {
        VecEnvError::Step(_) | VecEnvError::Ended { .. } => PyRuntimeError::new_err(error.to_string()),
        _ => PyValueError::new_err(error.to_string()),
    }
}

/// The result of `work`, which runs without the GIL. A panic becomes a `RuntimeError`.
pub fn detached<T: Send>(py: Python<'_>, work: impl FnOnce() -> PyResult<T> + Send) -> PyResult<T> {
    py.detach(|| catch_unwind(AssertUnwindSafe(work))).unwrap_or_else(|panic| Err(internal_error(&*panic)))
}

/// Fails with `KeyboardInterrupt` if Ctrl-C was pressed. For code that runs without the GIL.
pub fn check_ctrl_c() -> PyResult<()> {
    Python::attach(|py| {
        py.check_signals()?;
        Ok(())
    })
}

fn internal_error(panic: &(dyn Any + Send)) -> PyErr {
    let text = panic.downcast_ref::<&str>().copied();
    let text = text.or_else(|| panic.downcast_ref::<String>().map(String::as_str)).unwrap_or("unknown");
    PyRuntimeError::new_err(format!(
        "internal error: {text}; help: please report it, with the call that caused it"
    ))
}
