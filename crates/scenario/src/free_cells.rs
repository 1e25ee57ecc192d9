//! The space in which a robot can be, as cells of a grid.
//!
//! In: a [`Scenario`]. Out: [`FreeCells`], which depend on its enclosure, walls, static obstacles, robot and collision range
//! alone.

use super::Vec2;
use super::geometry::enclosure_distance;
use super::schema::Scenario;
use super::spatial_index::Part;
use glam::vec2;

/// Side of a cell relative to the robot's smallest distance from surfaces, unless there would be too many cells.
const CELL: f32 = 0.75;
/// Approximate maximum number of cells, without those at the border.
const MAX_CELLS: f32 = 40_000.0;
/// The minimum distance of a free cell's centre from walls, in cells. If it were smaller, paths could pass between the cells
/// of a thin wall.
const MIN_KEPT_CELLS: f32 = 0.75;

/// The cells of a grid, numbered row by row from the lower left. Positions are in cells from the lower left corner. A border
/// of one cell around the enclosure belongs to the grid.
#[derive(Debug)]
pub struct FreeCells {
    /// Lower left corner, in m.
    min_m: Vec2,
    /// Side of a cell, in m.
    pub(super) cell_m: f32,
    pub(super) columns: usize,
    rows: usize,
    pub(super) cells: Vec<Cell>,
}

/// What is in a cell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Cell {
    /// The robot can be at its centre.
    Free,
    /// A wall or a static obstacle is too close.
    Occupied,
    /// It is part of the border.
    Border,
}

impl FreeCells {
    /// The cells of `scenario`. The centre of a free cell is at least about as far from all surfaces as the
    /// robot must be ([`Scenario::sure_collision_m`]).
    #[must_use]
    pub fn new(scenario: &Scenario) -> Self {
        let kept_m = scenario.sure_collision_m().max(scenario.robot.inner_radius_m());
        let (low, high) = scenario.enclosure.bounds_m();
        let size = high - low;
        let cell_m = (CELL * kept_m).max((size.x * size.y / MAX_CELLS).sqrt());
        let count = |length_m: f32| (length_m / cell_m).ceil() as usize + 2;
        let (columns, rows) = (count(size.x), count(size.y));
        let cells = vec![Cell::Border; columns * rows];
        let mut grid = Self { min_m: low - cell_m, cell_m, columns, rows, cells };
        // Unless a cell is larger than `kept_m`, there are free cells in every passage that the robot fits through with a quarter
        // of a cell to spare on both sides.
        grid.fill(scenario, (kept_m - cell_m / 4.0).max(MIN_KEPT_CELLS * cell_m));
        grid
    }

    fn fill(&mut self, scenario: &Scenario, kept_m: f32) {
        for cell in (1..self.rows - 1).flat_map(|row| (1..self.columns - 1).map(move |k| (row, k))) {
            let index = cell.0 * self.columns + cell.1;
            let distance_m = enclosure_distance(&scenario.enclosure, self.centre_m(index));
            self.cells[index] = if distance_m < kept_m { Cell::Occupied } else { Cell::Free };
        }
        for part in Part::static_parts(scenario) {
            let (low, high) = part.bounds_m(scenario);
            let (low, high) = (self.position(low - kept_m), self.position(high + kept_m));
            for row in low.y as usize..=high.y as usize {
                for index in row * self.columns + low.x as usize..=row * self.columns + high.x as usize {
                    let is_free = self.cells[index] == Cell::Free;
                    if is_free && part.distance_m(scenario, self.centre_m(index)) < kept_m {
                        self.cells[index] = Cell::Occupied;
                    }
                }
            }
        }
    }

    /// A point's position. A point outside the enclosure's bounding box counts as the nearest one in it.
    pub(super) fn position(&self, point_m: Vec2) -> Vec2 {
        let high = vec2((self.columns - 1) as f32, (self.rows - 1) as f32);
        ((point_m - self.min_m) / self.cell_m).clamp(Vec2::ONE, high)
    }

    /// The index of the cell at a position.
    pub(super) fn cell_at(&self, position: Vec2) -> usize {
        position.y as usize * self.columns + position.x as usize
    }

    /// The position of a cell's centre.
    pub(super) fn centre(&self, cell: usize) -> Vec2 {
        let (cell, columns) = (cell as u32, self.columns as u32);
        vec2((cell % columns) as f32 + 0.5, (cell / columns) as f32 + 0.5)
    }

    fn centre_m(&self, cell: usize) -> Vec2 {
        self.min_m + self.centre(cell) * self.cell_m
    }

    pub(super) fn is_free(&self, cell: usize) -> bool {
        self.cells[cell] == Cell::Free
    }

    /// Whether the straight line from `from` to `to` leads through free cells, checked at points at most a cell apart. `to` must
    /// be in a free cell. What is in the cell of `from` does not matter.
    pub(super) fn sees(&self, from: Vec2, to: Vec2) -> bool {
        let line = to - from;
        let parts = line.abs().max_element().ceil();
        let (first, step) = (self.cell_at(from), line / parts);
        let mut at = from;
        (1..parts as u32).all(|_| {
            at += step;
            let cell = self.cell_at(at);
            self.is_free(cell) || cell == first
        })
    }

    /// The free cell whose centre is nearest to a position; of equally near ones, the first. `None` if no cell is free.
    pub(super) fn nearest_free(&self, position: Vec2) -> Option<usize> {
        let farthest = (self.columns + self.rows) as f32;
        let last = vec2(self.columns as f32, self.rows as f32) - 1.0;
        let mut reach = 1.0;
        loop {
            let low = (position - reach).max(Vec2::ZERO);
            let high = (position + reach).min(last);
            let row = |row: usize| {
                (low.x as usize..=high.x as usize).map(move |column| row * self.columns + column)
            };
            let near = (low.y as usize..=high.y as usize).flat_map(row).filter(|&cell| self.is_free(cell));
            let distances = near.map(|cell| (self.centre(cell).distance(position), cell));
            let nearest = distances.reduce(|best, other| if other.0 < best.0 { other } else { best });
            if nearest.is_some_and(|(distance, _)| distance <= reach) || reach > farthest {
                return nearest.map(|(_, cell)| cell);
            }
            reach *= 2.0;
        }
    }
}
