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
    /// Path of the field, such as `obstacles[2].shape.radius_m`; empty for the whole file.
    pub path: String,
    /// The problem and its fix, as the rest of a sentence that starts with the path; a whole sentence if the path is empty.
    pub message: String,
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.path.is_empty() {
            f.write_str(&self.message)
        } else {
            write!(f, "`{}` {}", self.path, self.message)
        }
    }
}

/// Whether two fields, given by their paths, are the same, or one contains the other.
#[must_use]
pub fn overlap(a: &str, b: &str) -> bool {
    let (short, long) = if a.len() <= b.len() { (a, b) } else { (b, a) };
    long.strip_prefix(short)
        .is_some_and(|rest| short.is_empty() || rest.is_empty() || rest.starts_with(['.', '[']))
}

/// A problem of a file, with its location in the text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LocatedDiagnostic {
    /// Line and column, both counted from 1, the column in characters. `None` for a problem of the whole file.
    pub line_column: Option<(usize, usize)>,
    /// The problem and its fix.
    pub message: String,
    /// The file, if it is not the one that was read, but one that it names.
    pub file: Option<PathBuf>,
}

impl LocatedDiagnostic {
    /// This problem, located in `file` instead of the file that was read.
    #[must_use]
    pub fn in_file(self, file: &Path) -> Self {
        Self { file: Some(file.into()), ..self }
    }
}

/// The error for an unusable file, with its problems.
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
            problems: vec![LocatedDiagnostic { line_column: None, message: message.into(), file: None }],
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
        let located = |(offset, message)| LocatedDiagnostic {
            line_column: Some(line_column(text, offset)),
            message,
            file: None,
        };
        Self::first_of(path, problems.len(), problems.into_iter().take(MAX_PROBLEMS).map(located).collect())
    }

    /// The error for `count` problems, of which the first are given.
    fn first_of(path: &Path, count: usize, mut problems: Vec<LocatedDiagnostic>) -> Self {
        if let Some(more @ 1..) = count.checked_sub(MAX_PROBLEMS) {
            let noun = if more == 1 { "problem" } else { "problems" };
            let message = format!("and {more} more {noun}: fix some and check again");
            problems.push(LocatedDiagnostic { line_column: None, message, file: None });
        }
        Self { path: path.into(), problems }
    }

    /// The error for at least one located problem. Only the first [`MAX_PROBLEMS`] are kept.
    #[must_use]
    pub fn from_located(path: &Path, mut problems: Vec<LocatedDiagnostic>) -> Self {
        let count = problems.len();
        problems.truncate(MAX_PROBLEMS);
        Self::first_of(path, count, problems)
    }

    /// This error with the problems of `other`, an error for a file that this file names.
    #[must_use]
    pub fn with_problems_of(mut self, other: Self) -> Self {
        let is_same = other.path == self.path;
        let of_other = other.problems.into_iter();
        self.problems.extend(of_other.map(|found| match found.file {
            None if !is_same => found.in_file(&other.path),
            _ => found,
        }));
        self
    }

    /// The error for the problems that a check found, as [`locate`] locates them. Only the first [`MAX_PROBLEMS`] are kept.
    #[must_use]
    pub fn from_diagnostics(path: &Path, text: &str, diagnostics: &[Diagnostic]) -> Self {
        Self::first_of(path, diagnostics.len(), locate(text, diagnostics.iter().take(MAX_PROBLEMS)))
    }

    /// Path of the file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The problems; never empty. Of more than [`MAX_PROBLEMS`], the first and the number of the others.
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
            write!(f, "{}:", printable_path(problem.file.as_ref().unwrap_or(&self.path)))?;
            if let Some((line, column)) = problem.line_column {
                write!(f, "{line}:{column}:")?;
            }
            write!(f, " {}", problem.message)?;
        }
        Ok(())
    }
}

/// The locations of `diagnostics` in the text of their file: at the field or, if the text omits it, at the innermost field around
/// it that the text contains, or at the start of the top-level value. A diagnostic without a path has no location.
pub fn locate<'d>(text: &str, diagnostics: impl Iterator<Item = &'d Diagnostic>) -> Vec<LocatedDiagnostic> {
    let text = without_mark(text);
    let source_map = SourceMap::new(text);
    let located = |found: &Diagnostic| LocatedDiagnostic {
        line_column: Some(&found.path)
            .filter(|path| !path.is_empty())
            .and_then(|path| source_map.offset_of(path).or_else(|| source_map.start()))
            .map(|offset| line_column(text, offset)),
        message: found.to_string(),
        file: None,
    };
    diagnostics.map(located).collect()
}

/// Whether a RON text contains the field at `path`.
#[must_use]
pub fn has_field(text: &str, path: &str) -> bool {
    let map = SourceMap::new(without_mark(text));
    map.offset_of(path).is_some_and(|at| map.path_at(at) == path)
}

/// `path` as text. Runs record the paths of their files as text, so a file whose path is not UTF-8 could not be found again.
///
/// # Errors
/// The path is not UTF-8.
pub fn utf8_path(path: &Path) -> Result<&str, FileError> {
    path.to_str().ok_or_else(|| {
        FileError::for_file(path, "the path is not valid UTF-8: rename the file or its folder")
    })
}

/// Line and column, counted from 1, of the character at a byte offset.
fn line_column(text: &str, offset: usize) -> (usize, usize) {
    let before = &text[..text.floor_char_boundary(offset)];
    let line = 1 + before.bytes().filter(|&byte| byte == b'\n').count();
    let column = 1 + before.chars().rev().take_while(|&c| c != '\n').count();
    (line, column)
}
