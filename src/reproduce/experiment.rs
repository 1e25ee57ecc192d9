//! The schema of an experiment: arms to train over several seeds, and the figures and tables that compare them.
//!
//! In: a RON file from `assets/experiments/` or from the user. Out: an [`Experiment`].
//!
//! An **arm** is one way to learn: a stage of training, or several stages, each of which starts from the weights of the
//! stage before it (knowledge transfer), or runs that exist already. A **condition** changes all arms, or some of them,
//! in the same way; with conditions, every arm is trained under each of them. **Figures** and **tables** show the
//! results, and **claims** are tested against them.

use serde::{Deserialize, Serialize};

use super::claim::Claim;
use super::figure_spec::FigureSpec;
use super::seeds::Seeds;
use super::table_spec::{TableKind, TableSpec};
use crate::run::preset::{Budget, EvaluationConfig};
use crate::run::settings::Settings;

/// An experiment.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Experiment {
    /// The heading in the report.
    pub title: String,
    /// The question and the setup, in a few sentences.
    #[serde(default)]
    pub about: String,
    /// The number of seeds, 1 to 1,000: `5` stands for the seeds 1 to 5; or a list of seeds, such as `[3, 17, 42]`.
    /// `--seeds` overrides it.
    #[serde(default)]
    pub seeds: Seeds,
    /// The evaluation during training, instead of the presets' own. It does not affect what is learned.
    #[serde(default)]
    pub evaluation: Option<EvaluationConfig>,
    /// The test after training.
    #[serde(default)]
    pub test: TestRule,
    /// Changes to every stage under every condition, after all other changes. `--set` adds to them.
    #[serde(default, skip_serializing_if = "Settings::is_empty")]
    pub overrides: Settings,
    /// The arms to compare, at least one.
    pub arms: Vec<Arm>,
    /// The conditions under which all arms are trained. If empty, the arms are trained once, without changes.
    #[serde(default)]
    pub conditions: Vec<Condition>,
    /// The figures.
    #[serde(default)]
    pub figures: Vec<FigureSpec>,
    /// The tables.
    #[serde(default)]
    pub tables: Vec<TableSpec>,
    /// Whether its training runs are shortened (`--quick`). It is not part of the file.
    #[serde(skip)]
    pub(super) is_quick: bool,
}

impl Experiment {
    /// All claims of figures and tables.
    pub fn claims(&self) -> impl Iterator<Item = &Claim> {
        let figures = self.figures.iter().flat_map(|figure| &figure.claims);
        figures.chain(self.tables.iter().flat_map(|table| &table.claims))
    }

    /// The names of the arms that claims and tables compare, in pairs.
    pub(super) fn compared_arms(&self) -> impl Iterator<Item = (&str, &str)> {
        let claims = self.claims().map(|claim| (claim.better.as_str(), claim.than.as_str()));
        claims.chain(self.tables.iter().filter_map(|table| match &table.show {
            TableKind::Contrast { better, than, .. } => Some((better.as_str(), than.as_str())),
            _ => None,
        }))
    }
}

/// The test of a policy after training; by default the paper's 5 rounds of 100 episodes. The benchmark route is always
/// tested as well.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct TestRule {
    /// Rounds, 1 to 1,000.
    pub rounds: usize,
    /// Episodes per round, 1 to 10,000.
    pub episodes: usize,
    /// The seed of starts and goals, which are the same for every policy.
    pub seed: u64,
}

impl Default for TestRule {
    fn default() -> Self {
        Self { rounds: 5, episodes: 100, seed: 1000 }
    }
}

/// An arm: one way to learn.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Arm {
    /// The name in figures and tables.
    pub name: String,
    /// The stages, in order. Each but the first starts from the final weights of the stage before it.
    #[serde(default)]
    pub stages: Vec<Stage>,
    /// Instead of stages: folders of finished runs, one for each seed (relative to the experiment's folder or the working
    /// directory). They are read, and never changed.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub runs: Vec<String>,
    /// The policy that is tested.
    #[serde(default)]
    pub policy: TestedPolicy,
}

/// The policy of an arm that is tested.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum TestedPolicy {
    /// The policy after the episodes or env steps that a figure or table names, as in the paper.
    #[default]
    After,
    /// The best policy of the last stage, chosen by the evaluations during training, whose starts and goals differ from
    /// the test's. What a figure or table names in `after` is ignored.
    Best,
}

/// A stage: one training run of an arm.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Stage {
    /// The scenario: a RON file (relative to the experiment's folder or the working directory), or the name of a shipped
    /// scenario.
    pub scenario: String,
    /// The preset: a RON file, or the name of a shipped preset.
    pub preset: String,
    /// The length of the training run, instead of the preset's own.
    #[serde(default)]
    pub budget: Option<Budget>,
    /// The initial epsilon of a stage that starts from another stage's weights, instead of the preset's (the paper:
    /// 0.5).
    #[serde(default)]
    pub epsilon: Option<f32>,
    /// Fields of the preset and the scenario to change, by path:
    /// `{"learning.gamma": 0.97, "scenario.lidar.noise_std_m": 0.02}`.
    #[serde(default, skip_serializing_if = "Settings::is_empty")]
    pub overrides: Settings,
}

/// A condition: a change to all arms, or to some of them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Condition {
    /// The name in figures and tables.
    pub name: String,
    /// Another scenario for every stage. The overrides apply to it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scenario: Option<String>,
    /// Fields of the preset and the scenario to change in every stage, by path, after the stage's own overrides.
    #[serde(default, skip_serializing_if = "Settings::is_empty")]
    pub overrides: Settings,
    /// The names of the arms that are changed; empty for all.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub only_arms: Vec<String>,
    /// The scenarios whose stages are changed, by the names that the stages use; empty for all.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub only_scenarios: Vec<String>,
}

impl Condition {
    /// Whether the condition changes `stage` of `arm`.
    #[must_use]
    pub fn changes(&self, arm: &Arm, stage: &Stage) -> bool {
        self.includes(arm)
            && (self.only_scenarios.is_empty() || self.only_scenarios.contains(&stage.scenario))
    }

    /// Whether `arm` is one of the arms that the condition changes.
    #[must_use]
    pub fn includes(&self, arm: &Arm) -> bool {
        self.only_arms.is_empty() || self.only_arms.contains(&arm.name)
    }
}
