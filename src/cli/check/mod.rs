//! The mode `--check`: prints every problem in scenarios, presets, policies and files of the other kinds in `kind.rs`.

mod files;
pub mod kind;

use std::path::{Path, PathBuf};

use serde::Serialize;

use self::files::CheckedFile;
use self::kind::FileKind;
use super::output::{print_json, print_stdout};
use crate::run::RunError;
use crate::run::progress::print_stderr;
use crate::scenario::{LocatedDiagnostic, printable_path};

/// The JSON object that `--check --json` prints.
#[derive(Serialize)]
pub struct CheckReport {
    /// The paths of all checked files.
    files: Vec<String>,
    /// The kinds of these files, in the same order; null for a file that can't be read.
    kinds: Vec<Option<&'static str>>,
    problems: Vec<ProblemReport>,
    /// The questionable settings of valid files.
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

/// Checks the files and folders in `paths`.
#[must_use]
pub fn check_files(paths: &[PathBuf]) -> CheckReport {
    CheckReport::new(&files::check(paths))
}

/// Checks the files and folders in `paths`, and prints one line per valid file, per problem and per note.
///
/// # Errors
/// A file is invalid.
pub fn run(paths: &[PathBuf], json: bool) -> Result<(), RunError> {
    let checked = files::check(paths);
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

fn print_lines(checked: &[CheckedFile]) -> Result<(), RunError> {
    for file in checked {
        let path = printable_path(&file.path);
        let kind = file.kind.map(FileKind::name);
        match (&file.error, kind) {
            (None, kind) => print_stdout(&format!("{path}: ok ({})\n", kind.unwrap_or_default()))?,
            (Some(error), None) => print_stderr(&error.to_string()),
            (Some(error), Some(kind)) => {
                let count = error.problems().len();
                let plural = if count == 1 { "" } else { "s" };
                print_stderr(&format!("{error}\n{path}: {count} problem{plural} in this {kind}"));
            }
        }
        for (level, note) in &file.notes {
            let path = note.file.as_deref().map_or_else(|| path.clone(), printable_path);
            let place = note.line_column.map_or(String::new(), |(line, column)| format!("{line}:{column}:"));
            print_stderr(&format!("{path}:{place} {level}: {}", note.message));
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
            kinds: checked.iter().map(|file| file.kind.map(FileKind::name)).collect(),
            problems: problems.collect(),
            notes: notes.collect(),
        }
    }
}

impl ProblemReport {
    fn new(path: &Path, problem: &LocatedDiagnostic) -> Self {
        Self {
            path: problem.file.as_deref().unwrap_or(path).display().to_string(),
            line: problem.line_column.map(|(line, _)| line),
            column: problem.line_column.map(|(_, column)| column),
            message: problem.message.clone(),
        }
    }
}
