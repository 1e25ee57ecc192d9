//! Each number of a scenario against its range, and against the numbers it must fit.

use super::{Diagnostics, MAX_ANGLE_RAD, METRES, METRES_PER_SECOND, RADIANS, RADIANS_PER_SECOND, SECONDS};
use super::{obstacles, polygons, speeds};
use crate::schema::*;
use glam::Vec2;

/// The fastest that an obstacle or the robot may move, m/s.
pub(super) const MAX_SPEED_M_S: f32 = 5.0;
/// A full turn as one writes it, 6.2832: a little more than 2 pi.
const ALL_AROUND_RAD: f32 = 62_832.0 / 10_000.0;
/// The fastest that anything may turn or revolve, rad/s.
pub(super) const MAX_ANGULAR_SPEED_RAD_S: f32 = 20.0;

pub(super) fn check(scenario: &Scenario, diagnostics: &mut Diagnostics) {
    texts(scenario, diagnostics);
    enclosure(&scenario.enclosure, diagnostics);
    obstacles::check(scenario, diagnostics);
    robot(&scenario.robot, diagnostics);
    lidar(&scenario.lidar, diagnostics);
    task(scenario, diagnostics);
    places(scenario, diagnostics);
    speeds::check(scenario, diagnostics);
}

fn texts(scenario: &Scenario, diagnostics: &mut Diagnostics) {
    let name = &scenario.name;
    if name.trim().is_empty() || name.chars().count() > 100 || name.chars().any(char::is_control) {
        diagnostics.push(format_args!("name"), "must have 1 to 100 characters on one line");
    }
    if scenario.about.chars().count() > 2_000 {
        diagnostics.push(format_args!("about"), "is too long: write at most 2000 characters");
    }
}

fn enclosure(enclosure: &Enclosure, diagnostics: &mut Diagnostics) {
    match enclosure {
        Enclosure::Rectangle { width_m, height_m } => {
            diagnostics.check_range(format_args!("enclosure.width_m"), *width_m, 0.5..=1000.0, METRES);
            diagnostics.check_range(format_args!("enclosure.height_m"), *height_m, 0.5..=1000.0, METRES);
        }
        Enclosure::Polygon { corners_m } => {
            let path = format_args!("enclosure.corners_m");
            let before = diagnostics.0.len();
            diagnostics.check_points(path, corners_m, 3..=64);
            if diagnostics.0.len() > before {
                return;
            }
            let (low, high) = enclosure.bounds_m();
            for (axis, extent) in [("x", high.x - low.x), ("y", high.y - low.y)] {
                if extent < 0.5 {
                    let message =
                        format!("reach over {extent} m along {axis}: move them apart, to 0.5 m at least");
                    diagnostics.push(path, message);
                }
            }
            if diagnostics.0.len() == before {
                polygons::check_simple(path, corners_m, diagnostics);
            }
        }
    }
}

fn robot(robot: &Robot, diagnostics: &mut Diagnostics) {
    diagnostics.check_range(format_args!("robot.radius_m"), robot.radius_m, 0.01..=10.0, METRES);
    diagnostics.check_count(format_args!("robot.motions"), robot.motions.len(), 1..=64);
    for (k, motion) in robot.motions.iter().enumerate().take(64) {
        let path = format_args!("robot.motions[{k}].v_m_s");
        diagnostics.check_range(path, motion.v_m_s, -MAX_SPEED_M_S..=MAX_SPEED_M_S, METRES_PER_SECOND);
        diagnostics.check_range(
            format_args!("robot.motions[{k}].w_rad_s"),
            motion.w_rad_s,
            -MAX_ANGULAR_SPEED_RAD_S..=MAX_ANGULAR_SPEED_RAD_S,
            RADIANS_PER_SECOND,
        );
    }
    diagnostics.check_range(format_args!("robot.actuator_lag_s"), robot.actuator_lag_s, 0.0..=10.0, SECONDS);
}

fn lidar(lidar: &Lidar, diagnostics: &mut Diagnostics) {
    diagnostics.check_range(format_args!("lidar.beams"), lidar.beams, 1..=4096, "");
    let path = format_args!("lidar.field_of_view_rad");
    diagnostics.check_range(
        path,
        lidar.field_of_view_rad,
        0.01..=ALL_AROUND_RAD,
        " (radians: all around is 6.2832)",
    );
    diagnostics.check_range(format_args!("lidar.max_range_m"), lidar.max_range_m, 0.01..=1000.0, METRES);
    diagnostics.check_range(format_args!("lidar.noise_std_m"), lidar.noise_std_m, 0.0..=10.0, METRES);
    diagnostics.check_range(format_args!("lidar.dropout"), lidar.dropout, 0.0..=1.0, " (a probability)");
    diagnostics.check_range(format_args!("lidar.latency_steps"), lidar.latency_steps, 0..=50, "");
}

