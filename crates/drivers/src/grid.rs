//! Grids of square cells over a rectangle.

use glam::{Vec2, vec2};

/// The maximum number of cells of a grid.
pub(crate) const MAX_CELLS: usize = 200_000;

/// A grid of square cells over a rectangle. Cells are numbered row by row from the lower left.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Grid {
    /// Lower left corner, in m.
    pub(crate) min_m: Vec2,
    /// Side of a cell, in m.
    pub(crate) cell_m: f32,
    pub(crate) columns: usize,
    pub(crate) rows: usize,
}

impl Grid {
    /// The grid over the rectangle with cells of `cell_m`, or larger ones if there would be more than [`MAX_CELLS`].
    pub(crate) fn over(min_m: Vec2, max_m: Vec2, cell_m: f32) -> Self {
        let size = (max_m - min_m).max(Vec2::splat(cell_m));
        let least_m = (size.x * size.y / MAX_CELLS as f32).sqrt();
        let mut cell_m = cell_m.max(least_m * 1.01);
        loop {
            let count = |length: f32| (length / cell_m).ceil().max(1.0) as usize;
            let (columns, rows) = (count(size.x), count(size.y));
            if columns.saturating_mul(rows) <= MAX_CELLS {
                return Self { min_m, cell_m, columns, rows };
            }
            // The last row or column of an elongated rectangle is mostly outside it.
            cell_m *= 1.05;
        }
    }

    pub(crate) fn len(&self) -> usize {
        self.columns * self.rows
    }

    /// Whether `point_m` lies in the grid.
    pub(crate) fn contains(&self, point_m: Vec2) -> bool {
        let at = (point_m - self.min_m) / self.cell_m;
        at.cmpge(Vec2::ZERO).all() && at.x < self.columns as f32 && at.y < self.rows as f32
    }

    /// The index of the cell at `point_m`, or of the nearest one for a point outside.
    pub(crate) fn cell(&self, point_m: Vec2) -> usize {
        let (column, row) = self.column_row(point_m);
        row * self.columns + column
    }

    /// Column and row of the cell at `point_m`, or of the nearest one.
    pub(crate) fn column_row(&self, point_m: Vec2) -> (usize, usize) {
        let at = (point_m - self.min_m) / self.cell_m;
        // A negative number or NaN becomes 0.
        ((at.x as usize).min(self.columns - 1), (at.y as usize).min(self.rows - 1))
    }

    /// The centre of a cell, in m.
    pub(crate) fn centre_m(&self, cell: usize) -> Vec2 {
        let (column, row) = ((cell % self.columns) as f32, (cell / self.columns) as f32);
        self.min_m + vec2(column + 0.5, row + 0.5) * self.cell_m
    }

    /// The cells whose centres may lie within `reach_m` of the box from `low_m` to `high_m`.
    pub(crate) fn cells_near(&self, low_m: Vec2, high_m: Vec2, reach_m: f32) -> impl Iterator<Item = usize> {
        let (left, bottom) = self.column_row(low_m - reach_m);
        let (right, top) = self.column_row(high_m + reach_m);
        let columns = self.columns;
        (bottom..=top).flat_map(move |row| (left..=right).map(move |column| row * columns + column))
    }

    /// Whether `is_free` holds for the cells along the straight line from `from_m` to `to_m`, sampled at most half a cell apart.
    pub(crate) fn sees(&self, from_m: Vec2, to_m: Vec2, is_free: impl Fn(usize) -> bool) -> bool {
        let line = to_m - from_m;
        let samples = (2.0 * line.length() / self.cell_m).ceil().clamp(1.0, MAX_CELLS as f32);
        (0..=samples as usize).all(|k| is_free(self.cell(from_m + line * (k as f32 / samples))))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_grid_covers_any_rectangle_with_a_limited_number_of_cells() {
        for (width_m, height_m) in
            [(5.0, 4.0), (100.0, 100.0), (20_000.0, 0.104), (0.104, 20_000.0), (1e6, 0.01)]
        {
            let grid = Grid::over(Vec2::ZERO, vec2(width_m, height_m), 0.05);
            assert!(grid.len() <= MAX_CELLS, "{width_m} m x {height_m} m: {} cells", grid.len());
            let covered_m = vec2(grid.columns as f32, grid.rows as f32) * grid.cell_m;
            assert!(covered_m.x > 0.999 * width_m && covered_m.y > 0.999 * height_m, "{covered_m}");
        }
        let small = Grid::over(Vec2::ZERO, vec2(5.0, 4.0), 0.05);
        assert_eq!(small.len(), 8_000, "below the maximum, cells keep the given size");
    }
}
