//! Sets of scenarios: several scenarios and level generators in one training run, each with its share of the episodes.
//!
//! In: a set's file ([`ScenarioSetFile`]), which names scenarios. Out, once these are read: a [`ScenarioSet`]. Whether
//! one policy can drive in all members depends on the policy ([`SetFit`]).

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::check::{Diagnostics, check_texts, diagnostics};
use super::file_error::{Diagnostic, FileError};
use super::levels::{LevelError, LevelGenerator, level_generator_diagnostics};
use super::limits::{SET_LEVELS, SET_SCENARIOS, SET_SHARE};
use super::load::parse_checked;
use super::schema::{Lidar, Robot, Scenario, TaskRules};

/// Number of levels of a generator, unless a set gives another number.
const DEFAULT_LEVELS: u32 = 1_000;

/// The file of a set of scenarios. Each episode of each arena draws one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScenarioSetFile {
    /// Name of the set, 1 to 100 characters on one line.
    pub name: String,
    /// Purpose of the set, at most 2,000 characters.
    #[serde(default)]
    pub about: String,
    /// The scenarios and level generators, 1 to 64. For a policy with the paper's observation, they must have the same
    /// LIDAR beams and field of view and the same control period; for one whose actions are the robot's motions, the
    /// same motions.
    pub scenarios: Vec<SetEntry>,
}

/// A scenario of a set, or a level generator, as the set's file names it.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SetEntry {
    /// A scenario: its file, relative to the folder of the set's file, or the name of a shipped one.
    pub scenario: Option<String>,
    /// A level generator instead of a scenario: its file, relative to the folder of the set's file, or the name of a shipped
    /// one. Each episode draws one of its levels.
    pub generator: Option<String>,
    /// Number of levels of the generator that episodes draw from, 1 to 1,000,000: those with the seeds 0, 1, and so on.
    /// Evaluations use other levels [default: 1,000].
    pub levels: Option<u32>,
    /// Name of the entry in files, tables and curves, different from all others [default: the file's name without folder and
    /// extension].
    pub name: Option<String>,
    /// Weight of the entry: its share of the episodes, relative to the other entries, 0.001 to 1,000 [default: 1].
    pub share: Option<f32>,
}

impl ScenarioSetFile {
    /// Parses and checks the set in `text`. Errors name `path`. The files that the set names are not read.
    ///
    /// # Errors
    /// [`FileError`] if the text is not a set, or has diagnostics; it lists all of them.
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self, FileError> {
        parse_checked(text, path, |set, _| Self::diagnostics(set), Self::diagnostics)
    }

    /// All problems of the set itself.
    #[must_use]
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        let mut found = Diagnostics::default();
        check_texts(&self.name, &self.about, &mut found);
        found.check_count(format_args!("scenarios"), self.scenarios.len(), SET_SCENARIOS);
        for (k, entry) in self.scenarios.iter().enumerate().take(*SET_SCENARIOS.end()) {
            entry.check(k, &mut found);
            let name = column_name(&entry.name());
            let is_taken = || self.scenarios[..k].iter().any(|other| column_name(&other.name()) == name);
            if !name.is_empty() && is_taken() {
                let message = format!("is the second one called `{name}`: give this entry another `name`");
                found.push(format_args!("scenarios[{k}]"), message);
            }
        }
        found.into_vec()
    }
}

impl SetEntry {
    /// The file, or the shipped name, that the entry names.
    #[must_use]
    pub fn file(&self) -> &str {
        self.scenario.as_ref().or(self.generator.as_ref()).map_or("", String::as_str)
    }

    /// The entry's name.
    #[must_use]
    pub fn name(&self) -> String {
        match &self.name {
            Some(name) => name.clone(),
            None => Path::new(self.file()).file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        }
    }

    /// The weight of the entry: its share of the episodes, relative to the other entries.
    #[must_use]
    pub fn share(&self) -> f32 {
        self.share.unwrap_or(1.0)
    }

    /// The number of levels, if the entry is a generator.
    #[must_use]
    pub fn levels(&self) -> u32 {
        self.levels.unwrap_or(DEFAULT_LEVELS)
    }

    /// Checks entry `k`.
    fn check(&self, k: usize, found: &mut Diagnostics) {
        let names_one_file = self.scenario.is_some() != self.generator.is_some();
        if names_one_file && self.name.as_deref() == Some("") {
            let message = "is empty: write a name, or leave it out to use the file's name";
            found.push(format_args!("scenarios[{k}].name"), message);
        } else if !names_one_file || self.name().is_empty() {
            let message = "must name one file: write either `scenario: \"FILE\"` or `generator: \"FILE\"`";
            found.push(format_args!("scenarios[{k}]"), message);
        }
        if self.levels.is_some() && self.generator.is_none() {
            found.push(format_args!("scenarios[{k}].levels"), "belongs to a generator: remove it");
        }
        found.check_range(format_args!("scenarios[{k}].share"), self.share(), SET_SHARE, "");
        found.check_range(format_args!("scenarios[{k}].levels"), self.levels(), SET_LEVELS, "");
    }
}

/// `name` as part of a column name: characters other than letters and digits become underscores.
#[must_use]
pub fn column_name(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect()
}

/// A set of scenarios. Each episode of each arena draws one of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScenarioSet {
    /// Name of the set.
    pub name: String,
    /// The members, at least one.
    pub members: Vec<SetMember>,
}

/// A member of a set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SetMember {
    /// Name in files, tables and curves.
    pub name: String,
    /// Weight of the member: its share of the episodes, relative to the other members.
    pub share: f32,
    /// The scenario, or the levels.
    pub source: SetSource,
}

