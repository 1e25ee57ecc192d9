//! Sets of scenarios: several scenarios in one training run, each with its share of the episodes.
//!
//! In: a set's file ([`ScenarioSetFile`]), which names scenarios. Out, once these are read: a [`ScenarioSet`], whose members
//! have the same observations and actions, so that one policy can drive in all of them.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::check::{Diagnostics, check_texts, diagnostics};
use super::file_error::{Diagnostic, FileError};
use super::limits::{SET_SCENARIOS, SET_SHARE};
use super::load::parse_checked;
use super::schema::Scenario;

/// The file of a set of scenarios. Each episode of each arena draws one of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScenarioSetFile {
    /// Name of the set, 1 to 100 characters on one line.
    pub name: String,
    /// Purpose of the set, at most 2,000 characters.
    #[serde(default)]
    pub about: String,
    /// The scenarios, 1 to 64. They must have the same LIDAR beams and field of view, motions and control period.
    pub scenarios: Vec<SetEntry>,
}

/// A scenario of a set, as its file names it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SetEntry {
    /// The scenario's file, relative to the folder of the set's file, or the name of a shipped scenario.
    pub scenario: String,
    /// Name of the entry in files, tables and curves, different from all others [default: the file's name without folder and
    /// extension].
    #[serde(default)]
    pub name: Option<String>,
    /// Share of the episodes, relative to those of the other entries, 0.001 to 1,000.
    #[serde(default = "default_share")]
    pub share: f32,
}

fn default_share() -> f32 {
    1.0
}

impl ScenarioSetFile {
    /// The checked set in `text`. Errors name `path`. The files that it names are not read.
    ///
    /// # Errors
    /// [`FileError`] if the text is not a set, or has diagnostics; it lists all of them.
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self, FileError> {
        parse_checked(text, path, Self::diagnostics, Self::diagnostics)
    }

    /// All problems of the set itself.
    #[must_use]
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        let mut found = Diagnostics::default();
        check_texts(&self.name, &self.about, &mut found);
        found.check_count(format_args!("scenarios"), self.scenarios.len(), SET_SCENARIOS);
        for (k, entry) in self.scenarios.iter().enumerate() {
            found.check_range(format_args!("scenarios[{k}].share"), entry.share, SET_SHARE, "");
            let name = column_name(&entry.name());
            if name.is_empty() {
                found.push(
                    format_args!("scenarios[{k}].scenario"),
                    "is empty: write a scenario's file or name",
                );
            } else if self.scenarios[..k].iter().any(|other| column_name(&other.name()) == name) {
                let message = format!("is the second one called `{name}`: give this entry another `name`");
                found.push(format_args!("scenarios[{k}].scenario"), message);
            }
        }
        found.into_vec()
    }
}

impl SetEntry {
    /// The entry's name.
    #[must_use]
    pub fn name(&self) -> String {
        match &self.name {
            Some(name) => name.clone(),
            None => Path::new(&self.scenario).file_stem().unwrap_or_default().to_string_lossy().into_owned(),
        }
    }
}

/// `name` as a part of the name of a column: characters other than letters and digits become underscores.
#[must_use]
pub fn column_name(name: &str) -> String {
    name.chars().map(|c| if c.is_alphanumeric() { c } else { '_' }).collect()
}

/// A set of scenarios with the same observations and actions. Each episode of each arena draws one of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ScenarioSet {
    /// Name of the set.
    pub name: String,
    /// The scenarios, at least one.
    pub members: Vec<SetMember>,
}

/// A scenario of a set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct SetMember {
    /// Name of the entry in files, tables and curves.
    pub name: String,
    /// Share of the episodes, relative to those of the other members.
    pub share: f32,
    /// The scenario.
    pub scenario: Scenario,
}

impl ScenarioSet {
    /// All problems of the set and of its scenarios.
    #[must_use]
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        let mut found = Diagnostics::default();
        found.check_count(format_args!("members"), self.members.len(), SET_SCENARIOS);
        for (k, member) in self.members.iter().enumerate() {
            found.check_range(format_args!("members[{k}].share"), member.share, SET_SHARE, "");
            for Diagnostic { path, message } in diagnostics(&member.scenario) {
                found.push(format_args!("members[{k}].scenario.{path}"), message);
            }
            if let Some(difference) = self.misfit(k) {
                found.push(format_args!("members[{k}].scenario"), difference);
            }
        }
        found.into_vec()
    }

    /// The reason why one policy cannot drive in both the first member and member `k`, as the rest of a sentence that begins
    /// with the member; `None` if it can.
    #[must_use]
    pub fn misfit(&self, k: usize) -> Option<String> {
        let (first, other) = (self.members.first()?, self.members.get(k)?);
        let fields = differing_fields(&first.scenario, &other.scenario);
        if fields.is_empty() {
            return None;
        }
        Some(format!(
            "(`{}`) needs another policy than `{}`, because of its {}; help: give all scenarios of a set the same LIDAR beams \
             and field of view, motions and control period",
            other.name,
            first.name,
            fields.join(" and "),
        ))
    }
}

/// The fields that fix observations and actions, and differ, with both values.
fn differing_fields(first: &Scenario, other: &Scenario) -> Vec<String> {
    let mut fields = Vec::new();
    let mut compare = |field: &str, first: String, other: String| {
        if first != other {
            fields.push(format!("{field} ({other}, not {first})"));
        }
    };
    let (a, b) = (&first.lidar, &other.lidar);
    compare("lidar.beams", a.beams.to_string(), b.beams.to_string());
    compare("lidar.field_of_view_rad", a.field_of_view_rad.to_string(), b.field_of_view_rad.to_string());
    let (a, b) = (&first.task, &other.task);
    compare("task.control_period_s", a.control_period_s.to_string(), b.control_period_s.to_string());
    let (a, b) = (&first.robot.motions, &other.robot.motions);
    if a.len() == b.len() && a != b {
        fields.push("robot.motions (other speeds)".into());
    } else if a != b {
        fields.push(format!("robot.motions ({} motions, not {})", b.len(), a.len()));
    }
    fields
}
