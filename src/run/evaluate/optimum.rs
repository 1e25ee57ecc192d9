//! The comparison of episodes with optimal times.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread::Builder;

use bevy::math::vec2;

use super::{EpisodeResult, period_s, round_to_microsecond};
use crate::planner::{self, Resolution, StepBounds};
use crate::scenario::{Scenario, TaskRules};

/// Bounds on the optimal time of each episode, in the order of `episodes`: those of the planner, which knows
/// the whole scenario ([`planner::step_bounds`]), at its default resolution. The number of `threads` (0: one
/// per core) does not change the result.
#[must_use]
pub fn bounds(scenario: &Scenario, episodes: &[EpisodeResult], threads: usize) -> Vec<StepBounds> {
    let of = |n: &EpisodeResult| {
        let start = (n.start.x_m, n.start.y_m, n.start.heading_rad);
        let goal = vec2(n.goal.x_m, n.goal.y_m);
        if scenario.generators.is_empty() {
            return planner::step_bounds(scenario, start, goal, n.clock.0, Resolution::default());
        }
        planner::step_bounds(
            &scenario.with_generated_obstacles(n.layout_seed),
            start,
            goal,
            n.clock.0,
            Resolution::default(),
        )
    };
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let threads = if threads == 0 { cores() } else { threads }.min(episodes.len());
    // Some plans take a hundred times as long as others, so threads take episodes one at a time.
    let next = AtomicUsize::new(0);
    let work = || {
        let next_bounds = || {
            let index = next.fetch_add(1, Ordering::Relaxed);
            episodes.get(index).map(|episode| (index, of(episode)))
        };
        std::iter::from_fn(next_bounds).collect::<Vec<_>>()
    };
    let mut found: Vec<_> = std::thread::scope(|scope| {
        // This thread works too, so threads that cannot be started only cost time.
        let start = |_| Builder::new().spawn_scoped(scope, work).ok();
        let workers: Vec<_> = (1..threads).filter_map(start).collect();
        let mut found = work();
        for worker in workers {
            found.extend(worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)));
        }
        found
    });
    found.sort_by_key(|(index, _)| *index);
    found.into_iter().map(|(_, bounds)| bounds).collect()
}

/// The comparison of successful episodes with optimal times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OptimumComparison {
    /// Number of compared episodes: those that succeeded and for which the planner found a path.
    pub episodes: usize,
    /// Mean time of the planned paths, in s.
    pub optimum_mean_time_s: f64,
    /// Mean time of the policy divided by that of the planned paths. If these are optimal, so is a ratio of 1.
    pub time_ratio: f64,
    /// Mean time of the policy divided by the mean of the proven lower bounds, 1 or more. The ratio to the
    /// true optimum lies between `time_ratio` and this.
    pub lower_bound_ratio: f64,
}

impl OptimumComparison {
    /// Compares each of `episodes` with its [`bounds`]. `None` if there is nothing to compare.
    #[must_use]
    pub fn from_episodes(
        episodes: &[EpisodeResult],
        bounds: &[StepBounds],
        rules: &TaskRules,
    ) -> Option<Self> {
        let (mut count, mut actual, mut planned, mut proven) = (0_usize, 0_u64, 0_u64, 0_u64);
        for (episode, bounds) in episodes.iter().zip(bounds).filter(|(n, _)| n.succeeded()) {
            let Some(plan_steps) = bounds.plan_steps else { continue };
            count += 1;
            actual += u64::from(episode.steps);
            planned += u64::from(plan_steps);
            proven += u64::from(bounds.lower_steps);
        }
        (count > 0).then(|| Self {
            episodes: count,
            optimum_mean_time_s: round_to_microsecond(
                planned as f64 / count as f64 * period_s(rules.control_period_s),
            ),
            time_ratio: actual as f64 / planned as f64,
            lower_bound_ratio: actual as f64 / proven as f64,
        })
    }
}

/// Compares the successful episodes with their [`bounds`], computed on all cores. `None` if there is nothing
/// to compare, or the planner does not support the scenario ([`planner::is_supported`]).
#[must_use]
pub fn compare_with_optimum(scenario: &Scenario, episodes: &[EpisodeResult]) -> Option<OptimumComparison> {
    let succeeded: Vec<EpisodeResult> = episodes.iter().filter(|n| n.succeeded()).copied().collect();
    OptimumComparison::from_episodes(&succeeded, &bounds(scenario, &succeeded, 0), &scenario.task)
}
