//! Whether the robot can get from wherever it may start to wherever a target may be.
//!
//! The robot's middle must keep the collision range from everything: what is left is looked at on a fine grid. Only
//! what is surely out of reach is noted: a cell counts as free if there could be a free point in it. What moves, and
//! what generators make (they keep their gaps), stands in nobody's way for ever, and is left aside.
//!
//! Asked of scenarios in which everything has its room.

use super::Notes;
use super::extent::{bones, moves};
use super::grid::{Cells, Grid, Parts, Point};
use crate::polygon::sides;
use crate::schema::*;

/// A part of the free space in which a rule has places: how many cells of it, and one place among them.
struct Site {
    part: u32,
    cells: usize,
    place: Point,
}

pub(super) fn check(scenario: &Scenario, notes: &mut Notes) {
    let room = f64::from(scenario.task.collision_range_m);
    let (low, high) = scenario.enclosure.bounds_m();
    let Some(grid) = Grid::over(wide(low), wide(high), room) else { return };
    // From a cell's middle to its corner.
    let half = grid.cell_m * std::f64::consts::FRAC_1_SQRT_2;
    let parts = Parts::of(&blocked(scenario, &grid, (room - half) * (1.0 - 1e-6)));
    rules(scenario, &grid, &parts, notes);

    let [start, target] = [scenario.course.start_m, scenario.course.target_m].map(|place| {
        let (row, column) = grid.cell_at(wide(place));
        parts.at(row, column)
    });
    if start.is_some() && target.is_some() && start != target {
        let message = format!(
            "can't be reached from course.start_m: {}; open a way, or move one of them",
            needs(scenario)
        );
        notes.add(format_args!("course.target_m"), message);
    }
}

/// All places of both rules must lie in one part.
fn rules(scenario: &Scenario, grid: &Grid, parts: &Parts, notes: &mut Notes) {
    let starts = sites(scenario, &scenario.starts, grid, parts);
    let targets = sites(scenario, &scenario.targets, grid, parts);
    // The largest part is the one that is meant.
    let Some(main) = starts.iter().chain(&targets).max_by_key(|site| site.cells) else { return };
    let odd = |sites: &[Site]| sites.iter().position(|site| site.part != main.part);
    let (odd_start, odd_target) = (odd(&starts), odd(&targets));
    let all_starts_odd = starts.iter().all(|site| site.part != main.part);
    let (name, there, message) = match (odd_start, odd_target) {
        (Some(start), _) if all_starts_odd => ("starts", &starts[start], "from where the robot can't get to"),
        (_, Some(target)) => ("targets", &targets[target], "where the robot can't get from"),
        (Some(start), None) => ("starts", &starts[start], "from where the robot can't get to"),
        (None, None) => return,
    };
    // (Adding 0 makes a -0 a 0.)
    let round = |x: f64| (100.0 * x).round() / 100.0 + 0.0;
    let point = |(x, y): Point| format!("({:.2}, {:.2})", round(x), round(y));
    let message = format!(
        "may be at {}, {message} {}: {}; open a way, fill that place up, or write a rule without it",
        point(there.place),
        point(main.place),
        needs(scenario)
    );
    notes.add(format_args!("{name}"), message);
}

fn needs(scenario: &Scenario) -> String {
    format!(
        "it needs a gap of more than {:.2} m, twice the collision range",
        2.0 * scenario.task.collision_range_m
    )
}

/// The parts that the places of `rule` lie in.
fn sites(scenario: &Scenario, rule: &PlaceRule, grid: &Grid, parts: &Parts) -> Vec<Site> {
    let mut sites: Vec<Site> = Vec::new();
    let mut longest: Vec<usize> = Vec::new();
    // One run of cells, with a place in it.
    let mut add = |part: Option<u32>, cells: usize, place: Point| {
        let Some(part) = part else { return };
        let index = sites.iter().position(|site| site.part == part).unwrap_or_else(|| {
            sites.push(Site { part, cells: 0, place });
            longest.push(0);
            sites.len() - 1
        });
        sites[index].cells += cells;
        if cells > longest[index] {
            (longest[index], sites[index].place) = (cells, place);
        }
    };
    match rule {
        PlaceRule::Fixed { at_m, .. } => {
            let (row, column) = grid.cell_at(wide(*at_m));
            add(parts.at(row, column), 1, wide(*at_m));
        }
        PlaceRule::OneOf { places_m } => {
            for &place in places_m {
                let (row, column) = grid.cell_at(wide(place));
                add(parts.at(row, column), 1, wide(place));
            }
        }
        PlaceRule::Random { clearance_m } | PlaceRule::Within { clearance_m, .. } => {
            let mut taken = blocked(scenario, grid, f64::from(*clearance_m));
            if let PlaceRule::Within { min_m, max_m, .. } = rule {
                taken.set_outside_box(wide(*min_m), wide(*max_m));
            }
            for row in taken.rows() {
                for (from, to) in taken.gaps(row) {
                    add(parts.at(row, from), to - from, grid.middle(row, (from + to) / 2));
                }
            }
        }
    }
    sites
}

/// The cells whose middles are outside, or nearer than `margin` to something that stands still.
fn blocked<'a>(scenario: &Scenario, grid: &'a Grid, margin: f64) -> Cells<'a> {
    let mut cells = Cells::none(grid);
    let corners: Vec<Point> = scenario.enclosure.corners_m().into_iter().map(wide).collect();
    cells.set_outside(&corners);
    for (from, to) in sides(&corners) {
        cells.set_near(&[from, to], margin);
    }
    let mut set = |obstacle: &Obstacle| {
        let (points, radius) = bones(&obstacle.shape, obstacle.rotation_rad);
        let middle = wide(obstacle.position_m);
        let points: Vec<Point> =
            points.into_iter().map(|(x, y)| (middle.0 + f64::from(x), middle.1 + f64::from(y))).collect();
        cells.set_near(&points, margin + f64::from(radius));
    };
    scenario.walls.iter().flat_map(Wall::pieces).for_each(|piece| set(&piece));
    scenario.obstacles.iter().filter(|obstacle| !moves(obstacle)).for_each(set);
    cells
}

fn wide((x, y): (f32, f32)) -> Point {
    (f64::from(x), f64::from(y))
}
