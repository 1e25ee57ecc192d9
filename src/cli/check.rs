//! The mode `--check`: prints every problem of scenarios, presets and experiments, and what is doubtful about them.

use std::path::{Path, PathBuf};

use serde::Serialize;

use super::output::{print_json, print_stdout};
use crate::reproduce::Experiment;
use crate::run::RunError;
use crate::run::check_files::{self, CheckedFile};
use crate::run::progress::print_stderr;
use crate::scenario::LocatedDiagnostic;

/// The JSON object that `--check --json` prints.
#[derive(Serialize)]
struct CheckReport {
    /// The paths of all checked files.
    files: Vec<String>,
    problems: Vec<ProblemReport>,
    /// The doubtful settings of valid files.
    notes: Vec<NoteReport>,
}

#[derive(Serialize)]
struct ProblemReport {
    path: String,
    line: Option<usize>,
    column: Option<usize>,
    message: String,
}

#[derive(Serialize)]
struct NoteReport {
    /// "note" or "warning".
    level: String,
    #[serde(flatten)]
    problem: ProblemReport,
}

/// Checks the files and folders in `paths`, and prints one line per valid file, per problem and per note.
///
/// # Errors
/// A file is invalid.
pub fn run(paths: &[PathBuf], json: bool) -> Result<(), RunError> {
    let checked = checked_files(paths);
    if json {
        print_json(&CheckReport::new(&checked))?;
    } else {
        print_lines(&checked)?;
    }
    match checked.iter().filter(|file| file.error.is_some()).count() {
        0 => Ok(()),
        invalid => {
            Err(RunError::InvalidInput(format!("{invalid} of {} checked files are invalid", checked.len())))
        }
    }
}

/// The checked files in `paths`. A file is valid if it is a valid scenario, preset or experiment.
fn checked_files(paths: &[PathBuf]) -> Vec<CheckedFile> {
    let mut checked = check_files::check(paths);
    for file in &mut checked {
        if file.error.is_some() && Experiment::load(&file.path).is_ok() {
            file.error = None;
        }
    }
    checked
}

fn print_lines(checked: &[CheckedFile]) -> Result<(), RunError> {
    for file in checked {
        match &file.error {
            None => print_stdout(&format!("{}: ok\n", file.path.display()))?,
            Some(error) => print_stderr(&error.to_string()),
        }
        for (level, note) in &file.notes {
            let place = note.line_column.map_or(String::new(), |(line, column)| format!("{line}:{column}:"));
            print_stderr(&format!("{}:{place} {level}: {}", file.path.display(), note.message));
        }
    }
    Ok(())
}

impl CheckReport {
    fn new(checked: &[CheckedFile]) -> Self {
        let errors = checked.iter().filter_map(|file| file.error.as_ref());
        let problems = errors.flat_map(|error| {
            error.problems().iter().map(|problem| ProblemReport::new(error.path(), problem))
        });
        let notes = checked.iter().flat_map(|file| {
            file.notes.iter().map(|(level, note)| NoteReport {
                level: level.to_string(),
                problem: ProblemReport::new(&file.path, note),
            })
        });
        Self {
            files: checked.iter().map(|file| file.path.display().to_string()).collect(),
            problems: problems.collect(),
            notes: notes.collect(),
        }
    }
}

impl ProblemReport {
    fn new(path: &Path, problem: &LocatedDiagnostic) -> Self {
        Self {
            path: path.display().to_string(),
            line: problem.line_column.map(|(line, _)| line),
            column: problem.line_column.map(|(_, column)| column),
            message: problem.message.clone(),
        }
    }
}
