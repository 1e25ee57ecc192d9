//! Whether scenarios and presets can be used, without using them: what `wayfield --check` does.
//!
//! In: paths of files and folders. Out: each file with what is wrong with it, if anything.

use std::io;
use std::path::{Path, PathBuf};

use super::preset::Preset;
use crate::scenario::{FileError, Scenario, read_text};

/// Fields that a preset has and a scenario has not.
const OF_PRESETS: [&str; 3] = ["arenas", "budget", "learning"];

/// A file that was looked at (or a folder in which there is none).
#[derive(Clone, Debug)]
pub struct CheckedFile {
    /// Where it is, as it was named.
    pub path: PathBuf,
    /// All that is wrong with it.
    pub error: Option<FileError>,
}

/// Looks at every file of `paths`, in their order. Of a folder these are all whose names end in `.ron`, in the order of
/// their names, those in its folders too; what is hidden (`.name`) is left out.
#[must_use]
pub fn check(paths: &[PathBuf]) -> Vec<CheckedFile> {
    let mut checked = Vec::new();
    for path in paths {
        if !path.is_dir() {
            checked.push(CheckedFile { path: path.clone(), error: wrong_with(path) });
            continue;
        }
        let before = checked.len();
        check_folder(path, &mut checked);
        if checked.len() == before {
            let message =
                "there is no .ron file in this folder: name a scenario, a preset, or a folder that has some";
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
            let error = wrong_with(&path);
            checked.push(CheckedFile { path, error });
        }
    }
}

/// What is in a folder and not hidden, in the order of the names, each with whether it is a folder itself. (A link to a
/// folder is none: it may lead back here.)
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

/// What is wrong with the scenario or preset at `path`.
fn wrong_with(path: &Path) -> Option<FileError> {
    let text = match read_text(path) {
        Ok(text) => text,
        Err(error) => return Some(error),
    };
    let as_scenario = Scenario::parse(&text, path).err()?;
    let as_preset = Preset::parse(&text, path).err()?;
    Some(if is_meant_as_preset(&text) { as_preset } else { as_scenario })
}

/// Whether a text that is neither has a field that only presets have.
fn is_meant_as_preset(text: &str) -> bool {
    text.split(['\n', ',', '(']).any(|piece| {
        let word = piece.split(':').next().unwrap_or_default().trim();
        word.len() < piece.trim().len() && OF_PRESETS.contains(&word)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_told_of_as_what_it_was_meant_to_be() {
        assert!(is_meant_as_preset("(\n    about: \"x\",\n    arenas: 16,\n)"));
        assert!(is_meant_as_preset("(budget : EnvSteps(1), lerning: ())"));
        assert!(!is_meant_as_preset("(name: \"arenas\", // learning is fun\n obstacles: [(shap: 1)])"));
    }
}
