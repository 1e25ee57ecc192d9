//! The length of the shortest path to a goal around walls and static obstacles, from anywhere.
//!
//! Source: A. Nash, S. Koenig and C. Tovey, *Lazy Theta\*: any-angle path planning and path length analysis in 3D*, AAAI 2010,
//! here without a heuristic, from the goal outwards, only as far as queries need. A path is a chain of straight lines between
//! centres of cells, or just the straight line to the goal where that is free.

use std::sync::Arc;

use super::Vec2;
use super::free_cells::{Cell, FreeCells};
use glam::vec2;

/// The goal, in place of the index of a cell.
const GOAL: u32 = u32::MAX;
/// The difference of lengths, in cells, below which the order of cells does not matter.
const BUCKET: f32 = 0.25;

/// The lengths of the shortest paths to a goal, computed only as far as queries need. A result depends on the cells, the goal
/// and the point, not on earlier queries.
#[derive(Debug, Default)]
pub struct Geodesic {
    free: Option<Arc<FreeCells>>,
    goal_m: Vec2,
    /// The goal's position, in cells.
    goal: Vec2,
    /// The length of the path from each cell, in cells.
    lengths: Vec<f32>,
    /// Where the path from each cell leads first, in a straight line: a cell or the goal.
    bends: Vec<u32>,
    /// Whether length and bend of a cell are final.
    settled: Vec<bool>,
    /// Free cells next to settled ones, by length.
    open: Queue,
    /// Occupied cells next to settled ones. They are used only if nothing is left in `open`: a path into a closed-off area
    /// breaks through a wall where it is thinnest.
    walls: Queue,
}

/// Cells by length, in buckets of width [`BUCKET`]. In a bucket, the last one added comes first.
#[derive(Debug, Default)]
struct Queue {
    buckets: Vec<Vec<u32>>,
    /// No bucket before this index has cells.
    first: usize,
}

impl Queue {
    fn clear(&mut self) {
        self.buckets.iter_mut().for_each(Vec::clear);
        self.first = 0;
    }

    fn push(&mut self, length: f32, cell: usize) {
        let bucket = (length / BUCKET) as usize;
        if bucket >= self.buckets.len() {
            self.buckets.resize_with(bucket + 1, Vec::new);
        }
        self.buckets[bucket].push(cell as u32);
        self.first = self.first.min(bucket);
    }

    fn pop(&mut self) -> Option<usize> {
        while let Some(bucket) = self.buckets.get_mut(self.first) {
            if let Some(cell) = bucket.pop() {
                return Some(cell as usize);
            }
            self.first += 1;
        }
        None
    }
}

impl Geodesic {
    /// The length, in m, of the shortest path from `from_m` to `goal_m` over `free`, for the robot's centre. Never less than the
    /// straight-line distance, and equal to it if all free cells around `from_m` see the goal. If walls close off the goal, the
    /// path breaks through them. If no cell is free, the length is the straight-line distance.
    pub fn distance_m(&mut self, free: &Arc<FreeCells>, goal_m: Vec2, from_m: Vec2) -> f32 {
        let is_current = self.free.as_ref().is_some_and(|current| Arc::ptr_eq(current, free));
        if !is_current || self.goal_m != goal_m {
            self.aim(free, goal_m);
        }
        let line = goal_m - from_m;
        let straight_m = libm::hypotf(line.x, line.y);
        self.around(free, free.position(from_m))
            .map_or(straight_m, |length| straight_m.max(length * free.cell_m))
    }

    /// Forgets all lengths, and starts from another goal.
    fn aim(&mut self, free: &Arc<FreeCells>, goal_m: Vec2) {
        (self.free, self.goal_m, self.goal) = (Some(free.clone()), goal_m, free.position(goal_m));
        self.lengths.clear();
        self.lengths.resize(free.cells.len(), f32::INFINITY);
        self.bends.clear();
        self.bends.resize(free.cells.len(), GOAL);
        self.settled.clear();
        self.settled.extend(free.cells.iter().map(|cell| *cell == Cell::Border));
        self.open.clear();
        self.walls.clear();
        if let Some(first) = free.nearest_free(self.goal) {
            self.lengths[first] = free.centre(first).distance(self.goal);
            self.open.push(self.lengths[first], first);
        }
    }