/// The scenarios of a set's member.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum SetSource {
    /// One scenario.
    Scenario(Box<Scenario>),
    /// Levels of a generator.
    Levels {
        /// The generator.
        generator: Box<LevelGenerator>,
        /// The number of levels that training episodes draw from. Their seeds are 0, 1, and so on.
        levels: u32,
    },
}

impl SetSource {
    /// The first scenario.
    ///
    /// # Errors
    /// The generator has no level that the robot can solve.
    pub fn first(&self) -> Result<Scenario, LevelError> {
        match self {
            Self::Scenario(scenario) => Ok(Scenario::clone(scenario)),
            Self::Levels { generator, .. } => generator.level(0),
        }
    }

    /// Robot, LIDAR and rules, which all scenarios of this source have in common.
    #[must_use]
    pub fn task(&self) -> (&Robot, &Lidar, &TaskRules) {
        match self {
            Self::Scenario(scenario) => (&scenario.robot, &scenario.lidar, &scenario.task),
            Self::Levels { generator, .. } => (&generator.robot, &generator.lidar, &generator.task),
        }
    }

    fn diagnostics(&self) -> Vec<Diagnostic> {
        match self {
            Self::Scenario(scenario) => diagnostics(scenario),
            Self::Levels { generator, .. } => level_generator_diagnostics(generator),
        }
    }
}

impl ScenarioSet {
    /// The set of 1,000 levels of one generator.
    #[must_use]
    pub fn of_levels(generator: LevelGenerator) -> Self {
        let name = generator.name.clone();
        let source = SetSource::Levels { generator: Box::new(generator), levels: DEFAULT_LEVELS };
        Self { name: name.clone(), members: vec![SetMember { name, share: 1.0, source }] }
    }

    /// All problems of the set and of its scenarios.
    #[must_use]
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        let mut found = Diagnostics::default();
        found.check_count(format_args!("members"), self.members.len(), SET_SCENARIOS);
        for (k, member) in self.members.iter().enumerate().take(*SET_SCENARIOS.end()) {
            found.check_range(format_args!("members[{k}].share"), member.share, SET_SHARE, "");
            if let SetSource::Levels { levels, .. } = member.source {
                found.check_range(format_args!("members[{k}].source.levels"), levels, SET_LEVELS, "");
            }
            for Diagnostic { path, message } in member.source.diagnostics() {
                found.push(format_args!("members[{k}].source.{path}"), message);
            }
        }
        found.into_vec()
    }

    /// The index of the first member in which a policy for member 0 cannot drive, and the reason, as the rest of a sentence
    /// whose subject is the member; `None` if a policy for member 0 can drive in all members.
    #[must_use]
    pub fn misfit(&self, fit: SetFit) -> Option<(usize, String)> {
        let mut members = self.members.iter().enumerate();
        members.find_map(|(k, member)| Some((k, self.misfit_of(&member.name, member.source.task(), fit)?)))
    }

    /// Why a policy for member 0 cannot drive in the scenario or level generator called `name`, as in [`Self::misfit`].
    #[must_use]
    pub fn misfit_of(&self, name: &str, task: (&Robot, &Lidar, &TaskRules), fit: SetFit) -> Option<String> {
        let first = self.members.first()?;
        let fields = differing_fields(first.source.task(), task, fit);
        if fields.is_empty() {
            return None;
        }
        Some(format!(
            "(`{name}`) needs a different policy from `{}`, because of its {}: give all scenarios of a set the same LIDAR beams \
             and field of view, motions and control period, or use a preset for all of them, such as `general`",
            first.name,
            fields.join(" and "),
        ))
    }
}

/// The fields that the scenarios of a set must have in common, so that one policy can drive in all of them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SetFit {
    /// The LIDAR's beams and field of view, and the control period.
    pub lidar: bool,
    /// The robot's motions.
    pub motions: bool,
}

/// The fields covered by `fit` that differ, as text for a message.
fn differing_fields(
    first: (&Robot, &Lidar, &TaskRules),
    other: (&Robot, &Lidar, &TaskRules),
    fit: SetFit,
) -> Vec<String> {
    let mut fields = Vec::new();
    let mut compare = |field: &str, first: String, other: String| {
        if fit.lidar && first != other {
            fields.push(format!("{field} ({other}, not {first})"));
        }
    };
    let (a, b) = (first.1, other.1);
    compare("lidar.beams", a.beams.to_string(), b.beams.to_string());
    compare("lidar.field_of_view_rad", a.field_of_view_rad.to_string(), b.field_of_view_rad.to_string());
    let (a, b) = (first.2, other.2);
    compare("task.control_period_s", a.control_period_s.to_string(), b.control_period_s.to_string());
    let (a, b) = (&first.0.motions, &other.0.motions);
    if !fit.motions {
        return fields;
    }
    if a.len() != b.len() {
        fields.push(format!("robot.motions ({} motions, not {})", b.len(), a.len()));
    } else if a != b {
        fields.push("robot.motions (other speeds)".into());
    }
    fields
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_first_64_of_too_many_entries_are_checked() {
        // Each is compared with all before it: a large file would take minutes.
        let scenarios = vec![SetEntry::default(); SET_SCENARIOS.end() + 1];
        let set = ScenarioSetFile { name: "a".into(), about: String::new(), scenarios };
        let found = set.diagnostics();
        let is_at = |path: &str| found.iter().any(|found| found.path == path);
        assert!(is_at("scenarios") && is_at("scenarios[63]") && !is_at("scenarios[64]"), "{found:?}");
        assert!(!found.iter().any(|found| found.message.contains("second")), "they have no name: {found:?}");
    }
}
