//! The floor: the cells that the robot can reach, and the free cells around them.
//!
//! In: the free cells of a map. Out: the part of them that the scenario keeps, and two ends of it that are far apart. Rooms that
//! the robot cannot enter are left out, because a goal in them could never be reached.

use std::collections::VecDeque;

use crate::grid::{Cell, Grid};

/// A clearance is chosen if at least this fraction of the reachable positions has it.
const ROOMY_FRACTION: f64 = 0.2;

/// The smallest clearance of starts and goals, in keep-out distances: the robot has 10 % to spare.
pub const MIN_CLEARANCE: f64 = 1.1;

/// What the robot needs, in cells.
#[derive(Clone, Copy, Debug)]
pub struct Margins {
    /// The robot's keep-out distance ([`wayfield_scenario::Scenario::keep_out_m`]).
    pub keep_out: f64,
    /// The usual clearance of starts and goals.
    pub clearance: f64,
}

/// The floor of a map.
#[derive(Clone, Debug)]
pub struct Floor {
    /// The cells that the scenario keeps free.
    pub cells: Grid<bool>,
    /// The clearance for starts and goals, in cells. At most the usual one; smaller where corridors are narrow.
    pub clearance: f64,
    /// Two positions that keep the clearance and are about as far apart as any two, found by two breadth-first searches.
    pub ends: (Cell, Cell),
    /// Length of the shortest path between them, in steps between cells that share a side.
    pub longest_path: usize,
}

impl Floor {
    /// The floor of a map with the free cells `free`. The cells where the robot's centre fits form connected sets. The floor
    /// consists of the set with the most cells between the corners `low` and `high` (exclusive), and the free cells around it.
    /// `None` if the robot fits nowhere, or nowhere with 10 % to spare.
    pub fn new(free: &Grid<bool>, margins: Margins, (low, high): (Cell, Cell)) -> Option<Self> {
        let distances = free.map(|is_free| !is_free).squared_distances(true);
        // From the centre of a cell to the side of the nearest one that is not free.
        let wall_distance = |cell: Cell| f64::from(distances.at(cell)).sqrt() - 0.5;
        let mut centres = Grid::filled(free.columns, free.rows, false);
        for cell in free.members() {
            centres.set(cell, wall_distance(cell) > margins.keep_out);
        }
        let (labels, sizes) = centres.components();
        let mut counts = vec![0_usize; sizes.len()];
        for row in low.1..high.1 {
            for cell in (low.0..high.0).map(|column| (column, row)).filter(|&cell| centres.at(cell)) {
                counts[labels.at(cell) as usize] += 1;
            }
        }
        let most = |&part: &usize| (counts[part], sizes[part], usize::MAX - part);
        let part = (0..counts.len()).max_by_key(most)? as u32;
        let centres = labels.map(|label| label == part);
        let wall_distances: Vec<f64> = centres.members().map(wall_distance).collect();
        let clearance = clearance(&wall_distances, margins);
        let cells = widened(free, centres.clone(), (clearance / 1.12).floor() as usize);
        let is_roomy = |cell: &Cell| wall_distance(*cell) > clearance;
        let (one, _) = farthest(&centres, centres.members().find(is_roomy)?, is_roomy);
        let (other, longest_path) = farthest(&centres, one, is_roomy);
        Some(Self { cells, clearance, ends: (one, other), longest_path })
    }
}

/// Tries a few clearances and returns the largest one that enough positions have, or else the smallest one. `wall_distances`
/// holds each position's distance from the nearest cell that is not free.
fn clearance(wall_distances: &[f64], Margins { keep_out, clearance }: Margins) -> f64 {
    let fraction = |least: f64| {
        wall_distances.iter().filter(|&&distance| distance > least).count() as f64
            / wall_distances.len() as f64
    };
    let smaller = [1.8, 1.5, 1.25].map(|factor| factor * keep_out).into_iter();
    let mut choices = std::iter::once(clearance).chain(smaller.filter(|&smaller| smaller < clearance));
    choices.find(|&least| fraction(least) >= ROOMY_FRACTION).unwrap_or(MIN_CLEARANCE * keep_out)
}

