//! The notes of a run: questionable settings of its preset and its scenario, alone and together.
//!
//! In: a preset, the scenario if it is known, or a run's configuration. Out: [`Note`]s, which `--check`, `--train`, the
//! editor and the app show before training.
//!
//! | file | what it checks |
//! |---|---|
//! | `learning.rs` | whether gradient steps are taken and change anything, the learning rate, the target network |
//! | `schedules.rs` | schedules that end long before or after the budget, exploration, evaluations |
//! | `reward.rs` | rewards that teach nothing or the wrong thing |

mod learning;
mod reward;
mod schedules;
#[cfg(test)]
mod tests;

use std::fmt;

use super::folder::RunConfig;
use super::preset::{Budget, Preset};
use crate::learning::Exploration;
use crate::scenario::{Note, NoteLevel, Scenario, notes};

/// The number of env steps of a run, as far as it is known beforehand.
#[derive(Clone, Copy, Debug)]
struct RunLength {
    least: u64,
    /// `None` for a budget in episodes without a scenario.
    most: Option<u64>,
    /// The budget if it is in env steps. `least` and `most` are then both this number, rounded up to whole control steps.
    budget: Option<u64>,
}

impl RunLength {
    fn of(preset: &Preset, scenario: Option<&Scenario>) -> Self {
        let arenas = preset.arenas as u64;
        match preset.budget {
            Budget::EnvSteps(n) => {
                let whole = n.div_ceil(arenas.max(1)).saturating_mul(arenas);
                Self { least: whole, most: Some(whole), budget: Some(n) }
            }
            Budget::Episodes(n) => {
                let limit = scenario.map(|scenario| u64::from(scenario.task.max_episode_steps));
                // When the last episode ends, those of the other arenas are still running.
                let most = limit.map(|limit| n.saturating_add(arenas).saturating_mul(limit));
                Self { least: n, most, budget: None }
            }
        }
    }

    /// The length as part of a note: "the budget is 6000"; for a budget in episodes, "the run has at most 13000 env steps", with
    /// `bound` "at most" or "at least".
    fn text(self, bound: &str, env_steps: u64) -> String {
        match self.budget {
            Some(budget) => format!("the budget is {budget}"),
            None => format!("the run has {bound} {env_steps} env steps"),
        }
    }
}

/// The questionable settings of the valid `preset` for a run in `scenario`; `has_reward_terms` is whether plugins add
/// rewards. The more important ones come first.
#[must_use]
pub fn preset_notes(preset: &Preset, scenario: Option<&Scenario>, has_reward_terms: bool) -> Vec<Note> {
    let length = RunLength::of(preset, scenario);
    let mut notes = Vec::new();
    reward::check(&preset.reward, scenario, has_reward_terms, &mut notes);
    learning::check(&preset.learning, length, &mut notes);
    schedules::check(preset, length, &mut notes);
    notes.sort_by_key(|note| note.level == NoteLevel::Note);
    notes
}

/// A note about a file of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct RunNote {
    /// The file, or the shipped name, as the user gave it.
    pub file: String,
    /// The note.
    pub note: Note,
}

impl fmt::Display for RunNote {
    /// Such as "mine.ron: `reward.collided` is 50: ...".
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.file, self.note.diagnostic)
    }
}

/// The questionable settings of a run: first those of its scenario (for a set, of the first one), then those of its preset,
/// which is checked with the longest time limit of the set and the initial epsilon of the transfer, if there are any.
#[must_use]
pub fn run_notes(config: &RunConfig) -> Vec<RunNote> {
    let of = |file: &String, notes: Vec<Note>| {
        let file = file.clone();
        notes.into_iter().map(move |note| RunNote { file: file.clone(), note })
    };
    let has_reward_terms = !config.reward_terms.is_empty();
    let mut preset = config.preset.clone();
    if let Some(epsilon) = config.transfer.as_ref().and_then(|transfer| transfer.epsilon) {
        let (Exploration::PerEpisode { start, .. } | Exploration::Linear { start, .. }) =
            &mut preset.learning.exploration;
        *start = epsilon;
    }
    let mut scenario = config.scenario.clone();
    let members = config.scenario_set.iter().flat_map(|set| &set.members);
    let limits = members.map(|member| member.source.task().2.max_episode_steps);
    scenario.task.max_episode_steps = limits.fold(scenario.task.max_episode_steps, u32::max);
    let of_preset = preset_notes(&preset, Some(&scenario), has_reward_terms);
    of(&config.scenario_from, notes(&config.scenario)).chain(of(&config.preset_from, of_preset)).collect()
}
