//! The schema of an experiment's figures.

use serde::{Deserialize, Serialize};

use super::claim::Claim;
use super::measure::Measure;

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

/// The kind of a figure.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum FigureKind {
    /// Learning curves over episodes, in a panel for each series: the mean over the seeds with its 95 % interval.
    LearningCurves {
        /// The series, one panel each.
        series: Vec<EpisodeSeries>,
        /// The number of episodes in the moving mean, 1 to 10,000.
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
        /// The policy after this number of episodes, over all stages.
        after: u64,
    },
    /// A map of the benchmark route with the planner's path and each arm's trajectory (seed 1).
    BenchmarkRoute {
        /// The policy after this number of episodes, over all stages.
        after: u64,
    },
}

fn default_smoothing() -> usize {
    50
}

/// A value of each training episode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum EpisodeSeries {
    /// The undiscounted sum of rewards.
    Return,
    /// The number of goals reached.
    Goals,
}

/// A horizontal line.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReferenceLineSpec {
    /// The series whose panel shows the line.
    pub series: EpisodeSeries,
    /// The value, in the series' unit.
    pub value: f64,
    /// The label.
    pub label: String,
}
