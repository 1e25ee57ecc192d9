//! The schema of an experiment's figures.

use serde::{Deserialize, Serialize};

use super::claim::Claim;
use super::measure::Measure;
use crate::run::preset::Budget;

/// A figure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct FigureSpec {
    /// The name of the figure's files, also used by `--only`: lower-case letters, digits and `-`.
    pub name: String,
    /// The title.
    pub title: String,
    /// The caption.
    #[serde(default)]
    pub caption: String,
    /// The kind of figure.
    pub draw: FigureKind,
    /// Claims to test.
    #[serde(default)]
    pub claims: Vec<Claim>,
}

impl FigureSpec {
    /// The number of training episodes in the figure's moving means, which its claims use, too. `None` for a figure without
    /// curves.
    #[must_use]
    pub fn window(&self) -> Option<usize> {
        match self.draw {
            FigureKind::LearningCurves { smoothing, .. } => Some(smoothing),
            FigureKind::DotPlot { .. } | FigureKind::BenchmarkRoute { .. } => None,
        }
    }
}

/// The kind of a figure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum FigureKind {
    /// Learning curves, in a panel for each series: the mean over the seeds with its 95 % interval.
    LearningCurves {
        /// The series, one panel each.
        series: Vec<Series>,
        /// The x axis. By default episodes; env steps if a stage has a budget in env steps, or if the training runs differ in
        /// the number of arenas.
        #[serde(default)]
        over: Option<Axis>,
        /// The number of episodes in the moving mean, 1 to 10,000. The figure's claims about training episodes use it, too.
        #[serde(default = "default_smoothing")]
        smoothing: usize,
        /// Horizontal lines, such as the paper's values.
        #[serde(default)]
        reference_lines: Vec<ReferenceLineSpec>,
    },
    /// A dot for each seed, and their mean with its 95 % interval. Rows are arms (and conditions), columns are measures.
    DotPlot {
        /// The measures, one column each.
        measures: Vec<Measure>,
        /// The episodes or env steps, over all stages, after which the policies are tested; 0 is before the first step. Without
        /// it, after training.
        #[serde(default)]
        after: Option<Budget>,
    },
    /// A map of the benchmark route with the planner's path and each arm's trajectory (its first seed). Arms with other
    /// obstacles, another robot or another route than the first arm are left out.
    BenchmarkRoute {
        /// The episodes or env steps, over all stages, after which the policies drive the route. Without it, after
        /// training.
        #[serde(default)]
        after: Option<Budget>,
    },
}

fn default_smoothing() -> usize {
    50
}

/// A series of values during training.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Series {
    /// The undiscounted sum of rewards of each training episode.
    Return,
    /// The number of goals reached in each training episode.
    Goals,
    /// The percentage of episodes that succeed in each evaluation during training. A claim about it has the measure
    /// `SuccessRate`.
    SuccessRate,
}

/// The x axis of learning curves.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Axis {
    /// Finished episodes.
    Episodes,
    /// Env steps.
    EnvSteps,
}

/// A horizontal line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferenceLineSpec {
    /// The series whose panel shows the line.
    pub series: Series,
    /// The value, in the series' unit.
    pub value: f64,
    /// The label.
    pub label: String,
}
