//! The check of scenario and preset files behind `wayfield --check`.
//!
//! In: paths of files and folders. Out: every file in them, with its problems.

use std::io;
use std::path::{Path, PathBuf};

use super::preset::Preset;
use crate::scenario::{FileError, Scenario, read_text};

/// Names of fields that only presets have.
const PRESET_FIELDS: [&str; 3] = ["arenas", "budget", "learning"];

/// A checked file, or a folder without files to check.
#[derive(Clone, Debug)]
pub struct CheckedFile {
    /// The path, as the user gave it.
    pub path: PathBuf,
    /// All problems; `None` for a valid file.
    pub error: Option<FileError>,
}

/// Checks the files in `paths`, in this order. In a folder, all files named `*.ron` are checked, sorted by
/// path and including subfolders; hidden files and folders (`.name`) are skipped.
#[must_use]
pub fn check(paths: &[PathBuf]) -> Vec<CheckedFile> {
    let mut checked = Vec::new();
    for path in paths {
        if !path.is_dir() {
            checked.push(CheckedFile { path: path.clone(), error: problems(path) });
            continue;
        }
        let before = checked.len();
        check_folder(path, &mut checked);
        if checked.len() == before {
            let message =
                "this folder has no .ron file; help: give a scenario or preset file, or a folder of them";
            let error = Some(FileError::for_file(path, message));
            checked.push(CheckedFile { path: path.clone(), error });
        }
    }
    checked
}

fn check_folder(folder: &Path, checked: &mut Vec<CheckedFile>) {
    let entries = match entries(folder) {
        Ok(entries) => entries,
        Err(error) => {
            let error = Some(FileError::for_file(folder, format!("this folder can't be read: {error}")));
            checked.push(CheckedFile { path: folder.into(), error });
            return;
        }
    };
    for (path, is_folder) in entries {
        if is_folder {
            check_folder(&path, checked);
        } else if path.extension().is_some_and(|ending| ending == "ron") {
            let error = problems(&path);
            checked.push(CheckedFile { path, error });
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

/// The problems of the scenario or preset at `path`; `None` if it is valid.
fn problems(path: &Path) -> Option<FileError> {
    let text = match read_text(path) {
        Ok(text) => text,
        Err(error) => return Some(error),
    };
    let as_scenario = Scenario::parse(&text, path).err()?;
    let as_preset = Preset::parse(&text, path).err()?;
    Some(if looks_like_preset(&text) { as_preset } else { as_scenario })
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
