//! The measures that compare arms: names, units, decimals and directions. The numbers come from `results.rs`.

use serde::{Deserialize, Serialize};

/// A measure of a trained arm.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Measure {
    /// The percentage of test episodes that succeed.
    Success,
    /// The mean time on the scenario's benchmark route over 25 episodes, in s; a failed episode counts as the time limit.
    BenchmarkRouteTime,
    /// The mean time of all test episodes, in s; a failed episode counts as the time limit.
    MeanTime,
    /// The time of the successful test episodes divided by the planner's time for the same episodes; if the planner's paths are
    /// optimal, 1 is optimal.
    TimeRatio,
    /// The time of the successful test episodes divided by the proven lower bounds for the same episodes. The ratio to the
    /// true optimum lies between this and [`TimeRatio`](Self::TimeRatio).
    BoundRatio,
    /// The success rate in the evaluations during training, in percent: at a point between two evaluations, the value that the
    /// curve `SuccessRate` has there.
    SuccessRate,
    /// The mean return of the last 100 training episodes (or of all, if there are fewer).
    Return,
    /// The mean number of goals reached in the last 100 training episodes (or in all, if there are fewer).
    Goals,
    /// Episodes of the last stage until the moving mean over 50 episodes reaches this number of goals per episode.
    EpisodesTo(f64),
    /// Thousands of env steps of the last stage until the moving mean reaches this number of goals per episode.
    StepsTo(f64),
}

impl Measure {
    /// A short name for column headings.
    #[must_use]
    pub fn heading(self) -> String {
        match self {
            Self::Success => "Success".into(),
            Self::SuccessRate => "Success in evaluations during training".into(),
            Self::BenchmarkRouteTime => "Benchmark route".into(),
            Self::MeanTime => "Mean time".into(),
            Self::TimeRatio => "Time / optimal".into(),
            Self::BoundRatio => "Time / lower bound".into(),
            Self::Return => "Return".into(),
            Self::Goals => "Goals per episode".into(),
            Self::EpisodesTo(goals) => format!("Episodes to {}", goals_per_episode(goals)),
            Self::StepsTo(goals) => format!("Env steps to {}", goals_per_episode(goals)),
        }
    }

    /// The unit; empty for a pure number.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Success | Self::SuccessRate => "%",
            Self::BenchmarkRouteTime | Self::MeanTime => "s",
            Self::StepsTo(_) => "thousands",
            Self::TimeRatio | Self::BoundRatio | Self::Return | Self::Goals | Self::EpisodesTo(_) => "",
        }
    }

    /// The range of possible values, in the unit; `None` means no limits.
    #[must_use]
    pub fn limits(self) -> Option<(f64, f64)> {
        match self {
            Self::Return => None,
            Self::Success | Self::SuccessRate => Some((0.0, 100.0)),
            _ => Some((0.0, f64::INFINITY)),
        }
    }

    /// The range of possible differences, in the unit; `None` means no limits.
    #[must_use]
    pub fn difference_limits(self) -> Option<(f64, f64)> {
        self.limits().map(|(low, high)| (low - high, high - low))
    }

    /// The number of decimals to show.
    #[must_use]
    pub fn digits(self) -> usize {
        match self {
            Self::Success | Self::SuccessRate | Self::Goals | Self::StepsTo(_) => 1,
            Self::BenchmarkRouteTime | Self::MeanTime | Self::TimeRatio | Self::BoundRatio => 2,
            Self::Return | Self::EpisodesTo(_) => 0,
        }
    }

    /// Whether larger values are better.
    #[must_use]
    pub fn more_is_better(self) -> bool {
        matches!(self, Self::Success | Self::SuccessRate | Self::Return | Self::Goals)
    }

    /// Whether the measure comes from a test of the policy, and not from the records of training.
    #[must_use]
    pub fn needs_test(self) -> bool {
        self != Self::SuccessRate && !self.is_of_episodes()
    }

    /// Whether the measure is about training episodes.
    #[must_use]
    pub fn is_of_episodes(self) -> bool {
        matches!(self, Self::Return | Self::Goals | Self::EpisodesTo(_) | Self::StepsTo(_))
    }

    /// The problem with the measure's parameter; `None` if it is valid.
    pub(super) fn invalid_reason(self) -> Option<String> {
        match self {
            Self::EpisodesTo(x) | Self::StepsTo(x) if !(0.01..=1000.0).contains(&x) => {
                Some(format!("asks for {x} goals per episode; help: give 0.01 to 1000"))
            }
            _ => None,
        }
    }
}

fn goals_per_episode(goals: f64) -> String {
    format!("{goals} goal{} per episode", if goals == 1.0 { "" } else { "s" })
}
