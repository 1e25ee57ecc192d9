//! Each number of a scenario against its range, and against the numbers it must fit.

use super::Notes;
use crate::scenario::geometry::length;
use crate::scenario::schema::*;

const METRES: &str = " (metres)";
const METRES_A_SECOND: &str = " (metres a second)";
const SECONDS: &str = " (seconds)";
const RADIANS: &str = " (radians: a full turn is 6.2832)";
const RADIANS_A_SECOND: &str = " (radians a second)";
/// A full turn either way, with a little room for rounding.
const TURN: f32 = 6.3;
/// The fastest that an obstacle or the robot may move, m/s.
const FASTEST_M_S: f32 = 5.0;
/// The fastest that anything may turn or revolve, rad/s.
const FASTEST_RAD_S: f32 = 20.0;

pub(super) fn check(scenario: &Scenario, notes: &mut Notes) {
    texts(scenario, notes);
    let Enclosure::Rectangle { width_m, height_m } = scenario.enclosure;
    notes.number(format_args!("enclosure.width_m"), width_m, 0.5..=1000.0, METRES);
    notes.number(format_args!("enclosure.height_m"), height_m, 0.5..=1000.0, METRES);
    notes.count(format_args!("obstacles"), scenario.obstacles.len(), 0..=10_000);
    for (k, obstacle) in scenario.obstacles.iter().enumerate().take(10_000) {
        check_obstacle(k, obstacle, notes);
    }
    robot(&scenario.robot, notes);
    lidar(&scenario.lidar, notes);
    task(scenario, notes);
    places(scenario, notes);
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

fn check_obstacle(k: usize, obstacle: &Obstacle, notes: &mut Notes) {
    let mut size = |name: &str, value: f32| {
        notes.number(format_args!("obstacles[{k}].shape.{name}"), value, 0.001..=1000.0, METRES);
    };
    match obstacle.shape {
        Shape::Circle { radius_m } => size("radius_m", radius_m),
        Shape::Rectangle { width_m, height_m } => {
            size("width_m", width_m);
            size("height_m", height_m);
        }
    }
    point(format_args!("obstacles[{k}].position_m"), obstacle.position_m, notes);
    notes.number(format_args!("obstacles[{k}].rotation_rad"), obstacle.rotation_rad, -TURN..=TURN, RADIANS);
    match &obstacle.motion {
        ObstacleMotion::Still => {}
        ObstacleMotion::Orbit { centre_m, speed_rad_s } => {
            point(format_args!("obstacles[{k}].motion.centre_m"), *centre_m, notes);
            let path = format_args!("obstacles[{k}].motion.speed_rad_s");
            notes.number(path, *speed_rad_s, -FASTEST_RAD_S..=FASTEST_RAD_S, RADIANS_A_SECOND);
            let arm = length(obstacle.position_m.0 - centre_m.0, obstacle.position_m.1 - centre_m.1);
            let speed = (arm * speed_rad_s).abs();
            if speed > FASTEST_M_S && speed_rad_s.abs() <= FASTEST_RAD_S && arm.is_finite() {
                let most = FASTEST_M_S / arm;
                notes.add(
                    path,
                    format!("makes the obstacle move at {speed:.3} m/s: write at most {most:.3}, for 5 m/s"),
                );
            }
        }
        ObstacleMotion::Patrol { waypoints_m, speed_m_s } => {
            let path = format_args!("obstacles[{k}].motion.waypoints_m");
            notes.count(path, waypoints_m.len(), 1..=256);
            for (j, &corner) in waypoints_m.iter().enumerate().take(256) {
                point(format_args!("obstacles[{k}].motion.waypoints_m[{j}]"), corner, notes);
            }
            let path = format_args!("obstacles[{k}].motion.speed_m_s");
            notes.number(path, *speed_m_s, 0.0..=FASTEST_M_S, METRES_A_SECOND);
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
    notes.number(format_args!("lidar.max_range_m"), lidar.max_range_m, 0.01..=1000.0, METRES);
    notes.number(format_args!("lidar.noise_std_m"), lidar.noise_std_m, 0.0..=10.0, METRES);
    notes.number(format_args!("lidar.dropout"), lidar.dropout, 0.0..=1.0, " (a probability)");
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
        let PlaceRule::Random { clearance_m } = *rule;
        let path = format_args!("{name}.clearance_m");
        notes.number(path, clearance_m, 0.0..=1000.0, METRES);
        notes.above(path, clearance_m, scenario.task.collision_range_m, "the collision range");
    }
    let course = &scenario.course;
    point(format_args!("course.start_m"), course.start_m, notes);
    point(format_args!("course.target_m"), course.target_m, notes);
    notes.number(format_args!("course.heading_rad"), course.heading_rad, -TURN..=TURN, RADIANS);
}

/// Coordinates: within the largest enclosure there is.
fn point(path: std::fmt::Arguments<'_>, (x, y): (f32, f32), notes: &mut Notes) {
    notes.number(format_args!("{path}[0]"), x, -500.0..=500.0, METRES);
    notes.number(format_args!("{path}[1]"), y, -500.0..=500.0, METRES);
}
