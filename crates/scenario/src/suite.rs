//! Suites: the scenarios and levels in which drivers and policies are tested, by families.
//!
//! In: a suite's file. Out: a checked [`SuiteFile`], which names scenarios. They need not fit one policy.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::check::{Diagnostics, check_name, check_texts};
use super::file_error::{Diagnostic, FileError};
use super::limits::{
    COLLISION_RANGE_M, SUITE_EPISODES, SUITE_FAMILIES, SUITE_LEVELS, SUITE_SCENARIOS, SUITE_TIME_LIMIT_S,
};
use super::load::parse_checked;
use super::set::column_name;

/// The smallest seed of evaluation levels. Training levels have smaller seeds.
pub const FIRST_EVALUATION_LEVEL: u64 = 1_000_000;
/// Number of levels of a generator in a suite, unless the suite states another.
pub const DEFAULT_SUITE_LEVELS: u32 = 100;
/// Number of episodes in each scenario of a suite, unless the suite states another. The default for a level is 1.
pub const DEFAULT_SUITE_EPISODES: u32 = 100;

/// The file of a suite: families of scenarios in which drivers and policies are tested.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SuiteFile {
    /// Name of the suite, 1 to 100 characters on one line.
    pub name: String,
    /// Purpose of the suite, at most 2,000 characters.
    #[serde(default)]
    pub about: String,
    /// The families, 1 to 64. Results are given for each.
    pub families: Vec<SuiteFamily>,
}

/// A family of a suite: scenarios, or the levels of a generator, whose results are given together.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SuiteFamily {
    /// Name of the family in tables and files, 1 to 100 characters on one line, different from all others.
    pub name: String,
    /// The scenarios, at most 10,000: files, folders of files, both relative to the folder of the suite's file, or shipped names.
    #[serde(default)]
    pub scenarios: Vec<String>,
    /// A level generator instead of scenarios: its file, relative to the folder of the suite's file, or a shipped name.
    #[serde(default)]
    pub generator: Option<String>,
    /// Number of levels of the generator, 1 to 10,000 [default: 100].
    #[serde(default)]
    pub levels: Option<u32>,
    /// The seed of the first level; each further level has the next seed [default: 1,000,000; training uses smaller ones].
    #[serde(default)]
    pub first_level: Option<u64>,
    /// Number of episodes in each scenario or level, 1 to 10,000 [default: 100 in a scenario, 1 in a level].
    #[serde(default)]
    pub episodes: Option<u32>,
    /// Whether episodes drive the scenario's benchmark route, instead of drawn starts and goals.
    #[serde(default)]
    pub benchmark_route: bool,
    /// The time limit of an episode instead of the scenarios' own, 0.1 to 100,000 s.
    #[serde(default)]
    pub time_limit_s: Option<f32>,
    /// The collision range instead of the scenarios' own, 0.01 to 100 m. Must be more than the robot's radius.
    #[serde(default)]
    pub collision_range_m: Option<f32>,
    /// A score besides success, collisions and times.
    #[serde(default)]
    pub score: Option<SuiteScore>,
}

/// A score of a family.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum SuiteScore {
    /// The BARN Challenge's: 0 after a failure, otherwise T / clip(time, 2 T, 8 T), at most 0.5. T is the time for the shortest
    /// path at the robot's top speed. An imported BARN world states the length of that path; in others, it is `shortest_path_m`
    /// of `--eval --csv`.
    Barn,
}

impl SuiteFile {
    /// The checked suite in `text`. Errors name `path`. The files that the suite names are not read.
    ///
    /// # Errors
    /// [`FileError`] if the text is not a suite, or has diagnostics; it lists all of them.
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self, FileError> {
        parse_checked(text, path, |suite, _| Self::diagnostics(suite), Self::diagnostics)
    }

    /// All problems of the suite itself, not of the files that it names.
    #[must_use]
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        let mut found = Diagnostics::default();
        check_texts(&self.name, &self.about, &mut found);
        found.check_count(format_args!("families"), self.families.len(), SUITE_FAMILIES);
        for (k, family) in self.families.iter().enumerate().take(*SUITE_FAMILIES.end()) {
            family.check(k, &mut found);
            let name = column_name(&family.name);
            if self.families[..k].iter().any(|other| column_name(&other.name) == name) {
                let message = format!("is the second one called `{name}`: give this family another `name`");
                found.push(format_args!("families[{k}]"), message);
            }
        }
        found.into_vec()
    }
}

impl SuiteFamily {
    /// The number of levels, if the family has a generator.
    #[must_use]
    pub fn levels(&self) -> u32 {
        self.levels.unwrap_or(DEFAULT_SUITE_LEVELS)
    }

    /// The seed of the first level, if the family has a generator.
    #[must_use]
    pub fn first_level(&self) -> u64 {
        self.first_level.unwrap_or(FIRST_EVALUATION_LEVEL)
    }

    /// The number of episodes in each scenario or level.
    #[must_use]
    pub fn episodes(&self) -> u32 {
        self.episodes.unwrap_or(if self.generator.is_some() { 1 } else { DEFAULT_SUITE_EPISODES })
    }

    /// Checks family `k`.
    fn check(&self, k: usize, found: &mut Diagnostics) {
        check_name(&format!("families[{k}].name"), &self.name, found);
        if self.scenarios.is_empty() == self.generator.is_none() {
            let message = if self.generator.is_some() {
                "has both `scenarios` and a `generator`: write a family for each"
            } else {
                "must have scenarios: write either `scenarios: [\"FILE\", ...]` or `generator: \"FILE\"`"
            };
            found.push(format_args!("families[{k}]"), message);
        }
        if !self.scenarios.is_empty() {
            found.check_count(format_args!("families[{k}].scenarios"), self.scenarios.len(), SUITE_SCENARIOS);
        }
        for (field, is_given) in
            [("levels", self.levels.is_some()), ("first_level", self.first_level.is_some())]
        {
            if is_given && self.generator.is_none() {
                found.push(format_args!("families[{k}].{field}"), "belongs to a generator: remove it");
            }
        }
        found.check_range(format_args!("families[{k}].levels"), self.levels(), SUITE_LEVELS, "");
        if self.first_level().checked_add(u64::from(self.levels())).is_none() {
            found.push(
                format_args!("families[{k}].first_level"),
                "is too large for this number of levels: give a smaller seed",
            );
        }
        found.check_range(format_args!("families[{k}].episodes"), self.episodes(), SUITE_EPISODES, "");
        if let Some(limit_s) = self.time_limit_s {
            found.check_range(format_args!("families[{k}].time_limit_s"), limit_s, SUITE_TIME_LIMIT_S, " s");
        }
        if let Some(range_m) = self.collision_range_m {
            let path = format_args!("families[{k}].collision_range_m");
            found.check_range(path, range_m, COLLISION_RANGE_M, " m");
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn of_too_many_families_only_the_first_are_checked() {
        // Each is compared with all before it: a large file would take minutes.
        let families = vec![SuiteFamily::default(); SUITE_FAMILIES.end() + 1];
        let suite = SuiteFile { name: "a".into(), about: String::new(), families };
        let found = suite.diagnostics();
        let is_at = |path: &str| found.iter().any(|found| found.path == path);
        assert!(is_at("families") && is_at("families[63]") && !is_at("families[64]"), "{found:?}");
    }
}
