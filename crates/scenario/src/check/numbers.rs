//! Each number of a scenario against its range, and against the numbers it must fit.

use super::{METRES, METRES_A_SECOND, Notes, RADIANS, RADIANS_A_SECOND, SECONDS, TURN};
use super::{obstacles, outlines, speeds};
use crate::schema::*;

/// The fastest that an obstacle or the robot may move, m/s.
pub(super) const FASTEST_M_S: f32 = 5.0;
/// A full turn as one writes it, 6.2832: a little more than 2 pi.
const ALL_AROUND_RAD: f32 = 62_832.0 / 10_000.0;
/// The fastest that anything may turn or revolve, rad/s.
pub(super) const FASTEST_RAD_S: f32 = 20.0;

pub(super) fn check(scenario: &Scenario, notes: &mut Notes) {
    texts(scenario, notes);
    enclosure(&scenario.enclosure, notes);
    obstacles::check(scenario, notes);
    robot(&scenario.robot, notes);
    lidar(&scenario.lidar, notes);
    task(scenario, notes);
    places(scenario, notes);
    speeds::check(scenario, notes);
}

fn texts(scenario: &Scenario, notes: &mut Notes) {
    let name = &scenario.name;
    if name.trim().is_empty() || name.chars().count() > 100 || name.chars().any(char::is_control) {
        notes.add(format_args!("name"), "must have 1 to 100 characters on one line");
    }
    if scenario.about.chars().count() > 2_000 {
        notes.add(format_args!("about"), "is too long: write at most 2000 characters");
    }
}

fn enclosure(enclosure: &Enclosure, notes: &mut Notes) {
    match enclosure {
        Enclosure::Rectangle { width_m, height_m } => {
            notes.number(format_args!("enclosure.width_m"), *width_m, 0.5..=1000.0, METRES);
            notes.number(format_args!("enclosure.height_m"), *height_m, 0.5..=1000.0, METRES);
        }
        Enclosure::Polygon { corners_m } => {
            let path = format_args!("enclosure.corners_m");
            let before = notes.0.len();
            notes.points(path, corners_m, 3..=64);
            if notes.0.len() > before {
                return;
            }
            let (low, high) = enclosure.bounds_m();
            for (axis, extent) in [("x", high.0 - low.0), ("y", high.1 - low.1)] {
                if extent < 0.5 {
                    let message =
                        format!("reach over {extent} m along {axis}: move them apart, to 0.5 m at least");
                    notes.add(path, message);
                }
            }
            if notes.0.len() == before {
                outlines::simple(path, corners_m, notes);
            }
        }
    }
}

fn robot(robot: &Robot, notes: &mut Notes) {
    notes.number(format_args!("robot.radius_m"), robot.radius_m, 0.01..=10.0, METRES);
    notes.count(format_args!("robot.motions"), robot.motions.len(), 1..=64);
    for (k, motion) in robot.motions.iter().enumerate().take(64) {
        let path = format_args!("robot.motions[{k}].v_m_s");
        notes.number(path, motion.v_m_s, -FASTEST_M_S..=FASTEST_M_S, METRES_A_SECOND);
        notes.number(
            format_args!("robot.motions[{k}].w_rad_s"),
            motion.w_rad_s,
            -FASTEST_RAD_S..=FASTEST_RAD_S,
            RADIANS_A_SECOND,
        );
    }
    notes.number(format_args!("robot.actuator_lag_s"), robot.actuator_lag_s, 0.0..=10.0, SECONDS);
}

fn lidar(lidar: &Lidar, notes: &mut Notes) {
    notes.number(format_args!("lidar.beams"), lidar.beams, 1..=4096, "");
    let path = format_args!("lidar.field_of_view_rad");
    notes.number(path, lidar.field_of_view_rad, 0.01..=ALL_AROUND_RAD, " (radians: all around is 6.2832)");
    notes.number(format_args!("lidar.max_range_m"), lidar.max_range_m, 0.01..=1000.0, METRES);
    notes.number(format_args!("lidar.noise_std_m"), lidar.noise_std_m, 0.0..=10.0, METRES);
    notes.number(format_args!("lidar.dropout"), lidar.dropout, 0.0..=1.0, " (a probability)");
    notes.number(format_args!("lidar.latency_steps"), lidar.latency_steps, 0..=50, "");
}

