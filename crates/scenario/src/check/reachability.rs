//! The check that the robot can reach every possible goal from every possible start.
//!
//! In: the valid part of a scenario. The robot's centre must stay at least the collision range away from everything, or the
//! robot's inner radius if that is more; the space that remains is divided into a fine grid. A cell counts as free if it
//! could contain a free point, so that only goals that are certainly out of reach are reported. Moving and generated
//! obstacles are ignored: the former don't block a passage forever, the latter leave gaps.

use super::grid::{BlockedCells, CellGrid, ConnectedRegions};
use super::{Diagnostics, ValidPart};
use crate::polygon::sides;
use crate::schema::*;
use glam::DVec2;

/// A connected region of free space that contains positions of a rule.
pub(crate) struct RegionSite {
    /// Number of the region, as in [`ConnectedRegions`].
    pub(crate) region: u32,
    /// Number of its cells that the rule allows.
    pub(crate) cells: usize,
    /// A position in it that the rule allows.
    place: DVec2,
}

pub(super) fn check(valid: &ValidPart, diagnostics: &mut Diagnostics) {
    let scenario = &valid.scenario;
    if !valid.has("enclosure") || !valid.has_keep_out() {
        return;
    }
    let collision_m = f64::from(scenario.sure_collision_m());
    let (low, high) = scenario.enclosure.bounds_m();
    let Some(grid) = CellGrid::over(low.as_dvec2(), high.as_dvec2(), collision_m) else { return };
    let half = grid.half_diagonal_m();
    let regions = ConnectedRegions::of(&blocked(scenario, &grid, (collision_m - half) * (1.0 - 1e-6)));
    if valid.has("starts") && valid.has("goals") {
        check_rules(scenario, &grid, &regions, diagnostics);
    }
    let Some(route) = &scenario.benchmark_route else { return };
    let [start, goal] = [route.start_m, route.goal_m].map(|place| {
        let (row, column) = grid.cell_at(place.as_dvec2());
        regions.at(row, column)
    });
    if start.is_some() && goal.is_some() && start != goal {
        let message = format!(
            "can't be reached from benchmark_route.start_m: {}; widen a gap, or move one of them",
            required_gap(scenario)
        );
        diagnostics.push(format_args!("benchmark_route.goal_m"), message);
    }
}

/// Checks that all positions of both rules are in one region.
fn check_rules(
    scenario: &Scenario,
    grid: &CellGrid,
    regions: &ConnectedRegions,
    diagnostics: &mut Diagnostics,
) {
    let starts = sites(scenario, &scenario.starts, grid, regions);
    let goals = sites(scenario, &scenario.goals, grid, regions);
    // The region with the most cells that a rule allows is taken for the intended one.
    let Some(main) = starts.iter().chain(&goals).max_by_key(|site| site.cells) else { return };
    let odd = |sites: &[RegionSite]| sites.iter().position(|site| site.region != main.region);
    let (odd_start, odd_goal) = (odd(&starts), odd(&goals));
    let all_starts_odd = starts.iter().all(|site| site.region != main.region);
    let (name, odd_site, message) = match (odd_start, odd_goal) {
        (Some(start), _) if all_starts_odd => ("starts", &starts[start], "from which the robot can't reach"),
        (_, Some(goal)) => ("goals", &goals[goal], "which the robot can't reach from"),
        (Some(start), None) => ("starts", &starts[start], "from which the robot can't reach"),
        (None, None) => return,
    };
    // Adding 0 turns -0 into 0.
    let round = |x: f64| (100.0 * x).round() / 100.0 + 0.0;
    let point = |place: DVec2| format!("({:.2}, {:.2})", round(place.x), round(place.y));
    let message = format!(
        "includes {}, {message} {}: {}; widen a gap, block that area, or exclude it from the rule",
        point(odd_site.place),
        point(main.place),
        required_gap(scenario)
    );
    diagnostics.push(format_args!("{name}"), message);
}

fn required_gap(scenario: &Scenario) -> String {
    let gap_m = 2.0 * scenario.sure_collision_m();
    let is_range = scenario.sure_collision_m() <= scenario.task.collision_range_m;
    let what = if is_range {
        "twice the collision range"
    } else {
        "twice the distance from its origin to its nearest edge"
    };
    format!("the robot needs a gap of more than {gap_m:.2} m, {what}")
}

/// The regions that contain positions of `rule`.
pub(crate) fn sites(
    scenario: &Scenario,
    rule: &PlacementRule,
    grid: &CellGrid,
    regions: &ConnectedRegions,
) -> Vec<RegionSite> {
    let mut sites: Vec<RegionSite> = Vec::new();
    let mut longest: Vec<usize> = Vec::new();
    // Adds a run of cells and a position in it. The position in the longest run of a region is kept.
    let mut add = |region: Option<u32>, cells: usize, place: DVec2| {
        let Some(region) = region else { return };
        let index = sites.iter().position(|site| site.region == region).unwrap_or_else(|| {
            sites.push(RegionSite { region, cells: 0, place });
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
            add(regions.at(row, column), 1, position_m.as_dvec2());
        }
        PlacementRule::OneOf { positions_m } => {
            for &place in positions_m {
                let (row, column) = grid.cell_at(place.as_dvec2());
                add(regions.at(row, column), 1, place.as_dvec2());
            }
        }
        PlacementRule::Random { clearance_m } | PlacementRule::Within { clearance_m, .. } => {
            let mut taken = blocked(scenario, grid, f64::from(*clearance_m));
            if let PlacementRule::Within { min_m, max_m, .. } = rule {
                taken.set_outside_box(min_m.as_dvec2(), max_m.as_dvec2());
            }
            for row in taken.rows() {
                for (from, to) in taken.free_runs(row) {
                    add(regions.at(row, from), to - from, grid.centre(row, (from + to) / 2));
                }
            }
        }
    }
    sites
}

/// The cells whose centres are outside the enclosure, or closer than `margin` to it, an inner wall or a static obstacle.
pub(crate) fn blocked<'a>(scenario: &Scenario, grid: &'a CellGrid, margin: f64) -> BlockedCells<'a> {
    let mut cells = BlockedCells::empty(grid);
    let corners: Vec<DVec2> = scenario.enclosure.corners_m().iter().map(|corner| corner.as_dvec2()).collect();
    cells.set_outside(&corners);
    for (from, to) in sides(&corners) {
        cells.set_near(&[from, to], margin);
    }
    let mut set = |obstacle: &Obstacle| {
        let (points, radius) = obstacle.shape.support_points(obstacle.rotation_rad);
        let middle = obstacle.position_m.as_dvec2();
        let points: Vec<DVec2> = points.iter().map(|point| middle + point.as_dvec2()).collect();
        cells.set_near(&points, margin + f64::from(radius));
    };
    scenario.walls.iter().flat_map(Wall::pieces).for_each(|piece| set(&piece));
    scenario.obstacles.iter().filter(|obstacle| !obstacle.motion.is_moving()).for_each(set);
    cells
}
