//! The checks of a level generator: ranges of numbers, and comparisons between them.

use std::fmt::Arguments;
use std::ops::RangeInclusive;

use super::schema::{Clutter, LevelGenerator, Route, Traffic, WallLayout};
use super::{floor, rooms, text_grid};
use crate::check::{
    Diagnostics, METRES, METRES_PER_SECOND, RADIANS, check_random_shape, check_robot_and_task,
    checked_period_s, fastest_m_s, rounded_up,
};
use crate::file_error::Diagnostic;
use crate::limits::*;
use crate::schema::{PlacementRule, Scenario};
use glam::Vec2;

/// All problems of `generator`. A generator without them is safe to use, but it may have no levels if its parameters leave too
/// little space.
#[must_use]
pub fn level_generator_diagnostics(generator: &LevelGenerator) -> Vec<Diagnostic> {
    let mut diagnostics = Diagnostics::default();
    check_scenario_parts(generator, &mut diagnostics);
    check_sizes(generator, &mut diagnostics);
    let range = 0..=MAX_LEVEL_LAYOUTS;
    diagnostics.check_count(format_args!("wall_layouts"), generator.wall_layouts.len(), range.clone());
    for (k, walls) in generator.wall_layouts.iter().enumerate().take(MAX_LEVEL_LAYOUTS) {
        check_walls(format_args!("wall_layouts[{k}]"), walls, generator, &mut diagnostics);
    }
    diagnostics.check_count(format_args!("clutter"), generator.clutter.len(), range);
    for (k, clutter) in generator.clutter.iter().enumerate().take(MAX_LEVEL_LAYOUTS) {
        check_clutter(format_args!("clutter[{k}]"), clutter, generator, &mut diagnostics);
    }
    diagnostics.check_count(format_args!("traffic"), generator.traffic.len(), 0..=MAX_LEVEL_LAYOUTS);
    for (k, traffic) in generator.traffic.iter().enumerate().take(MAX_LEVEL_LAYOUTS) {
        check_traffic(format_args!("traffic[{k}]"), traffic, generator, &mut diagnostics);
    }
    if diagnostics.is_empty() {
        check_floor_size(generator, &mut diagnostics);
    }
    diagnostics.into_vec()
}

/// Checks the parts that all levels have in common.
fn check_scenario_parts(generator: &LevelGenerator, diagnostics: &mut Diagnostics) {
    let LevelGenerator { name, about, robot, lidar, task, .. } = generator.clone();
    let fixed = PlacementRule::Fixed { position_m: Vec2::ZERO, heading_rad: None };
    let (starts, goals) = (fixed.clone(), fixed);
    let common = Scenario { name, about, robot, lidar, task, starts, goals, ..Scenario::default() };
    check_robot_and_task(&common, diagnostics);
    if generator.name.chars().count() > MAX_GENERATOR_NAME_CHARS {
        let message = format!("is too long: write at most {MAX_GENERATOR_NAME_CHARS} characters");
        diagnostics.push(format_args!("name"), message);
    }
}

fn check_sizes(generator: &LevelGenerator, diagnostics: &mut Diagnostics) {
    let LevelGenerator { width_m, height_m, gap_m, .. } = *generator;
    diagnostics.check_pair(format_args!("width_m"), width_m, LEVEL_SIDE_M, METRES);
    diagnostics.check_pair(format_args!("height_m"), height_m, LEVEL_SIDE_M, METRES);
    let path = format_args!("gap_m");
    diagnostics.check_range(path, gap_m, LEVEL_GAP_M, METRES);
    diagnostics.check_gap(path, gap_m, &generator.robot, &generator.task);
    match generator.route {
        Route::Random { clearance_m } => {
            let path = format_args!("route.clearance_m");
            diagnostics.check_range(path, clearance_m, LEVEL_CLEARANCE_M, METRES);
            let least = MIN_CLEARANCE_GAPS * f64::from(gap_m);
            // The factor allows for the rounding of both numbers.
            if f64::from(clearance_m) < least * (1.0 - 1e-6) {
                let least = rounded_up(least, 4);
                let message =
                    format!("is {clearance_m}: write at least {least}, {MIN_CLEARANCE_GAPS} times gap_m");
                diagnostics.push(path, message);
            }
        }
        Route::Fixed { start_m, heading_rad, goal_m } => {
            diagnostics.check_range(format_args!("route.heading_rad"), heading_rad, ANGLE_RAD, RADIANS);
            for (name, at) in [("start_m", start_m), ("goal_m", goal_m)] {
                let path = format_args!("route.{name}");
                diagnostics.check_point(path, at);
                if at.x.abs() > width_m.0 / 2.0 || at.y.abs() > height_m.0 / 2.0 {
                    let message =
                        "is outside the smallest enclosure: move it, or write a larger width_m or height_m";
                    diagnostics.push(path, message);
                }
            }
        }
        Route::Across { margin_m } => {
            let path = format_args!("route.margin_m");
            diagnostics.check_range(path, margin_m, LEVEL_MARGIN_M, METRES);
            let (least, most) = (2.0 * generator.gap_m, height_m.0 / 3.0);
            if least > most {
                let message = format!(
                    "can be as small as {} m, too small for a route: its margin_m must be at least twice gap_m and at most a \
                     third of the height; write a smallest height of more than {} m, or a smaller gap_m",
                    height_m.0,
                    rounded_up(f64::from(3.0 * least), 2)
                );
                diagnostics.push(format_args!("height_m"), message);
            } else if !(least..=most).contains(&margin_m) {
                let message = format!(
                    "is {margin_m}: write at least {least}, twice gap_m, and at most {most}, a third of the smallest height"
                );
                diagnostics.push(path, message);
            }
        }
    }
}

