//! A rectangular array of cells. For a set of cells: its connected components, and the distance of every cell to the set.

/// A rectangular array. Row 0 is the lowest, column 0 the leftmost: x points right, y up.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Grid<T> {
    /// Number of cells along x.
    pub columns: usize,
    /// Number of cells along y.
    pub rows: usize,
    /// The values, row by row from the bottom: rows x columns.
    pub values: Vec<T>,
}

/// Column and row of a cell.
pub type Cell = (usize, usize);

impl<T: Copy> Grid<T> {
    /// A grid in which every cell has the same value.
    pub fn filled(columns: usize, rows: usize, value: T) -> Self {
        Self { columns, rows, values: vec![value; columns * rows] }
    }

    /// The value of a cell, which must exist.
    pub fn at(&self, (column, row): Cell) -> T {
        self.values[row * self.columns + column]
    }

    /// Changes the value of a cell, which must exist.
    pub fn set(&mut self, (column, row): Cell, value: T) {
        self.values[row * self.columns + column] = value;
    }

    /// Every cell, row by row from the bottom.
    pub fn cells(&self) -> impl Iterator<Item = Cell> + use<T> {
        let columns = self.columns;
        (0..self.rows).flat_map(move |row| (0..columns).map(move |column| (column, row)))
    }

    /// The cells that share a side with `cell`.
    pub fn neighbours(&self, (column, row): Cell) -> impl Iterator<Item = Cell> + use<T> {
        let (columns, rows) = (self.columns, self.rows);
        let left = column.checked_sub(1).map(|column| (column, row));
        let right = (column + 1 < columns).then_some((column + 1, row));
        let below = row.checked_sub(1).map(|row| (column, row));
        let above = (row + 1 < rows).then_some((column, row + 1));
        [left, right, below, above].into_iter().flatten()
    }

    /// The cells that share a side or a corner with `cell`, and `cell` itself.
    pub fn around(&self, (column, row): Cell) -> impl Iterator<Item = Cell> + use<T> {
        let (right, high) = ((column + 2).min(self.columns), (row + 2).min(self.rows));
        (row.saturating_sub(1)..high)
            .flat_map(move |row| (column.saturating_sub(1)..right).map(move |column| (column, row)))
    }

    /// The corners of the grid: lower left and upper right, the latter exclusive.
    pub fn corners(&self) -> (Cell, Cell) {
        ((0, 0), (self.columns, self.rows))
    }

    /// The grid with the function `value` applied to every cell.
    pub fn map<U>(&self, value: impl Fn(T) -> U) -> Grid<U> {
        Grid {
            columns: self.columns,
            rows: self.rows,
            values: self.values.iter().map(|&old| value(old)).collect(),
        }
    }
}

impl Grid<bool> {
    /// The cells in the set.
    pub fn members(&self) -> impl Iterator<Item = Cell> + '_ {
        self.cells().filter(|&cell| self.at(cell))
    }

    /// Lower left and upper right corner of the set in cells, the latter exclusive. `None` if the set is empty.
    pub fn bounds(&self) -> Option<(Cell, Cell)> {
        self.members().fold(None, |bounds, (column, row)| {
            let ((left, low), (right, high)) = bounds.unwrap_or(((column, row), (0, 0)));
            Some(((left.min(column), low.min(row)), (right.max(column + 1), high.max(row + 1))))
        })
    }

    /// The connected components of the set: the label of each cell (`u32::MAX` outside the set), and the number of cells by
    /// label. Cells are connected if they share a side.
    pub fn components(&self) -> (Grid<u32>, Vec<usize>) {
        const NONE: u32 = u32::MAX;
        let mut labels = Grid::filled(self.columns, self.rows, NONE);
        let (mut sizes, mut stack) = (Vec::new(), Vec::new());
        for first in self.members() {
            if labels.at(first) != NONE {
                continue;
            }
            let label = sizes.len() as u32;
            sizes.push(0);
            labels.set(first, label);
            stack.push(first);
            while let Some(cell) = stack.pop() {
                sizes[label as usize] += 1;
                for next in self.neighbours(cell).filter(|&next| self.at(next)) {
                    if labels.at(next) == NONE {
                        labels.set(next, label);
                        stack.push(next);
                    }
                }
            }
        }
        (labels, sizes)
    }

    /// The squared distance, in cells, from the centre of each cell to that of the nearest cell in the set. With `outside`, all
    /// cells outside the grid count as part of the set. (Felzenszwalb and Huttenlocher, *Distance transforms of sampled
    /// functions*, 2012.)
    pub fn squared_distances(&self, outside: bool) -> Grid<f32> {
        // A border of one cell stands for all cells outside.
        let (columns, rows) = (self.columns + 2, self.rows + 2);
        let far = (columns * columns + rows * rows) as f32;
        let mut squares = Grid::filled(columns, rows, if outside { 0.0 } else { far });
        for (column, row) in self.cells() {
            squares.set((column + 1, row + 1), if self.at((column, row)) { 0.0 } else { far });
        }
        let (mut line, mut envelope) = (Vec::new(), Envelope::default());
        for column in 0..columns {
            line.clear();
            line.extend((0..rows).map(|row| squares.at((column, row))));
            envelope.transform(&mut line);
            (0..rows).for_each(|row| squares.set((column, row), line[row]));
        }
        for row in squares.values.chunks_exact_mut(columns) {
            envelope.transform(row);
        }
        let mut inner = Grid::filled(self.columns, self.rows, 0.0);
        for (column, row) in self.cells() {
            inner.set((column, row), squares.at((column + 1, row + 1)));
        }
        inner
    }
}

