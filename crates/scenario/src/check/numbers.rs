//! The range checks of single numbers, and the comparisons between them.

use std::fmt::Arguments;

use glam::Vec2;

use super::{COLLISION_RANGE, GOAL_RADIUS, ROBOT_RADIUS};
use super::{Diagnostics, METRES, METRES_PER_SECOND, RADIANS, RADIANS_PER_SECOND, SECONDS};
use super::{obstacles, polygons, speeds};
use crate::limits::*;
use crate::schema::*;
use crate::steering;
use crate::text::{code_point, is_noncharacter};

pub(super) fn check(scenario: &Scenario, diagnostics: &mut Diagnostics) {
    check_texts(&scenario.name, &scenario.about, diagnostics);
    check_enclosure(&scenario.enclosure, diagnostics);
    obstacles::check(scenario, diagnostics);
    check_robot(&scenario.robot, diagnostics);
    check_slip_and_odometry(&scenario.robot, diagnostics);
    check_lidar(&scenario.lidar, diagnostics);
    check_task(scenario, diagnostics);
    check_rule("starts", &scenario.starts, scenario, diagnostics);
    check_rule("goals", &scenario.goals, scenario, diagnostics);
    if let Some(route) = &scenario.benchmark_route {
        check_benchmark_route(route, diagnostics);
    }
    speeds::check(scenario, diagnostics);
}

/// Checks the name and the description of a scenario, or of a set of them.
pub(crate) fn check_texts(name: &str, about: &str, diagnostics: &mut Diagnostics) {
    check_name("name", name, diagnostics);
    check_characters("about", about, diagnostics);
    if about.chars().count() > MAX_ABOUT_CHARS {
        let message = format!("is too long: write at most {MAX_ABOUT_CHARS} characters");
        diagnostics.push(format_args!("about"), message);
    }
}

/// Checks the name in the field at `path`.
pub(crate) fn check_name(path: &str, name: &str, diagnostics: &mut Diagnostics) {
    let is_too_long = name.chars().count() > MAX_NAME_CHARS;
    if name.trim().is_empty() || is_too_long || name.contains(['\n', '\r']) {
        let message = format!("must have 1 to {MAX_NAME_CHARS} characters on one line");
        diagnostics.push(format_args!("{path}"), message);
    } else if name.contains('\t') {
        diagnostics.push(format_args!("{path}"), "contains a tab: write a space instead");
    }
    check_characters(path, name, diagnostics);
}

/// Checks that `text` has only characters that can also be drawn in a figure.
fn check_characters(field: &str, text: &str, diagnostics: &mut Diagnostics) {
    let is_allowed = |c| matches!(c, '\n' | '\r' | '\t') || !(char::is_control(c) || is_noncharacter(c));
    if let Some(c) = text.chars().find(|&c| !is_allowed(c)) {
        let message = format!("contains the character {}, which can't be printed: remove it", code_point(c));
        diagnostics.push(format_args!("{field}"), message);
    }
}

fn check_enclosure(enclosure: &Enclosure, diagnostics: &mut Diagnostics) {
    match enclosure {
        Enclosure::Rectangle { width_m, height_m } => {
            diagnostics.check_range(format_args!("enclosure.width_m"), *width_m, ENCLOSURE_SIDE_M, METRES);
            diagnostics.check_range(format_args!("enclosure.height_m"), *height_m, ENCLOSURE_SIDE_M, METRES);
        }
        Enclosure::Polygon { corners_m } => {
            let path = format_args!("enclosure.corners_m");
            let before = diagnostics.found.len();
            diagnostics.check_points(path, corners_m, ENCLOSURE_CORNERS);
            if diagnostics.found.len() == before {
                check_extent(path, enclosure, diagnostics);
            }
            if diagnostics.found.len() == before {
                polygons::check_simple(path, corners_m, diagnostics);
            }
        }
    }
}

fn check_extent(path: Arguments<'_>, enclosure: &Enclosure, diagnostics: &mut Diagnostics) {
    let (low, high) = enclosure.bounds_m();
    let least = *ENCLOSURE_SIDE_M.start();
    for (axis, extent) in [("x", high.x - low.x), ("y", high.y - low.y)] {
        if extent < least {
            let message = format!("span only {extent} m along {axis}: spread them over at least {least} m");
            diagnostics.push(path, message);
        }
    }
}

