//! The error type of unusable files, which names file, line and column of every problem.
//!
//! In: a path, the text if there is one, diagnostics. Out: [`FileError`], which prints one line
//! `path:line:column: problem: fix` per problem.

use std::fmt;
use std::path::{Path, PathBuf};

use wayfield_ron_patch::SourceMap;

use super::limits::MAX_PROBLEMS;
use super::text::{printable_path, without_mark};

/// A problem found by a check in a value that was read successfully.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Path of the field, such as `obstacles[2].shape.radius_m`.
    pub path: String,
    /// The problem and its fix, as the rest of a sentence that starts with the path.
    pub message: String,
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` {}", self.path, self.message)
    }
}

/// A problem of a file, with its location in the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LocatedDiagnostic {
    /// Line and column, both counted from 1, the column in characters. `None` for a problem of the whole file.
    pub line_column: Option<(usize, usize)>,
    /// The problem and its fix.
    pub message: String,
}

/// The error for an unusable file, with all of its problems.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileError {
    path: PathBuf,
    problems: Vec<LocatedDiagnostic>,
}

impl FileError {
    /// The error for a problem of the whole file.
    #[must_use]
    pub fn for_file(path: &Path, message: impl Into<String>) -> Self {
        Self {
            path: path.into(),
            problems: vec![LocatedDiagnostic { line_column: None, message: message.into() }],
        }
    }

    /// The error for a problem at a byte offset of the text.
    #[must_use]
    pub fn at_offset(path: &Path, text: &str, offset: usize, message: impl Into<String>) -> Self {
        Self::at_offsets(path, text, vec![(offset, message.into())])
    }

    /// The error for several problems at byte offsets of the text.
    #[must_use]
    pub(super) fn at_offsets(path: &Path, text: &str, problems: Vec<(usize, String)>) -> Self {
        let located =
            |(offset, message)| LocatedDiagnostic { line_column: Some(line_column(text, offset)), message };
        Self { path: path.into(), problems: problems.into_iter().map(located).collect() }
    }

    /// The error for the problems that a check found, as [`locate`] locates them. Only the first [`MAX_PROBLEMS`] are kept.
    #[must_use]
    pub fn from_diagnostics(path: &Path, text: &str, diagnostics: &[Diagnostic]) -> Self {
        let mut problems = locate(text, diagnostics.iter().take(MAX_PROBLEMS));
        if let Some(more @ 1..) = diagnostics.len().checked_sub(MAX_PROBLEMS) {
            let message = format!("and {more} more problems: fix some and check again");
            problems.push(LocatedDiagnostic { line_column: None, message });
        }
        Self { path: path.into(), problems }
    }

    /// Path of the file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// All problems; never empty.
    #[must_use]
    pub fn problems(&self) -> &[LocatedDiagnostic] {
        &self.problems
    }
}

impl std::error::Error for FileError {}

impl fmt::Display for FileError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (k, problem) in self.problems.iter().enumerate() {
            if k > 0 {
                f.write_str("\n")?;
            }
            write!(f, "{}:", printable_path(&self.path))?;
            if let Some((line, column)) = problem.line_column {
                write!(f, "{line}:{column}:")?;
            }
            write!(f, " {}", problem.message)?;
        }
        Ok(())
    }
}

/// The locations of `diagnostics` in the text of their file: at the field, or at the start of the value if the text omits
/// the field.
pub fn locate<'d>(text: &str, diagnostics: impl Iterator<Item = &'d Diagnostic>) -> Vec<LocatedDiagnostic> {
    let text = without_mark(text);
    let source_map = SourceMap::new(text);
    let located = |found: &Diagnostic| LocatedDiagnostic {
        line_column: source_map
            .offset_of(&found.path)
            .or_else(|| source_map.start())
            .map(|offset| line_column(text, offset)),
        message: found.to_string(),
    };
    diagnostics.map(located).collect()
}

/// `path` as text. Runs record the names of their files as text, so that a file whose name is not UTF-8 could not be found
/// again.
///
/// # Errors
/// The path is not UTF-8.
pub fn utf8(path: &Path) -> Result<&str, FileError> {
    path.to_str().ok_or_else(|| FileError::for_file(path, "the file's name is not valid UTF-8: rename it"))
}

/// Line and column, counted from 1, of the character at a byte offset.
fn line_column(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset).unwrap_or(text);
    let line = 1 + before.bytes().filter(|&byte| byte == b'\n').count();
    let column = 1 + before.chars().rev().take_while(|&c| c != '\n').count();
    (line, column)
}
