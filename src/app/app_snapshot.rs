//! The status: how the session stands, in numbers and words, taken once a frame beside the [`Scene`](super::scene::Scene).
//!
//! In: the session and the learner, read only (`extract.rs`). Out: plain data for the panels.

use std::sync::Arc;

use super::commands::{Pace, SessionMode};
use crate::scenario::Scenario;

/// A scenario or preset that can be chosen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Choice {
    /// By what it is asked for: a shipped one's name, or a file's path.
    pub from: String,
    /// What to call it.
    pub title: String,
    /// What it is for, in a few sentences.
    pub about: String,
}

/// How serious a notice is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// Something went as asked.
    Info,
    /// Something could not be done; all else goes on.
    Error,
}

/// A notice to the user, until it is dismissed.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Notice {
    /// How serious it is.
    pub severity: Severity,
    /// What happened, and the mend; may have several lines.
    pub text: String,
}

/// How the session stands.
#[derive(Clone, Debug, PartialEq)]
pub struct AppSnapshot {
    /// Time stands still.
    pub paused: bool,
    /// How quickly it passes otherwise.
    pub pace: Pace,
    /// Who drives.
    pub mode: SessionMode,
    /// The scenario as it was asked for, among `scenarios`.
    pub scenario_from: String,
    /// The preset as it was asked for, among `presets`.
    pub preset_from: String,
    /// The world is another than its file has it: moved by hand, or edited and not saved.
    pub scenario_modified: bool,
    /// The world is the paper's Scenario I as it stands in the file: the paper's levels can be compared with.
    pub is_paper_scenario_1: bool,
    /// What can be chosen.
    pub scenarios: Vec<Choice>,
    /// What can be chosen.
    pub presets: Vec<Choice>,
    /// The seed of every random draw.
    pub seed: u64,
    /// Whether training began from another's weights, and from which (a file, or the scenario before).
    pub transfer_from: Option<String>,
    /// Episodes ended in training.
    pub episodes: u64,
    /// Env steps of training, all arenas together.
    pub env_steps: u64,
    /// Gradient steps taken.
    pub gradient_steps: u64,
    /// Env steps after which the preset would stop a training without a window; here it goes on.
    pub budget_env_steps: Option<u64>,
    /// The chance of a random action, 0 to 1.
    pub epsilon: f32,
    /// Success rate of the greedy policy in the last evaluation, 0 to 1.
    pub success_rate: Option<f64>,
    /// That of the best policy so far.
    pub best_success_rate: Option<f64>,
    /// Env steps per second of wall time, over the last second or so.
    pub env_steps_per_s: f64,
    /// How many times real time that is, for one arena.
    pub real_time_factor: f64,
    /// Simulated time of one arena since the training's start, in s.
    pub simulated_s: f64,
    /// Frames drawn per second.
    pub frames_per_s: f64,
    /// A policy that was opened, to compare with: its name.
    pub opened_policy: Option<String>,
    /// What the user should know.
    pub notices: Vec<Notice>,
    /// A training of some worth, not saved as it stands, would be gone if another began.
    pub restart_loses_training: bool,
    /// The shipped policy that can drive in this world and sees what the preset shows: its name.
    pub expert: Option<String>,
    /// The world that was saved last, and its file.
    pub saved_scenario: Option<(String, Arc<Scenario>)>,
    /// A world that was opened to be edited: another number with each, its name or file, the world.
    pub draft: Option<(u64, String, Arc<Scenario>)>,
    /// Whether there is a disk. A browser has none: no folder can be saved, and a picture is one that it draws itself.
    pub has_disk: bool,
}