fn check_robot(robot: &Robot, diagnostics: &mut Diagnostics) {
    diagnostics.check_range(format_args!("robot.radius_m"), robot.radius_m, ROBOT_RADIUS_M, METRES);
    if let Some(shape) = &robot.shape {
        check_robot_shape(robot, shape, diagnostics);
    }
    diagnostics.check_count(format_args!("robot.motions"), robot.motions.len(), MOTIONS);
    for (k, motion) in robot.motions.iter().enumerate().take(*MOTIONS.end()) {
        let path = format_args!("robot.motions[{k}].v_m_s");
        diagnostics.check_range(path, motion.v_m_s, -MAX_SPEED_M_S..=MAX_SPEED_M_S, METRES_PER_SECOND);
        let path = format_args!("robot.motions[{k}].w_rad_s");
        let range = -MAX_ANGULAR_SPEED_RAD_S..=MAX_ANGULAR_SPEED_RAD_S;
        diagnostics.check_range(path, motion.w_rad_s, range, RADIANS_PER_SECOND);
    }
    if let Some(radius_m) = robot.min_turning_radius_m {
        let path = format_args!("robot.min_turning_radius_m");
        diagnostics.check_range(path, radius_m, TURNING_RADIUS_M, METRES);
        if TURNING_RADIUS_M.contains(&radius_m) {
            steering::check(robot, radius_m, diagnostics);
        }
    }
    let path = format_args!("robot.actuator_lag_s");
    diagnostics.check_ranged(path, robot.actuator_lag_s, ACTUATOR_LAG_S, SECONDS);
    if let Some(limit) = robot.max_acceleration_m_s2 {
        let unit = " (metres per second squared)";
        diagnostics.check_range(format_args!("robot.max_acceleration_m_s2"), limit, ACCELERATION_M_S2, unit);
    }
    if let Some(limit) = robot.max_angular_acceleration_rad_s2 {
        let path = format_args!("robot.max_angular_acceleration_rad_s2");
        let unit = " (radians per second squared)";
        diagnostics.check_range(path, limit, ANGULAR_ACCELERATION_RAD_S2, unit);
    }
}

fn check_slip_and_odometry(robot: &Robot, diagnostics: &mut Diagnostics) {
    if let Some(Slip { forward, turning, std }) = robot.slip {
        diagnostics.check_ranged(format_args!("robot.slip.forward"), forward, SLIP, " (a fraction)");
        diagnostics.check_ranged(format_args!("robot.slip.turning"), turning, SLIP, " (a fraction)");
        diagnostics.check_ranged(format_args!("robot.slip.std"), std, SLIP_STD, " (a fraction)");
    }
    let Some(OdometryDrift { distance_error, rotation_error, heading_drift_rad_m }) = robot.odometry_drift
    else {
        return;
    };
    let path = format_args!("robot.odometry_drift.distance_error");
    diagnostics.check_ranged(path, distance_error, ODOMETRY_ERROR, " (metres per metre)");
    let path = format_args!("robot.odometry_drift.rotation_error");
    diagnostics.check_ranged(path, rotation_error, ODOMETRY_ERROR, " (radians per radian)");
    let path = format_args!("robot.odometry_drift.heading_drift_rad_m");
    diagnostics.check_ranged(path, heading_drift_rad_m, HEADING_DRIFT_RAD_M, " (radians per metre)");
}

/// Checks the body of a robot that is not a disc. Its origin, where the LIDAR is, must be inside.
fn check_robot_shape(robot: &Robot, shape: &Shape, diagnostics: &mut Diagnostics) {
    let path = format_args!("robot.shape");
    if let Shape::Circle { radius_m } = shape {
        return diagnostics.push(path, format!("is a circle: write `radius_m: {radius_m}` instead"));
    }
    let before = diagnostics.found.len();
    obstacles::check_fields(path, shape.clone().fields_mut(), diagnostics);
    if diagnostics.found.len() > before {
        return;
    }
    let (inner_m, reach_m) = (robot.inner_radius_m(), robot.reach_m());
    let (least, most) = (ROBOT_RADIUS_M.start(), ROBOT_RADIUS_M.end());
    if inner_m < *least {
        let message = format!(
            "does not extend {least} m around its origin, where the LIDAR is: make it wider, or move its corners"
        );
        diagnostics.push(path, message);
    } else if reach_m > *most {
        diagnostics.push(path, format!("reaches {reach_m:.3} m from its origin: make it at most {most} m"));
    }
    if robot.radius_m != Robot::default().radius_m {
        diagnostics
            .push(format_args!("robot.radius_m"), "has no effect on a robot with a `shape`: remove it");
    }
}

fn check_lidar(lidar: &Lidar, diagnostics: &mut Diagnostics) {
    diagnostics.check_range(format_args!("lidar.beams"), lidar.beams, BEAMS, "");
    let path = format_args!("lidar.field_of_view_rad");
    diagnostics.check_range(path, lidar.field_of_view_rad, FIELD_OF_VIEW_RAD, RADIANS);
    diagnostics.check_range(format_args!("lidar.max_range_m"), lidar.max_range_m, LIDAR_RANGE_M, METRES);
    diagnostics.check_ranged(format_args!("lidar.noise_std_m"), lidar.noise_std_m, LIDAR_NOISE_M, METRES);
    diagnostics.check_ranged(format_args!("lidar.dropout"), lidar.dropout, 0.0..=1.0, " (a probability)");
    let path = format_args!("lidar.latency_steps");
    diagnostics.check_ranged(path, lidar.latency_steps, LIDAR_LATENCY_STEPS, "");
}

