//! The app's status: the state of the session in numbers and words, taken once per frame together with the
//! [`Scene`](super::scene::Scene).
//!
//! In: the session and the learner, read-only (`extract.rs`). Out: plain data for the panels.

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::commands::{Pace, PolicySource, SessionMode};
use crate::scenario::{Scenario, SetFit};

/// The path of a scenario's file, and the scenario.
pub type ScenarioFile = (String, Arc<Scenario>);

/// A scenario or preset that can be chosen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choice {
    /// The scenario's or preset's file, or its shipped name.
    pub from: String,
    /// Title to display.
    pub title: String,
    /// Description in a few sentences.
    pub about: String,
}

/// The last session, which can be continued.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct LastSession {
    /// The scenario's name.
    pub scenario: String,
    /// The preset's title.
    pub preset: String,
    /// The seed.
    pub seed: u64,
    /// Env steps of its training run.
    pub env_steps: u64,
    /// Time since it was saved, in s.
    #[serde(default)]
    pub age_s: u64,
}

/// Unsaved changes in the editor of an earlier session.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct UnsavedEdits {
    /// The scenario's name.
    pub scenario: String,
    /// Time since they were backed up, in s.
    pub age_s: u64,
}

/// Severity of a notice.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// A confirmation, or a hint.
    Info,
    /// A questionable setting.
    Warning,
    /// Something failed; everything else continues.
    Error,
}

/// A notice to the user.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// Severity of the notice.
    pub severity: Severity,
    /// What happened, and how to fix it. May have several lines.
    pub text: String,
}

/// The best policy so far, by evaluation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BestSoFar {
    /// Success rate in its evaluation, 0 to 1.
    pub success_rate: f64,
    /// Env steps of the training run when it was evaluated.
    pub env_steps: u64,
}

/// A shipped policy.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExpertChoice {
    /// Its name, such as "Scenario I expert".
    pub name: String,
    /// Whether it was trained in another scenario.
    pub is_new_here: bool,
}

/// The state of the session.
#[derive(Clone, Debug, PartialEq)]
pub struct AppStatus {
    /// Whether time is paused.
    pub paused: bool,
    /// Pace of the simulated time.
    pub pace: Pace,
    /// What drives the robots.
    pub mode: SessionMode,
    /// The file or shipped name of the scenario or of the set of scenarios, as in `scenarios`.
    pub scenario_from: String,
    /// Whether `scenario_from` is a set of scenarios or a level generator.
    pub is_set: bool,
    /// What an edited scenario must have in common with the current one, so that training can continue in it.
    pub needs: SetFit,
    /// The preset's file or shipped name, as in `presets`.
    pub preset_from: String,
    /// Whether the scenario differs from its file: an object was moved, or an edit was not saved.
    pub scenario_modified: bool,
    /// Whether this is the paper's Scenario I, unmodified, so that the paper's results apply.
    pub is_paper_scenario_1: bool,
    /// Scenarios to choose from.
    pub scenarios: Vec<Choice>,
    /// Presets to choose from.
    pub presets: Vec<Choice>,
    /// Seed of every random draw.
    pub seed: u64,
    /// Source of the initial weights, if they are not random: a policy file, or the scenario before a transfer.
    pub transfer_from: Option<String>,
    /// Finished training episodes.
    pub episodes: u64,
    /// Env steps of training, all arenas together.
    pub env_steps: u64,
    /// Gradient steps.
    pub gradient_steps: u64,
    /// Env steps after which a headless training run with this preset ends. In the app, training continues.
    pub budget_env_steps: Option<u64>,
    /// Probability of a random action, 0 to 1.
    pub epsilon: f32,
    /// Success rate of the greedy policy in the last evaluation, 0 to 1.
    pub success_rate: Option<f64>,
    /// The best policy so far.
    pub best: Option<BestSoFar>,
    /// Env steps per second of wall time, over about the last second.
    pub env_steps_per_s: f64,
    /// Speed of the simulation as a multiple of real time, for one arena.
    pub real_time_factor: f64,
    /// Simulated time of one arena since the training run started, in s.
    pub simulated_s: f64,
    /// Frames per second.
    pub frames_per_s: f64,
    /// Name of the opened policy, if there is one to compare with.
    pub opened_policy: Option<String>,
    /// Name of the classical driver that the user has chosen to compare with in place of that policy.
    pub opened_driver: Option<String>,
    /// Notices, oldest first.
    pub notices: Vec<Notice>,
    /// Whether a new training run would discard an unsaved one that is worth keeping.
    pub restart_loses_training: bool,
    /// The last session, if the user has not decided yet whether to continue it.
    pub last_session: Option<LastSession>,
    /// Unsaved changes of an earlier session, if the user has not decided yet whether to restore them.
    pub unsaved_edits: Option<UnsavedEdits>,
    /// Whether the question before quitting is open.
    pub quit_question: bool,
    /// A shipped policy that can drive here, with the observations of the preset.
    pub expert: Option<ExpertChoice>,
    /// The policy that Test, Drive and Compare use: the current or the best one.
    pub tested: PolicySource,
    /// The scenario that was saved last, and its file; `None` if the current scenario has changed since.
    pub saved_scenario: Option<ScenarioFile>,
    /// Whether files can be written to disk. In a browser, folders cannot be saved, and figures are SVGs.
    pub has_disk: bool,
}
