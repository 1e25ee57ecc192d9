//! What an experiment is: arms to train, over several seeds, and what to show of them.
//!
//! In: a RON file of `assets/experiments/`, or a user's own. Out: a checked [`Experiment`].
//!
//! An **arm** is a way to learn: one stage, or several that hand their weights on (knowledge transfer). Under each
//! **condition** (if there are any) the experiment is done with something changed in all arms alike. What is shown are
//! **figures** and **tables**, with the **claims** that they bear out or do not.

use std::path::Path;

use serde::{Deserialize, Serialize};

use super::measure::Measure;
use super::overrides::Override;
use crate::run::preset::{Budget, EvaluationConfig};
use crate::scenario::{Diagnostic, FileError, parse_ron, read_text};

/// One experiment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Experiment {
    /// Its heading in the report.
    pub title: String,
    /// What is asked, in a few sentences.
    #[serde(default)]
    pub about: String,
    /// How many seeds: 1, 2, ... up to this, 1 to 1,000. The command line may say otherwise.
    #[serde(default = "default_seeds")]
    pub seeds: u64,
    /// How often policies are evaluated during training, if not as the presets say. It changes nothing of what is
    /// learnt.
    #[serde(default)]
    pub evaluation: Option<EvaluationConfig>,
    /// The test after training.
    #[serde(default)]
    pub test: TestRule,
    /// What is compared, at least one.
    pub arms: Vec<Arm>,
    /// What is changed in all arms alike. None: nothing, once.
    #[serde(default)]
    pub conditions: Vec<Condition>,
    /// Pictures of it.
    #[serde(default)]
    pub figures: Vec<FigureSpec>,
    /// Tables of it.
    #[serde(default)]
    pub tables: Vec<TableSpec>,
}

fn default_seeds() -> u64 {
    5
}

/// The test of a policy after training: the paper's 5 rounds of 100 episodes, and its course.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TestRule {
    /// Rounds, 1 to 1,000.
    pub rounds: usize,
    /// Navigations in each, 1 to 10,000.
    pub episodes: usize,
    /// The seed of their starts and goals: the same ones for every policy.
    pub seed: u64,
}

impl Default for TestRule {
    fn default() -> Self {
        Self { rounds: 5, episodes: 100, seed: 1000 }
    }
}

/// A way to learn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Arm {
    /// What to call it.
    pub name: String,
    /// One after another; each but the first starts from the weights that the one before it ended with.
    pub stages: Vec<Stage>,
    /// Which policy is tested.
    #[serde(default)]
    pub policy: TestedPolicy,
}

/// Which policy of an arm is tested.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum TestedPolicy {
    /// The policy as it stands after so many episodes, as in the paper.
    #[default]
    AtEpisode,
    /// When the last stage is over, the best of it by its own evaluations (which use other starts and goals than the
    /// test), whatever number of episodes a figure or table names.
    Best,
}

/// One training.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stage {
    /// The world: a RON file (seen from the experiment's folder, or from where the program runs), or a shipped one by
    /// name.
    pub scenario: String,
    /// How to learn: likewise.
    pub preset: String,
    /// How long, if not as the preset says.
    #[serde(default)]
    pub budget: Option<Budget>,
    /// Epsilon at the start of a stage that takes up another's weights, if not the preset's (the paper: 0.5).
    #[serde(default)]
    pub epsilon: Option<f32>,
    /// What is changed in scenario and preset.
    #[serde(default)]
    pub overrides: Override,
}

/// Something that is changed in all arms alike.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Condition {
    /// What to call it.
    pub name: String,
    /// The change, in every stage.
    #[serde(default)]
    pub overrides: Override,
}

/// A picture.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FigureSpec {
    /// What `--only` and its files call it: lower-case letters, digits, `-`.
    pub name: String,
    /// Its heading.
    pub title: String,
    /// What is to be seen on it.
    #[serde(default)]
    pub caption: String,
    /// What is drawn.
    pub draw: FigureKind,
    /// What it is to bear out.
    #[serde(default)]
    pub claims: Vec<Claim>,
}