fn check_walls(
    path: Arguments<'_>,
    walls: &WallLayout,
    generator: &LevelGenerator,
    diagnostics: &mut Diagnostics,
) {
    let mut pair = |name: &str, pair: (f32, f32), range: RangeInclusive<f32>, unit: &str| {
        diagnostics.check_pair(format_args!("{path}.{name}"), pair, range, unit);
    };
    match walls {
        WallLayout::Cells { cell_m, fill } => {
            pair("cell_m", *cell_m, LEVEL_CELL_M, METRES);
            pair("fill", *fill, SOLID_FILL, " (a fraction)");
            check_cells(format_args!("{path}.cell_m"), cell_m.0, MAX_LEVEL_CELLS, generator, diagnostics);
        }
        WallLayout::Grid { rows } => {
            text_grid::check(format_args!("{path}.rows"), rows, generator, diagnostics);
        }
        WallLayout::Rooms { side_m, door_m, loops } => {
            pair("side_m", *side_m, ROOM_SIDE_M, METRES);
            pair("door_m", *door_m, LEVEL_GAP_M, METRES);
            pair("loops", *loops, 0.0..=1.0, " (a probability)");
            check_passage(format_args!("{path}.door_m"), door_m.0, generator, diagnostics);
            check_room(format_args!("{path}.side_m[0]"), side_m.0, loops.1, generator.gap_m, diagnostics);
            check_cells(format_args!("{path}.side_m"), side_m.0, MAX_LEVEL_ROOMS, generator, diagnostics);
        }
        WallLayout::Maze { passage_m, wall_m, loops } => {
            pair("passage_m", *passage_m, LEVEL_GAP_M, METRES);
            pair("wall_m", *wall_m, LEVEL_CELL_M, METRES);
            pair("loops", *loops, 0.0..=1.0, " (a probability)");
            check_passage(format_args!("{path}.passage_m"), passage_m.0, generator, diagnostics);
            check_cells(
                format_args!("{path}.passage_m"),
                passage_m.0,
                MAX_LEVEL_CELLS,
                generator,
                diagnostics,
            );
        }
        WallLayout::Traps { count, width_m, depth_m } => {
            pair("width_m", *width_m, LEVEL_GAP_M, METRES);
            pair("depth_m", *depth_m, LEVEL_GAP_M, METRES);
            check_passage(format_args!("{path}.width_m"), width_m.0, generator, diagnostics);
            diagnostics.check_pair(format_args!("{path}.count"), *count, LEVEL_COUNT, "");
        }
    }
}

/// Checks that the smallest width of a passage is more than the gap.
fn check_passage(
    path: Arguments<'_>,
    least_m: f32,
    generator: &LevelGenerator,
    diagnostics: &mut Diagnostics,
) {
    diagnostics.check_above(format_args!("{path}[0]"), least_m, generator.gap_m, ("gap_m", "gap_m"));
}

/// Checks that the smallest side of a room, `least_m`, has space for a door that is wider than the gap, or for two doors if
/// `loops` is above 0.
fn check_room(path: Arguments<'_>, least_m: f32, loops: f32, gap_m: f32, diagnostics: &mut Diagnostics) {
    let (doors, what) = if loops > 0.0 {
        (2.0, "twice the sum of gap_m and a wall's thickness")
    } else {
        (1.0, "the sum of gap_m and a wall's thickness")
    };
    // Rounded, so that the message shows a short number.
    let bound_m = (doors * f64::from(gap_m + rooms::THICKNESS_M) * 1e4).round() / 1e4;
    diagnostics.check_above(path, least_m, bound_m as f32, (what, "gap_m"));
}

