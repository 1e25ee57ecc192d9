//! Exceptions: converts wayfield's errors and panics to Python exceptions.

use std::any::Any;
use std::fs::{File, metadata};
use std::io::ErrorKind;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;

use pyo3::exceptions::{
    PyFileNotFoundError, PyIsADirectoryError, PyKeyboardInterrupt, PyOSError, PyPermissionError,
    PyRuntimeError, PyValueError,
};
use pyo3::prelude::*;
use wayfield::drivers::DriverConfig;
use wayfield::env::VecEnvError;
use wayfield::run::RunError;
use wayfield::run::policy_card::WITH_MAP;
use wayfield::run::settings::SettingError;
use wayfield::run::shipped;

/// The exception for an error of a run.
pub fn run_error(error: RunError) -> PyErr {
    match error {
        RunError::InvalidInput(message) => PyValueError::new_err(message),
        RunError::Failed(message) => PyRuntimeError::new_err(message),
        RunError::Stopped(message) => PyKeyboardInterrupt::new_err(message),
    }
}

/// The exception for an error in the file `wanted`, which may be a shipped name: the one that Python's `open` raises if the file
/// cannot be opened.
pub fn file_error(wanted: &str, error: impl Into<RunError>) -> PyErr {
    let message = match error.into() {
        RunError::InvalidInput(message) => message,
        error => return run_error(error),
    };
    let file = shipped::split_seed(wanted.trim_end_matches(WITH_MAP)).0;
    let is_shipped = shipped::is_any(file) || DriverConfig::shipped(file).is_some();
    // The name of a scenario is no preset.
    if file == "-" || is_shipped && !message.contains("no such file") {
        return PyValueError::new_err(message);
    }
    match open_problem(Path::new(file)) {
        Some(ErrorKind::NotFound) => PyFileNotFoundError::new_err(message),
        Some(ErrorKind::IsADirectory) => PyIsADirectoryError::new_err(message),
        Some(ErrorKind::PermissionDenied) => PyPermissionError::new_err(message),
        Some(_) => PyOSError::new_err(message),
        None => PyValueError::new_err(message),
    }
}

/// Why the file at `path` cannot be opened; `None` if it can. A pipe is not opened: that may block.
fn open_problem(path: &Path) -> Option<ErrorKind> {
    match metadata(path) {
        Ok(found) if found.is_dir() => Some(ErrorKind::IsADirectory),
        Ok(found) if found.is_file() => File::open(path).err().map(|error| error.kind()),
        Ok(_) => None,
        Err(error) => Some(error.kind()),
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
