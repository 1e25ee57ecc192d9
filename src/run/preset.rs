//! A preset: how to learn. Everything that is chosen beside the world and the seed.
//!
//! In: a RON file of `assets/presets/`, or a user's own. Out: a checked [`Preset`].

use std::path::Path;

use serde::{Deserialize, Serialize};

use crate::learning::{LearningConfig, MAX_STORED_FLOATS};
use crate::scenario::{Diagnostic, FileError, Scenario, parse_ron, read_text};
use crate::task::{Encoding, RewardConfig, observation};

/// The most env steps or episodes that may be asked for: no run gets there, and sums of them are far from what 64 bits hold.
pub const MAX_STEPS: u64 = 1_000_000_000_000_000;
/// The most characters of `about`.
const MAX_ABOUT_CHARS: usize = 20_000;

/// The most bodies that may stand and drive in all arenas together: robots, obstacles, straight pieces of walls. So many
/// take about 2 GB.
pub const MAX_BODIES: usize = 1_000_000;
/// The most numbers in the scans and observations of all arenas together: 1 GB.
const MAX_OBSERVED_FLOATS: usize = 1 << 28;

/// The bodies that one arena of `scenario` has at most.
#[must_use]
pub fn bodies_per_arena(scenario: &Scenario) -> usize {
    let pieces: usize = scenario.walls.iter().map(|wall| wall.corners_m.len().saturating_sub(1)).sum();
    1 + pieces + scenario.max_obstacles()
}

/// How to learn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Preset {
    /// What it is for and what is special about it.
    #[serde(default)]
    pub about: String,
    /// How many arenas run side by side, 1 to 4096. The paper: 1.
    pub arenas: usize,
    /// How long a run is, unless the command line says otherwise.
    pub budget: Budget,
    /// When the policy is evaluated during training.
    #[serde(default)]
    pub evaluation: EvaluationConfig,
    /// In which units eq. (8) enters the network: `Scaled` to the order of one, or `Raw`. The paper doesn't say.
    #[serde(default)]
    pub observation: Encoding,
    /// What a step is worth: eqs. (3) to (7).
    #[serde(default)]
    pub reward: RewardConfig,
    /// The algorithm and its numbers.
    pub learning: LearningConfig,
}

/// How long a run is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Budget {
    /// Until so many episodes have ended, over all arenas; 1 to 10^15.
    Episodes(u64),
    /// Until so many env steps were taken, over all arenas; 1 to 10^15.
    EnvSteps(u64),
}

/// When and how long the greedy policy is evaluated during training. Evaluations have a world and streams of their
/// own: they change nothing of what is learnt, only which policy is kept as the best.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct EvaluationConfig {
    /// Every so many env steps, 1 to 10^15.
    pub every_env_steps: u64,
    /// Over so many episodes (always the same ones), 1 to 100,000.
    pub episodes: usize,
}

impl Default for EvaluationConfig {
    fn default() -> Self {
        Self { every_env_steps: 10_000, episodes: 200 }
    }
}

