//! A uniform grid over many shapes: which of them are near a point, and which a ray may hit.
//!
//! In: the bounding boxes of items, and their distances from points. Out: the indices of the items in cells. An item is listed
//! in every cell that it touches, and in some cells near it.

use glam::{Vec2, vec2};

/// The number of cells per item. Items are cheaper to test than cells are to walk through.
const CELLS_PER_ITEM: f32 = 0.35;
/// The maximum length of a side of the grid, in cells.
const MAX_SIDE: f32 = 512.0;
/// The maximum number of cells in all bounding boxes together. If many items are large, the grid is coarser.
const MAX_BOX_CELLS: f64 = 262_144.0;

/// A grid of square cells that lists items by their indices. Immutable.
#[derive(Clone, Debug)]
pub struct UniformGrid {
    /// The lower left corner, in m.
    low: Vec2,
    cell_m: f32,
    cells_per_m: f32,
    columns: usize,
    rows: usize,
    /// Where the items of each cell begin in `items`, row by row; one more entry than cells.
    starts: Vec<u32>,
    items: Vec<u32>,
}

impl UniformGrid {
    /// The smallest number of items for which a grid is worth its cost.
    pub const MIN_ITEMS: usize = 32;

    /// A grid over items with these bounding boxes: their lower left and upper right corners, in m. `distance_m` gives the
    /// distance of an item, by its index, from a point. Rounding errors are not considered: boxes and distances need a margin
    /// for them.
    ///
    /// `None` if there are no items or if a coordinate is not finite.
    #[must_use]
    pub fn new(boxes: &[(Vec2, Vec2)], distance_m: impl Fn(usize, Vec2) -> f32) -> Option<Self> {
        let (low, high) = boxes.iter().copied().reduce(|all, item| (all.0.min(item.0), all.1.max(item.1)))?;
        let extent = high - low;
        if !boxes.iter().all(|(low, high)| low.is_finite() && high.is_finite()) || !extent.is_finite() {
            return None;
        }
        let mut grid = Self::empty(low, extent, boxes.len());
        // More than `MAX_BOX_CELLS` boxes exceed it in any grid, because each touches at least one cell.
        while grid.columns * grid.rows > 1
            && boxes.iter().map(|item| grid.box_cells(item)).sum::<f64>() > MAX_BOX_CELLS
        {
            grid = Self::with_cells(low, extent, 2.0 * grid.cell_m);
        }
        grid.fill(boxes, distance_m);
        Some(grid)
    }

    fn empty(low: Vec2, extent: Vec2, items: usize) -> Self {
        let cell_m = (extent.x * extent.y / (CELLS_PER_ITEM * items as f32)).sqrt();
        Self::with_cells(low, extent, cell_m.max(extent.max_element() / MAX_SIDE).max(1e-3))
    }

    fn with_cells(low: Vec2, extent: Vec2, cell_m: f32) -> Self {
        let cells_per_m = 1.0 / cell_m;
        // One more, so that the upper right corner is inside.
        let count = |side_m: f32| (side_m * cells_per_m) as usize + 1;
        let (columns, rows) = (count(extent.x), count(extent.y));
        Self { low, cell_m, cells_per_m, columns, rows, starts: Vec::new(), items: Vec::new() }
    }

    /// The number of cells that a box touches.
    fn box_cells(&self, &(low, high): &(Vec2, Vec2)) -> f64 {
        let (low, high) = (self.cell_at(low), self.cell_at(high));
        (high.0 - low.0 + 1) as f64 * (high.1 - low.1 + 1) as f64
    }

    fn fill(&mut self, boxes: &[(Vec2, Vec2)], distance_m: impl Fn(usize, Vec2) -> f32) {
        // With room for rounding.
        let half_diagonal_m = 0.7072 * self.cell_m;
        let mut listed = Vec::new();
        for (item, &(low, high)) in boxes.iter().enumerate() {
            let (low, high) = (self.cell_at(low), self.cell_at(high));
            for (row, column) in (low.1..=high.1).flat_map(|row| (low.0..=high.0).map(move |c| (row, c))) {
                let centre = self.low + vec2(column as f32 + 0.5, row as f32 + 0.5) * self.cell_m;
                if distance_m(item, centre) <= half_diagonal_m {
                    listed.push(((row * self.columns + column) as u32, item as u32));
                }
            }
        }
        listed.sort_unstable();
        let first_of = |cell: usize| listed.partition_point(|&(other, _)| (other as usize) < cell) as u32;
        self.starts = (0..=self.columns * self.rows).map(first_of).collect();
        self.items = listed.into_iter().map(|(_, item)| item).collect();
    }