/// The cells of `free` that are at most `steps` steps from the cells `from`. Every other step may be diagonal, so that n steps
/// lead at most 1.12 n cells away, and about n on average.
fn widened(free: &Grid<bool>, from: Grid<bool>, steps: usize) -> Grid<bool> {
    let mut cells = from;
    let mut border: Vec<Cell> = cells.members().collect();
    for step in 0..steps {
        let mut next = Vec::new();
        for &(column, row) in &border {
            let diagonal = (step % 2 == 1).then(|| free.around((column, row)));
            let sides = free.neighbours((column, row));
            for cell in sides.chain(diagonal.into_iter().flatten()).filter(|&cell| free.at(cell)) {
                if !cells.at(cell) {
                    cells.set(cell, true);
                    next.push(cell);
                }
            }
        }
        border = next;
    }
    cells
}

/// The allowed cell that is farthest from `from` by steps inside the set, with the number of steps.
fn farthest(set: &Grid<bool>, from: Cell, is_allowed: impl Fn(&Cell) -> bool) -> (Cell, usize) {
    let mut seen = Grid::filled(set.columns, set.rows, false);
    let mut queue = VecDeque::from([(from, 0)]);
    seen.set(from, true);
    let mut last = (from, 0);
    while let Some((cell, steps)) = queue.pop_front() {
        if steps > last.1 && is_allowed(&cell) {
            last = (cell, steps);
        }
        for next in set.neighbours(cell).filter(|&next| set.at(next)) {
            if !seen.at(next) {
                seen.set(next, true);
                queue.push_back((next, steps + 1));
            }
        }
    }
    last
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The set of cells marked `.` in rows from the top.
    fn free(rows: &[&str]) -> Grid<bool> {
        let values = rows.iter().rev().flat_map(|row| row.bytes().map(|byte| byte == b'.')).collect();
        Grid { columns: rows[0].len(), rows: rows.len(), values }
    }

    #[test]
    fn a_room_behind_a_narrow_door_is_left_out() {
        let (wall, rooms) = ("#".repeat(38), format!("#{}#{}#", ".".repeat(24), ".".repeat(11)));
        let door = rooms.replace(".#.", "...");
        let mut rows = vec![rooms.as_str(); 22];
        (rows[0], rows[21]) = (&wall, &wall);
        rows[10..13].fill(&door);
        let map = free(&rows);
        let margins = Margins { keep_out: 2.0, clearance: 5.0 };
        let floor = Floor::new(&map, margins, map.corners()).expect("the robot fits");
        assert_eq!(floor.clearance, 5.0);
        assert!(
            floor.cells.at((1, 1)) && floor.cells.at((24, 20)),
            "the large room is floor up to its corners"
        );
        assert!(!floor.cells.at((31, 10)), "the small room is not floor");
        let other = Floor::new(&map, margins, ((26, 0), (38, 22))).expect("the robot fits");
        assert!(
            other.cells.at((36, 20)) && !other.cells.at((3, 3)),
            "only the small room is floor if the corners enclose it"
        );
        assert!(Floor::new(&map, Margins { keep_out: 11.0, clearance: 12.0 }, map.corners()).is_none());
    }

    #[test]
    fn the_clearance_shrinks_in_narrow_corridors() {
        let map = free(&["..........", "..........", "..........", "..........", ".........."]);
        let floor = Floor::new(&map, Margins { keep_out: 1.0, clearance: 4.0 }, map.corners())
            .expect("the robot fits");
        assert_eq!(floor.clearance, 1.8);
        assert_eq!(floor.longest_path, 5, "between columns 2 and 7");
    }
}
