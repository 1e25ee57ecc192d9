//! Output of results on stdout.

use std::io::{ErrorKind, Write};

use serde::Serialize;

use crate::run::RunError;

/// Prints `value` as one line of JSON.
///
/// # Errors
/// Stdout cannot be written.
pub fn print_json(value: &impl Serialize) -> Result<(), RunError> {
    let text = serde_json::to_string(value).map_err(|error| RunError::Failed(error.to_string()))?;
    print_stdout(&format!("{text}\n"))
}

/// Prints `text`.
///
/// # Errors
/// Stdout cannot be written. A reader that closes the pipe early (`| head`) is not an error.
pub fn print_stdout(text: &str) -> Result<(), RunError> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(RunError::Failed(format!("stdout: the results can't be written: {error}")))
        }
        _ => Ok(()),
    }
}
