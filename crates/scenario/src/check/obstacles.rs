//! The range checks of walls, obstacles and generators.

use std::fmt::Arguments;

use super::numbers::check_region;
use super::{Diagnostics, METRES, METRES_PER_SECOND, RADIANS, RADIANS_PER_SECOND, key_frames, polygons};
use crate::fields::{Field, FieldValue, Quantity};
use crate::limits::*;
use crate::ranged::Ranged;
use crate::schema::*;

pub(super) fn check(scenario: &Scenario, diagnostics: &mut Diagnostics) {
    diagnostics.check_count(format_args!("walls"), scenario.walls.len(), 0..=MAX_WALLS);
    for (k, wall) in scenario.walls.iter().enumerate().take(MAX_WALLS) {
        check_wall(k, wall, diagnostics);
    }
    check_segments(&scenario.walls, diagnostics);
    diagnostics.check_count(format_args!("obstacles"), scenario.obstacles.len(), 0..=MAX_OBSTACLES);
    for (k, obstacle) in scenario.obstacles.iter().enumerate().take(MAX_OBSTACLES) {
        check_obstacle(k, obstacle, diagnostics);
    }
    let pedestrians = scenario.obstacles.iter().filter(|obstacle| obstacle.motion.is_pedestrian()).count();
    if pedestrians > MAX_PEDESTRIANS {
        let message = format!("contain {pedestrians} pedestrians: write at most {MAX_PEDESTRIANS}");
        diagnostics.push(format_args!("obstacles"), message);
    }
    key_frames::check_total(&scenario.obstacles, diagnostics);
    diagnostics.check_count(format_args!("generators"), scenario.generators.len(), 0..=MAX_GENERATORS);
    for (k, generator) in scenario.generators.iter().enumerate().take(MAX_GENERATORS) {
        check_generator(k, generator, scenario, diagnostics);
    }
    let asked: u64 = scenario.generators.iter().map(|generator| u64::from(generator.count)).sum();
    // A single count above the limit has already been reported.
    if asked > MAX_GENERATED_OBSTACLES
        && scenario.generators.iter().all(|g| u64::from(g.count) <= MAX_GENERATED_OBSTACLES)
    {
        let message = format!(
            "ask for {asked} obstacles in total: write counts that add up to at most {MAX_GENERATED_OBSTACLES}"
        );
        diagnostics.push(format_args!("generators"), message);
    }
}

fn check_wall(k: usize, wall: &Wall, diagnostics: &mut Diagnostics) {
    let path = format_args!("walls[{k}].thickness_m");
    match &wall.cells {
        Some(cells) => {
            cells.check(format_args!("walls[{k}].cells"), diagnostics);
            if !wall.corners_m.is_empty() {
                let message = "has corners and cells: write only one of them, or two walls";
                diagnostics.push(format_args!("walls[{k}]"), message);
            }
        }
        None if wall.corners_m.is_empty() => {
            let message = "has neither corners nor cells: write `corners_m` or `cells`";
            diagnostics.push(format_args!("walls[{k}]"), message);
        }
        None => {
            diagnostics.check_points(format_args!("walls[{k}].corners_m"), &wall.corners_m, WALL_CORNERS);
        }
    }
    diagnostics.check_range(path, wall.thickness_m, WALL_THICKNESS_M, METRES);
}

/// Checks the number of segments of all walls, including the rectangles that cells form.
fn check_segments(walls: &[Wall], diagnostics: &mut Diagnostics) {
    let segments: usize = walls.iter().map(Wall::piece_count).sum();
    if segments > MAX_WALL_SEGMENTS {
        let has_cells = walls.iter().any(|wall| wall.cells.is_some());
        let counted = if has_cells { "segments and rectangles of cells" } else { "segments" };
        let message = format!("have {segments} {counted} in total: write at most {MAX_WALL_SEGMENTS}");
        diagnostics.push(format_args!("walls"), message);
    }
}

fn check_obstacle(k: usize, obstacle: &Obstacle, diagnostics: &mut Diagnostics) {
    let (mut shape, mut motion) = (obstacle.shape.clone(), obstacle.motion.clone());
    check_fields(format_args!("obstacles[{k}].shape"), shape.fields_mut(), diagnostics);
    diagnostics.check_point(format_args!("obstacles[{k}].position_m"), obstacle.position_m);
    diagnostics.check_range(
        format_args!("obstacles[{k}].rotation_rad"),
        obstacle.rotation_rad,
        ANGLE_RAD,
        RADIANS,
    );
    check_fields(format_args!("obstacles[{k}].motion"), motion.fields_mut(), diagnostics);
    key_frames::check(format_args!("obstacles[{k}].motion"), &obstacle.motion, diagnostics);
}

/// Checks the fields of the shape or the motion at `path`.
pub(super) fn check_fields(path: Arguments<'_>, fields: Vec<Field<'_>>, diagnostics: &mut Diagnostics) {
    for Field { names, value, .. } in fields {
        let mut number = |name: &str, value: Ranged<f32>, quantity: Quantity| {
            let unit = match quantity {
                Quantity::Size | Quantity::Reach => METRES,
                Quantity::Speed => METRES_PER_SECOND,
                Quantity::AngularSpeed => RADIANS_PER_SECOND,
            };
            diagnostics.check_ranged(format_args!("{path}.{name}"), value, quantity.range(), unit);
        };
        let path = format_args!("{path}.{}", names[0]);
        match value {
            FieldValue::Number(value, quantity) => number(names[0], (*value).into(), quantity),
            FieldValue::Ranged(value, quantity) => number(names[0], *value, quantity),
            FieldValue::Pair(values, quantity) => {
                names.iter().zip(values).for_each(|(name, value)| number(name, (*value).into(), quantity));
            }
            // Key frames are checked as a whole.
            FieldValue::Seed(_) | FieldValue::Flag(_) | FieldValue::KeyFrames(..) => {}
            FieldValue::Centre(centre_m) => diagnostics.check_point(path, *centre_m),
            FieldValue::Waypoints(waypoints_m) => diagnostics.check_points(path, waypoints_m, WAYPOINTS),
            FieldValue::Corners(corners_m) => polygons::check_convex(path, corners_m, diagnostics),
        }
    }
}

fn check_generator(k: usize, generator: &Generator, scenario: &Scenario, diagnostics: &mut Diagnostics) {
    diagnostics.check_range(format_args!("generators[{k}].count"), generator.count, GENERATOR_COUNT, "");
    check_random_shape(format_args!("generators[{k}].shape"), &generator.shape, diagnostics);
    let path = format_args!("generators[{k}].gap_m");
    diagnostics.check_range(path, generator.gap_m, CLEARANCE_M, METRES);
    diagnostics.check_gap(path, generator.gap_m, &scenario.robot, &scenario.task);
    if let Some(Region { min_m, max_m }) = generator.within {
        check_region(format_args!("generators[{k}].within"), min_m, max_m, diagnostics);
    }
}

/// Checks the ranges of the sizes of the shape at `path`.
pub(crate) fn check_random_shape(path: Arguments<'_>, shape: &RandomShape, diagnostics: &mut Diagnostics) {
    let mut sizes = |name: &str, (low, high): (f32, f32)| {
        diagnostics.check_pair(format_args!("{path}.{name}"), (low, high), SHAPE_SIZE_M, METRES);
    };
    match *shape {
        RandomShape::Circle { radius_m } => sizes("radius_m", radius_m),
        RandomShape::Rectangle { width_m, height_m } => {
            sizes("width_m", width_m);
            sizes("height_m", height_m);
        }
    }
}
