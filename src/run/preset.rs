//! Training presets: all settings of a training run except the seed. A preset may also name a default scenario.
//!
//! In: a RON file, shipped in `assets/presets/` or written by the user. Out: a checked [`Preset`].

mod based_on;

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::mirror;
use crate::learning::LearningConfig;
use crate::limits::{MAX_ABOUT_CHARS, MAX_ARENAS, MAX_EVALUATION_EPISODES, MAX_STEPS};
use crate::policy::ActionSet;
use crate::policy::range::{ConfigError, within};
use crate::scenario::{Diagnostic, FileError, LocatedDiagnostic, Scenario, SetFit, read_text};
use crate::task::{Encoding, LevelSampling, RewardConfig};

/// A training preset: all settings of a training run except the seed. It may also name a default scenario.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Preset {
    /// A description: what the preset is for, and what is special about it. At most 20,000 characters.
    pub about: String,
    /// Another preset, which provides all fields that this file lacks: a shipped one by name, such as `"fast"`, or a file,
    /// relative to this one. The parts `evaluation`, `reward`, `learning`, `network` and `replay` are combined field by
    /// field; a choice or a list is replaced as a whole. A preset that has been read is complete and has `None`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub based_on: Option<String>,
    /// Number of parallel arenas, 1 to 4096. The paper: 1.
    pub arenas: usize,
    /// Length of a run; `--episodes` and `--steps` override it. The paper: 1000 episodes.
    pub budget: Budget,
    /// Schedule of the evaluations during training.
    pub evaluation: EvaluationConfig,
    /// The observation: the paper's, eq. (8), `Scaled` to the order of one or `Raw` in m and rad (the paper doesn't say which);
    /// or `Sectors`, for any LIDAR and any robot.
    pub observation: Encoding,
    /// Fraction of the moving things, 0 to 1, whose motion is left out of predictions in training, so that the policy does not
    /// rely on predictions. Evaluations leave nothing out.
    pub prediction_dropout: f32,
    /// The motions to choose among: those of the scenario's `Robot`, as in the paper, or `Relative` ones, in units of any
    /// robot's limits.
    pub actions: ActionSet,
    /// The reward of a step, eqs. (3) to (7).
    pub reward: RewardConfig,
    /// The algorithm and its hyperparameters.
    pub learning: LearningConfig,
    /// How levels are drawn in training on a level generator or a set with generators.
    pub levels: LevelSampling,
    /// The scenario, level generator or set of scenarios to train in, unless `--scenario` names another: a file, relative to
    /// this one, or a shipped name, such as `"clutter"`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scenario: Option<String>,
}

/// The length of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
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
    /// Number of episodes of the final test, 0 (no test) to 100,000. After training, the best policy is tested in episodes that
    /// were not used to select it.
    pub final_episodes: usize,
}

impl Default for EvaluationConfig {
    fn default() -> Self {
        Self { every_env_steps: 10_000, episodes: 200, final_episodes: 500 }
    }
}

impl Default for Preset {
    /// The paper's training: PER-D3QN as in Table 1, 1000 episodes in one arena.
    fn default() -> Self {
        Self {
            about: String::new(),
            based_on: None,
            arenas: 1,
            budget: Budget::Episodes(1000),
            evaluation: EvaluationConfig::default(),
            observation: Encoding::default(),
            prediction_dropout: 0.0,
            actions: ActionSet::default(),
            reward: RewardConfig::default(),
            learning: LearningConfig::default(),
            levels: LevelSampling::default(),
            scenario: None,
        }
    }
}

impl Preset {
    /// What the scenarios of a set must have in common, so that one policy can drive in all of them.
    #[must_use]
    pub fn fit(&self) -> SetFit {
        SetFit { lidar: self.observation.sectors().is_none(), motions: self.actions == ActionSet::Robot }
    }

