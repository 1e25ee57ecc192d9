//! The files of sets of scenarios, and the scenarios that they name.
//!
//! In: the text of a set's file. Out: a checked [`ScenarioSet`].

use std::path::Path;

use super::preset::Preset;
use super::shipped;
use crate::scenario::{
    Diagnostic, FileError, Scenario, ScenarioSet, ScenarioSetFile, SetEntry, SetFit, SetMember, SetSource,
    read_text, resemblance,
};

/// Whether the fields of a file's text resemble those of a set of scenarios more than those of a scenario or a preset.
#[must_use]
pub fn looks_like(text: &str) -> bool {
    let others = [resemblance::<Scenario>(text, "Scenario"), resemblance::<Preset>(text, "Preset")];
    others.iter().all(|other| resemblance::<ScenarioSetFile>(text, "ScenarioSet") > *other)
}

/// The set in `text`, the contents of the file at `path`, with the scenarios that it names.
///
/// # Errors
/// The text is not a set, or a scenario cannot be read or is invalid.
pub fn parse(text: &str, path: &Path) -> Result<ScenarioSet, FileError> {
    let file = ScenarioSetFile::parse(text, path)?;
    let mut set = ScenarioSet { name: file.name.clone(), members: Vec::new() };
    let mut problems = Vec::new();
    for (k, entry) in file.scenarios.iter().enumerate() {
        let mut problem = |message| {
            let field = if entry.generator.is_some() { "generator" } else { "scenario" };
            problems.push(Diagnostic { path: format!("scenarios[{k}].{field}"), message });
        };
        let wanted = match named_file(path, entry.file()) {
            Ok(wanted) => wanted,
            Err(why) => {
                problem(format!("can't be used: {why}"));
                continue;
            }
        };
        match source(entry, &wanted) {
            Ok(source) => {
                set.members.push(SetMember { name: entry.name(), share: entry.share(), source });
            }
            Err(why) => problem(format!("can't be used: {why}")),
        }
    }
    if problems.is_empty() { Ok(set) } else { Err(FileError::from_diagnostics(path, text, &problems)) }
}

/// Checks that one policy can drive in all scenarios of `set`, which comes from the file or shipped name `from`.
///
/// # Errors
/// It cannot. The message names the scenario, with its line if the set has a file.
pub fn check_fit(set: &ScenarioSet, from: &str, fit: SetFit) -> Result<(), FileError> {
    let Some((k, message)) = set.misfit(fit) else { return Ok(()) };
    let (path, text) = (Path::new(from), read_text(Path::new(from)).unwrap_or_default());
    let field = match set.members[k].source {
        SetSource::Scenario(_) => "scenario",
        SetSource::Levels { .. } => "generator",
    };
    let diagnostic = Diagnostic { path: format!("scenarios[{k}].{field}"), message };
    Err(FileError::from_diagnostics(path, &text, &[diagnostic]))
}

/// The scenario, or the generator, in the file `wanted`, which `entry` names.
fn source(entry: &SetEntry, wanted: &str) -> Result<SetSource, String> {
    if entry.generator.is_none() {
        let scenario = shipped::scenario(wanted).map_err(|error| error.to_string())?;
        return Ok(SetSource::Scenario(Box::new(scenario)));
    }
    let loaded = shipped::Source::load(wanted).map_err(|error| error.to_string())?;
    let shipped::Source::Levels(generator) = loaded else {
        return Err("it is not a level generator; help: write `scenario:` instead of `generator:`".into());
    };
    let generator = Box::new(generator);
    let levels = SetSource::Levels { generator, levels: entry.levels() };
    levels.first().map_err(|error| error.to_string())?;
    Ok(levels)
}

/// The file or shipped name that the file at `from` refers to as `name`: the file with that path relative to the folder of `from`
/// if there is one, else `name` itself. `name` need not exist. It may end with the seed of a level, such as `:17`.
///
/// # Errors
/// It is a folder, a pipe or a device, and not a shipped scenario or level generator. An untrusted file must not name a pipe or
/// a device, because reading it might never end.
pub(super) fn named_file(from: &Path, name: &str) -> Result<String, String> {
    let beside = |name: &str| {
        let path = from.parent().map(|folder| folder.join(name)).filter(|path| path.is_file());
        path.map(|path| path.display().to_string())
    };
    let level_beside = || {
        let (file, seed) = shipped::split_seed(name);
        Some(format!("{}:{}", beside(file)?, seed?))
    };
    let wanted = beside(name).or_else(level_beside).unwrap_or_else(|| name.into());
    let (file, _) = shipped::split_seed(&wanted);
    let is_shipped = shipped::is_scenario(file) || shipped::is_level_generator(file);
    if Path::new(file).exists() && !Path::new(file).is_file() && !is_shipped {
        return Err("it is not a file; help: name a file".into());
    }
    Ok(wanted)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_and_a_level_of_a_file_are_relative_to_the_file_that_names_them() {
        let folder = tempfile::tempdir().expect("a folder");
        let mine = folder.path().join("mine.ron");
        std::fs::write(&mine, "()").expect("written");
        let named = |name: &str| named_file(&folder.path().join("suite.ron"), name);
        assert_eq!(named("mine.ron"), Ok(mine.display().to_string()));
        assert_eq!(named("mine.ron:17"), Ok(format!("{}:17", mine.display())));
        assert_eq!(named("mine.ron:x"), Ok("mine.ron:x".into()));
        assert_eq!(named("clutter:17"), Ok("clutter:17".into()));
        let a_folder = folder.path().display();
        assert!(named(&format!("{a_folder}:17")).is_err() && named(&a_folder.to_string()).is_err());
    }
}
