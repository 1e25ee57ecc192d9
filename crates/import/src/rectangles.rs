//! Covers a set of cells with few rectangles.

use crate::grid::{Cell, Grid};

/// Rectangles that together cover the set and nothing else: the lower left and upper right cell of each, the latter exclusive.
/// From each cell not yet covered, two candidates are grown, one along x first and one along y first, and the larger is taken.
pub fn rectangles(set: &Grid<bool>) -> Vec<(Cell, Cell)> {
    let mut open = set.clone();
    let mut found = Vec::new();
    for cell in set.cells() {
        if !open.at(cell) {
            continue;
        }
        let (wide, tall) = (grown(&open, cell, true), grown(&open, cell, false));
        let area = |(right, high): Cell| (right - cell.0) * (high - cell.1);
        let end = if area(wide) >= area(tall) { wide } else { tall };
        for row in cell.1..end.1 {
            (cell.0..end.0).for_each(|column| open.set((column, row), false));
        }
        found.push((cell, end));
    }
    found
}

/// The exclusive upper right cell of a rectangle in the set that is grown from `first`, along x first or along y first.
fn grown(set: &Grid<bool>, first: Cell, along_x: bool) -> Cell {
    let (mut right, mut high) = (first.0 + 1, first.1 + 1);
    for grows_x in [along_x, !along_x] {
        if grows_x {
            while right < set.columns && (first.1..high).all(|row| set.at((right, row))) {
                right += 1;
            }
        } else {
            while high < set.rows && (first.0..right).all(|column| set.at((column, high))) {
                high += 1;
            }
        }
    }
    (right, high)
}

/// The blocks of `side` x `side` cells, cut off at the grid's edge, that lie entirely in the set, as a set of cells.
pub fn whole_blocks(set: &Grid<bool>, side: usize) -> Grid<bool> {
    let mut blocks = Grid::filled(set.columns, set.rows, false);
    for low in (0..set.rows).step_by(side) {
        for left in (0..set.columns).step_by(side) {
            let (right, high) = ((left + side).min(set.columns), (low + side).min(set.rows));
            let cells = || (low..high).flat_map(move |row| (left..right).map(move |column| (column, row)));
            if cells().all(|cell| set.at(cell)) {
                cells().for_each(|cell| blocks.set(cell, true));
            }
        }
    }
    blocks
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn rectangles_cover_the_set_once(
            columns in 1_usize..10, rows in 1_usize..10, bits in proptest::collection::vec(any::<bool>(), 100),
        ) {
            let set = Grid { columns, rows, values: bits[..columns * rows].to_vec() };
            let mut covered = Grid::filled(columns, rows, false);
            for ((left, low), (right, high)) in rectangles(&set) {
                for row in low..high {
                    for column in left..right {
                        prop_assert!(!covered.at((column, row)), "twice");
                        covered.set((column, row), true);
                    }
                }
            }
            prop_assert_eq!(covered, set);
        }
    }

    #[test]
    fn an_l_is_two_rectangles() {
        let set = Grid { columns: 3, rows: 2, values: vec![true, true, true, true, false, false] };
        assert_eq!(rectangles(&set), [((0, 0), (3, 1)), ((0, 1), (1, 2))]);
    }
}
