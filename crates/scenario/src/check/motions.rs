//! The checks of the robot's motions that need no map: the robot can move, and reach the nearest goals within the time limit.

use super::{Diagnostics, ValidPart};
use crate::limits::EPISODE_STEPS;
use crate::schema::{Robot, Scenario, TaskRules};

/// Factor that allows for rounding errors.
const SLACK: f64 = 1.0 - 1e-6;

pub(super) fn check(valid: &ValidPart, diagnostics: &mut Diagnostics) {
    let scenario = &valid.scenario;
    if !valid.has("robot.motions") {
        return;
    }
    if max_speed_m_s(&scenario.robot) == 0.0 {
        let message = "never move the robot: write a v_m_s other than 0 for at least one of them";
        diagnostics.push(format_args!("robot.motions"), message);
        return;
    }
    if !valid.has("task") {
        return;
    }
    let TaskRules { max_episode_steps, min_goal_distance_m, .. } = scenario.task;
    let needed = steps_to(scenario, min_goal_distance_m);
    if f64::from(max_episode_steps) < needed {
        let message = format!(
            "is {max_episode_steps}: in this time the robot covers at most {:.3} m, but goals are at least \
             {min_goal_distance_m} m away: {}",
            step_m(scenario) * f64::from(max_episode_steps),
            more_steps(needed)
        );
        diagnostics.push(format_args!("task.max_episode_steps"), message);
    }
}

/// The highest speed of the robot along its heading, in m/s.
pub(super) fn max_speed_m_s(robot: &Robot) -> f32 {
    robot.motions.iter().map(|motion| motion.v_m_s.abs()).fold(0.0, f32::max)
}

/// The longest distance that the robot drives in one control step, in m.
pub(super) fn step_m(scenario: &Scenario) -> f64 {
    f64::from(max_speed_m_s(&scenario.robot)) * f64::from(scenario.task.control_period_s)
}

/// The least number of control steps, rounded up, in which the robot gets to a goal that is `distance_m` away.
pub(super) fn steps_to(scenario: &Scenario, distance_m: f32) -> f64 {
    let travel_m = f64::from(distance_m) - f64::from(scenario.task.goal_radius_m);
    (travel_m / step_m(scenario) * SLACK).ceil()
}

/// The fix for a time limit that should be at least `steps`.
pub(super) fn more_steps(steps: f64) -> String {
    if steps <= f64::from(*EPISODE_STEPS.end()) {
        format!("write at least {steps}, or make the robot faster")
    } else {
        "make the robot faster".into()
    }
}
