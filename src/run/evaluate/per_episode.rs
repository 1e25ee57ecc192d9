//! The planner's results for each episode, computed on all cores.

use std::borrow::Cow;

use bevy::math::{Vec2, vec2};

use super::EpisodeResult;
use crate::planner::{self, Resolution, StepBounds};
use crate::run::on_all_cores;
use crate::scenario::Scenario;

/// Bounds on the optimal time of each episode, in the order of `episodes`: those of the planner, which knows
/// the whole scenario ([`planner::step_bounds`]), at its default resolution. The number of `threads` (0: one
/// per core) does not change the result.
#[must_use]
pub fn bounds(scenario: &Scenario, episodes: &[EpisodeResult], threads: usize) -> Vec<StepBounds> {
    per_episode(scenario, episodes, threads, |layout, episode| {
        let (start, goal) = start_and_goal(episode);
        planner::step_bounds(layout, start, goal, episode.clock.0, Resolution::default())
    })
}

/// The length, in m, of the shortest path of each episode from the robot's start to the edge of the goal, around static
/// obstacles and walls, in the order of `episodes`. Moving obstacles and the turning radius are ignored. If there is no path, or
/// the scenario has polygons, which the planner does not support, it is the length of the straight line. The number of `threads`
/// (0: one per core) does not change the result.
///
/// See [`planner::shortest_path_m`] for the accuracy.
#[must_use]
pub fn shortest_paths_m(scenario: &Scenario, episodes: &[EpisodeResult], threads: usize) -> Vec<f64> {
    per_episode(scenario, episodes, threads, |layout, episode| {
        let (start, goal) = start_and_goal(episode);
        let straight_m = episode.start.distance_m(&episode.goal) - layout.task.goal_radius_m;
        planner::shortest_path_m(layout, start, goal).unwrap_or_else(|| f64::from(straight_m.max(0.0)))
    })
}

fn start_and_goal(episode: &EpisodeResult) -> ((f32, f32, f32), Vec2) {
    let EpisodeResult { start, goal, .. } = episode;
    ((start.x_m, start.y_m, start.heading_rad), vec2(goal.x_m, goal.y_m))
}

/// The results of `compute` for each of `episodes`, in their order. `compute` gets the scenario as drawn for the episode.
fn per_episode<T: Send>(
    scenario: &Scenario,
    episodes: &[EpisodeResult],
    threads: usize,
    compute: impl Fn(&Scenario, &EpisodeResult) -> T + Sync,
) -> Vec<T> {
    let result = |episode: &EpisodeResult| {
        let layout = if scenario.varies_by_episode() {
            Cow::Owned(scenario.with_generated_obstacles(episode.layout_seed))
        } else {
            Cow::Borrowed(scenario)
        };
        compute(&layout, episode)
    };
    on_all_cores::map(episodes.len(), threads, || (), |(), index| result(&episodes[index]))
}