fn task(scenario: &Scenario, notes: &mut Notes) {
    let task = &scenario.task;
    notes.number(format_args!("task.goal_radius_m"), task.goal_radius_m, 0.001..=100.0, METRES);
    notes.number(format_args!("task.collision_range_m"), task.collision_range_m, 0.01..=100.0, METRES);
    notes.number(format_args!("task.time_limit_steps"), task.time_limit_steps, 1..=1_000_000, "");
    notes.number(format_args!("task.control_period_s"), task.control_period_s, 0.001..=10.0, SECONDS);
    let path = format_args!("task.min_target_distance_m");
    notes.number(path, task.min_target_distance_m, 0.001..=1000.0, METRES);

    let path = format_args!("task.collision_range_m");
    notes.above(path, task.collision_range_m, scenario.robot.radius_m, "the robot's radius");
    let path = format_args!("lidar.max_range_m");
    notes.above(path, scenario.lidar.max_range_m, task.collision_range_m, "the collision range");
    let path = format_args!("task.min_target_distance_m");
    notes.above(path, task.min_target_distance_m, task.goal_radius_m, "the goal radius");
}

fn places(scenario: &Scenario, notes: &mut Notes) {
    for (name, rule) in [("starts", &scenario.starts), ("targets", &scenario.targets)] {
        match rule {
            PlaceRule::Random { clearance_m } => clear(name, *clearance_m, scenario, notes),
            PlaceRule::Within { min_m, max_m, clearance_m } => {
                region(format_args!("{name}"), *min_m, *max_m, notes);
                clear(name, *clearance_m, scenario, notes);
            }
            PlaceRule::Fixed { at_m, heading_rad } => {
                notes.point(format_args!("{name}.at_m"), *at_m);
                let path = format_args!("{name}.heading_rad");
                match heading_rad {
                    Some(_) if name == "targets" => {
                        notes.add(path, "has no meaning: a target looks nowhere; leave it out");
                    }
                    Some(heading) => notes.number(path, *heading, -TURN..=TURN, RADIANS),
                    None => {}
                }
            }
            PlaceRule::OneOf { places_m } => {
                notes.points(format_args!("{name}.places_m"), places_m, 1..=256);
            }
        }
    }
    let course = &scenario.course;
    notes.point(format_args!("course.start_m"), course.start_m);
    notes.point(format_args!("course.target_m"), course.target_m);
    notes.number(format_args!("course.heading_rad"), course.heading_rad, -TURN..=TURN, RADIANS);
}

/// The clearance of the rule called `name`.
fn clear(name: &str, clearance_m: f32, scenario: &Scenario, notes: &mut Notes) {
    let path = format_args!("{name}.clearance_m");
    notes.number(path, clearance_m, 0.0..=1000.0, METRES);
    notes.above(path, clearance_m, scenario.task.collision_range_m, "the collision range");
}

/// A rectangle's corners: each a point, the lower left one below and left of the other.
pub(super) fn region(path: std::fmt::Arguments<'_>, min: (f32, f32), max: (f32, f32), notes: &mut Notes) {
    notes.point(format_args!("{path}.min_m"), min);
    notes.point(format_args!("{path}.max_m"), max);
    for (index, low, high) in [(0, min.0, max.0), (1, min.1, max.1)] {
        if low >= high && low.is_finite() && high.is_finite() {
            let message = format!(
                "is {high}, and `min_m[{index}]` is {low}: write the lower left corner as min_m, the \
                                   upper right one as max_m"
            );
            notes.add(format_args!("{path}.max_m[{index}]"), message);
        }
    }
}
