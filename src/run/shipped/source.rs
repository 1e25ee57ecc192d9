//! The meaning of a name after `--scenario`: a scenario, a level of a generator, a level generator, or a set of scenarios.

use std::path::Path;

use super::super::scenario_set;
use super::{GENERAL_GENERATORS, GENERATORS, SCENARIOS, SETS, find, user_file};
use crate::import::{ImportOptions, import, is_map_or_world};
use crate::scenario::{FileError, LevelGenerator, Scenario, ScenarioSet, path_exists};

/// A scenario, a generator of scenarios, or a set of scenarios.
#[derive(Clone, Debug, PartialEq)]
pub enum Source {
    /// A scenario, or a level of a generator.
    Scenario(Scenario),
    /// A level generator.
    Levels(LevelGenerator),
    /// The first scenario of a set, and the set.
    Set(Box<Scenario>, ScenarioSet),
}

impl Source {
    /// The scenario, level generator or set in the file `wanted`, which may be the `config.ron` of a run, or the shipped one of
    /// that name. A ROS map or a Gazebo world is imported for the robot of Scenario I. A seed after a
    /// colon, as in `clutter:17`, selects the generator's level with this seed.
    ///
    /// # Errors
    /// As for [`Scenario::load`] and [`LevelGenerator::load`]; for an unknown name, the message names the closest shipped one.
    /// It is also an error if there is a seed, but `wanted` is not a generator or has no level with this seed.
    pub fn load(wanted: &str) -> Result<Self, FileError> {
        let (file, seed) = split_seed(wanted);
        let path = Path::new(file);
        let source = if let Some(imported) = imported(path) {
            Self::Scenario(imported?)
        } else if let Some(shipped) = find(SCENARIOS, file) {
            Self::Scenario(Scenario::parse(shipped.text, shipped.path)?)
        } else if let Some(shipped) = find(GENERATORS, file).or_else(|| find(GENERAL_GENERATORS, file)) {
            Self::Levels(LevelGenerator::parse(shipped.text, shipped.path)?)
        } else if let Some(shipped) = find(SETS, file) {
            Self::parse(shipped.text, Path::new(shipped.path))?
        } else {
            user_file(
                file,
                SCENARIOS,
                |text| Self::parse(text, path),
                |config| match config.scenario_set {
                    Some(set) => Self::Set(Box::new(config.scenario), set),
                    None => Self::Scenario(config.scenario),
                },
            )?
        };
        match (source, seed) {
            (Self::Levels(generator), Some(seed)) => level(&generator, seed, path).map(Self::Scenario),
            (Self::Scenario(_), Some(seed)) => Err(no_levels("scenario", seed, path)),
            (Self::Set(..), Some(seed)) => Err(no_levels("set of scenarios", seed, path)),
            (source, None) => Ok(source),
        }
    }

    /// The scenario, level generator or set in the RON text `text`, which is called `path` in messages.
    ///
    /// # Errors
    /// As for [`load`](Self::load).
    pub fn parse(text: &str, path: &Path) -> Result<Self, FileError> {
        if scenario_set::looks_like(text) {
            let set = scenario_set::parse(text, path)?;
            let first = set.members.first().map(|member| member.source.first()).transpose();
            let first = first.map_err(|error| FileError::for_file(path, error.to_string()))?;
            Ok(Self::Set(Box::new(first.unwrap_or_default()), set))
        } else if LevelGenerator::looks_like(text) {
            LevelGenerator::parse(text, path).map(Self::Levels)
        } else {
            Scenario::parse(text, path).map(Self::Scenario)
        }
    }

    /// The scenario itself, or level 0 of the generator in the file `wanted`.
    ///
    /// # Errors
    /// The generator has no level 0; or the source is a set, and the message names its scenarios.
    pub fn into_scenario(self, wanted: &str) -> Result<Scenario, FileError> {
        match self {
            Self::Scenario(scenario) => Ok(scenario),
            Self::Set(_, set) => {
                let names: Vec<&str> = set.members.iter().map(|member| member.name.as_str()).collect();
                let why = format!(
                    "is a set of scenarios ({}), but one scenario is needed here; help: give one of them",
                    names.join(", ")
                );
                Err(FileError::for_file(Path::new(wanted), why))
            }
            Self::Levels(generator) => level(&generator, 0, Path::new(wanted)),
        }
    }
}

/// The scenario of the map or world at `path`; `None` if it is neither.
fn imported(path: &Path) -> Option<Result<Scenario, FileError>> {
    let is_imported = is_map_or_world(path) && path_exists(path);
    is_imported.then(|| import(path, &ImportOptions::default()).map(|imported| imported.scenario))
}

fn no_levels(kind: &str, seed: u64, path: &Path) -> FileError {
    FileError::for_file(path, format!("is a {kind}, which has no levels; help: leave out `:{seed}`"))
}

fn level(generator: &LevelGenerator, seed: u64, path: &Path) -> Result<Scenario, FileError> {
    generator.level(seed).map_err(|error| FileError::for_file(path, error.to_string()))
}

/// `clutter` and 17 for `clutter:17`, unless there is a file of that whole name.
pub fn split_seed(wanted: &str) -> (&str, Option<u64>) {
    let parts = wanted.rsplit_once(':').filter(|_| !path_exists(Path::new(wanted)));
    match parts.and_then(|(file, seed)| Some((file, seed.parse().ok()?))) {
        Some((file, seed)) => (file, Some(seed)),
        None => (wanted, None),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_seed_after_a_colon_names_a_level() {
        let Ok(Source::Levels(generator)) = Source::load("clutter") else { panic!("a shipped generator") };
        let level = |seed| Ok(Source::Scenario(generator.level(seed).expect("a level")));
        assert_eq!(Source::load("clutter:17"), level(17));
        assert_eq!(Source::load("scenarios/generators/clutter.ron:17"), level(17));
        assert_eq!(super::super::scenario("clutter").map(Source::Scenario), level(0));
        let of_levels = ScenarioSet::of_levels(generator.clone());
        assert_eq!(super::super::scenario_or_set("clutter").expect("levels").1, Some(of_levels));
        assert_eq!(super::super::scenario_or_set("clutter:3").expect("a level").1, None);
        let error = Source::load("maze:17").expect_err("a scenario").to_string();
        assert_eq!(error, "maze: is a scenario, which has no levels; help: leave out `:17`");
    }
}
