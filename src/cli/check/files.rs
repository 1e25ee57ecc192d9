//! The files that `wayfield --check` checks.
//!
//! In: paths of files and folders. Out: every file given or found, with its kind, and its problems or its notes.

use std::io;
use std::path::{Path, PathBuf};

use super::kind::{self, FileKind, LocatedNotes};
use crate::scenario::{FileError, is_special_file};

/// A checked file, or a folder that can't be read or has no files to check.
#[derive(Clone, Debug)]
pub struct CheckedFile {
    /// The path as the user gave it, or below a folder that the user gave.
    pub path: PathBuf,
    /// The kind of the file; `None` if it can't be read.
    pub kind: Option<FileKind>,
    /// All problems; `None` for a valid file.
    pub error: Option<FileError>,
    /// The questionable settings of a valid file.
    pub notes: LocatedNotes,
}

impl CheckedFile {
    fn new(path: PathBuf) -> Self {
        let (kind, checked) = kind::check(&path);
        match checked {
            Ok(notes) => Self { path, kind, error: None, notes },
            Err(error) => Self { path, kind, error: Some(error), notes: Vec::new() },
        }
    }

    fn unreadable(path: PathBuf, message: impl Into<String>) -> Self {
        let error = Some(FileError::for_file(&path, message));
        Self { path, kind: None, error, notes: Vec::new() }
    }
}

/// Checks the files and folders in `paths`, in this order. In a folder and its subfolders, all files named `*.ron` are checked,
/// sorted by path; hidden files and folders (`.name`) are skipped.
#[must_use]
pub fn check(paths: &[PathBuf]) -> Vec<CheckedFile> {
    let mut checked = Vec::new();
    for path in paths {
        if !path.is_dir() {
            checked.push(CheckedFile::new(path.clone()));
            continue;
        }
        let before = checked.len();
        check_folder(path, &mut checked);
        if checked.len() == before {
            let message =
                "this folder has no .ron file; help: give a scenario or preset file, or a folder of them";
            checked.push(CheckedFile::unreadable(path.clone(), message));
        }
    }
    checked
}

fn check_folder(folder: &Path, checked: &mut Vec<CheckedFile>) {
    let entries = match entries(folder) {
        Ok(entries) => entries,
        Err(error) => {
            let message = format!("this folder can't be read: {error}");
            checked.push(CheckedFile::unreadable(folder.into(), message));
            return;
        }
    };
    for (path, is_folder) in entries {
        if is_folder {
            check_folder(&path, checked);
        } else if path.extension().is_some_and(|ending| ending == "ron") {
            // Reading a pipe in a folder could block for ever. A pipe that the user names explicitly is read.
            checked.push(if is_special_file(&path) {
                CheckedFile::unreadable(
                    path,
                    "this is a pipe, a socket or a device, not a file; help: remove it",
                )
            } else {
                CheckedFile::new(path)
            });
        }
    }
}

/// The entries of a folder that are not hidden, sorted by path; the flag is true for a folder. Links to folders are left out,
/// because they may form a cycle.
fn entries(folder: &Path) -> io::Result<Vec<(PathBuf, bool)>> {
    let mut entries = Vec::new();
    for entry in std::fs::read_dir(folder)? {
        let entry = entry?;
        let is_folder = entry.file_type()?.is_dir();
        if !entry.file_name().to_string_lossy().starts_with('.') && (is_folder || !entry.path().is_dir()) {
            entries.push((entry.path(), is_folder));
        }
    }
    entries.sort();
    Ok(entries)
}