/// The lower envelope of parabolas, one above each cell of a line.
#[derive(Default)]
struct Envelope {
    values: Vec<f32>,
    /// The cells whose parabolas are part of the envelope, and where each part begins.
    parts: Vec<(usize, f32)>,
}

impl Envelope {
    /// Replaces each value by the minimum over all cells of the line: a cell's value plus the squared distance to it.
    fn transform(&mut self, line: &mut [f32]) {
        self.values.clear();
        self.values.extend_from_slice(line);
        self.parts.clear();
        for cell in 0..line.len() {
            let mut begin = f32::NEG_INFINITY;
            while let Some(&(other, start)) = self.parts.last() {
                begin = self.crossing(other, cell);
                if begin > start {
                    break;
                }
                self.parts.pop();
                begin = f32::NEG_INFINITY;
            }
            self.parts.push((cell, begin));
        }
        let mut part = 0;
        for (cell, value) in line.iter_mut().enumerate() {
            while self.parts.get(part + 1).is_some_and(|&(_, begin)| begin < cell as f32) {
                part += 1;
            }
            let centre = self.parts[part].0;
            let offset = cell as f32 - centre as f32;
            *value = offset * offset + self.values[centre];
        }
    }

    /// Where the parabola above `right` falls below that above `left`.
    fn crossing(&self, left: usize, right: usize) -> f32 {
        let height = |cell: usize| f64::from(self.values[cell]) + (cell * cell) as f64;
        ((height(right) - height(left)) / (2 * (right - left)) as f64) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn distances_are_those_to_the_nearest_cell(
            columns in 1_usize..12, rows in 1_usize..12, bits in proptest::collection::vec(any::<bool>(), 144),
        ) {
            let set = Grid { columns, rows, values: bits[..columns * rows].to_vec() };
            let distances = set.squared_distances(false);
            for (x, y) in set.cells() {
                let to = |(column, row): Cell| {
                    column.abs_diff(x).pow(2) + row.abs_diff(y).pow(2)
                };
                if let Some(nearest) = set.members().map(to).min() {
                    prop_assert_eq!(distances.at((x, y)), nearest as f32);
                }
            }
        }
    }

    #[test]
    fn the_outside_is_one_cell_away_from_the_border() {
        let distances = Grid::filled(3, 3, false).squared_distances(true);
        assert_eq!(distances.values, [1.0, 1.0, 1.0, 1.0, 4.0, 1.0, 1.0, 1.0, 1.0]);
    }

    #[test]
    fn cells_that_touch_only_at_a_corner_are_separate_components() {
        let set = Grid { columns: 3, rows: 2, values: vec![true, false, true, false, true, true] };
        let (labels, sizes) = set.components();
        assert_eq!(sizes, [1, 3]);
        assert_ne!(labels.at((0, 0)), labels.at((1, 1)));
        assert_eq!(set.bounds(), Some(((0, 0), (3, 2))));
    }
}