impl Preset {
    /// The preset in the file at `path`, read and checked.
    ///
    /// # Errors
    /// With file, line, column and mend: a file that cannot be read, is no preset, or asks for what cannot be.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        Self::parse(&read_text(path)?, path)
    }

    /// The preset that `text` spells, checked; `path` is only what errors name.
    ///
    /// # Errors
    /// As [`Preset::load`].
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        let preset: Self = parse_ron(text, path)?;
        let diagnostics = preset.diagnostics();
        if diagnostics.is_empty() {
            Ok(preset)
        } else {
            Err(FileError::from_diagnostics(path, text, &diagnostics))
        }
    }

    /// Whether a training in its arenas of `scenario` asks for no more memory than a training may. (Both are sound by
    /// themselves.)
    ///
    /// # Errors
    /// What there is too much of, and what to write less for.
    pub fn check_memory(&self, scenario: &Scenario) -> Result<(), String> {
        let arenas = self.arenas;
        let bodies = bodies_per_arena(scenario).saturating_mul(arenas);
        if bodies > MAX_BODIES {
            return Err(format!(
                "{arenas} arenas of this scenario have {bodies} bodies together, more than {MAX_BODIES}: give fewer \
                 `arenas`, or a scenario with fewer obstacles and walls"
            ));
        }
        let width = observation::width(scenario.lidar.beams);
        // This observation and the next; this scan, and those that are late.
        let rows = 2 + 1 + scenario.lidar.latency_steps as usize + 1;
        let seen = arenas.saturating_mul(width).saturating_mul(rows);
        if seen > MAX_OBSERVED_FLOATS {
            return Err(format!(
                "what is seen in {arenas} arenas with {} beams and a latency of {} steps takes {seen} numbers, more than \
                 {MAX_OBSERVED_FLOATS}: give fewer `arenas`, `lidar.beams` or `lidar.latency_steps`",
                scenario.lidar.beams, scenario.lidar.latency_steps
            ));
        }
        let LearningConfig { replay, n_step, .. } = &self.learning;
        let states = replay.capacity + arenas * (n_step + 1);
        let remembered = states.saturating_mul(width);
        if remembered > MAX_STORED_FLOATS {
            return Err(format!(
                "{states} states of {width} numbers are to be remembered: {remembered} numbers, more than \
                 {MAX_STORED_FLOATS}: give less for `learning.replay.capacity`, or fewer `arenas` or `lidar.beams`"
            ));
        }
        Ok(())
    }

    /// Everything in it that cannot be meant.
    #[must_use]
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        let mut diagnostics = Vec::new();
        let mut found =
            |path: &str, message: String| diagnostics.push(Diagnostic { path: path.into(), message });
        if !(1..=4096).contains(&self.arenas) {
            found("arenas", format!("is {}; give 1 to 4096", self.arenas));
        }
        let (Budget::Episodes(budget) | Budget::EnvSteps(budget)) = self.budget;
        if !(1..=MAX_STEPS).contains(&budget) {
            found("budget", format!("is {budget}; give 1 to {MAX_STEPS}"));
        }
        let every = self.evaluation.every_env_steps;
        if !(1..=MAX_STEPS).contains(&every) {
            let message = format!("is {every}; give at least 1, such as 10000, and at most {MAX_STEPS}");
            found("evaluation.every_env_steps", message);
        }
        if self.about.chars().count() > MAX_ABOUT_CHARS {
            found("about", format!("is too long: write at most {MAX_ABOUT_CHARS} characters"));
        }
        if !(1..=100_000).contains(&self.evaluation.episodes) {
            found("evaluation.episodes", format!("is {}; give 1 to 100000", self.evaluation.episodes));
        }
        if let Err((field, problem)) = self.reward.check() {
            found(&format!("reward.{field}"), problem);
        }
        if let Err(error) = self.learning.check() {
            found(&format!("learning.{}", error.field), error.problem);
        }
        diagnostics
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::shipped;

    #[test]
    fn a_training_that_no_memory_holds_is_refused_in_words() {
        let fast = shipped::preset("fast").expect("shipped");
        let empty = shipped::scenario("empty").expect("shipped");
        let most = Preset { arenas: 4096, ..fast.clone() };
        for (name, scenario) in shipped::scenarios() {
            assert_eq!(most.check_memory(&scenario), Ok(()), "{name}: as many arenas as there may be");
        }
        let refused = |scenario: &Scenario, change: fn(&mut Preset), field: &str| {
            let mut preset = fast.clone();
            change(&mut preset);
            let error = preset.check_memory(scenario).expect_err(field);
            assert!(error.contains(field), "{error}");
        };
        let one = shipped::scenario("crowd").expect("shipped").obstacles[0].clone();
        let crowd = Scenario { obstacles: vec![one; 10_000], ..Scenario::default() };
        // 16 arenas of 10,000 obstacles are 160,016 bodies; 100 are 1,000,100.
        assert_eq!(Preset { arenas: 16, ..fast.clone() }.check_memory(&crowd), Ok(()));
        refused(&crowd, |preset| preset.arenas = 100, "`arenas`");
        let mut fine = empty.clone();
        (fine.lidar.beams, fine.lidar.latency_steps) = (4096, 50);
        refused(&fine, |preset| preset.arenas = 4096, "`lidar.latency_steps`");
        // 2^19 and an eighth states of 4,100 numbers: 2.4e9.
        refused(&fine, |preset| preset.learning.replay.capacity = 1 << 19, "`learning.replay.capacity`");
    }
}