fn check_clutter(
    path: Arguments<'_>,
    clutter: &Clutter,
    generator: &LevelGenerator,
    diagnostics: &mut Diagnostics,
) {
    match clutter {
        Clutter::Automaton { fill, smoothings, cell_m } => {
            diagnostics.check_pair(format_args!("{path}.fill"), *fill, AUTOMATON_FILL, " (a fraction)");
            diagnostics.check_pair(format_args!("{path}.smoothings"), *smoothings, SMOOTHINGS, "");
            let path = format_args!("{path}.cell_m");
            diagnostics.check_pair(path, *cell_m, LEVEL_CELL_M, METRES);
            check_cells(path, cell_m.0, MAX_LEVEL_CELLS, generator, diagnostics);
        }
        Clutter::Scatter { count, shapes } => {
            diagnostics.check_pair(format_args!("{path}.count"), *count, LEVEL_COUNT, "");
            diagnostics.check_count(format_args!("{path}.shapes"), shapes.len(), 1..=MAX_LEVEL_LAYOUTS);
            for (k, shape) in shapes.iter().enumerate().take(MAX_LEVEL_LAYOUTS) {
                check_random_shape(format_args!("{path}.shapes[{k}]"), shape, diagnostics);
            }
        }
    }
}

fn check_traffic(
    path: Arguments<'_>,
    traffic: &Traffic,
    generator: &LevelGenerator,
    diagnostics: &mut Diagnostics,
) {
    let (Traffic::Lanes { count, radius_m, speed_m_s, .. }
    | Traffic::CircleCrossing { count, radius_m, speed_m_s, .. }
    | Traffic::RandomCrossing { count, radius_m, speed_m_s }
    | Traffic::RandomWalks { count, radius_m, speed_m_s, .. }
    | Traffic::Orbits { count, radius_m, speed_m_s, .. }
    | Traffic::PedestrianCircle { count, radius_m, speed_m_s, .. }
    | Traffic::PedestrianCrowd { count, radius_m, speed_m_s, .. }) = *traffic;
    diagnostics.check_pair(format_args!("{path}.count"), count, LEVEL_COUNT, "");
    diagnostics.check_pair(format_args!("{path}.radius_m"), radius_m, TRAFFIC_SIZE_M, METRES);
    let most = fastest_m_s(checked_period_s(&generator.task));
    diagnostics.check_pair(format_args!("{path}.speed_m_s"), speed_m_s, 0.0..=most, METRES_PER_SECOND);
    match *traffic {
        Traffic::Lanes { pairs, .. } => {
            diagnostics.check_pair(format_args!("{path}.pairs"), pairs, LANE_PAIRS, "");
        }
        Traffic::CircleCrossing { circle_m, .. } => {
            diagnostics.check_pair(format_args!("{path}.circle_m"), circle_m, LEVEL_CIRCLE_M, METRES);
        }
        Traffic::RandomCrossing { .. } => {}
        Traffic::Orbits { circles, orbit_m, .. } => {
            diagnostics.check_pair(format_args!("{path}.circles"), circles, ORBIT_CIRCLES, "");
            diagnostics.check_pair(format_args!("{path}.orbit_m"), orbit_m, LEVEL_ORBIT_M, METRES);
        }
        Traffic::PedestrianCircle { circle_m, noise_m, .. } => {
            diagnostics.check_pair(format_args!("{path}.circle_m"), circle_m, LEVEL_CIRCLE_M, METRES);
            diagnostics.check_range(format_args!("{path}.noise_m"), noise_m, LEVEL_NOISE_M, METRES);
        }
        Traffic::PedestrianCrowd { goals, .. } => {
            diagnostics.check_pair(format_args!("{path}.goals"), goals, LEVEL_GOALS, "");
        }
        Traffic::RandomWalks { reach_m, .. } => {
            diagnostics.check_pair(format_args!("{path}.reach_m"), reach_m, TRAFFIC_SIZE_M, METRES);
        }
    }
}

/// Checks that the largest enclosure has at most `most` cells of the smallest side, `side_m`.
fn check_cells(
    path: Arguments<'_>,
    side_m: f32,
    most: u32,
    generator: &LevelGenerator,
    diagnostics: &mut Diagnostics,
) {
    if generator.width_m.1 * generator.height_m.1 / (side_m * side_m) > most as f32 {
        let message = format!(
            "can be as small as {side_m} m, so the largest enclosure could have more than {most} cells: write a larger \
             minimum, or a smaller enclosure"
        );
        diagnostics.push(path, message);
    }
}

/// Checks that the floor's grid over the largest enclosure does not take too much memory.
fn check_floor_size(generator: &LevelGenerator, diagnostics: &mut Diagnostics) {
    let half_gap_m = generator.gap_m / 2.0;
    let cell_m = floor::cell_m(half_gap_m, generator.route);
    let cells = f64::from(generator.width_m.1) * f64::from(generator.height_m.1) / (cell_m * cell_m);
    if cells > f64::from(MAX_FLOOR_CELLS) {
        // With `Across`, only the gap limits the side of a cell.
        let gap_limits = cell_m >= floor::cell_m(half_gap_m, Route::Across { margin_m: 0.0 });
        let cause = if gap_limits { "gap_m" } else { "clearance_m" };
        let message =
            format!("is too large for such a small {cause}: write a smaller enclosure, or a larger {cause}");
        diagnostics.push(format_args!("width_m"), message);
    }
}
