//! A fine grid over the enclosure with blocked cells and connected regions of free cells.
//!
//! In: outlines with a margin. Out: [`BlockedCells`], a bit per cell, and [`ConnectedRegions`]: the free cells grouped into
//! regions whose cells share sides. Solids are convex, so each blocks one interval per row, and the work grows with
//! the number of rows, not of cells.

use glam::{DVec2, Vec2Swizzles, dvec2};

use crate::limits::MAX_CELLS;
use crate::polygon::sides;

/// Smallest side of a cell as a fraction of the distance that the robot's centre must keep.
const MIN_CELL_FRACTION: f64 = 1.0 / 32.0;
/// Largest side of a cell as a fraction of that distance. In larger cells a passable gap could get lost.
const MAX_CELL_FRACTION: f64 = 1.0 / 2.0;

/// The position and size of the cells.
pub(crate) struct CellGrid {
    origin: DVec2,
    /// The side of a cell, in m.
    pub(super) cell_m: f64,
    columns: usize,
    rows: usize,
    /// Whether rows run along y; they run along the longer side of the enclosure.
    transposed: bool,
}

impl CellGrid {
    /// A grid over the box between two corners for a robot whose centre must stay `clearance_m` from everything. `None` if the
    /// box is so large that the cells would be too coarse.
    pub(super) fn over(low: DVec2, high: DVec2, clearance_m: f64) -> Option<Self> {
        let (width, height) = (high.x - low.x, high.y - low.y);
        let cell_m = (clearance_m * MIN_CELL_FRACTION).max((width * height / f64::from(MAX_CELLS)).sqrt());
        (cell_m <= clearance_m * MAX_CELL_FRACTION).then(|| Self::with_cells(low, high, cell_m))
    }

    /// A grid over the box between two corners, with cells of side `cell_m`.
    pub(crate) fn with_cells(low: DVec2, high: DVec2, cell_m: f64) -> Self {
        let (width, height) = (high.x - low.x, high.y - low.y);
        let transposed = height > width;
        let count = |extent: f64| ((extent / cell_m).ceil() as usize).max(1);
        let (columns, rows) =
            if transposed { (count(height), count(width)) } else { (count(width), count(height)) };
        let grid = Self { origin: low, cell_m, columns, rows, transposed };
        Self { origin: grid.swap_axes(low), ..grid }
    }

    /// Distance from the centre of a cell to its corner, in m.
    pub(crate) fn half_diagonal_m(&self) -> f64 {
        self.cell_m * std::f64::consts::FRAC_1_SQRT_2
    }

    /// Converts a point between the scenario's axes and the grid's axes, in either direction.
    pub(super) fn swap_axes(&self, point: DVec2) -> DVec2 {
        if self.transposed { point.yx() } else { point }
    }

    /// Row and column of the cell that contains a point of the scenario.
    pub(super) fn cell_at(&self, point: DVec2) -> (usize, usize) {
        let DVec2 { x, y } = self.swap_axes(point);
        let index = |at: f64, origin: f64, count: usize| {
            (((at - origin) / self.cell_m).max(0.0) as usize).min(count - 1)
        };
        (index(y, self.origin.y, self.rows), index(x, self.origin.x, self.columns))
    }

    /// Centre of a cell, in the scenario's axes.
    pub(super) fn centre(&self, row: usize, column: usize) -> DVec2 {
        self.swap_axes(dvec2(self.origin.x + (column as f64 + 0.5) * self.cell_m, self.y(row)))
    }

    fn y(&self, row: usize) -> f64 {
        self.origin.y + (row as f64 + 0.5) * self.cell_m
    }

    /// First column whose centre is greater than `x`.
    fn column_beyond(&self, x: f64) -> usize {
        (((x - self.origin.x) / self.cell_m - 0.5).floor() + 1.0).clamp(0.0, self.columns as f64) as usize
    }

    /// First column whose centre is at least `x`.
    fn column_from(&self, x: f64) -> usize {
        ((x - self.origin.x) / self.cell_m - 0.5).ceil().clamp(0.0, self.columns as f64) as usize
    }
}

/// A set of cells of a grid, one bit per cell.
pub(crate) struct BlockedCells<'a> {
    grid: &'a CellGrid,
    words_per_row: usize,
    bits: Vec<u64>,
}

