//! Clutter by the cellular automaton of the BARN dataset (Perille et al. 2020, "Benchmarking Metric Ground Navigation").

use glam::{Vec2, vec2};
use wayfield_random::{Stream, uniform_01};

use super::draft::Draft;
use super::{number, whole};
use crate::schema::{Obstacle, ObstacleMotion, Shape};

/// A cell with at least this many filled neighbours is filled.
const MIN_TO_FILL: usize = 5;
/// A cell with at most this many filled neighbours is emptied.
const MAX_TO_EMPTY: usize = 1;

/// A grid of cells, row by row, in the middle of the field.
struct Cells {
    columns: usize,
    rows: usize,
    filled: Vec<bool>,
}

/// Adds a circle for every filled cell. The regions of free space that contain starts are filled with circles too, except for
/// the largest one.
pub(super) fn add(
    draft: &mut Draft,
    fill: (f32, f32),
    smoothings: (u32, u32),
    cell_m: (f32, f32),
    stream: &mut Stream,
) {
    let (fill, cell_m) = (number(stream, fill), number(stream, cell_m));
    let size = draft.field.max_m - draft.field.min_m;
    let count = |extent: f32| (extent / cell_m * (1.0 + 1e-6)) as usize;
    let mut cells = Cells::random(count(size.x), count(size.y), fill, stream);
    for _ in 0..whole(stream, smoothings) {
        cells.smooth();
    }
    let circle = |cell: usize| Obstacle {
        shape: Shape::Circle { radius_m: cell_m / 2.0 },
        position_m: cells.centre(cell) * cell_m,
        rotation_rad: 0.0,
        motion: ObstacleMotion::Static,
    };
    let (filled, empty): (Vec<usize>, Vec<usize>) =
        (0..cells.filled.len()).partition(|&cell| cells.filled[cell]);
    filled.into_iter().for_each(|cell| draft.add_obstacle(circle(cell)));
    let empty = empty.into_iter().map(circle).collect();
    for plug in draft.floor().plugs(empty, cell_m / 2.0) {
        draft.add_obstacle(plug);
    }
}

impl Cells {
    fn random(columns: usize, rows: usize, fill: f32, stream: &mut Stream) -> Self {
        let filled = (0..columns * rows).map(|_| uniform_01(stream) < fill).collect();
        Self { columns, rows, filled }
    }

    fn smooth(&mut self) {
        let smoothed = |cell| match self.filled_neighbours(cell) {
            MIN_TO_FILL.. => true,
            0..=MAX_TO_EMPTY => false,
            _ => self.filled[cell],
        };
        self.filled = (0..self.filled.len()).map(smoothed).collect();
    }

    /// The number of filled cells among the eight around `cell`. Cells outside the grid are empty.
    fn filled_neighbours(&self, cell: usize) -> usize {
        let (row, column) = (cell / self.columns, cell % self.columns);
        let rows = row.saturating_sub(1)..(row + 2).min(self.rows);
        let columns = || column.saturating_sub(1)..(column + 2).min(self.columns);
        let around = rows.flat_map(|row| columns().map(move |column| row * self.columns + column));
        around.filter(|&other| other != cell && self.filled[other]).count()
    }

    /// The centre of a cell relative to the middle of the grid, in units of the cell side.
    fn centre(&self, cell: usize) -> Vec2 {
        let middle = |index: usize, count: usize| index as f32 + 0.5 - count as f32 / 2.0;
        vec2(middle(cell % self.columns, self.columns), middle(cell / self.columns, self.rows))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn smoothing_fills_crowded_cells_and_empties_isolated_ones() {
        let rows = ["##...", "#.#..", ".#..#", "....."];
        let filled = rows.concat().chars().map(|c| c == '#').collect();
        let mut cells = Cells { columns: 5, rows: 4, filled };
        cells.smooth();
        let drawn: Vec<String> = cells
            .filled
            .chunks(5)
            .map(|row| row.iter().map(|&filled| if filled { '#' } else { '.' }).collect())
            .collect();
        assert_eq!(drawn, ["##...", "###..", ".#...", "....."]);
        assert_eq!(cells.centre(0), vec2(-2.0, -1.5));
        assert_eq!(cells.centre(19), vec2(2.0, 1.5));
    }
}
