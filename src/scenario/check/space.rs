//! Whether all obstacles stay inside the walls, and whether there is room for starts, targets and the course.
//!
//! Asked of scenarios whose numbers are sound.

use super::Notes;
use crate::scenario::geometry::{clearance, half_extents, length, reach_from};
use crate::scenario::motion::pose_at;
use crate::scenario::placement::free_points;
use crate::scenario::schema::*;

/// An obstacle may stand out of a wall by so much, in m: rounding.
const SLACK_M: f32 = 1e-4;
/// At how many moments of an episode room is looked for when obstacles move.
const MOMENTS: u64 = 4;

pub(super) fn check(scenario: &Scenario, notes: &mut Notes) {
    let Enclosure::Rectangle { width_m, height_m } = scenario.enclosure;
    for (k, obstacle) in scenario.obstacles.iter().enumerate() {
        let (x, y) = farthest(obstacle);
        let over = (x - width_m / 2.0).max(y - height_m / 2.0);
        if over > SLACK_M {
            let (what, mend) = match obstacle.motion {
                ObstacleMotion::Still => ("reaches", "move it inwards or make it smaller"),
                _ => ("reaches on its way", "shorten the way or make it smaller"),
            };
            notes.add(
                format_args!("obstacles[{k}]"),
                format!("{what} {over:.3} m beyond the enclosure: {mend}"),
            );
        }
    }
    course(scenario, notes);
    room(scenario, notes);
}

/// The largest |x| and |y| that an obstacle covers on its whole way.
fn farthest(obstacle: &Obstacle) -> (f32, f32) {
    let (half_x, half_y) = half_extents(&obstacle.shape, obstacle.rotation_rad);
    let at = |(x, y): (f32, f32)| (x.abs() + half_x, y.abs() + half_y);
    match &obstacle.motion {
        ObstacleMotion::Still => at(obstacle.position_m),
        ObstacleMotion::Orbit { centre_m, .. } => {
            let reach = reach_from(obstacle, *centre_m);
            (centre_m.0.abs() + reach, centre_m.1.abs() + reach)
        }
        ObstacleMotion::Patrol { waypoints_m, .. } => waypoints_m
            .iter()
            .map(|&corner| at(corner))
            .fold(at(obstacle.position_m), |a, b| (a.0.max(b.0), a.1.max(b.1))),
    }
}

/// The course's ends must be where the robot doesn't collide, and apart.
fn course(scenario: &Scenario, notes: &mut Notes) {
    let (course, task) = (&scenario.course, &scenario.task);
    for (name, point) in [("start_m", course.start_m), ("target_m", course.target_m)] {
        let clear = clearance(scenario, point, 0);
        let least = task.collision_range_m;
        if clear < least {
            let lies = if clear < 0.0 { "inside an obstacle or wall" } else { "from an obstacle or wall" };
            let message =
                format!("lies {:.3} m {lies}: put it at least {least} m clear of everything", clear.abs());
            notes.add(format_args!("course.{name}"), message);
        }
    }
    let apart = length(course.start_m.0 - course.target_m.0, course.start_m.1 - course.target_m.1);
    notes.above(format_args!("course.target_m"), apart, task.goal_radius_m, "the goal radius from the start");
}

/// Starts and targets must find room, and targets far enough from wherever the robot is.
fn room(scenario: &Scenario, notes: &mut Notes) {
    let moves = scenario.obstacles.iter().any(|o| o.motion != ObstacleMotion::Still);
    let moments = if moves { MOMENTS } else { 1 };
    let far = 2.0 * scenario.task.min_target_distance_m;
    let (mut starts, mut targets, mut spread) = (None, None, false);
    for step in (0..moments).map(|k| k * u64::from(scenario.task.time_limit_steps) / MOMENTS) {
        let frozen = frozen(scenario, step);
        if starts.is_none() && free_points(&frozen, &scenario.starts, 0).next().is_none() {
            starts = Some(step);
        }
        let (mut some, mut wide) = (false, false);
        let (mut low, mut high) = ((f32::MAX, f32::MAX), (f32::MIN, f32::MIN));
        for (x, y) in free_points(&frozen, &scenario.targets, 0) {
            some = true;
            low = (low.0.min(x), low.1.min(y));
            high = (high.0.max(x), high.1.max(y));
            if high.0 - low.0 >= far || high.1 - low.1 >= far {
                wide = true;
                break;
            }
        }
        if !some && targets.is_none() {
            targets = Some(step);
        }
        spread |= some && !wide;
    }
    let mut none = |name: &str, step: Option<u64>, rule: &PlaceRule| {
        if let Some(step) = step {
            let PlaceRule::Random { clearance_m } = rule;
            let message = format!(
                "finds no free space at step {step}: no point of the enclosure is {clearance_m} m clear; use fewer or \
                 smaller obstacles, or a smaller clearance_m"
            );
            notes.add(format_args!("{name}"), message);
        }
    };
    none("starts", starts, &scenario.starts);
    none("targets", targets, &scenario.targets);
    if spread {
        let message = format!(
            "is {}: the free space for targets is less than twice as long, so some places of the robot leave no \
             target; write less, or make room",
            scenario.task.min_target_distance_m
        );
        notes.add(format_args!("task.min_target_distance_m"), message);
    }
}

/// The scenario with every obstacle standing where it is at `step`.
fn frozen(scenario: &Scenario, step: u64) -> Scenario {
    let mut still = scenario.clone();
    for obstacle in &mut still.obstacles {
        let (x, y, rotation) = pose_at(obstacle, step, scenario.task.control_period_s);
        *obstacle = Obstacle {
            shape: obstacle.shape.clone(),
            position_m: (x, y),
            rotation_rad: rotation,
            motion: ObstacleMotion::Still,
        };
    }
    still
}