    /// The length of the path from a position, in cells: the mean of [`Self::through`] over the free ones of the four cells
    /// around the position, with bilinear weights, so that the length has no jumps. If none of the four is free, the length
    /// through the nearest free cell. `None` if all free ones of the four see the goal, or no cell is free.
    fn around(&mut self, free: &FreeCells, from: Vec2) -> Option<f32> {
        let low = (from - 0.5).floor();
        let part = from - 0.5 - low;
        let first = free.cell_at(low);
        let (mut sum, mut weights, mut is_straight) = (0.0, 0.0, true);
        for (cell, weight) in [
            (first, (1.0 - part.x) * (1.0 - part.y)),
            (first + 1, part.x * (1.0 - part.y)),
            (first + free.columns, (1.0 - part.x) * part.y),
            (first + free.columns + 1, part.x * part.y),
        ] {
            if weight > 0.0 && free.is_free(cell) {
                sum += weight * self.through(free, cell, from);
                weights += weight;
                is_straight &= self.bends[cell] == GOAL;
            }
        }
        if weights > 0.0 {
            return (!is_straight).then_some(sum / weights);
        }
        free.nearest_free(from).map(|cell| self.through(free, cell, from))
    }

    /// The length of the path from a position via the bend of `cell`, in cells.
    fn through(&mut self, free: &FreeCells, cell: usize, from: Vec2) -> f32 {
        while !self.settled[cell] && self.settle_next(free) {}
        let (bend, length) = self.end_of_line(free, self.bends[cell]);
        length + bend.distance(from)
    }

    /// The position of a bend or of the goal, and the length of the path from there.
    fn end_of_line(&self, free: &FreeCells, bend: u32) -> (Vec2, f32) {
        if bend == GOAL {
            (self.goal, 0.0)
        } else {
            (free.centre(bend as usize), self.lengths[bend as usize])
        }
    }

    /// Makes the length of the next cell final. Returns false if all are.
    fn settle_next(&mut self, free: &FreeCells) -> bool {
        let Some(cell) = self.open.pop().or_else(|| self.walls.pop()) else { return false };
        if self.settled[cell] {
            return true;
        }
        let (at, is_free) = (free.centre(cell), free.is_free(cell));
        if is_free && !self.sees_bend(free, cell, at) {
            self.bend_at_neighbour(free, cell);
        }
        self.settled[cell] = true;
        // From an occupied cell, the path continues cell by cell.
        let (bend, (end, length)) = if is_free {
            (self.bends[cell], self.end_of_line(free, self.bends[cell]))
        } else {
            (cell as u32, (at, self.lengths[cell]))
        };
        for (next, step) in neighbours(free, cell) {
            if self.settled[next] {
                continue;
            }
            let is_next_free = free.is_free(next);
            let (bend, candidate) = if is_next_free {
                (bend, length + end.distance(at + step))
            } else {
                (cell as u32, self.lengths[cell] + step.length())
            };
            if candidate < self.lengths[next] {
                (self.lengths[next], self.bends[next]) = (candidate, bend);
                let queue = if is_next_free { &mut self.open } else { &mut self.walls };
                queue.push(candidate, next);
            }
        }
        true
    }

    /// Whether the line from a cell to its bend is free. It counts as free if both neighbours between which it leaves the cell
    /// have the same bend.
    fn sees_bend(&self, free: &FreeCells, cell: usize, at: Vec2) -> bool {
        let bend = self.bends[cell];
        let end = self.end_of_line(free, bend).0;
        let line = end - at;
        let (along_x, along_y) = (line.x.signum() as isize, line.y.signum() as isize * free.columns as isize);
        let side = cell.wrapping_add_signed(if line.x.abs() >= line.y.abs() { along_x } else { along_y });
        let diagonal = cell.wrapping_add_signed(along_x + along_y);
        let has_same = |next: usize| self.settled[next] && free.is_free(next) && self.bends[next] == bend;
        has_same(side) && has_same(diagonal) || free.sees(end, at)
    }

    /// For a cell that does not see its bend: makes its path lead to the settled neighbour through which it is shortest.
    fn bend_at_neighbour(&mut self, free: &FreeCells, cell: usize) {
        let of_neighbour = |(next, step): (usize, Vec2)| (self.lengths[next] + step.length(), next);
        let settled = neighbours(free, cell).filter(|(next, _)| self.settled[*next]).map(of_neighbour);
        let shortest = settled.reduce(|best, other| if other.0 < best.0 { other } else { best });
        if let Some((length, next)) = shortest.filter(|(length, _)| length.is_finite()) {
            (self.lengths[cell], self.bends[cell]) = (length, next as u32);
        }
    }
}

/// The eight neighbours of a cell that is not at the border, and the steps to them.
fn neighbours(free: &FreeCells, cell: usize) -> impl Iterator<Item = (usize, Vec2)> + use<> {
    const STEPS: [(isize, isize); 8] = [(1, 0), (0, 1), (-1, 0), (0, -1), (1, 1), (-1, 1), (-1, -1), (1, -1)];
    let columns = free.columns as isize;
    let step = move |(dx, dy)| (cell.wrapping_add_signed(dy * columns + dx), vec2(dx as f32, dy as f32));
    STEPS.into_iter().map(step)
}