fn check_task(scenario: &Scenario, diagnostics: &mut Diagnostics) {
    let TaskRules {
        goal_radius_m,
        collision_range_m,
        max_episode_steps,
        control_period_s,
        min_goal_distance_m,
    } = scenario.task;
    let goal_radius = format_args!("task.goal_radius_m");
    let collision_range = format_args!("task.collision_range_m");
    let goal_distance = format_args!("task.min_goal_distance_m");
    diagnostics.check_range(goal_radius, goal_radius_m, GOAL_RADIUS_M, METRES);
    diagnostics.check_range(collision_range, collision_range_m, COLLISION_RANGE_M, METRES);
    diagnostics.check_range(format_args!("task.max_episode_steps"), max_episode_steps, EPISODE_STEPS, "");
    diagnostics.check_range(
        format_args!("task.control_period_s"),
        control_period_s,
        CONTROL_PERIOD_S,
        SECONDS,
    );
    diagnostics.check_range(goal_distance, min_goal_distance_m, GOAL_DISTANCE_M, METRES);

    if scenario.robot.shape.is_none() {
        diagnostics.check_above(collision_range, collision_range_m, scenario.robot.radius_m, ROBOT_RADIUS);
    }
    let lidar_range = format_args!("lidar.max_range_m");
    diagnostics.check_above(lidar_range, scenario.lidar.max_range_m, collision_range_m, COLLISION_RANGE);
    diagnostics.check_above(goal_distance, min_goal_distance_m, goal_radius_m, GOAL_RADIUS);
}

/// Checks the placement rule in the field `name`.
fn check_rule(name: &str, rule: &PlacementRule, scenario: &Scenario, diagnostics: &mut Diagnostics) {
    match rule {
        PlacementRule::Random { clearance_m } => check_clearance(name, *clearance_m, scenario, diagnostics),
        PlacementRule::Within { min_m, max_m, clearance_m } => {
            check_region(format_args!("{name}"), *min_m, *max_m, diagnostics);
            check_clearance(name, *clearance_m, scenario, diagnostics);
        }
        PlacementRule::Fixed { position_m, heading_rad } => {
            diagnostics.check_point(format_args!("{name}.position_m"), *position_m);
            check_heading(name, *heading_rad, diagnostics);
        }
        PlacementRule::OneOf { positions_m } => {
            diagnostics.check_points(format_args!("{name}.positions_m"), positions_m, POSITIONS);
        }
    }
}

fn check_heading(name: &str, heading_rad: Option<f32>, diagnostics: &mut Diagnostics) {
    let path = format_args!("{name}.heading_rad");
    match heading_rad {
        Some(_) if name == "goals" => {
            diagnostics.push(path, "has no effect: a goal has no heading; remove it");
        }
        Some(heading_rad) => diagnostics.check_range(path, heading_rad, ANGLE_RAD, RADIANS),
        None => {}
    }
}

fn check_benchmark_route(route: &BenchmarkRoute, diagnostics: &mut Diagnostics) {
    diagnostics.check_point(format_args!("benchmark_route.start_m"), route.start_m);
    diagnostics.check_point(format_args!("benchmark_route.goal_m"), route.goal_m);
    let path = format_args!("benchmark_route.heading_rad");
    diagnostics.check_range(path, route.heading_rad, ANGLE_RAD, RADIANS);
}

fn check_clearance(name: &str, clearance_m: f32, scenario: &Scenario, diagnostics: &mut Diagnostics) {
    let path = format_args!("{name}.clearance_m");
    diagnostics.check_range(path, clearance_m, CLEARANCE_M, METRES);
    diagnostics.check_clearance(path, clearance_m, scenario);
}

/// Checks the two corners of a rectangle: `min` must be below and to the left of `max`.
pub(super) fn check_region(path: Arguments<'_>, min: Vec2, max: Vec2, diagnostics: &mut Diagnostics) {
    diagnostics.check_point(format_args!("{path}.min_m"), min);
    diagnostics.check_point(format_args!("{path}.max_m"), max);
    for (index, low, high) in [(0, min.x, max.x), (1, min.y, max.y)] {
        if low >= high && low.is_finite() && high.is_finite() {
            let message = format!(
                "is {high} and `min_m[{index}]` is {low}: write the lower left corner as min_m and the upper right \
                 one as max_m"
            );
            diagnostics.push(format_args!("{path}.max_m[{index}]"), message);
        }
    }
}