fn task(scenario: &Scenario, diagnostics: &mut Diagnostics) {
    let task = &scenario.task;
    diagnostics.check_range(format_args!("task.goal_radius_m"), task.goal_radius_m, 0.001..=100.0, METRES);
    diagnostics.check_range(
        format_args!("task.collision_range_m"),
        task.collision_range_m,
        0.01..=100.0,
        METRES,
    );
    diagnostics.check_range(
        format_args!("task.max_episode_steps"),
        task.max_episode_steps,
        1..=1_000_000,
        "",
    );
    diagnostics.check_range(
        format_args!("task.control_period_s"),
        task.control_period_s,
        0.001..=10.0,
        SECONDS,
    );
    let path = format_args!("task.min_goal_distance_m");
    diagnostics.check_range(path, task.min_goal_distance_m, 0.001..=1000.0, METRES);

    let path = format_args!("task.collision_range_m");
    diagnostics.check_above(path, task.collision_range_m, scenario.robot.radius_m, "the robot's radius");
    let path = format_args!("lidar.max_range_m");
    diagnostics.check_above(path, scenario.lidar.max_range_m, task.collision_range_m, "the collision range");
    let path = format_args!("task.min_goal_distance_m");
    diagnostics.check_above(path, task.min_goal_distance_m, task.goal_radius_m, "the goal radius");
}

fn places(scenario: &Scenario, diagnostics: &mut Diagnostics) {
    for (name, rule) in [("starts", &scenario.starts), ("goals", &scenario.goals)] {
        match rule {
            PlacementRule::Random { clearance_m } => clear(name, *clearance_m, scenario, diagnostics),
            PlacementRule::Within { min_m, max_m, clearance_m } => {
                region(format_args!("{name}"), *min_m, *max_m, diagnostics);
                clear(name, *clearance_m, scenario, diagnostics);
            }
            PlacementRule::Fixed { position_m, heading_rad } => {
                diagnostics.check_point(format_args!("{name}.position_m"), *position_m);
                let path = format_args!("{name}.heading_rad");
                match heading_rad {
                    Some(_) if name == "goals" => {
                        diagnostics.push(path, "has no meaning: a goal looks nowhere; leave it out");
                    }
                    Some(heading) => {
                        diagnostics.check_range(path, *heading, -MAX_ANGLE_RAD..=MAX_ANGLE_RAD, RADIANS);
                    }
                    None => {}
                }
            }
            PlacementRule::OneOf { positions_m } => {
                diagnostics.check_points(format_args!("{name}.positions_m"), positions_m, 1..=256);
            }
        }
    }
    let benchmark_route = &scenario.benchmark_route;
    diagnostics.check_point(format_args!("benchmark_route.start_m"), benchmark_route.start_m);
    diagnostics.check_point(format_args!("benchmark_route.goal_m"), benchmark_route.goal_m);
    diagnostics.check_range(
        format_args!("benchmark_route.heading_rad"),
        benchmark_route.heading_rad,
        -MAX_ANGLE_RAD..=MAX_ANGLE_RAD,
        RADIANS,
    );
}

/// The clearance of the rule called `name`.
fn clear(name: &str, clearance_m: f32, scenario: &Scenario, diagnostics: &mut Diagnostics) {
    let path = format_args!("{name}.clearance_m");
    diagnostics.check_range(path, clearance_m, 0.0..=1000.0, METRES);
    diagnostics.check_above(path, clearance_m, scenario.task.collision_range_m, "the collision range");
}

/// A rectangle's corners: each a point, the lower left one below and left of the other.
pub(super) fn region(path: std::fmt::Arguments<'_>, min: Vec2, max: Vec2, diagnostics: &mut Diagnostics) {
    diagnostics.check_point(format_args!("{path}.min_m"), min);
    diagnostics.check_point(format_args!("{path}.max_m"), max);
    for (index, low, high) in [(0, min.x, max.x), (1, min.y, max.y)] {
        if low >= high && low.is_finite() && high.is_finite() {
            let message = format!(
                "is {high}, and `min_m[{index}]` is {low}: write the lower left corner as min_m, the \
                                   upper right one as max_m"
            );
            diagnostics.push(format_args!("{path}.max_m[{index}]"), message);
        }
    }
}
