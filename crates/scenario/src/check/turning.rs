//! The notes on a robot that can't turn, or that has no space to turn around.

use super::space::{sides, without_moving_obstacles};
use super::{Note, NoteLevel};
use crate::geometry::{clearance, length};
use crate::schema::{Robot, Scenario};
use glam::vec2;

/// Points along each axis of the grid on which clearance is measured.
const GRID: u16 = 64;
/// The same in a scenario whose obstacles and walls have more than [`MANY_SIDES`] sides.
const COARSE_GRID: u16 = 16;
/// Number of sides of obstacles and walls above which the coarse grid is used.
const MANY_SIDES: usize = 1_000;

pub(super) fn check(scenario: &Scenario, notes: &mut Vec<Note>) {
    let radius_m = turning_radius_m(&scenario.robot);
    let mut warn = |message: String| notes.push(Note::new(NoteLevel::Warning, "robot.motions", message));
    if radius_m.is_infinite() {
        return warn(
            "never turn the robot, so it misses every goal that is not on its straight line: write a w_rad_s other than 0"
                .into(),
        );
    }
    let drives = |sign: f32| scenario.robot.motions.iter().any(|motion| motion.v_m_s * sign > 0.0);
    if drives(1.0) && drives(-1.0) {
        // By driving forwards and backwards in turn, it can turn around in a narrow space, too.
        return;
    }
    let needed_m = radius_m + scenario.keep_out_m();
    let widest_m = widest_disc_m(scenario, needed_m);
    if widest_m < needed_m {
        warn(format!(
            "turn the robot with a radius of at least {radius_m:.2} m, which needs a free disc of {needed_m:.2} m radius, \
             but the largest here has at most {widest_m:.2} m, so it can turn around at best by circling an obstacle or \
             inner wall: write a smaller v_m_s or a larger w_rad_s"
        ));
    }
}

/// The smallest turning radius of the robot, in m; infinite if it can't turn.
fn turning_radius_m(robot: &Robot) -> f32 {
    let turning = robot.motions.iter().filter(|motion| motion.w_rad_s != 0.0);
    turning.map(|motion| (motion.v_m_s / motion.w_rad_s).abs()).fold(f32::INFINITY, f32::min)
}

/// An upper bound on the radius, in m, of the largest disc that is free of walls and static obstacles. The search ends when the
/// bound reaches `enough_m`.
fn widest_disc_m(scenario: &Scenario, enough_m: f32) -> f32 {
    let still = without_moving_obstacles(scenario);
    let grid = if sides(&still) > MANY_SIDES { COARSE_GRID } else { GRID };
    let (low, high) = still.enclosure.bounds_m();
    let step = (high - low) / f32::from(grid);
    // No point is farther than this from a point of the grid, and clearance changes by no more than the distance.
    let half_diagonal_m = length(step.x, step.y) / 2.0;
    let centre = |k: u16, low: f32, step: f32| low + (f32::from(k) + 0.5) * step;
    let mut widest_m = 0.0_f32;
    for row in 0..grid {
        for column in 0..grid {
            let point = vec2(centre(column, low.x, step.x), centre(row, low.y, step.y));
            widest_m = widest_m.max(clearance(&still, point, 0) + half_diagonal_m);
            if widest_m >= enough_m {
                return widest_m;
            }
        }
    }
    widest_m
}
