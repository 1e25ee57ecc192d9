//! Training presets: all settings of a training run except the scenario and the seed.
//!
//! In: a RON file, shipped in `assets/presets/` or written by the user. Out: a checked [`Preset`].

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::learning::LearningConfig;
use crate::limits::{MAX_ABOUT_CHARS, MAX_ARENAS, MAX_EVALUATION_EPISODES, MAX_STEPS};
use crate::policy::range::within;
use crate::scenario::{Diagnostic, FileError, parse_checked, read_text};
use crate::task::{Encoding, RewardConfig};

/// A training preset: all settings of a training run except the scenario and the seed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Preset {
    /// A description: what the preset is for, and what is special about it.
    #[serde(default)]
    pub about: String,
    /// Number of parallel arenas, 1 to 4096. The paper: 1.
    pub arenas: usize,
    /// Length of a run; `--episodes` and `--steps` override it.
    pub budget: Budget,
    /// Schedule of the evaluations during training.
    #[serde(default)]
    pub evaluation: EvaluationConfig,
    /// How the observation, eq. (8), enters the network: `Scaled` to the order of one, or `Raw` in m and rad.
    /// The paper doesn't specify it.
    #[serde(default)]
    pub observation: Encoding,
    /// The reward of a step, eqs. (3) to (7).
    #[serde(default)]
    pub reward: RewardConfig,
    /// The algorithm and its hyperparameters.
    pub learning: LearningConfig,
}

/// The length of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Budget {
    /// Number of finished episodes over all arenas, 1 to 10^15.
    Episodes(u64),
    /// Number of env steps over all arenas, 1 to 10^15.
    EnvSteps(u64),
}

/// The evaluations of the greedy policy during training, and the test of the best policy after it.
///
/// Evaluations run in a simulation with separate random streams. They do not affect learning, only which
/// policy is kept as the best. The first one is made before the first step.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct EvaluationConfig {
    /// Interval in env steps, 1 to 10^15.
    pub every_env_steps: u64,
    /// Number of episodes, 1 to 100,000. Every evaluation uses the same episodes.
    pub episodes: usize,
    /// Number of episodes of the final test, 0 (no test) to 100,000. After the training, the best policy is tested in episodes
    /// that it was not selected by.
    pub final_episodes: usize,
}

impl Default for EvaluationConfig {
    fn default() -> Self {
        Self { every_env_steps: 10_000, episodes: 200, final_episodes: 500 }
    }
}

impl Preset {
    /// The preset in the file at `path`.
    ///
    /// # Errors
    /// The file cannot be read, is not a preset or has invalid values. The message gives file, line, column
    /// and a fix.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        Self::parse(&read_text(path)?, path)
    }

    /// The preset in `text`; error messages name it by `path`.
    ///
    /// # Errors
    /// As for [`Preset::load`].
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self, FileError> {
        parse_checked(text, path, Self::diagnostics, Self::diagnostics)
    }

    /// All invalid values.
    #[must_use]
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        let mut diagnostics = Vec::new();
        let mut add =
            |path: &str, message: String| diagnostics.push(Diagnostic { path: path.into(), message });
        let (Budget::Episodes(budget) | Budget::EnvSteps(budget)) = self.budget;
        let EvaluationConfig { every_env_steps, episodes, final_episodes } = self.evaluation;
        let ranges = [
            within("arenas", self.arenas, 1..=MAX_ARENAS),
            within("budget", budget, 1..=MAX_STEPS),
            within("evaluation.every_env_steps", every_env_steps, 1..=MAX_STEPS),
            within("evaluation.episodes", episodes, 1..=MAX_EVALUATION_EPISODES),
            within("evaluation.final_episodes", final_episodes, 0..=MAX_EVALUATION_EPISODES),
        ];
        for error in ranges.into_iter().filter_map(Result::err) {
            add(&error.field, error.problem);
        }
        if self.about.chars().count() > MAX_ABOUT_CHARS {
            add("about", format!("is too long; help: write at most {MAX_ABOUT_CHARS} characters"));
        }
        if let Err((field, problem)) = self.reward.check() {
            add(&format!("reward.{field}"), problem);
        }
        if let Err(error) = self.learning.check() {
            add(&format!("learning.{}", error.field), error.problem);
        }
        diagnostics
    }
}
