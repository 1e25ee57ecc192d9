//! A fine grid over the enclosure: which of its cells are blocked, and which hang together.
//!
//! In: outlines with a margin. Out: [`BlockedCells`] as bits, row by row, and [`ConnectedRegions`]: the free cells in pieces that hang
//! together side by side. All shapes are convex, so that each blocks one interval of a row: the work goes with the
//! number of rows, not of cells.

use glam::{DVec2, Vec2Swizzles, dvec2};

use crate::polygon::sides;

/// About so many cells at most.
const MAX_CELLS: f64 = 1_048_576.0;
/// Cells need not be smaller than this part of the robot's room.
const MIN_CELL_FRACTION: f64 = 1.0 / 32.0;
/// Nor may they be larger than this part: what fits through a gap would be lost between them.
const MAX_CELL_FRACTION: f64 = 1.0 / 2.0;

/// Where the cells are.
pub(super) struct CellGrid {
    origin: DVec2,
    /// The side of a cell, in m.
    pub(super) cell_m: f64,
    columns: usize,
    rows: usize,
    /// Rows go along the longer side of the enclosure: whether that is y.
    turned: bool,
}

impl CellGrid {
    /// A grid over the box between two corners for a robot whose middle needs `room_m` to all sides; none where the box
    /// is so large that cells would be too coarse.
    pub(super) fn over(low: DVec2, high: DVec2, room_m: f64) -> Option<Self> {
        let (width, height) = (high.x - low.x, high.y - low.y);
        let cell_m = (room_m * MIN_CELL_FRACTION).max((width * height / MAX_CELLS).sqrt());
        let turned = height > width;
        let count = |extent: f64| ((extent / cell_m).ceil() as usize).max(1);
        let (columns, rows) =
            if turned { (count(height), count(width)) } else { (count(width), count(height)) };
        let grid = Self { origin: low, cell_m, columns, rows, turned };
        (cell_m <= room_m * MAX_CELL_FRACTION).then(|| Self { origin: grid.along(low), ..grid })
    }

    /// Between the world's axes and the grid's, either way.
    pub(super) fn along(&self, point: DVec2) -> DVec2 {
        if self.turned { point.yx() } else { point }
    }

    /// The row and column of the cell that a point (along the world's axes) lies in.
    pub(super) fn cell_at(&self, point: DVec2) -> (usize, usize) {
        let DVec2 { x, y } = self.along(point);
        let index = |at: f64, origin: f64, count: usize| {
            (((at - origin) / self.cell_m).max(0.0) as usize).min(count - 1)
        };
        (index(y, self.origin.y, self.rows), index(x, self.origin.x, self.columns))
    }

    /// The middle of a cell, along the world's axes.
    pub(super) fn middle(&self, row: usize, column: usize) -> DVec2 {
        self.along(dvec2(self.origin.x + (column as f64 + 0.5) * self.cell_m, self.y(row)))
    }

    fn y(&self, row: usize) -> f64 {
        self.origin.y + (row as f64 + 0.5) * self.cell_m
    }

    /// The first column whose middle is beyond `x`.
    fn column_beyond(&self, x: f64) -> usize {
        (((x - self.origin.x) / self.cell_m - 0.5).floor() + 1.0).clamp(0.0, self.columns as f64) as usize
    }

    /// The first column whose middle is not before `x`.
    fn column_from(&self, x: f64) -> usize {
        ((x - self.origin.x) / self.cell_m - 0.5).ceil().clamp(0.0, self.columns as f64) as usize
    }
}

/// A bit for each cell of a grid.
pub(super) struct BlockedCells<'a> {
    grid: &'a CellGrid,
    words_a_row: usize,
    bits: Vec<u64>,
}

impl<'a> BlockedCells<'a> {
    /// None set.
    pub(super) fn none(grid: &'a CellGrid) -> Self {
        let words_a_row = grid.columns.div_ceil(64);
        Self { grid, words_a_row, bits: vec![0; words_a_row * grid.rows] }
    }