impl<'a> BlockedCells<'a> {
    /// The empty set.
    pub(super) fn empty(grid: &'a CellGrid) -> Self {
        let words_per_row = grid.columns.div_ceil(64);
        Self { grid, words_per_row, bits: vec![0; words_per_row * grid.rows] }
    }

    /// Adds the cells whose centres are outside the polygon with these corners.
    pub(super) fn set_outside(&mut self, corners: &[DVec2]) {
        let corners: Vec<DVec2> = corners.iter().map(|&corner| self.grid.swap_axes(corner)).collect();
        let mut crossings = Vec::new();
        for row in 0..self.grid.rows {
            let y = self.grid.y(row);
            crossings.clear();
            crossings.extend(sides(&corners).filter_map(|(from, to)| crossing(from, to, y)));
            crossings.sort_by(f64::total_cmp);
            let mut column = 0;
            for pair in crossings.chunks_exact(2) {
                self.set(row, column, self.grid.column_from(pair[0]));
                column = self.grid.column_beyond(pair[1]);
            }
            self.set(row, column, self.grid.columns);
        }
    }

    /// Adds the cells whose centres are closer than `margin` to the convex hull of `points`, listed in order around it.
    pub(super) fn set_near(&mut self, points: &[DVec2], margin: f64) {
        let points: Vec<DVec2> = points.iter().map(|&point| self.grid.swap_axes(point)).collect();
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for point in &points {
            (low, high) = (low.min(point.y), high.max(point.y));
        }
        // This area is bounded by arcs about the points and by the sides, shifted outwards. Whether that is to the left or to
        // the right depends on the order of the points, so both shifts are used; a side shifted inwards stays within the area.
        let mut moved = Vec::with_capacity(2 * points.len());
        for (a, b) in sides(&points) {
            let length = a.distance(b);
            if length > 0.0 {
                let shift = dvec2((b.y - a.y) / length * margin, (a.x - b.x) / length * margin);
                moved.push((a + shift, b + shift));
                moved.push((a - shift, b - shift));
            }
        }
        let row_of = |y: f64| ((y - self.grid.origin.y) / self.grid.cell_m).clamp(0.0, self.grid.rows as f64);
        for row in row_of(low - margin) as usize..row_of(high + margin).ceil() as usize {
            let y = self.grid.y(row);
            let (mut from, mut to) = (f64::INFINITY, f64::NEG_INFINITY);
            for point in &points {
                let square = margin * margin - (y - point.y) * (y - point.y);
                if square > 0.0 {
                    let half = square.sqrt();
                    (from, to) = (from.min(point.x - half), to.max(point.x + half));
                }
            }
            for &(a, b) in &moved {
                if let Some(x) = crossing(a, b, y) {
                    (from, to) = (from.min(x), to.max(x));
                }
            }
            if from < to {
                self.set(row, self.grid.column_beyond(from), self.grid.column_from(to));
            }
        }
    }

    /// Adds the cells whose centres are outside a box.
    pub(super) fn set_outside_box(&mut self, low: DVec2, high: DVec2) {
        let (low, high) = (self.grid.swap_axes(low), self.grid.swap_axes(high));
        for row in 0..self.grid.rows {
            let y = self.grid.y(row);
            if y < low.y || y > high.y {
                self.set(row, 0, self.grid.columns);
            } else {
                self.set(row, 0, self.grid.column_from(low.x));
                self.set(row, self.grid.column_beyond(high.x), self.grid.columns);
            }
        }
    }

    /// Adds the columns from `from` up to, but not including, `to` of a row.
    fn set(&mut self, row: usize, from: usize, to: usize) {
        if from >= to {
            return;
        }
        let row = &mut self.bits[row * self.words_per_row..][..self.words_per_row];
        let (first, last) = (from / 64, (to - 1) / 64);
        let (head, tail) = (u64::MAX << (from % 64), u64::MAX >> (63 - (to - 1) % 64));
        if first == last {
            row[first] |= head & tail;
        } else {
            row[first] |= head;
            row[first + 1..last].fill(u64::MAX);
            row[last] |= tail;
        }
    }

