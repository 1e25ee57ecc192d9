//! The import of a world of solids: those that border the floor are kept exactly, and the space between them that the robot
//! can't reach is filled.

use glam::{DVec2, dvec2};
use wayfield_scenario::Scenario;

use crate::Imported;
use crate::draft::{self, Source};
use crate::findings::Findings;
use crate::floor::Floor;
use crate::frame::Frame;
use crate::grid::{Cell, Grid};
use crate::solid::{Solid, bounds};
use crate::stages::MovingDisc;
use crate::trace::{Scale, Surroundings, filled};

/// Width of the free margin of the grid around the solids, in m.
const MARGIN_M: f64 = 1.0;
/// Maximum number of cells of the grid over a world.
const MAX_GRID_CELLS: f64 = (1 << 22) as f64;
/// Maximum number of tests of a cell against a solid.
const MAX_TESTS: f64 = (1 << 27) as f64;

/// A grid over a world.
struct Raster {
    /// The lower left corner in m.
    low_m: DVec2,
    /// Side of a cell in m.
    cell_m: f64,
    /// The cells whose centre is at least half a cell from every solid.
    free: Grid<bool>,
}

impl Raster {
    /// A grid with cells that are small compared with `keep_out_m`, the robot's keep-out distance.
    ///
    /// # Errors
    /// The world is too large for the robot, or has too many large solids.
    fn new(solids: &[Solid], keep_out_m: f64) -> Result<Self, String> {
        let (low, high) = bounds(solids, &[]);
        let low_m = low - DVec2::splat(MARGIN_M);
        let size = high - low + DVec2::splat(2.0 * MARGIN_M);
        let cell_m = (keep_out_m / 8.0).max((size.x * size.y / MAX_GRID_CELLS).sqrt());
        if cell_m > keep_out_m / 2.0 || !cell_m.is_finite() {
            return Err(format!(
                "the world is {:.0} m x {:.0} m, too large for a robot that keeps {keep_out_m:.3} m from walls; help: \
                 remove what is far away, or use a larger robot (--robot)",
                size.x, size.y
            ));
        }
        let count = |length: f64| (length / cell_m).ceil() as usize;
        let mut raster = Self { low_m, cell_m, free: Grid::filled(count(size.x), count(size.y), true) };
        let mut tests = 0.0;
        for solid in solids {
            let ((left, bottom), (right, top)) = raster.around(solid);
            tests += (right - left) as f64 * (top - bottom) as f64;
            if tests > MAX_TESTS {
                return Err("too many large shapes; help: remove shapes that overlap others".into());
            }
            for row in bottom..top {
                for column in left..right {
                    if solid.distance(raster.centre_m((column, row))) < cell_m / 2.0 {
                        raster.free.set((column, row), false);
                    }
                }
            }
        }
        Ok(raster)
    }

    /// The cells inside the margin: lower left and upper right corner, the latter exclusive. Only these are counted to find the
    /// largest part of the world, because the size of the space around a building depends on the margin.
    fn inner(&self) -> (Cell, Cell) {
        let margin = (MARGIN_M / self.cell_m) as usize;
        ((margin, margin), (self.free.columns - margin, self.free.rows - margin))
    }

    fn centre_m(&self, (column, row): Cell) -> DVec2 {
        self.low_m + dvec2(column as f64 + 0.5, row as f64 + 0.5) * self.cell_m
    }

    /// The cells of a solid's bounding box, and a few more around it: lower left and upper right corner, the latter exclusive.
    fn around(&self, solid: &Solid) -> (Cell, Cell) {
        let (low, high) = solid.bounds();
        let at = |point: DVec2, more: f64| {
            let cells = ((point - self.low_m) / self.cell_m + DVec2::splat(more)).max(DVec2::ZERO);
            ((cells.x as usize).min(self.free.columns), (cells.y as usize).min(self.free.rows))
        };
        (at(low, -2.0), at(high, 3.0))
    }

    /// Whether the solid borders the floor: it is less than two cells from the centre of a floor cell.
    fn borders(&self, solid: &Solid, floor: &Grid<bool>) -> bool {
        let ((left, bottom), (right, top)) = self.around(solid);
        (bottom..top).any(|row| {
            (left..right).any(|column| {
                floor.at((column, row)) && solid.distance(self.centre_m((column, row))) < 2.0 * self.cell_m
            })
        })
    }
}

/// A world of solids.
pub struct World<'a> {
    /// The name of its scenario.
    pub label: String,
    /// A sentence on what was read.
    pub about: String,
    /// What stands still: at least one solid.
    pub solids: &'a [Solid],
    /// What moves.
    pub moving: &'a [MovingDisc],
    /// What could not be represented.
    pub findings: &'a Findings,
}

impl World<'_> {
    /// The scenario of the world, with the robot of `base`.
    ///
    /// # Errors
    /// As a message: the world is too large for the robot, has too many large solids or no place that the robot fits into, or
    /// the scenario would be invalid or too large.
    pub fn import(self, base: &Scenario) -> Result<Imported, String> {
        let Self { label, about, solids, moving, findings } = self;
        let raster = Raster::new(solids, f64::from(base.keep_out_m()))?;
        let margins = draft::margins(base, raster.cell_m);
        let no_floor = || {
            let needed_m = draft::needed_m(base);
            format!(
                "the robot fits nowhere in this world: it needs more than {needed_m:.3} m to each side; help: use a smaller \
                 robot (--robot)"
            )
        };
        let floor = Floor::new(&raster.free, margins, raster.inner()).ok_or_else(no_floor)?;
        let ((left, bottom), (right, top)) = floor.cells.bounds().ok_or_else(no_floor)?;
        let kept: Vec<Solid> =
            solids.iter().filter(|solid| raster.borders(solid, &floor.cells)).copied().collect();
        let corner =
            |column: usize, row: usize| raster.low_m + dvec2(column as f64, row as f64) * raster.cell_m;
        let (low, high) = bounds(&kept, &[corner(left, bottom), corner(right, top)]);
        let centre_m = (low + high) / 2.0;
        let scale = Scale { cell_m: raster.cell_m, centre: (centre_m - raster.low_m) / raster.cell_m };
        let mut pockets = raster.free.clone();
        for cell in raster.free.cells() {
            let at = raster.centre_m(cell);
            let half = DVec2::splat(raster.cell_m / 2.0);
            let is_inside = (at - half).cmpge(low).all() && (at + half).cmple(high).all();
            pockets.set(cell, is_inside && raster.free.at(cell) && !floor.cells.at(cell));
        }
        let clearance_m = (floor.clearance - 2.0) * raster.cell_m;
        let mut obstacles: Vec<_> = kept.iter().map(|solid| solid.obstacle(centre_m)).collect();
        obstacles.extend(filled(&pockets, scale, clearance_m));
        obstacles.extend(moving.iter().filter_map(|disc| disc.obstacle(centre_m)));
        let found = Surroundings { obstacles, ..Surroundings::default() };
        let source = Source { file: label, about, frame: Frame { origin_m: centre_m, yaw_rad: 0.0 } };
        let scenario = draft::scenario(base, &source, high - low, &floor, scale, &found);
        draft::check(&scenario)
            .map_err(|problem| format!("{problem}; help: change the file, or use another robot (--robot)"))?;
        Ok(Imported { scenario, deviation_m: 0.0, path_length_m: None, findings: findings.lines() })
    }
}
