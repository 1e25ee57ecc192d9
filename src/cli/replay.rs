//! The mode `--replay`: repeats a training session of the app and compares the results.

use std::path::Path;

use super::output::print_stdout;
use crate::app::session::journal;
use crate::run::RunError;

/// Repeats the session saved in `folder`.
///
/// # Errors
/// The session's files are missing or invalid, or the result differs from its checkpoint.
pub fn run(folder: &Path) -> Result<(), RunError> {
    let replayed = journal::verify(folder)?;
    let (steps, interventions) = (replayed.steps, replayed.interventions);
    if replayed.bit_identical {
        return print_stdout(&format!(
            "{steps} control steps, {interventions} interventions: bit-identical to the saved session\n"
        ));
    }
    Err(RunError::Failed(format!(
        "{}: after {steps} control steps and {interventions} interventions the result differs from the checkpoint; help: \
         replay it with the version and the kind of CPU that recorded it, and check that its files were not edited",
        folder.display()
    )))
}
