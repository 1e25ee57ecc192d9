//! A* over a grid: the cheapest path between two cells, by steps to any of the eight neighbours.
//!
//! Source: P. E. Hart, N. J. Nilsson and B. Raphael, *A formal basis for the heuristic determination of minimum cost paths*, IEEE
//! Transactions on Systems Science and Cybernetics 4(2), 1968.
//!
//! A dense grid needs no hashing of nodes, so this is shorter and several times faster than a general graph search.

use std::cmp::Reverse;
use std::collections::BinaryHeap;

use glam::IVec2;

/// The extra cost of a cell that is too close to an obstacle or a wall. It is passable, so that there is a path even if the
/// robot or its goal is in such a cell, but even a long detour is cheaper.
pub(crate) const TOO_CLOSE: u16 = 200;
/// The cost of a horizontal or vertical step, without extra costs.
const SIDE: u32 = 10;
/// The cost of a diagonal step, without extra costs.
const DIAGONAL: u32 = 14;

/// A search for cheapest paths, with buffers that the next search reuses.
#[derive(Default)]
pub(crate) struct PathSearch {
    costs: Vec<u32>,
    parents: Vec<u32>,
    /// The cells to visit, see [`entry`].
    queue: BinaryHeap<Reverse<u64>>,
}

impl PathSearch {
    /// The cheapest path from the cell `from` to the cell `to`, both included, in a grid with `columns` columns. A step costs 10,
    /// or 14 diagonally, times (1 + the entry of the new cell in `extra_costs`). Ties are always broken in the same way.
    pub(crate) fn cheapest_path(
        &mut self,
        columns: usize,
        extra_costs: &[u16],
        from: usize,
        to: usize,
    ) -> Vec<usize> {
        let Self { costs, parents, queue } = self;
        costs.clear();
        costs.resize(extra_costs.len(), u32::MAX);
        parents.clear();
        parents.resize(extra_costs.len(), from as u32);
        queue.clear();
        costs[from] = 0;
        queue.push(entry(estimate(columns, from, to), from));
        while let Some(Reverse(first)) = queue.pop() {
            let cell = first as u32 as usize;
            if cell == to {
                break;
            }
            for (next, step) in neighbours(columns, extra_costs.len(), cell) {
                let cost = costs[cell].saturating_add(step * (1 + u32::from(extra_costs[next])));
                if cost < costs[next] {
                    costs[next] = cost;
                    parents[next] = cell as u32;
                    queue.push(entry(cost + estimate(columns, next, to), next));
                }
            }
        }
        let mut path = vec![to];
        let mut at = to;
        while at != from {
            at = parents[at] as usize;
            path.push(at);
        }
        path.reverse();
        path
    }
}

/// An entry of the queue: the estimated cost of a path through a cell, then the cell, in one number, which is quicker to compare.
fn entry(cost: u32, cell: usize) -> Reverse<u64> {
    Reverse(u64::from(cost) << 32 | cell as u64)
}

/// The cost of `path`, a list of neighbouring cells, as [`PathSearch::cheapest_path`] counts it.
pub(crate) fn path_cost(columns: usize, extra_costs: &[u16], path: impl Iterator<Item = usize>) -> u32 {
    let mut path = path.peekable();
    let mut cost = 0_u32;
    while let Some(from) = path.next() {
        let Some(&to) = path.peek() else { break };
        let step = estimate(columns, from, to);
        cost = cost.saturating_add(step * (1 + u32::from(extra_costs[to])));
    }
    cost
}

/// The cost of the shortest path without extra costs: no path costs less.
fn estimate(columns: usize, from: usize, to: usize) -> u32 {
    let dx = (from % columns).abs_diff(to % columns) as u32;
    let dy = (from / columns).abs_diff(to / columns) as u32;
    free_cost(dx, dy)
}

/// Like [`estimate`], for cells of an unbounded grid.
pub(crate) fn straight_cost(from: IVec2, to: IVec2) -> u32 {
    let limit = u32::MAX / DIAGONAL;
    free_cost(from.x.abs_diff(to.x).min(limit), from.y.abs_diff(to.y).min(limit))
}

/// The cost of a path to a cell `dx` columns and `dy` rows away, without extra costs.
fn free_cost(dx: u32, dy: u32) -> u32 {
    SIDE * dx.abs_diff(dy) + DIAGONAL * dx.min(dy)
}

/// The neighbours of `cell` and the costs of the steps to them.
fn neighbours(columns: usize, cells: usize, cell: usize) -> impl Iterator<Item = (usize, u32)> {
    const STEPS: [(isize, isize, u32); 8] = [
        (1, 0, SIDE),
        (0, 1, SIDE),
        (-1, 0, SIDE),
        (0, -1, SIDE),
        (1, 1, DIAGONAL),
        (-1, 1, DIAGONAL),
        (-1, -1, DIAGONAL),
        (1, -1, DIAGONAL),
    ];
    let (column, row) = (cell % columns, cell / columns);
    let rows = cells / columns;
    STEPS.into_iter().filter_map(move |(dx, dy, cost)| {
        let column = column.checked_add_signed(dx).filter(|column| *column < columns)?;
        let row = row.checked_add_signed(dy).filter(|row| *row < rows)?;
        Some((row * columns + column, cost))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cheapest_path(columns: usize, extra_costs: &[u16], from: usize, to: usize) -> Vec<usize> {
        PathSearch::default().cheapest_path(columns, extra_costs, from, to)
    }

    fn cost(columns: usize, extra_costs: &[u16], path: &[usize]) -> u32 {
        path_cost(columns, extra_costs, path.iter().copied())
    }

    #[test]
    fn the_path_around_a_wall_has_the_cost_worked_out_by_hand() {
        // 5 x 4 cells; a wall in column 2 is open at the top.
        let mut extra = [0; 20];
        let straight = cheapest_path(5, &extra, 0, 4);
        assert_eq!((straight.as_slice(), cost(5, &extra, &straight)), (&[0, 1, 2, 3, 4][..], 40));
        for row in 0..3 {
            extra[row * 5 + 2] = TOO_CLOSE;
        }
        // Up three rows and down again, such as 0 -> 5 -> 11 -> 17 -> 13 -> 9 -> 4: 4 diagonal steps and 2 vertical ones.
        let around = cheapest_path(5, &extra, 0, 4);
        assert!(around.contains(&17), "through the opening: {around:?}");
        assert_eq!(cost(5, &extra, &around), 4 * 14 + 2 * 10, "{around:?}");
    }

    #[test]
    fn a_path_leads_out_of_a_cell_that_is_too_close_and_may_be_a_single_cell() {
        let mut extra = [0; 9];
        (extra[0], extra[1], extra[3]) = (TOO_CLOSE, TOO_CLOSE, TOO_CLOSE);
        assert_eq!(cheapest_path(3, &extra, 0, 8), [0, 4, 8]);
        assert_eq!(cheapest_path(3, &extra, 4, 4), [4]);
    }
}
