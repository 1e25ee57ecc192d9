//! The comparison of episodes with optimal times.

use super::{EpisodeResult, bounds, period_s, round_to_millionth};
use crate::planner::StepBounds;
use crate::scenario::{Scenario, TaskRules};

/// The comparison of successful episodes with optimal times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OptimumComparison {
    /// Number of compared episodes: those that succeeded and for which the planner found a path.
    pub episodes: usize,
    /// Mean time of the planned paths, in s.
    pub optimum_mean_time_s: f64,
    /// Mean time of the policy divided by that of the planned paths. 1 is as fast as the planner.
    pub time_ratio: f64,
    /// Mean time of the policy divided by the mean of the proven lower bounds; at least 1. The ratio to the
    /// true optimum lies between `time_ratio` and this.
    pub lower_bound_ratio: f64,
}

impl OptimumComparison {
    /// Compares each successful episode with its [`bounds`]. `None` if there is nothing to compare.
    #[must_use]
    pub fn from_episodes(
        episodes: &[EpisodeResult],
        bounds: &[StepBounds],
        rules: &TaskRules,
    ) -> Option<Self> {
        let (mut count, mut actual, mut planned, mut proven) = (0_usize, 0_u64, 0_u64, 0_u64);
        for (episode, bounds) in episodes.iter().zip(bounds).filter(|(episode, _)| episode.succeeded()) {
            let Some(plan_steps) = bounds.plan_steps else { continue };
            count += 1;
            actual += u64::from(episode.steps);
            planned += u64::from(plan_steps);
            proven += u64::from(bounds.lower_steps);
        }
        (count > 0).then(|| Self {
            episodes: count,
            optimum_mean_time_s: round_to_millionth(
                planned as f64 / count as f64 * period_s(rules.control_period_s),
            ),
            time_ratio: actual as f64 / planned as f64,
            lower_bound_ratio: actual as f64 / proven as f64,
        })
    }
}

/// Compares the successful episodes with their [`bounds`], computed on all cores. `None` if there is nothing
/// to compare, or the planner does not support the scenario ([`is_supported`](crate::planner::is_supported)).
#[must_use]
pub fn compare_with_optimum(scenario: &Scenario, episodes: &[EpisodeResult]) -> Option<OptimumComparison> {
    let succeeded: Vec<EpisodeResult> = episodes.iter().filter(|e| e.succeeded()).copied().collect();
    OptimumComparison::from_episodes(&succeeded, &bounds(scenario, &succeeded, 0), &scenario.task)
}
