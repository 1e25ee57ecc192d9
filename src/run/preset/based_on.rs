//! Presets that are based on another: they hold only the fields that differ.

use std::cell::OnceCell;
use std::path::{Path, PathBuf};

use super::Preset;
use crate::run::shipped;
use crate::scenario::{
    Diagnostic, FileError, LocatedDiagnostic, choose, has_field, locate, overlay, parse_checked, parse_ron,
    path_exists, printable_path, read_text, to_ron,
};

/// The largest number of presets that are each based on the next.
const MAX_CHAIN: usize = 16;

/// The preset in `text`, complete: fields that it lacks come from the preset that it is based on. The values of the result are
/// not checked. `path` is the file of `text`, and `chain` holds the files that led to it.
///
/// # Errors
/// `text`, or a preset that it is based on, is not a preset or does not exist; or the chain is circular or too long. The error
/// also lists the invalid values of `text`.
pub(super) fn read(text: &str, path: &Path, chain: &[PathBuf]) -> Result<Preset, FileError> {
    let base = OnceCell::new();
    let read_base = |preset: &Preset| base.get_or_init(|| base_of(preset, text, path, chain));
    let check_known = |preset: &Preset, unknown: &[String]| {
        if !unknown.iter().any(|path| path == "based_on") {
            read_base(preset);
        }
        preset.value_diagnostics()
    };
    let check = |preset: &Preset| match read_base(preset) {
        Ok(_) => Vec::new(),
        Err(_) => preset.value_diagnostics(),
    };
    let parsed = parse_checked(text, path, check_known, check);
    let with_scenario = |preset: Preset| match &preset.scenario {
        Some(name) if has_field(text, "scenario") => {
            Preset { scenario: Some(scenario_of(name, path)), ..preset }
        }
        _ => preset,
    };
    match (parsed, base.into_inner()) {
        (Err(own), Some(Err(of_base))) => Err(own.with_problems_of(of_base)),
        (Ok(_), Some(Err(of_base))) => Err(of_base),
        (Ok(_), Some(Ok(Some(base)))) => {
            let base = to_ron(&base).map_err(|error| FileError::for_file(path, error.to_string()))?;
            // Both texts are presets, so their overlay is one.
            let preset: Preset = parse_ron(&overlay(&base, text), path)?;
            Ok(with_scenario(Preset { based_on: None, ..preset }))
        }
        (parsed, _) => parsed.map(with_scenario),
    }
}

/// The complete preset that `preset` is based on, if any; `preset` was read from `text`, the file at `path`.
fn base_of(preset: &Preset, text: &str, path: &Path, chain: &[PathBuf]) -> Result<Option<Preset>, FileError> {
    let Some(name) = &preset.based_on else { return Ok(None) };
    let fail = |message: String| {
        let diagnostic = Diagnostic { path: "based_on".into(), message };
        FileError::from_diagnostics(path, text, &[diagnostic])
    };
    let chain: Vec<PathBuf> = chain.iter().cloned().chain([canonical(path)]).collect();
    let file = file_of(name, path);
    if chain.contains(&canonical(&file)) || chain.len() >= MAX_CHAIN {
        let files: Vec<_> = chain.iter().map(|file| printable_path(file)).collect();
        let files = files.join(" -> ");
        return Err(fail(format!(
            "is circular or too long ({files}); help: remove the `based_on` of one of them"
        )));
    }
    let Some((file, text)) = base_text(name, path)? else {
        let names: Vec<_> = shipped::preset_names().collect();
        let known = choose(name, &names, "the shipped ones are");
        return Err(fail(format!("names no file and no shipped preset: {known}")));
    };
    read(&text, &file, &chain).map(Some)
}

/// The locations of `diagnostics` about the complete preset of `text`, the file at `path`. A diagnostic about an inherited field
/// is located in the file that the field comes from.
pub(super) fn locate_fields<'d>(
    text: &str,
    path: &Path,
    diagnostics: impl Iterator<Item = &'d Diagnostic>,
) -> Vec<LocatedDiagnostic> {
    let files = files(text, path);
    let located = |found: &Diagnostic| {
        let holder = files.iter().find(|(_, text)| has_field(text, &found.path));
        match holder.filter(|(file, _)| file != path) {
            Some((file, text)) => {
                locate(text, [found].into_iter()).into_iter().map(|at| at.in_file(file)).next()
            }
            None => locate(text, [found].into_iter()).into_iter().next(),
        }
    };
    diagnostics.filter_map(located).collect()
}

/// The files of a valid preset, with their texts: its own, then those that it is based on.
fn files(text: &str, path: &Path) -> Vec<(PathBuf, String)> {
    let mut files = vec![(path.to_path_buf(), text.to_owned())];
    while files.len() <= MAX_CHAIN {
        let (path, text) = &files[files.len() - 1];
        let preset: Option<Preset> = parse_ron(text, path).ok();
        let Some(name) = preset.and_then(|preset| preset.based_on) else { break };
        let Ok(Some(base)) = base_text(&name, path) else { break };
        files.push(base);
    }
    files
}

/// The file and the text of the preset `name`, on which the preset at `path` is based; `None` if there is no such file or
/// shipped preset.
fn base_text(name: &str, path: &Path) -> Result<Option<(PathBuf, String)>, FileError> {
    let file = file_of(name, path);
    if path_exists(&file) && !file.is_dir() {
        let text = read_text(&file)?;
        return Ok(Some((file, text)));
    }
    Ok(shipped::preset_text(name).map(|(from, text)| (from.into(), text.to_owned())))
}

/// The scenario `name` of the preset at `path`: the file of this name, relative to the preset, or else the name itself.
fn scenario_of(name: &str, path: &Path) -> String {
    let file = file_of(name, path);
    // A folder that happens to be called `hall` does not hide the shipped scenario.
    if path_exists(&file) && !file.is_dir() { file.display().to_string() } else { name.into() }
}

/// The file of this name, relative to the preset at `path`.
fn file_of(name: &str, path: &Path) -> PathBuf {
    path.parent().unwrap_or(Path::new("")).join(name)
}

/// The canonical form of `path`, to compare files whose paths are spelled differently.
fn canonical(path: &Path) -> PathBuf {
    path.canonicalize().unwrap_or_else(|_| path.into())
}
