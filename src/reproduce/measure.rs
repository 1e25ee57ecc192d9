//! What is measured of a trained arm, and in what sense more of it is better.
//!
//! In: a name in an experiment's file. Out: unit, heading, digits, direction; the numbers come from
//! `results.rs`.

use serde::{Deserialize, Serialize};

/// What is measured.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Measure {
    /// Share of test episodes that succeed, in percent.
    Success,
    /// Mean time of the paper's course over 25 drives, in s; a drive that fails counts as the time limit.
    BenchmarkRouteTime,
    /// Mean time of all test episodes, in s; one that fails counts as the time limit.
    MeanTime,
    /// Time of the successful test episodes over the planner's for the same ones; 1 is the optimum, if the planner
    /// found it.
    TimeRatio,
    /// The same over the proven lower bounds; the ratio to the true optimum lies between the two.
    BoundRatio,
    /// Mean return of the last 100 episodes of training (of all, if there are fewer).
    Return,
    /// Mean number of goals reached in the last 100 episodes of training (of all, if there are fewer).
    Goals,
    /// Episodes of the last stage until the mean of 50 of its episodes reaches so many goals an episode.
    EpisodesTo(f64),
    /// The same in thousands of env steps of the last stage.
    StepsTo(f64),
}

impl Measure {
    /// What it is, short enough for a column.
    #[must_use]
    pub fn heading(self) -> String {
        match self {
            Self::Success => "Success".into(),
            Self::BenchmarkRouteTime => "Course".into(),
            Self::MeanTime => "Mean time".into(),
            Self::TimeRatio => "Time / least".into(),
            Self::BoundRatio => "Time / bound".into(),
            Self::Return => "Return".into(),
            Self::Goals => "Goals an episode".into(),
            Self::EpisodesTo(goals) => format!("Episodes to {goals} goals"),
            Self::StepsTo(goals) => format!("Steps to {goals} goals"),
        }
    }

    /// Its unit; empty for a pure number.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Success => "%",
            Self::BenchmarkRouteTime | Self::MeanTime => "s",
            Self::StepsTo(_) => "thousands",
            Self::TimeRatio | Self::BoundRatio | Self::Return | Self::Goals | Self::EpisodesTo(_) => "",
        }
    }

    /// Decimals worth showing.
    #[must_use]
    pub fn digits(self) -> usize {
        match self {
            Self::Success | Self::Goals | Self::StepsTo(_) => 1,
            Self::BenchmarkRouteTime | Self::MeanTime | Self::TimeRatio | Self::BoundRatio => 2,
            Self::Return | Self::EpisodesTo(_) => 0,
        }
    }

    /// Whether more of it is better.
    #[must_use]
    pub fn more_is_better(self) -> bool {
        matches!(self, Self::Success | Self::Return | Self::Goals)
    }

    /// What is wrong with its number, if anything.
    pub(super) fn invalid_reason(self) -> Option<String> {
        match self {
            Self::EpisodesTo(x) | Self::StepsTo(x) if !(0.01..=1000.0).contains(&x) => {
                Some(format!("asks for {x} goals an episode; give 0.01 to 1000"))
            }
            _ => None,
        }
    }
}
