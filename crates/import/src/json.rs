//! JSON files that hold many worlds, each with a number.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Deserialize;
use serde::de::{DeserializeOwned, IgnoredAny};
use wayfield_scenario::{FileError, Scenario, read_text_with_limit};

use crate::limits::MAX_WORLD_BYTES;
use crate::options::ImportOptions;
use crate::{Imported, barn, stages};

/// The key that distinguishes a file of stages from a file of BARN worlds.
#[derive(Deserialize)]
#[serde(expecting = "an object")]
struct Probe {
    stages: Option<IgnoredAny>,
}

/// The worlds in the file at `path`, each with a name: only world number `options.world` if that is set, otherwise all.
///
/// # Errors
/// The file is missing or invalid, has no such world, or a scenario would be invalid.
pub fn import_file(path: &Path, options: &ImportOptions) -> Result<Vec<(String, Imported)>, FileError> {
    import_text(&read_text_with_limit(path, MAX_WORLD_BYTES)?, path, options)
}

/// Like [`import_file`], with the text of the file.
///
/// # Errors
/// As for [`import_file`].
pub fn import_text(
    text: &str,
    path: &Path,
    options: &ImportOptions,
) -> Result<Vec<(String, Imported)>, FileError> {
    if is_of_stages(text, path)? {
        let import =
            |(number, stage)| Ok((format!("stage-{number}"), stages::import(path, number, stage, options)?));
        return chosen(stages::parse(text, path)?, path, options)?.into_iter().map(import).collect();
    }
    let file = barn::parse(text, path)?;
    let import =
        |(number, world)| Ok((format!("barn-{number:03}"), barn::import_one(path, &file, world, options)?));
    chosen(file.by_number(), path, options)?.into_iter().map(import).collect()
}

/// The scenario with the robot and the rules of the worlds in the file at `path`.
///
/// # Errors
/// The file is missing or not a JSON file.
pub fn implied_robot(path: &Path) -> Result<Scenario, FileError> {
    let text = read_text_with_limit(path, MAX_WORLD_BYTES)?;
    Ok(if is_of_stages(&text, path)? { stages::turtlebot() } else { barn::robot() })
}

/// Whether `text` is that of a file of stages, not of BARN worlds.
fn is_of_stages(text: &str, path: &Path) -> Result<bool, FileError> {
    let probe: Probe = parse(text, path, "BARN worlds or stages")?;
    Ok(probe.stages.is_some())
}

/// Parses the text of a file of `what`, such as "BARN worlds".
///
/// # Errors
/// The text is not such a file.
pub fn parse<T: DeserializeOwned>(text: &str, path: &Path, what: &str) -> Result<T, FileError> {
    serde_json::from_str(text).map_err(|error| {
        let start: usize = text.split_inclusive('\n').take(error.line().max(1) - 1).map(str::len).sum();
        let at = (start + error.column().saturating_sub(1)).min(text.len());
        let message = format!("not a file of {what}: {error}; help: see docs/import.md");
        FileError::at_offset(path, text, at, message)
    })
}

/// The world that `options` select, or all of them.
fn chosen<T>(
    mut worlds: BTreeMap<u32, T>,
    path: &Path,
    options: &ImportOptions,
) -> Result<BTreeMap<u32, T>, FileError> {
    let (Some(least), Some(most)) = (worlds.keys().next().copied(), worlds.keys().next_back().copied())
    else {
        return Err(FileError::for_file(path, "it contains no worlds; help: see docs/import.md"));
    };
    let Some(world) = options.world else { return Ok(worlds) };
    worlds.retain(|&number, _| number == world);
    if worlds.is_empty() {
        let message = format!(
            "it has no world {world}; help: --world takes a number from {least} to {most} that the file contains"
        );
        return Err(FileError::for_file(path, message));
    }
    Ok(worlds)
}
