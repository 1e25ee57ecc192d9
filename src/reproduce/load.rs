//! Reading and checking an experiment's file.

use std::path::Path;

use super::check;
use super::experiment::Experiment;
use crate::scenario::{Diagnostic, FileError, parse_checked, read_text};

impl Experiment {
    /// Reads and checks the experiment in the file at `path`.
    ///
    /// # Errors
    /// The file cannot be read, is not an experiment, or has invalid values. The error names file, line and column, and
    /// how to fix it.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        Self::parse(&read_text(path)?, path)
    }

    /// Reads and checks the experiment in `text`; `path` is only used in errors.
    ///
    /// # Errors
    /// As for [`Experiment::load`].
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self, FileError> {
        parse_checked(text, path, check::diagnostics, Self::diagnostics)
    }

    /// All invalid values, with their fixes; empty for a valid experiment.
    #[must_use]
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        check::diagnostics(self, &[])
    }
}