    /// The free runs of a row, as half-open ranges of columns.
    pub(super) fn free_runs(&self, row: usize) -> impl Iterator<Item = (usize, usize)> {
        let mut column = 0;
        std::iter::from_fn(move || {
            let from = self.next(row, column, false);
            let to = self.next(row, from, true);
            column = to;
            (from < to).then_some((from, to))
        })
    }

    /// First column from `column` on whose bit equals `set`, or the number of columns.
    fn next(&self, row: usize, column: usize, set: bool) -> usize {
        let words = &self.bits[row * self.words_per_row..][..self.words_per_row];
        let mut word = column / 64;
        let mut ahead = u64::MAX << (column % 64);
        while word < words.len() {
            let found = (if set { words[word] } else { !words[word] }) & ahead;
            if found != 0 {
                return (word * 64 + found.trailing_zeros() as usize).min(self.grid.columns);
            }
            ahead = u64::MAX;
            word += 1;
        }
        self.grid.columns
    }

    /// The rows of the grid.
    pub(super) fn rows(&self) -> std::ops::Range<usize> {
        0..self.grid.rows
    }
}

/// The x coordinate at which a side crosses the height `y`, if it does.
fn crossing(from: DVec2, to: DVec2, y: f64) -> Option<f64> {
    ((from.y > y) != (to.y > y)).then(|| from.x + (y - from.y) / (to.y - from.y) * (to.x - from.x))
}

/// The free cells, grouped into regions whose cells share sides.
pub(crate) struct ConnectedRegions {
    /// Runs by row: first column, column after the last, and number of the run.
    runs: Vec<Vec<(usize, usize, u32)>>,
    /// For each run, the number of the first run of its region, which is also the number of the region.
    parents: Vec<u32>,
}

impl ConnectedRegions {
    pub(crate) fn of(cells: &BlockedCells<'_>) -> Self {
        let mut regions = Self { runs: Vec::new(), parents: Vec::new() };
        for row in cells.rows() {
            let mut runs: Vec<(usize, usize, u32)> = Vec::new();
            for (from, to) in cells.free_runs(row) {
                runs.push((from, to, regions.parents.len() as u32));
                regions.parents.push(regions.parents.len() as u32);
            }
            let previous = regions.runs.last().cloned().unwrap_or_default();
            let (mut a, mut b) = (0, 0);
            while a < previous.len() && b < runs.len() {
                if previous[a].0 < runs[b].1 && runs[b].0 < previous[a].1 {
                    let (one, other) = (regions.root(previous[a].2), regions.root(runs[b].2));
                    regions.parents[one.max(other) as usize] = one.min(other);
                }
                if previous[a].1 < runs[b].1 { a += 1 } else { b += 1 }
            }
            regions.runs.push(runs);
        }
        // The parent of a run that is not a root has a lower number, so its region is already known.
        for run in 0..regions.parents.len() {
            regions.parents[run] = regions.parents[regions.parents[run] as usize];
        }
        regions
    }

    /// Number of the region that contains a cell, or `None` if the cell is blocked.
    pub(super) fn at(&self, row: usize, column: usize) -> Option<u32> {
        let runs = self.runs.get(row)?;
        let after = runs.partition_point(|run| run.0 <= column);
        let &(_, to, run) = runs.get(after.checked_sub(1)?)?;
        (column < to).then(|| self.parents[run as usize])
    }

    /// Whether the centre of a cell of `region` is closer than `away_m` to `point`.
    pub(crate) fn is_near(&self, grid: &CellGrid, region: u32, point: DVec2, away_m: f64) -> bool {
        let (row, _) = grid.cell_at(point);
        let DVec2 { x, y } = grid.swap_axes(point);
        let reach = (away_m / grid.cell_m).ceil() as usize + 1;
        let rows = row.saturating_sub(reach)..(row + reach + 1).min(grid.rows);
        rows.into_iter().any(|row| {
            let square = away_m * away_m - (y - grid.y(row)) * (y - grid.y(row));
            let half = square.max(0.0).sqrt();
            let (from, to) = (grid.column_beyond(x - half), grid.column_from(x + half));
            let of_region = |run: &&(usize, usize, u32)| self.parents[run.2 as usize] == region;
            self.runs[row].iter().filter(of_region).any(|run| run.0.max(from) < run.1.min(to))
        })
    }