/// What a figure shows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum FigureKind {
    /// Learning curves over episodes, one panel for each series: mean over the seeds with a 95 % band.
    LearningCurves {
        /// One panel each.
        series: Vec<EpisodeSeries>,
        /// Episodes in the moving mean, 1 to 10,000.
        #[serde(default = "default_smoothing")]
        smoothing: usize,
        /// Horizontal lines: the paper's figures.
        #[serde(default)]
        reference_lines: Vec<ReferenceLineSpec>,
    },
    /// A dot for each seed, and their mean with its 95 % interval: a row an arm (and condition), a column a measure.
    DotPlot {
        /// One column each.
        measures: Vec<Measure>,
        /// After so many episodes over all stages.
        after: u64,
    },
    /// The benchmark route from above: the planner's way, and each arm's drive (seed 1).
    BenchmarkRoute {
        /// After so many episodes over all stages.
        after: u64,
    },
}

fn default_smoothing() -> usize {
    50
}

/// What is counted in each episode of training.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum EpisodeSeries {
    /// The undiscounted sum of rewards.
    Return,
    /// Goals reached.
    Goals,
}

/// A horizontal line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferenceLineSpec {
    /// In this panel.
    pub series: EpisodeSeries,
    /// At this height.
    pub value: f64,
    /// What it is.
    pub label: String,
}

/// A table.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TableSpec {
    /// What its files are called: lower-case letters, digits, `-`.
    pub name: String,
    /// Other names under which `--only` finds it.
    #[serde(default)]
    pub aliases: Vec<String>,
    /// Its heading.
    pub title: String,
    /// What is in it.
    pub show: TableKind,
    /// What it is to bear out.
    #[serde(default)]
    pub claims: Vec<Claim>,
}

/// What a table shows.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum TableKind {
    /// A row an arm: every seed's value, their mean with its 95 % interval, the paper's, the difference.
    Seeds {
        /// What is measured.
        measure: Measure,
        /// After so many episodes over all stages.
        after: u64,
        /// The paper's figure for an arm.
        #[serde(default)]
        paper: Vec<(String, f64)>,
    },
    /// A row an arm and seed, a column a round of the test: success in percent; and a row for the paper's rounds.
    Rounds {
        /// After so many episodes over all stages.
        after: u64,
        /// The paper's rounds of an arm, in percent.
        #[serde(default)]
        paper: Vec<(String, Vec<f64>)>,
    },
    /// A row an arm (and condition), a column a measure: means with their 95 % intervals.
    Measures {
        /// One column each.
        measures: Vec<Measure>,
        /// After so many episodes over all stages.
        after: u64,
    },
    /// A row a condition and number of episodes: one arm against another.
    Contrast {
        /// What is measured, a group of columns each.
        measures: Vec<Measure>,
        /// The arm that the paper has ahead.
        better: String,
        /// The other arm.
        than: String,
        /// After these numbers of episodes over all stages.
        after: Vec<u64>,
        /// The episodes are those of the last stage alone.
        #[serde(default)]
        of_last_stage: bool,
    },
}

/// A claim of the paper, or one to be held against the data: `better` is ahead of `than`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Claim {
    /// In words.
    pub statement: String,
    /// By this measure.
    pub measure: Measure,
    /// The arm that is claimed to be ahead.
    pub better: String,
    /// The other arm.
    pub than: String,
    /// After so many episodes over all stages.
    pub after: u64,
    /// The episodes are those of the last stage alone.
    #[serde(default)]
    pub of_last_stage: bool,
}

impl Experiment {
    /// The experiment in the file at `path`, read and checked.
    ///
    /// # Errors
    /// With file, line, column and mend: a file that cannot be read, is no experiment, or asks for what cannot be.
    pub fn load(path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        Self::parse(&read_text(path)?, path)
    }

    /// The experiment that `text` spells, checked; `path` is only what errors name.
    ///
    /// # Errors
    /// As [`Experiment::load`].
    pub fn parse(text: &str, path: impl AsRef<Path>) -> Result<Self, FileError> {
        let path = path.as_ref();
        let experiment: Self = parse_ron(text, path)?;
        let diagnostics = experiment.diagnostics();
        if diagnostics.is_empty() {
            Ok(experiment)
        } else {
            Err(FileError::from_diagnostics(path, text, &diagnostics))
        }
    }

    /// Everything in it that cannot be meant.
    #[must_use]
    pub fn diagnostics(&self) -> Vec<Diagnostic> {
        super::check::diagnostics(self)
    }
}