    /// Sets those whose middles lie outside the polygon with these corners.
    pub(super) fn set_outside(&mut self, corners: &[DVec2]) {
        let corners: Vec<DVec2> = corners.iter().map(|&corner| self.grid.along(corner)).collect();
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

    /// Sets those whose middles lie nearer than `margin` to the convex hull of `points`, which are in order around it.
    pub(super) fn set_near(&mut self, points: &[DVec2], margin: f64) {
        let points: Vec<DVec2> = points.iter().map(|&point| self.grid.along(point)).collect();
        let (mut low, mut high) = (f64::INFINITY, f64::NEG_INFINITY);
        for point in &points {
            (low, high) = (low.min(point.y), high.max(point.y));
        }
        // What is so near is bounded by arcs about the points and by the sides, moved out by the margin to both sides.
        let mut moved = Vec::with_capacity(2 * points.len());
        for (a, b) in sides(&points) {
            let long = a.distance(b);
            if long > 0.0 {
                let outwards = dvec2((b.y - a.y) / long * margin, (a.x - b.x) / long * margin);
                moved.push((a + outwards, b + outwards));
                moved.push((a - outwards, b - outwards));
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

    /// Sets those whose middles lie outside a box.
    pub(super) fn set_outside_box(&mut self, low: DVec2, high: DVec2) {
        let (low, high) = (self.grid.along(low), self.grid.along(high));
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

    /// Sets the columns `from` to before `to` of a row.
    fn set(&mut self, row: usize, from: usize, to: usize) {
        if from >= to {
            return;
        }
        let row = &mut self.bits[row * self.words_a_row..][..self.words_a_row];
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

    /// The runs of a row that are not set, as first column and the one after the last.
    pub(super) fn gaps(&self, row: usize) -> impl Iterator<Item = (usize, usize)> {
        let mut column = 0;
        std::iter::from_fn(move || {
            let from = self.next(row, column, false);
            let to = self.next(row, from, true);
            column = to;
            (from < to).then_some((from, to))
        })
    }

    /// The first column from `column` on whose bit is `set`, or the number of columns.
    fn next(&self, row: usize, column: usize, set: bool) -> usize {
        let words = &self.bits[row * self.words_a_row..][..self.words_a_row];
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

    /// The grid's rows.
    pub(super) fn rows(&self) -> std::ops::Range<usize> {
        0..self.grid.rows
    }
}

/// Where a side crosses the height `y`.
fn crossing(from: DVec2, to: DVec2, y: f64) -> Option<f64> {
    ((from.y > y) != (to.y > y)).then(|| from.x + (y - from.y) / (to.y - from.y) * (to.x - from.x))
}

/// The cells that are not set, in pieces that hang together side by side.
pub(super) struct ConnectedRegions {
    /// By rows: first column, the one after the last, and the run's number.
    runs: Vec<Vec<(usize, usize, u32)>>,
    /// For each run the first of its part, which gives the part its number.
    parents: Vec<u32>,
}

impl ConnectedRegions {
    pub(super) fn of(cells: &BlockedCells<'_>) -> Self {
        let mut parts = Self { runs: Vec::new(), parents: Vec::new() };
        for row in cells.rows() {
            let mut runs: Vec<(usize, usize, u32)> = Vec::new();
            for (from, to) in cells.gaps(row) {
                runs.push((from, to, parts.parents.len() as u32));
                parts.parents.push(parts.parents.len() as u32);
            }
            let above = parts.runs.last().cloned().unwrap_or_default();
            let (mut a, mut b) = (0, 0);
            while a < above.len() && b < runs.len() {
                if above[a].0 < runs[b].1 && runs[b].0 < above[a].1 {
                    let (one, other) = (parts.root(above[a].2), parts.root(runs[b].2));
                    parts.parents[one.max(other) as usize] = one.min(other);
                }
                if above[a].1 < runs[b].1 { a += 1 } else { b += 1 }
            }
            parts.runs.push(runs);
        }
        // A run's other one has a lower number, so that it knows its part already.
        for run in 0..parts.parents.len() {
            parts.parents[run] = parts.parents[parts.parents[run] as usize];
        }
        parts
    }

    /// The part that a cell belongs to; none if it is set.
    pub(super) fn at(&self, row: usize, column: usize) -> Option<u32> {
        let runs = self.runs.get(row)?;
        let after = runs.partition_point(|run| run.0 <= column);
        let &(_, to, run) = runs.get(after.checked_sub(1)?)?;
        (column < to).then(|| self.parents[run as usize])
    }

    /// The run that stands for the part that `run` belongs to, as far as is known; the way there gets shorter.
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
        // Cells of 1 m: no finer, since the robot needs 32 m.
        CellGrid::over(DVec2::ZERO, dvec2(width, height), 32.0).expect("not too large")
    }

    /// The cells as text, `#` where they are set, the lowest row first.
    fn drawn(cells: &BlockedCells<'_>) -> Vec<String> {
        let row = |row| {
            let mut text = "#".repeat(cells.grid.columns);
            for (from, to) in cells.gaps(row) {
                text.replace_range(from..to, &".".repeat(to - from));
            }
            text
        };
        cells.rows().map(row).collect()
    }

    #[test]
    fn what_is_near_a_point_is_a_disc_and_near_a_segment_a_rod() {
        let grid = grid(9.0, 5.0);
        let mut cells = BlockedCells::none(&grid);
        cells.set_near(&[dvec2(2.5, 2.5)], 2.1);
        cells.set_near(&[dvec2(7.5, 0.0), dvec2(7.5, 5.0)], 0.6);
        assert_eq!(drawn(&cells), ["..#....#.", ".###...#.", "#####..#.", ".###...#.", "..#....#."]);
    }

    #[test]
    fn a_turned_square_and_the_outside_of_an_l() {
        let grid = grid(6.0, 5.0);
        let mut cells = BlockedCells::none(&grid);
        cells.set_near(&[dvec2(3.0, 0.2), dvec2(5.3, 2.5), dvec2(3.0, 4.8), dvec2(0.7, 2.5)], 0.0);
        assert_eq!(drawn(&cells), ["......", "..##..", ".####.", "..##..", "......"]);
        let mut cells = BlockedCells::none(&grid);
        cells.set_outside(&[
            dvec2(0.0, 0.0),
            dvec2(6.0, 0.0),
            dvec2(6.0, 2.0),
            dvec2(2.0, 2.0),
            dvec2(2.0, 5.0),
            dvec2(0.0, 5.0),
        ]);
        assert_eq!(drawn(&cells), ["......", "......", "..####", "..####", "..####"]);
        let mut cells = BlockedCells::none(&grid);
        cells.set_outside_box(dvec2(1.0, 1.0), dvec2(4.0, 4.9));
        assert_eq!(drawn(&cells), ["######", "#...##", "#...##", "#...##", "#...##"]);
    }

    #[test]
    fn parts_hang_together_by_sides_not_by_corners() {
        let grid = grid(130.0, 3.0);
        let mut cells = BlockedCells::none(&grid);
        // A wall over all rows but for a gap; and a corner that only touches.
        cells.set(0, 70, 71);
        cells.set(1, 70, 71);
        cells.set(0, 128, 129);
        cells.set(1, 129, 130);
        let parts = ConnectedRegions::of(&cells);
        assert_eq!(parts.at(0, 0), parts.at(0, 127), "through the gap in row 2");
        assert_eq!(parts.at(0, 70), None);
        assert!(parts.at(0, 129).is_some());
        assert_ne!(parts.at(0, 129), parts.at(0, 0), "across a corner there is no way");
        assert_eq!(parts.at(2, 129), parts.at(0, 0));
    }

    #[test]
    fn a_tall_box_has_its_rows_upright_and_keeps_its_places() {
        let grid = grid(3.0, 130.0);
        assert_eq!((grid.rows, grid.columns), (3, 130));
        let (row, column) = grid.cell_at(dvec2(2.2, 77.9));
        assert_eq!((row, column), (2, 77));
        assert_eq!(grid.middle(row, column), dvec2(2.5, 77.5));
        assert!(
            CellGrid::over(dvec2(0.0, 0.0), dvec2(1000.0, 1000.0), 0.13).is_none(),
            "cells of 1 m are too coarse"
        );
    }
}
