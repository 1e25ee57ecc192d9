//! What a run writes down: a row for each episode, a row for each evaluation, and a summary.
//!
//! In: what the training loop saw. Out: serde types, whose field names are the columns of `episodes.csv` and
//! `evaluations.csv` and the keys of `summary.json`. Columns called `wall_s` are the only ones that differ between
//! two runs of the same seed.

use serde::{Deserialize, Serialize};

use crate::scenario::read_text;
use crate::task::EpisodeEnd;

/// A row of `episodes.csv`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EpisodeRow {
    /// Number of the episode, from 1, in the order in which they ended.
    pub episode: u64,
    /// The arena it was driven in, from 0.
    pub arena: usize,
    /// Env steps of the whole run when it ended.
    pub env_steps: u64,
    /// Gradient steps of the whole run when it ended.
    pub gradient_steps: u64,
    /// Its own length in control steps.
    pub steps: u32,
    /// The undiscounted sum of its rewards.
    #[serde(rename = "return")]
    pub total_return: f64,
    /// Of which r+ for reached goals.
    pub reward_goal: f32,
    /// Of which r- for the collision.
    pub reward_collision: f32,
    /// Of which the fall of the attraction U_a.
    pub reward_attraction: f32,
    /// Of which the fall of the repulsion U_r.
    pub reward_repulsion: f32,
    /// Of which the reward terms of plugins: columns of their own behind all others, called `reward_<name>`.
    #[serde(skip)]
    pub extra_rewards: Vec<f32>,
    /// Targets reached.
    pub goals: u32,
    /// Whether it ended in a collision: 1 or 0 (the time limit).
    pub collision: u8,
    /// Epsilon when it ended.
    pub epsilon: f32,
    /// Mean loss of the gradient steps since the row before (the row before's, if there were none).
    pub loss: Option<f64>,
    /// Their mean absolute TD error.
    pub td_error: Option<f64>,
    /// Their mean Q-value of the actions taken.
    pub mean_q: Option<f64>,
    /// Wall time since the process began (all processes together, if resumed), in s.
    pub wall_s: f64,
}

impl EpisodeRow {
    /// The number in the column `collision`.
    #[must_use]
    pub fn collision_flag(end: EpisodeEnd) -> u8 {
        u8::from(end == EpisodeEnd::Collided)
    }
}

/// A row of `evaluations.csv`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EvaluationRow {
    /// Env steps when the policy was evaluated.
    pub env_steps: u64,
    /// Episodes ended by then.
    pub episodes: u64,
    /// Gradient steps taken by then.
    pub gradient_steps: u64,
    /// Share of episodes that succeeded, 0 to 1.
    pub success_rate: f64,
    /// Share that ended in a collision.
    pub collision_rate: f64,
    /// Share that ran out of time.
    pub timeout_rate: f64,
    /// Mean simulated time of the successful ones, in s.
    pub mean_time_s: Option<f64>,
    /// Mean simulated time of all, in s, where one that failed counts as the whole time limit: by it the best policy is
    /// chosen.
    pub mean_cost_s: f64,
    /// Wall time since the process began (all processes together, if resumed), in s.
    pub wall_s: f64,
}

/// When a success rate was first reached in an evaluation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Milestone {
    /// Env steps by then.
    pub env_steps: u64,
    /// Episodes by then.
    pub episodes: u64,
    /// Wall time by then, from the process's start, evaluations included, in s.
    pub wall_s: f64,
}

/// `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// The version of wayfield.
    pub version: String,
    /// The scenario's name.
    pub scenario: String,
    /// The scenario, as it was asked for.
    pub scenario_from: String,
    /// The preset, as it was asked for.
    pub preset: String,
    /// The run's seed.
    pub seed: u64,
    /// Whether the run has used up its budget.
    pub finished: bool,
    /// Episodes ended.
    pub episodes: u64,
    /// Env steps taken, over all arenas.
    pub env_steps: u64,
    /// Gradient steps taken.
    pub gradient_steps: u64,
    /// Wall time from the process's start, evaluations included, in s; over all processes, if resumed.
    pub wall_s: f64,
    /// Success rate of the best policy in its evaluation, 0 to 1.
    pub best_success_rate: Option<f64>,
    /// Mean time of the best policy's successful episodes there, in s.
    pub best_mean_time_s: Option<f64>,
    /// Success rate in the last evaluation, 0 to 1.
    pub last_success_rate: Option<f64>,
    /// When 96 % (the paper's figure) was first reached.
    pub first_96: Option<Milestone>,
    /// When 99 % was first reached.
    pub first_99: Option<Milestone>,
}

impl Summary {
    /// The summary in the run's folder at `path`; None if there is none that can be read.
    #[must_use]
    pub fn read(path: &std::path::Path) -> Option<Self> {
        let text = read_text(path.join("summary.json")).ok()?;
        serde_json::from_str(&text).ok()
    }
}
