//! What is wrong with a file, in a form that an editor can jump to.
//!
//! In: a path, the text where there is one, findings. Out: [`FileError`], which prints one line
//! `path:line:column: what is wrong: how to mend it` for each thing.

use std::fmt;
use std::path::{Path, PathBuf};

use wayfield_ron_patch::SourceMap;

/// At most so many problems of one file are reported; the rest are counted.
const MAX_PROBLEMS: usize = 100;

/// Something in a file that reads well but can't be meant: found by a check.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Diagnostic {
    /// Where: the field's path, such as `obstacles[2].shape.radius_m`.
    pub path: String,
    /// What is wrong and how to mend it; the line starts with the path, so this goes on after it.
    pub message: String,
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "`{}` {}", self.path, self.message)
    }
}

/// One thing wrong with a file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct LocatedDiagnostic {
    /// Line and column, both from 1, the column in characters; none when it has no place in the text.
    pub line_column: Option<(usize, usize)>,
    /// What is wrong and how to mend it.
    pub message: String,
}

/// A file that can't be used, with everything that is wrong with it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FileError {
    path: PathBuf,
    problems: Vec<LocatedDiagnostic>,
}

impl FileError {
    /// A problem of the file as a whole.
    #[must_use]
    pub fn for_file(path: &Path, message: impl Into<String>) -> Self {
        Self {
            path: path.into(),
            problems: vec![LocatedDiagnostic { line_column: None, message: message.into() }],
        }
    }

    /// A problem at a byte offset of the file's text.
    #[must_use]
    pub fn at_offset(path: &Path, text: &str, offset: usize, message: impl Into<String>) -> Self {
        let line_column = Some(line_column(text, offset));
        Self { path: path.into(), problems: vec![LocatedDiagnostic { line_column, message: message.into() }] }
    }

    /// What a check found, each placed in the text where the text has its field, or at its beginning where that is left
    /// out. Only the first hundred are
    /// kept.
    #[must_use]
    pub fn from_diagnostics(path: &Path, text: &str, diagnostics: &[Diagnostic]) -> Self {
        let outline = SourceMap::new(text);
        let mut problems: Vec<_> = diagnostics
            .iter()
            .take(MAX_PROBLEMS)
            .map(|finding| LocatedDiagnostic {
                line_column: outline
                    .offset_of(&finding.path)
                    .or_else(|| outline.start())
                    .map(|offset| line_column(text, offset)),
                message: finding.to_string(),
            })
            .collect();
        if let Some(more @ 1..) = diagnostics.len().checked_sub(MAX_PROBLEMS) {
            let message = format!("and {more} more like these: mend some and look again");
            problems.push(LocatedDiagnostic { line_column: None, message });
        }
        Self { path: path.into(), problems }
    }

    /// The file.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// All that is wrong with it, never empty.
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
            write!(f, "{}:", self.path.display())?;
            if let Some((line, column)) = problem.line_column {
                write!(f, "{line}:{column}:")?;
            }
            write!(f, " {}", problem.message)?;
        }
        Ok(())
    }
}

/// The line and column, from 1, of a byte offset (a character's first byte, or the text's end).
fn line_column(text: &str, offset: usize) -> (usize, usize) {
    let before = text.get(..offset).unwrap_or(text);
    let line = 1 + before.bytes().filter(|&byte| byte == b'\n').count();
    let column = 1 + before.chars().rev().take_while(|&c| c != '\n').count();
    (line, column)
}
