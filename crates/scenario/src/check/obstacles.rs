//! The range checks of walls, obstacles and generators.

use super::numbers::check_region;
use super::{Diagnostics, METRES, METRES_PER_SECOND, RADIANS, RADIANS_PER_SECOND, polygons};
use crate::limits::*;
use crate::schema::*;

pub(super) fn check(scenario: &Scenario, diagnostics: &mut Diagnostics) {
    diagnostics.check_count(format_args!("walls"), scenario.walls.len(), 0..=MAX_WALLS);
    for (k, wall) in scenario.walls.iter().enumerate().take(MAX_WALLS) {
        diagnostics.check_points(format_args!("walls[{k}].corners_m"), &wall.corners_m, WALL_CORNERS);
        diagnostics.check_range(
            format_args!("walls[{k}].thickness_m"),
            wall.thickness_m,
            WALL_THICKNESS_M,
            METRES,
        );
    }
    let pieces: usize = scenario.walls.iter().map(|wall| wall.corners_m.len().saturating_sub(1)).sum();
    if pieces > MAX_WALL_SEGMENTS {
        let message = format!("have {pieces} segments in total: write at most {MAX_WALL_SEGMENTS}");
        diagnostics.push(format_args!("walls"), message);
    }
    diagnostics.check_count(format_args!("obstacles"), scenario.obstacles.len(), 0..=MAX_OBSTACLES);
    for (k, obstacle) in scenario.obstacles.iter().enumerate().take(MAX_OBSTACLES) {
        check_obstacle(k, obstacle, diagnostics);
    }
    diagnostics.check_count(format_args!("generators"), scenario.generators.len(), 0..=MAX_GENERATORS);
    for (k, generator) in scenario.generators.iter().enumerate().take(MAX_GENERATORS) {
        check_generator(k, generator, scenario.task.collision_range_m, diagnostics);
    }
    let asked: u64 = scenario.generators.iter().map(|generator| u64::from(generator.count)).sum();
    if asked > MAX_GENERATED_OBSTACLES
        && scenario.generators.iter().all(|g| u64::from(g.count) <= MAX_GENERATED_OBSTACLES)
    {
        let message = format!(
            "ask for {asked} obstacles in total: write counts that add up to at most {MAX_GENERATED_OBSTACLES}"
        );
        diagnostics.push(format_args!("generators"), message);
    }
}

fn check_obstacle(k: usize, obstacle: &Obstacle, diagnostics: &mut Diagnostics) {
    let mut size = |name: &str, value: f32| {
        diagnostics.check_range(format_args!("obstacles[{k}].shape.{name}"), value, SHAPE_SIZE_M, METRES);
    };
    match &obstacle.shape {
        Shape::Circle { radius_m } => size("radius_m", *radius_m),
        Shape::Rectangle { width_m, height_m } => {
            size("width_m", *width_m);
            size("height_m", *height_m);
        }
        Shape::Polygon { corners_m } => {
            polygons::check_convex(format_args!("obstacles[{k}].shape.corners_m"), corners_m, diagnostics);
        }
        Shape::Capsule { length_m, radius_m } => {
            size("length_m", *length_m);
            size("radius_m", *radius_m);
        }
    }
    diagnostics.check_point(format_args!("obstacles[{k}].position_m"), obstacle.position_m);
    diagnostics.check_range(
        format_args!("obstacles[{k}].rotation_rad"),
        obstacle.rotation_rad,
        ANGLE_RAD,
        RADIANS,
    );
    let mut speed = |value: f32| {
        let path = format_args!("obstacles[{k}].motion.speed_m_s");
        diagnostics.check_range(path, value, 0.0..=MAX_SPEED_M_S, METRES_PER_SECOND);
    };
    match &obstacle.motion {
        ObstacleMotion::Static => {}
        ObstacleMotion::Orbit { centre_m, speed_rad_s } => {
            diagnostics.check_point(format_args!("obstacles[{k}].motion.centre_m"), *centre_m);
            let path = format_args!("obstacles[{k}].motion.speed_rad_s");
            diagnostics.check_range(
                path,
                *speed_rad_s,
                -MAX_ANGULAR_SPEED_RAD_S..=MAX_ANGULAR_SPEED_RAD_S,
                RADIANS_PER_SECOND,
            );
        }
        ObstacleMotion::Patrol { waypoints_m, speed_m_s }
        | ObstacleMotion::BackAndForth { waypoints_m, speed_m_s } => {
            speed(*speed_m_s);
            diagnostics.check_points(
                format_args!("obstacles[{k}].motion.waypoints_m"),
                waypoints_m,
                WAYPOINTS,
            );
        }
        ObstacleMotion::RandomWalk { radius_m, speed_m_s, seed: _ } => {
            speed(*speed_m_s);
            diagnostics.check_range(
                format_args!("obstacles[{k}].motion.radius_m"),
                *radius_m,
                WALK_RADIUS_M,
                METRES,
            );
        }
    }
}

fn check_generator(k: usize, generator: &Generator, collision_range_m: f32, diagnostics: &mut Diagnostics) {
    diagnostics.check_range(format_args!("generators[{k}].count"), generator.count, GENERATOR_COUNT, "");
    let mut sizes = |name: &str, (low, high): (f32, f32)| {
        let path = format_args!("generators[{k}].shape.{name}");
        diagnostics.check_range(format_args!("{path}[0]"), low, SHAPE_SIZE_M, METRES);
        diagnostics.check_range(format_args!("{path}[1]"), high, SHAPE_SIZE_M, METRES);
        if low > high {
            diagnostics.push(path, format!("is ({low}, {high}): write the smaller number first"));
        }
    };
    match generator.shape {
        RandomShape::Circle { radius_m } => sizes("radius_m", radius_m),
        RandomShape::Rectangle { width_m, height_m } => {
            sizes("width_m", width_m);
            sizes("height_m", height_m);
        }
    }
    let path = format_args!("generators[{k}].gap_m");
    diagnostics.check_range(path, generator.gap_m, CLEARANCE_M, METRES);
    diagnostics.check_above(path, generator.gap_m, 2.0 * collision_range_m, "twice the collision range");
    if let Some(Region { min_m, max_m }) = generator.within {
        check_region(format_args!("generators[{k}].within"), min_m, max_m, diagnostics);
    }
}
