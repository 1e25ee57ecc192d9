//! Presets that are based on another: they hold only the fields that differ.

use std::path::{Path, PathBuf};

use super::Preset;
use crate::run::shipped;
use crate::scenario::{
    Diagnostic, FileError, choose, overlay, parse_checked, parse_ron, path_exists, printable_path, read_text,
    to_ron,
};

/// The largest number of presets that are each based on the next.
const MAX_CHAIN: usize = 16;

/// The preset in `text`, complete: fields that it lacks come from the preset that it is based on. Values are not checked.
/// `chain` holds the files that led to this one, which is at `path`.
///
/// # Errors
/// The text, or one that it is based on, is not a preset; there is no such preset; or a preset is based on itself.
pub(super) fn read(text: &str, path: &Path, chain: &[PathBuf]) -> Result<Preset, FileError> {
    let preset = parse_checked(text, path, value_diagnostics, |_| Vec::new())?;
    let Some(name) = &preset.based_on else { return Ok(preset) };
    let fail = |message: String| {
        let diagnostic = Diagnostic { path: "based_on".into(), message };
        FileError::from_diagnostics(path, text, &[diagnostic])
    };
    let chain: Vec<PathBuf> = chain.iter().cloned().chain([identity(path)]).collect();
    let file = path.parent().unwrap_or(Path::new("")).join(name);
    let base = if path_exists(&file) && !file.is_dir() {
        if chain.contains(&identity(&file)) || chain.len() >= MAX_CHAIN {
            let files: Vec<_> = chain.iter().map(|file| printable_path(file)).collect();
            let files = files.join(" -> ");
            return Err(fail(format!(
                "leads to no end ({files}); help: remove the `based_on` of one of them"
            )));
        }
        read(&read_text(&file)?, &file, &chain)?
    } else {
        let names: Vec<_> = shipped::preset_names().collect();
        let (from, shipped) = shipped::preset_text(name).ok_or_else(|| {
            fail(format!(
                "names no file and no shipped preset: {}",
                choose(name, &names, "the shipped ones are")
            ))
        })?;
        read(shipped, Path::new(from), &chain)?
    };
    let base = to_ron(&base).map_err(|error| fail(error.to_string()))?;
    // Both texts are presets, so this one is.
    let preset: Preset = parse_ron(&overlay(&base, text), path)?;
    Ok(Preset { based_on: None, ..preset })
}

/// The invalid values in a preset's own file.
fn value_diagnostics(preset: &Preset) -> Vec<Diagnostic> {
    Preset { based_on: None, ..preset.clone() }.diagnostics()
}

/// The file at `path`, by the same path however it is named.
fn identity(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.into())
}
