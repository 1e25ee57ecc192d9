//! The note on goals that the robot cannot reach within the time limit.
//!
//! A goal counts as out of reach only if the straight line to it is too long. Walls may put more goals out of reach.

use super::motions::{more_steps, step_m, steps_to};
use super::space::{possible_positions, without_moving_obstacles};
use super::{Note, NoteLevel};
use crate::geometry::length;
use crate::schema::Scenario;
use glam::Vec2;

/// Maximum number of starts, and of goals, that are compared.
const MAX_POSITIONS: usize = 512;
/// Smallest fraction of goals out of reach for which there is a note.
const MIN_FRACTION: f64 = 0.01;

pub(super) fn check(scenario: &Scenario, notes: &mut Vec<Note>) {
    let limit = scenario.task.max_episode_steps;
    let covered_m = step_m(scenario) * f64::from(limit);
    let reach_m = covered_m + f64::from(scenario.task.goal_radius_m);
    let (low, high) = scenario.enclosure.bounds_m();
    if f64::from(low.distance(high)) <= reach_m {
        return;
    }
    let still = without_moving_obstacles(scenario);
    let [starts, goals] =
        [&still.starts, &still.goals].map(|rule| thinned(possible_positions(&still, rule).collect()));
    let (mut all, mut beyond, mut farthest) = (0_u32, 0_u32, 0.0_f32);
    for start in &starts {
        for goal in &goals {
            let distance = length(goal.x - start.x, goal.y - start.y);
            if distance >= scenario.task.min_goal_distance_m {
                all += 1;
                beyond += u32::from(f64::from(distance) > reach_m);
                farthest = farthest.max(distance);
            }
        }
    }
    let fraction = f64::from(beyond) / f64::from(all.max(1));
    if fraction >= MIN_FRACTION {
        let message = format!(
            "is {limit}: in this time the robot covers at most {covered_m:.1} m, but {:.0} % of the goals are farther from \
             the start, up to {farthest:.1} m: {}, or bring starts and goals closer together",
            100.0 * fraction,
            more_steps(steps_to(scenario, farthest))
        );
        notes.push(Note::new(NoteLevel::Warning, "task.max_episode_steps", message));
    }
}

/// At most [`MAX_POSITIONS`] of the positions, evenly spread over the list.
fn thinned(positions: Vec<Vec2>) -> Vec<Vec2> {
    // An odd stride, so that not all of them are in the same columns of a grid.
    let every = positions.len().div_ceil(MAX_POSITIONS) | 1;
    positions.into_iter().step_by(every).collect()
}
