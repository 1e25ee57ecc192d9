//! Walls of solid cells, merged into few rectangles.
//!
//! In: the rows of a [`WallCells`]. Out: its [`CellBlock`]s, which all geometry of the wall uses. They are computed once.

use std::fmt::Arguments;
use std::sync::{Arc, OnceLock};

use glam::{Vec2, vec2};

use super::check::{Diagnostics, METRES};
use super::geometry::box_distance;
use super::limits::{MAX_WALL_CELLS, WALL_CELL_M};
use super::schema::{Obstacle, ObstacleMotion, Shape, WallCells};
use super::text_rows;

/// A rectangle of solid cells.
#[derive(Clone, Copy, Debug)]
pub(super) struct CellBlock {
    centre_m: Vec2,
    size_m: Vec2,
}

impl CellBlock {
    /// Distance from a point, in m; negative inside.
    pub(super) fn distance_m(&self, point: Vec2) -> f32 {
        box_distance((point - self.centre_m).abs() - self.size_m / 2.0)
    }

    /// Lower left and upper right corner, in m.
    pub(super) fn bounds_m(&self) -> (Vec2, Vec2) {
        (self.centre_m - self.size_m / 2.0, self.centre_m + self.size_m / 2.0)
    }

    /// The rectangle as a static obstacle.
    pub(super) fn obstacle(&self) -> Obstacle {
        Obstacle {
            shape: Shape::Rectangle { width_m: self.size_m.x, height_m: self.size_m.y },
            position_m: self.centre_m,
            rotation_rad: 0.0,
            motion: ObstacleMotion::Static,
        }
    }
}

/// The rectangles of a [`WallCells`], computed when first needed. Any two compare as equal, because they follow from the other
/// fields of the [`WallCells`], which are compared.
#[derive(Clone, Debug, Default)]
pub(super) struct CellBlocks(OnceLock<Arc<[CellBlock]>>);

impl PartialEq for CellBlocks {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl WallCells {
    /// The cells in `rows`, the top row first: `#` is solid, `.` or a space free. Their sides are `cell_m` long, and the grid's
    /// centre is `centre_m`.
    #[must_use]
    pub fn new(rows: Vec<String>, cell_m: f32, centre_m: Vec2) -> Self {
        Self { rows, cell_m, centre_m, blocks: CellBlocks::default() }
    }

    /// The rows of cells, the top row first.
    #[must_use]
    pub fn rows(&self) -> &[String] {
        &self.rows
    }

    /// Side of a cell, in m.
    #[must_use]
    pub fn cell_m(&self) -> f32 {
        self.cell_m
    }

    /// Centre of the grid, in m.
    #[must_use]
    pub fn centre_m(&self) -> Vec2 {
        self.centre_m
    }

    /// The same cells around another centre.
    #[must_use]
    pub fn with_centre(self, centre_m: Vec2) -> Self {
        Self::new(self.rows, self.cell_m, centre_m)
    }

    /// Lower left and upper right corner of the grid, in m.
    #[must_use]
    pub fn bounds_m(&self) -> (Vec2, Vec2) {
        let cells = vec2(text_rows::columns(&self.rows) as f32, self.rows.len() as f32);
        let half_m = cells * self.cell_m / 2.0;
        (self.centre_m - half_m, self.centre_m + half_m)
    }

    /// The rectangles that the solid cells form; none if there are more cells than allowed.
    pub(super) fn blocks(&self) -> &[CellBlock] {
        self.blocks.0.get_or_init(|| {
            if text_rows::columns(&self.rows).saturating_mul(self.rows.len()) > MAX_WALL_CELLS {
                return Arc::default();
            }
            let (columns, low_m) = (text_rows::columns(&self.rows), self.bounds_m().0);
            let corner = |column: usize, row: usize| low_m + vec2(column as f32, row as f32) * self.cell_m;
            let rectangles = text_rows::merged(text_rows::solid_cells(&self.rows), columns);
            let blocks = rectangles.into_iter().map(|(columns, rows)| {
                let (low, high) = (corner(columns.start, rows.start), corner(columns.end, rows.end));
                CellBlock { centre_m: (low + high) / 2.0, size_m: high - low }
            });
            blocks.collect()
        })
    }

    /// Checks the values of the cells at `path`.
    pub(super) fn check(&self, path: Arguments<'_>, diagnostics: &mut Diagnostics) {
        let rows = format_args!("{path}.rows");
        if text_rows::check(rows, &self.rows, MAX_WALL_CELLS, diagnostics)
            && !text_rows::solid_cells(&self.rows).contains(&true)
        {
            diagnostics.push(rows, "has no solid cell: write # for at least one");
        }
        diagnostics.check_range(format_args!("{path}.cell_m"), self.cell_m, WALL_CELL_M, METRES);
        diagnostics.check_point(format_args!("{path}.centre_m"), self.centre_m);
    }
}