    /// The column and row of the cell at `point`, or of the nearest cell if the point is outside.
    #[inline]
    fn cell_at(&self, point: Vec2) -> (usize, usize) {
        let cell = (point - self.low) * self.cells_per_m;
        // The conversion gives 0 for negative numbers.
        ((cell.x as usize).min(self.columns - 1), (cell.y as usize).min(self.rows - 1))
    }

    /// The side of a cell, in m.
    #[must_use]
    pub fn cell_m(&self) -> f32 {
        self.cell_m
    }

    /// An upper bound on the distance from `point` to any cell, in m.
    #[must_use]
    pub fn max_distance_m(&self, point: Vec2) -> f32 {
        let high = self.low + vec2(self.columns as f32, self.rows as f32) * self.cell_m;
        (point - self.low).abs().max((high - point).abs()).element_sum()
    }

    /// Whether `point`, in m, is inside the grid.
    #[must_use]
    #[inline]
    pub fn contains(&self, point: Vec2) -> bool {
        let cell = (point - self.low) * self.cells_per_m;
        cell.x >= 0.0 && cell.y >= 0.0 && cell.x < self.columns as f32 && cell.y < self.rows as f32
    }

    /// All items within `radius_m` of `point`, and possibly others; an item may occur more than once. A negative radius
    /// counts as 0.
    #[inline]
    pub fn near(&self, point: Vec2, radius_m: f32) -> impl Iterator<Item = usize> + '_ {
        let radius_m = radius_m.max(0.0);
        let (low, high) = (self.cell_at(point - radius_m), self.cell_at(point + radius_m));
        let of_row = move |row: usize| {
            let (from, to) = (row * self.columns + low.0, row * self.columns + high.0 + 1);
            &self.items[self.starts[from] as usize..self.starts[to] as usize]
        };
        (low.1..=high.1).flat_map(of_row).map(|&item| item as usize)
    }

    /// The items that each cell lists, cell by cell.
    pub fn cells(&self) -> impl Iterator<Item = &[u32]> {
        self.starts.windows(2).map(|ends| &self.items[ends[0] as usize..ends[1] as usize])
    }

    /// Walks along a ray from a point inside the grid, in a direction of length 1. Calls `visit` with every cell on its
    /// way: its index in [`Self::cells`], and the distance, in m, at which the ray leaves it. Ends when `visit` returns false, or
    /// at the border.
    #[inline]
    pub fn walk(&self, origin: Vec2, direction: Vec2, mut visit: impl FnMut(usize, f32) -> bool) {
        let start = (origin - self.low) * self.cells_per_m;
        let (mut column, mut row) = self.cell_at(origin);
        let (step_x, mut next_x, each_x) = self.axis(start.x, column, direction.x);
        let (step_y, mut next_y, each_y) = self.axis(start.y, row, direction.y);
        while column < self.columns && row < self.rows {
            let exit_m = next_x.min(next_y);
            if !visit(row * self.columns + column, exit_m) || exit_m == f32::INFINITY {
                return;
            }
            // Without a branch, which would often be mispredicted.
            let along_x = next_x < next_y;
            (column, next_x) = (
                column.wrapping_add_signed(if along_x { step_x } else { 0 }),
                next_x + if along_x { each_x } else { 0.0 },
            );
            (row, next_y) = (
                row.wrapping_add_signed(if along_x { 0 } else { step_y }),
                next_y + if along_x { 0.0 } else { each_y },
            );
        }
    }

    /// For one axis of a ray: the step from cell to cell, and the distances, in m, to the first border of a cell and from
    /// border to border.
    #[inline]
    fn axis(&self, start: f32, cell: usize, direction: f32) -> (isize, f32, f32) {
        let each = self.cell_m / direction.abs();
        if direction > 0.0 {
            (1, (cell as f32 + 1.0 - start) * each, each)
        } else if direction < 0.0 {
            (-1, (start - cell as f32) * each, each)
        } else {
            (0, f32::INFINITY, f32::INFINITY)
        }
    }
}