    /// Why a network that was built for `here` does not fit `there`: the number of inputs or outputs differs. `None` if it
    /// fits. Plugin sensors are not considered.
    #[must_use]
    pub fn network_misfit(&self, here: &Scenario, there: &Scenario) -> Option<String> {
        let count = |scenario: &Scenario| {
            let mut parts = Vec::new();
            if self.fit().lidar {
                parts.push(format!("{} beams", scenario.lidar.beams));
            }
            if self.fit().motions {
                parts.push(format!("{} motions", scenario.robot.motions.len()));
            }
            parts.join(" and ")
        };
        let (here, there) = (count(here), count(there));
        (here != there).then(|| format!("it has {there}, but the network was built for {here}"))
    }

    /// The preset in the file at `path`.
    ///
    /// # Errors
    /// The file cannot be read, is not a preset or has invalid values. The message gives the file, line and
    /// column, and a fix.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        Self::parse(&read_text(path)?, path)
    }

    /// The preset in `text`; error messages name it by `path`. A file that it is based on is relative to the folder of `path`.
    ///
    /// # Errors
    /// As for [`Preset::load`].
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        let preset = based_on::read(text, path, &[])?;
        let diagnostics = preset.diagnostics();
        if diagnostics.is_empty() {
            Ok(preset)
        } else {
            Err(FileError::from_located(path, Self::locate(text, path, diagnostics.iter())))
        }
    }

    /// Locates `diagnostics` of the preset in `text`, the contents of the file at `path`: each in the file that its field comes
    /// from, if the preset is based on another.
    #[must_use]
    pub fn locate<'d>(
        text: &str,
        path: &Path,
        diagnostics: impl Iterator<Item = &'d Diagnostic>,
    ) -> Vec<LocatedDiagnostic> {
        based_on::locate_fields(text, path, diagnostics)
    }

    /// All invalid values, and those that do not fit together.
    #[must_use]
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        let mut diagnostics = self.value_diagnostics();
        let of_learning = self.learning.problems().into_iter().map(in_learning);
        diagnostics.extend(of_learning.filter(|found| !diagnostics.contains(found)).collect::<Vec<_>>());
        if let Some(problem) = mirror::problem_of(self.observation).filter(|_| self.learning.mirror) {
            diagnostics.push(Diagnostic { path: "learning.mirror".into(), message: problem.into() });
        }
        let predicts = self.observation.sectors().is_some_and(|sectors| sectors.predicted_paths);
        if self.prediction_dropout > 0.0 && !predicts {
            let message = "needs an observation with predictions; help: use `observation: Sectors(..., predicted_paths: true)`, or \
                           `prediction_dropout: 0.0`";
            diagnostics.push(Diagnostic { path: "prediction_dropout".into(), message: message.into() });
        }
        if self.based_on.is_some() {
            let message = "is only read from a preset's own file; help: remove it here".into();
            diagnostics.push(Diagnostic { path: "based_on".into(), message });
        }
        diagnostics
    }

    /// The values that are invalid on their own.
    fn value_diagnostics(&self) -> Vec<Diagnostic> {
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
            within("prediction_dropout", self.prediction_dropout, 0.0..=1.0),
        ];
        let uniform = match self.levels {
            LevelSampling::Uniform => Ok(()),
            LevelSampling::ByProgress { uniform } => within("levels.uniform", uniform, 0.0..=1.0),
        };
        for error in ranges.into_iter().chain([uniform]).filter_map(Result::err) {
            add(&error.field, error.problem);
        }
        if let Err(problem) = self.observation.check() {
            add("observation", problem);
        }
        if let Err(problem) = self.actions.check() {
            add("actions", problem);
        }
        if self.about.chars().count() > MAX_ABOUT_CHARS {
            add("about", format!("is too long; help: write at most {MAX_ABOUT_CHARS} characters"));
        }
        for (field, problem) in self.reward.problems() {
            add(&format!("reward.{field}"), problem);
        }
        diagnostics.extend(self.learning.range_problems().into_iter().map(in_learning));
        diagnostics
    }
}

fn in_learning(error: ConfigError) -> Diagnostic {
    Diagnostic { path: format!("learning.{}", error.field), message: error.problem }
}

#[cfg(test)]
mod tests;