    /// Root of the tree that contains `run`, with path halving.
    fn root(&mut self, mut run: u32) -> u32 {
        while self.parents[run as usize] != run {
            let next = self.parents[run as usize];
            self.parents[run as usize] = self.parents[next as usize];
            run = next;
        }
        run
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grid(width: f64, height: f64) -> CellGrid {
        // Cells of 1 m: 1/32 of the distance that the robot must keep.
        CellGrid::over(DVec2::ZERO, dvec2(width, height), 32.0).expect("not too large")
    }

    /// The cells as text, lowest row first, with `#` for blocked cells.
    fn drawn(cells: &BlockedCells<'_>) -> Vec<String> {
        let row = |row| {
            let mut text = "#".repeat(cells.grid.columns);
            for (from, to) in cells.free_runs(row) {
                text.replace_range(from..to, &".".repeat(to - from));
            }
            text
        };
        cells.rows().map(row).collect()
    }

    #[test]
    fn the_cells_near_a_point_form_a_disc_and_near_a_segment_a_capsule() {
        let grid = grid(9.0, 5.0);
        let mut cells = BlockedCells::empty(&grid);
        cells.set_near(&[dvec2(2.5, 2.5)], 2.1);
        cells.set_near(&[dvec2(7.5, 1.5), dvec2(7.5, 3.5)], 1.1);
        assert_eq!(drawn(&cells), ["..#....#.", ".###..###", "#####.###", ".###..###", "..#....#."]);
    }

    #[test]
    fn a_rotated_square_and_the_outside_of_an_l_are_blocked() {
        let grid = grid(6.0, 5.0);
        let mut cells = BlockedCells::empty(&grid);
        cells.set_near(&[dvec2(3.0, 0.2), dvec2(5.3, 2.5), dvec2(3.0, 4.8), dvec2(0.7, 2.5)], 0.0);
        assert_eq!(drawn(&cells), ["......", "..##..", ".####.", "..##..", "......"]);
        let mut cells = BlockedCells::empty(&grid);
        cells.set_outside(&[
            dvec2(0.0, 0.0),
            dvec2(6.0, 0.0),
            dvec2(6.0, 2.0),
            dvec2(2.0, 2.0),
            dvec2(2.0, 5.0),
            dvec2(0.0, 5.0),
        ]);
        assert_eq!(drawn(&cells), ["......", "......", "..####", "..####", "..####"]);
        let mut cells = BlockedCells::empty(&grid);
        cells.set_outside_box(dvec2(1.0, 1.0), dvec2(4.0, 4.9));
        assert_eq!(drawn(&cells), ["######", "#...##", "#...##", "#...##", "#...##"]);
    }

    #[test]
    fn regions_connect_through_sides_but_not_through_corners() {
        let grid = grid(130.0, 3.0);
        let mut cells = BlockedCells::empty(&grid);
        // A wall with a gap in row 2, and two cells that touch only at a corner.
        cells.set(0, 70, 71);
        cells.set(1, 70, 71);
        cells.set(0, 128, 129);
        cells.set(1, 129, 130);
        let regions = ConnectedRegions::of(&cells);
        assert_eq!(regions.at(0, 0), regions.at(0, 127), "through the gap in row 2");
        assert_eq!(regions.at(0, 70), None);
        assert!(regions.at(0, 129).is_some());
        assert_ne!(regions.at(0, 129), regions.at(0, 0), "a corner does not connect");
        assert_eq!(regions.at(2, 129), regions.at(0, 0));
    }

    #[test]
    fn a_tall_box_has_rows_along_y_and_keeps_its_points() {
        let grid = grid(3.0, 130.0);
        assert_eq!((grid.rows, grid.columns), (3, 130));
        let (row, column) = grid.cell_at(dvec2(2.2, 77.9));
        assert_eq!((row, column), (2, 77));
        assert_eq!(grid.centre(row, column), dvec2(2.5, 77.5));
        assert!(
            CellGrid::over(dvec2(0.0, 0.0), dvec2(1000.0, 1000.0), 0.13).is_none(),
            "cells of 1 m are too coarse"
        );
    }
}
