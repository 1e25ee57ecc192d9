//! The checks of how far the robot and obstacles move and turn in one control step, and the notes on fast obstacles.

use std::f32::consts::PI;

use super::motions::max_speed_m_s;
use super::{Diagnostics, Note, NoteLevel, key_frames, rounded_down};
use crate::limits::*;
use crate::schema::*;
use crate::track::MotionSpeed;

/// Tolerance factor: a speed at the limit may exceed it slightly after rounding.
pub(super) const SLACK: f32 = 1.0 + 1e-5;

/// The control period of `task` in s, or 0 if it is invalid, which is reported elsewhere: then only speeds are checked.
pub(crate) fn checked_period_s(task: &TaskRules) -> f32 {
    if CONTROL_PERIOD_S.contains(&task.control_period_s) { task.control_period_s } else { 0.0 }
}

/// The highest allowed speed of an obstacle, in m/s. The obstacle must not jump over the robot in a control step of `period_s`.
pub(crate) fn fastest_m_s(period_s: f32) -> f32 {
    MAX_SPEED_M_S.min(MAX_STEP_M / period_s)
}

pub(super) fn check(scenario: &Scenario, diagnostics: &mut Diagnostics) {
    let period = checked_period_s(&scenario.task);
    for (k, obstacle) in scenario.obstacles.iter().enumerate().take(MAX_OBSTACLES) {
        check_obstacle(k, obstacle, period, diagnostics);
    }
    check_robot(scenario, period, diagnostics);
}

fn check_obstacle(k: usize, obstacle: &Obstacle, period: f32, diagnostics: &mut Diagnostics) {
    let path = format_args!("obstacles[{k}].motion");
    let fastest = obstacle.motion.fastest_speed();
    match fastest {
        MotionSpeed::AtRest => {}
        MotionSpeed::Revolution { centre_m, speed_rad_s } => {
            let path = format_args!("{path}.speed_rad_s");
            let (arm, speed) = (obstacle.distance_to(centre_m), obstacle.origin_speed_at(fastest));
            if speed_rad_s.abs() > MAX_ANGULAR_SPEED_RAD_S || !speed.is_finite() {
                return;
            }
            let most = || rounded_down((fastest_m_s(period) / arm).min(PI / period));
            if speed * period > MAX_STEP_M * SLACK {
                diagnostics.push(path, too_far(speed * period, "obstacle", &most()));
            } else if speed > MAX_SPEED_M_S * SLACK {
                diagnostics.push(path, format!("{}: write at most {}", too_fast(speed), most()));
            } else if speed_rad_s.abs() * period > PI * SLACK {
                diagnostics.push(path, turns_too_far(speed_rad_s.abs() * period, "obstacle", period));
            }
        }
        MotionSpeed::Variable => key_frames::check_speeds(k, obstacle, period, diagnostics),
        MotionSpeed::Translation(speed_m_s) => {
            let moved = speed_m_s * period;
            if moved > MAX_STEP_M * SLACK && speed_m_s <= MAX_SPEED_M_S {
                let most = rounded_down(MAX_STEP_M / period);
                diagnostics.push(format_args!("{path}.speed_m_s"), too_far(moved, "obstacle", &most));
            }
        }
    }
}

fn check_robot(scenario: &Scenario, period: f32, diagnostics: &mut Diagnostics) {
    let goal = scenario.task.goal_radius_m;
    for (k, motion) in scenario.robot.motions.iter().enumerate().take(*MOTIONS.end()) {
        let moved = motion.v_m_s.abs() * period;
        if moved > 2.0 * goal * SLACK && motion.v_m_s.abs() <= MAX_SPEED_M_S && goal >= *GOAL_RADIUS_M.start()
        {
            let most = rounded_down(2.0 * goal / period);
            let message = format!(
                "moves the robot {moved:.3} m in one control step, more than the goal's diameter of {:.3} m: write at most \
                 {most}, or a smaller task.control_period_s",
                2.0 * goal
            );
            diagnostics.push(format_args!("robot.motions[{k}].v_m_s"), message);
        }
        let turned = motion.w_rad_s.abs() * period;
        if turned > PI * SLACK && motion.w_rad_s.abs() <= MAX_ANGULAR_SPEED_RAD_S {
            let path = format_args!("robot.motions[{k}].w_rad_s");
            diagnostics.push(path, turns_too_far(turned, "robot", period));
        }
    }
}

/// Adds a note for each obstacle that is faster than the robot.
pub(super) fn note_fast_obstacles(scenario: &Scenario, notes: &mut Vec<Note>) {
    let robot_m_s = max_speed_m_s(&scenario.robot);
    for (k, obstacle) in scenario.obstacles.iter().enumerate() {
        let speed_m_s = obstacle.max_speed_at(obstacle.motion.fastest_speed()).abs();
        if speed_m_s > robot_m_s * SLACK {
            let field = match obstacle.motion.speed() {
                MotionSpeed::Revolution { .. } => ".speed_rad_s",
                MotionSpeed::Variable => "",
                _ => ".speed_m_s",
            };
            let message = format!(
                "moves the obstacle at up to {speed_m_s:.3} m/s, faster than the robot at {robot_m_s:.3} m/s, which can't \
                 evade it: slow it down, unless that is intended"
            );
            notes.push(Note::new(NoteLevel::Note, format!("obstacles[{k}].motion{field}"), message));
        }
    }
}

pub(super) fn too_fast(speed_m_s: f32) -> String {
    format!("moves the obstacle at {speed_m_s:.3} m/s, above the limit of {MAX_SPEED_M_S} m/s")
}

fn too_far(moved: f32, what: &str, most: &str) -> String {
    format!(
        "moves the {what} {moved:.3} m in one control step, above the limit of {MAX_STEP_M} m: write at most {most}, or a \
         smaller task.control_period_s"
    )
}

fn turns_too_far(turned: f32, what: &str, period: f32) -> String {
    format!(
        "turns the {what} by {turned:.3} rad in one control step, more than half a turn: write at most {}, or a \
         smaller task.control_period_s",
        rounded_down(PI / period)
    )
}
