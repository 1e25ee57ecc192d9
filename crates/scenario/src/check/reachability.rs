//! Whether the robot can get from wherever it may start to wherever a goal may be.
//!
//! The robot's middle must keep the collision range from everything: what is left is looked at on a fine grid. Only
//! what is surely out of reach is noted: a cell counts as free if there could be a free point in it. What moves, and
//! what generators make (they keep their gaps), stands in nobody's way for ever, and is left aside.
//!
//! Asked of scenarios in which everything has its room.

use super::Diagnostics;
use super::extent::{moves, support_points};
use super::grid::{BlockedCells, CellGrid, ConnectedRegions};
use crate::polygon::sides;
use crate::schema::*;
use glam::DVec2;

/// A part of the free space in which a rule has places: how many cells of it, and one place among them.
struct RegionSite {
    part: u32,
    cells: usize,
    place: DVec2,
}

pub(super) fn check(scenario: &Scenario, diagnostics: &mut Diagnostics) {
    let room = f64::from(scenario.task.collision_range_m);
    let (low, high) = scenario.enclosure.bounds_m();
    let Some(grid) = CellGrid::over(low.as_dvec2(), high.as_dvec2(), room) else { return };
    // From a cell's middle to its corner.
    let half = grid.cell_m * std::f64::consts::FRAC_1_SQRT_2;
    let parts = ConnectedRegions::of(&blocked(scenario, &grid, (room - half) * (1.0 - 1e-6)));
    rules(scenario, &grid, &parts, diagnostics);

    let [start, goal] = [scenario.benchmark_route.start_m, scenario.benchmark_route.goal_m].map(|place| {
        let (row, column) = grid.cell_at(place.as_dvec2());
        parts.at(row, column)
    });
    if start.is_some() && goal.is_some() && start != goal {
        let message = format!(
            "can't be reached from benchmark_route.start_m: {}; open a way, or move one of them",
            needs(scenario)
        );
        diagnostics.push(format_args!("benchmark_route.goal_m"), message);
    }
}

/// All places of both rules must lie in one part.
fn rules(scenario: &Scenario, grid: &CellGrid, parts: &ConnectedRegions, diagnostics: &mut Diagnostics) {
    let starts = sites(scenario, &scenario.starts, grid, parts);
    let goals = sites(scenario, &scenario.goals, grid, parts);
    // The largest part is the one that is meant.
    let Some(main) = starts.iter().chain(&goals).max_by_key(|site| site.cells) else { return };
    let odd = |sites: &[RegionSite]| sites.iter().position(|site| site.part != main.part);
    let (odd_start, odd_goal) = (odd(&starts), odd(&goals));
    let all_starts_odd = starts.iter().all(|site| site.part != main.part);
    let (name, there, message) = match (odd_start, odd_goal) {
        (Some(start), _) if all_starts_odd => ("starts", &starts[start], "from where the robot can't get to"),
        (_, Some(goal)) => ("goals", &goals[goal], "where the robot can't get from"),
        (Some(start), None) => ("starts", &starts[start], "from where the robot can't get to"),
        (None, None) => return,
    };
    // (Adding 0 makes a -0 a 0.)
    let round = |x: f64| (100.0 * x).round() / 100.0 + 0.0;
    let point = |place: DVec2| format!("({:.2}, {:.2})", round(place.x), round(place.y));
    let message = format!(
        "may be at {}, {message} {}: {}; open a way, fill that place up, or write a rule without it",
        point(there.place),
        point(main.place),
        needs(scenario)
    );
    diagnostics.push(format_args!("{name}"), message);
}

fn needs(scenario: &Scenario) -> String {
    format!(
        "it needs a gap of more than {:.2} m, twice the collision range",
        2.0 * scenario.task.collision_range_m
    )
}

/// The parts that the places of `rule` lie in.
fn sites(
    scenario: &Scenario,
    rule: &PlacementRule,
    grid: &CellGrid,
    parts: &ConnectedRegions,
) -> Vec<RegionSite> {
    let mut sites: Vec<RegionSite> = Vec::new();
    let mut longest: Vec<usize> = Vec::new();
    // One run of cells, with a place in it.
    let mut add = |part: Option<u32>, cells: usize, place: DVec2| {
        let Some(part) = part else { return };
        let index = sites.iter().position(|site| site.part == part).unwrap_or_else(|| {
            sites.push(RegionSite { part, cells: 0, place });
            longest.push(0);
            sites.len() - 1
        });
        sites[index].cells += cells;
        if cells > longest[index] {
            (longest[index], sites[index].place) = (cells, place);
        }
    };
    match rule {
        PlacementRule::Fixed { position_m, .. } => {
            let (row, column) = grid.cell_at(position_m.as_dvec2());
            add(parts.at(row, column), 1, position_m.as_dvec2());
        }
        PlacementRule::OneOf { positions_m } => {
            for &place in positions_m {
                let (row, column) = grid.cell_at(place.as_dvec2());
                add(parts.at(row, column), 1, place.as_dvec2());
            }
        }
        PlacementRule::Random { clearance_m } | PlacementRule::Within { clearance_m, .. } => {
            let mut taken = blocked(scenario, grid, f64::from(*clearance_m));
            if let PlacementRule::Within { min_m, max_m, .. } = rule {
                taken.set_outside_box(min_m.as_dvec2(), max_m.as_dvec2());
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
fn blocked<'a>(scenario: &Scenario, grid: &'a CellGrid, margin: f64) -> BlockedCells<'a> {
    let mut cells = BlockedCells::none(grid);
    let corners: Vec<DVec2> = scenario.enclosure.corners_m().iter().map(|corner| corner.as_dvec2()).collect();
    cells.set_outside(&corners);
    for (from, to) in sides(&corners) {
        cells.set_near(&[from, to], margin);
    }
    let mut set = |obstacle: &Obstacle| {
        let (points, radius) = support_points(&obstacle.shape, obstacle.rotation_rad);
        let middle = obstacle.position_m.as_dvec2();
        let points: Vec<DVec2> = points.iter().map(|point| middle + point.as_dvec2()).collect();
        cells.set_near(&points, margin + f64::from(radius));
    };
    scenario.walls.iter().flat_map(Wall::segments).for_each(|piece| set(&piece));
    scenario.obstacles.iter().filter(|obstacle| !moves(obstacle)).for_each(set);
    cells
}
