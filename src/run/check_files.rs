//! The check of scenario and preset files behind `wayfield --check`.
//!
//! In: paths of files and folders. Out: every file in them, with its problems, or its notes.

use std::io;
use std::path::{Path, PathBuf};

use super::notes::preset_notes;
use super::preset::Preset;
use crate::scenario::{FileError, LocatedDiagnostic, NoteLevel, Scenario, locate, notes, read_text};

/// Names of fields that only presets have.
const PRESET_FIELDS: [&str; 3] = ["arenas", "budget", "learning"];

/// A checked file, or a folder without files to check.
#[derive(Clone, Debug)]
pub struct CheckedFile {
    /// The path, as the user gave it.
    pub path: PathBuf,
    /// All problems; `None` for a valid file.
    pub error: Option<FileError>,
    /// The doubtful settings of a valid file, with their locations.
    pub notes: Vec<(NoteLevel, LocatedDiagnostic)>,
}

impl CheckedFile {
    /// The result for the scenario or preset at `path`.
    fn read(path: &Path) -> Self {
        match notes_of(path) {
            Ok(notes) => Self { path: path.into(), error: None, notes },
            Err(error) => Self::failed(path, error),
        }
    }

    fn failed(path: &Path, error: FileError) -> Self {
        Self { path: path.into(), error: Some(error), notes: Vec::new() }
    }
}

/// Checks the files in `paths`, in this order. In a folder, all files named `*.ron` are checked, sorted by
/// path and including subfolders; hidden files and folders (`.name`) are skipped.
#[must_use]
pub fn check(paths: &[PathBuf]) -> Vec<CheckedFile> {
    let mut checked = Vec::new();
    for path in paths {
        if !path.is_dir() {
            checked.push(CheckedFile::read(path));
            continue;
        }
        let before = checked.len();
        check_folder(path, &mut checked);
        if checked.len() == before {
            let message =
                "this folder has no .ron file; help: give a scenario or preset file, or a folder of them";
            checked.push(CheckedFile::failed(path, FileError::for_file(path, message)));
        }
    }
    checked
}

fn check_folder(folder: &Path, checked: &mut Vec<CheckedFile>) {
    let entries = match entries(folder) {
        Ok(entries) => entries,
        Err(error) => {
            let error = FileError::for_file(folder, format!("this folder can't be read: {error}"));
            checked.push(CheckedFile::failed(folder, error));
            return;
        }
    };
    for (path, is_folder) in entries {
        if is_folder {
            check_folder(&path, checked);
        } else if path.extension().is_some_and(|ending| ending == "ron") {
            checked.push(CheckedFile::read(&path));
        }
    }
}

/// The visible entries of a folder, sorted by path; the flag is true for a folder. Links to folders are left
/// out, because they may form a cycle.
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

/// The notes on the scenario or preset at `path`, or its problems.
fn notes_of(path: &Path) -> Result<Vec<(NoteLevel, LocatedDiagnostic)>, FileError> {
    let text = read_text(path)?;
    let found = match (Scenario::parse(&text, path), Preset::parse(&text, path)) {
        (Ok(scenario), _) => notes(&scenario),
        (_, Ok(preset)) => preset_notes(&preset, None, false),
        (_, Err(as_preset)) if looks_like_preset(&text) => return Err(as_preset),
        (Err(as_scenario), _) => return Err(as_scenario),
    };
    let located = locate(&text, found.iter().map(|note| &note.diagnostic));
    Ok(found.iter().map(|note| note.level).zip(located).collect())
}

/// Whether the text has a field that only presets have.
fn looks_like_preset(text: &str) -> bool {
    text.split(['\n', ',', '(']).any(|piece| {
        let word = piece.split(':').next().unwrap_or_default().trim();
        word.len() < piece.trim().len() && PRESET_FIELDS.contains(&word)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_invalid_file_with_preset_fields_looks_like_a_preset() {
        assert!(looks_like_preset("(\n    about: \"x\",\n    arenas: 16,\n)"));
        assert!(looks_like_preset("(budget : EnvSteps(1), lerning: ())"));
        assert!(!looks_like_preset("(name: \"arenas\", // learning is fun\n obstacles: [(shap: 1)])"));
    }
}
