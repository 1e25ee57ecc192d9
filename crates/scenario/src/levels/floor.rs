//! The floor of a level: its free space, as connected regions on a grid.
//!
//! In: the static parts of a level. Out: whether every goal can be reached from every start through passages of at least the
//! minimum width. If the answer is yes, it is proven: the centres of free cells are at least half the width plus half a cell's
//! diagonal away from all surfaces, so a path from centre to centre has the width. Random starts and goals have enough
//! clearance for the centres of their cells to be free.

use super::schema::Route;
use crate::check::{CellGrid, ConnectedRegions, RegionSite, blocked, sites};
use crate::schema::{Obstacle, PlacementRule, Scenario};

/// Largest side of a cell, as a fraction of half the minimum width of the passages. Larger cells close more of the passages
/// that are only a little wider than the minimum.
const MAX_CELL_FRACTION: f64 = 0.25;

/// The free space of a level, as connected regions on a grid.
pub(super) struct Floor<'a> {
    scenario: &'a Scenario,
    grid: CellGrid,
    regions: ConnectedRegions,
    /// Smallest distance of the centres of free cells from any surface, in m.
    clearance_m: f64,
}

/// The side of the cells, in m, for passages whose minimum width is twice `half_gap_m`.
pub(super) fn cell_m(half_gap_m: f32, route: Route) -> f64 {
    let half_gap_m = f64::from(half_gap_m);
    let largest = half_gap_m * MAX_CELL_FRACTION;
    match route {
        Route::Random { clearance_m } => {
            // A cell's diagonal must be shorter than this difference, or the centre of a position's cell may not be free. The
            // factor 0.999 leaves a margin for rounding.
            largest.min((f64::from(clearance_m) - half_gap_m) * (std::f64::consts::FRAC_1_SQRT_2 * 0.999))
        }
        Route::Across { .. } | Route::Fixed { .. } => largest,
    }
}

impl<'a> Floor<'a> {
    /// The floor of `scenario` for passages whose minimum width is twice `half_gap_m`.
    pub(super) fn new(scenario: &'a Scenario, half_gap_m: f32, route: Route) -> Self {
        let (low, high) = scenario.enclosure.bounds_m();
        let grid = CellGrid::with_cells(low.as_dvec2(), high.as_dvec2(), cell_m(half_gap_m, route));
        let clearance_m = f64::from(half_gap_m) + grid.half_diagonal_m();
        let regions = ConnectedRegions::of(&blocked(scenario, &grid, clearance_m));
        Self { scenario, grid, regions, clearance_m }
    }

    /// Checks that there are starts and goals, all in one region.
    ///
    /// # Errors
    /// The reason, as the rest of a sentence.
    pub(super) fn check(&self) -> Result<(), &'static str> {
        let (starts, goals) = (self.sites(&self.scenario.starts), self.sites(&self.scenario.goals));
        if starts.is_empty() || goals.is_empty() {
            return Err("there is no free space for starts and goals");
        }
        let all_in = |region| starts.iter().chain(&goals).all(|site| site.region == region);
        if all_in(starts[0].region) { Ok(()) } else { Err("some goals can't be reached from some starts") }
    }

    /// The `candidates`, circles of radius `radius_m`, that cover cells of a smaller region with starts and block no cell of the
    /// largest one.
    pub(super) fn plugs(&self, mut candidates: Vec<Obstacle>, radius_m: f32) -> Vec<Obstacle> {
        let sites = self.sites(&self.scenario.starts);
        let Some(main) = sites.iter().max_by_key(|site| site.cells) else { return Vec::new() };
        let radius_m = f64::from(radius_m);
        candidates.retain(|plug| {
            let near =
                |region, away_m| self.regions.is_near(&self.grid, region, plug.position_m.as_dvec2(), away_m);
            sites.iter().any(|site| site.region != main.region && near(site.region, radius_m))
                && !near(main.region, self.clearance_m + radius_m)
        });
        candidates
    }

    /// The regions that contain positions of `rule`.
    fn sites(&self, rule: &PlacementRule) -> Vec<RegionSite> {
        let mut rule = rule.clone();
        if let PlacementRule::Random { clearance_m } = &mut rule {
            // A position with the clearance may be this far from the centre of its cell.
            *clearance_m -= self.grid.half_diagonal_m() as f32;
        }
        sites(self.scenario, &rule, &self.grid, &self.regions)
    }
}
