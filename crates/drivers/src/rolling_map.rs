//! A map that is built from scans: an occupancy grid that moves with the robot.
//!
//! The frame of the map is the robot's pose at the start of the episode; odometry tracks the robot in it. A cell in which a beam
//! ends becomes occupied; a few beams that pass through it clear it again. Unknown cells count as free. The map keeps the cells
//! around the robot and forgets the others.

use glam::{IVec2, Vec2, ivec2};

use crate::dwa::MovingPoint;
use crate::grid::{Grid, MAX_CELLS};
use crate::path_search::{PathSearch, TOO_CLOSE, path_cost, straight_cost};
use crate::percept::{Odometry, Percept};
use crate::planned::{Map, closeness_cost};
use crate::robot::Robot;

/// The evidence that a hit adds to a cell, and the most that a cell holds. A beam that passes takes 1 away.
const HIT: u8 = 3;
const MAX_EVIDENCE: u8 = 6;
/// The largest side of a cell, in keep-out distances. Between larger cells there is no way around anything, and no point of a path
/// is near the robot. Where more than [`MAX_CELLS`] of them would be needed, the map is smaller than the LIDAR's reach.
const MAX_CELL: f32 = 4.0;

/// A cell of the map.
#[derive(Clone, Copy)]
struct Cell {
    /// Its column and row in the unbounded plane. Cells that are a multiple of `side` apart share a slot.
    at: IVec2,
    /// It is occupied if this is above 0.
    evidence: u8,
}

/// The map.
pub(crate) struct RollingMap {
    robot: Robot,
    /// What a scan shows up to this distance is in the map, in m: the LIDAR's range, unless that is too long for the map.
    reach_m: f32,
    cell_m: f32,
    /// The number of columns, and of rows.
    side: i32,
    cells: Vec<Cell>,
    /// The robot's pose.
    pose: Odometry,
    /// The extra costs around an occupied cell, by offset.
    stamp: Vec<(IVec2, u16)>,
    /// The grid around the robot at the last [`RollingMap::make_costs`], and the extra costs of its cells.
    window: Grid,
    costs: Vec<u16>,
    search: PathSearch,
}

impl RollingMap {
    /// An empty map. The side of a cell is `cell` keep-out distances (2 at most), or up to [`MAX_CELL`] where there would be too
    /// many cells. Where possible, paths keep another `margin` keep-out distances beyond the keep-out distance.
    pub(crate) fn new(robot: &Robot, cell: f32, margin: f32) -> Self {
        let most_m = MAX_CELL * robot.unit_m * (MAX_CELLS as f32).sqrt();
        let reach_m = robot.max_range_m.min(most_m / 3.0);
        let half_m = 1.5 * reach_m;
        let wanted_m = cell * robot.unit_m;
        let cell_m = wanted_m.max(2.0 * half_m / (MAX_CELLS as f32).sqrt());
        let side = ((2.0 * half_m / cell_m).ceil() as i32).max(1);
        let nothing = Cell { at: IVec2::MAX, evidence: 0 };
        let window = Grid { min_m: Vec2::ZERO, cell_m, columns: side as usize, rows: side as usize };
        Self {
            robot: robot.clone(),
            reach_m,
            cell_m,
            side,
            cells: vec![nothing; window.len()],
            pose: Odometry::default(),
            stamp: stamp(robot.unit_m, margin * robot.unit_m, cell_m),
            window,
            costs: vec![0; window.len()],
            search: PathSearch::default(),
        }
    }

    /// The cell of a point.
    fn at(&self, point_m: Vec2) -> IVec2 {
        // This is what `floor` gives. Without SSE4.1, that would be two calls of a function for each cell that a beam crosses.
        let point = point_m / self.cell_m;
        let truncated = point.as_ivec2();
        let is_below =
            ivec2(i32::from(point.x < truncated.x as f32), i32::from(point.y < truncated.y as f32));
        truncated.saturating_sub(is_below)
    }

    /// The slot of the cell `at`: its index in `cells`.
    fn slot(&self, at: IVec2) -> usize {
        (at.y.rem_euclid(self.side) * self.side + at.x.rem_euclid(self.side)) as usize
    }

    fn hit(&mut self, at: IVec2) {
        let slot = self.slot(at);
        let cell = &mut self.cells[slot];
        if cell.at != at {
            *cell = Cell { at, evidence: 0 };
        }
        cell.evidence = (cell.evidence + HIT).min(MAX_EVIDENCE);
    }

    fn pass(&mut self, at: IVec2) {
        let slot = self.slot(at);
        let cell = &mut self.cells[slot];
        if cell.at == at {
            cell.evidence = cell.evidence.saturating_sub(1);
        }
    }

    /// Adds a scan to the map.
    fn add_scan(&mut self, ranges_m: &[f32]) {
        let from = self.pose.translation_m;
        for (index, &range_m) in ranges_m.iter().enumerate().take(self.robot.beams.len()) {
            let range_m = range_m.min(self.reach_m);
            let beam = self.pose.to_outer(self.robot.beams[index]) - from;
            let end = self.at(from + beam * range_m);
            let mut last = end;
            for k in 1..(range_m / self.cell_m) as usize {
                let at = self.at(from + beam * (k as f32 * self.cell_m));
                if at != end && at != last {
                    self.pass(at);
                    last = at;
                }
            }
            if range_m < self.reach_m {
                self.hit(end);
            }
        }
    }

    /// The occupied cells around the robot.
    fn occupied(&self) -> impl Iterator<Item = IVec2> + '_ {
        let (centre, half) = (self.at(self.pose.translation_m), self.side / 2);
        let is_near = move |at: IVec2| (at.x - centre.x).abs() <= half && (at.y - centre.y).abs() <= half;
        self.cells.iter().filter(move |cell| cell.evidence > 0 && is_near(cell.at)).map(|cell| cell.at)
    }

    /// The cheapest path in the window of the last [`RollingMap::make_costs`], as the centres of its cells.
    pub(crate) fn cheapest_path(&mut self, from_m: Vec2, to_m: Vec2) -> Vec<Vec2> {
        let (from, to) = (self.window.cell(from_m), self.window.cell(to_m));
        let path = self.search.cheapest_path(self.window.columns, &self.costs, from, to);
        path.into_iter().map(|cell| self.window.centre_m(cell)).collect()
    }

    /// Continues `path` to `to_m` along the cheapest path, if it ends in the window of the last [`RollingMap::make_costs`].
    pub(crate) fn continue_path(&mut self, path: &mut Vec<Vec2>, to_m: Vec2) {
        if let Some(end) = path.last().copied().filter(|end| self.window.contains(*end)) {
            path.extend(&self.cheapest_path(end, to_m)[1..]);
        }
    }

    /// The cost of `path`, plus the costs of the straight lines from `at_m` to its first point and from its last point to `to_m`
    /// as if nothing were there. A path to a point outside the window ends at the edge of the window in which it was planned.
    pub(crate) fn path_cost(&self, at_m: Vec2, path: &[Vec2], to_m: Vec2) -> u32 {
        let columns = self.window.columns;
        let cells = path.iter().map(|point| self.window.cell(*point));
        let inside = path_cost(columns, &self.costs, cells);
        let straight = |from_m: Vec2, to_m: Vec2| straight_cost(self.at(from_m), self.at(to_m));
        let start = path.first().map_or(0, |first| straight(at_m, *first));
        let end = path.last().map_or(0, |last| straight(*last, to_m));
        start.saturating_add(inside).saturating_add(end)
    }

    /// Whether the straight line from `from_m`, the robot's position, to `to_m` passes only through cells with extra costs of at
    /// most `max_cost`. Costlier cells at its start, within the keep-out distance of the robot, are ignored; so is everything
    /// outside the window.
    pub(crate) fn is_clear(&self, from_m: Vec2, to_m: Vec2, max_cost: u16) -> bool {
        let line = to_m - from_m;
        let samples = (2.0 * line.length() / self.cell_m).ceil().clamp(1.0, MAX_CELLS as f32);
        let mut is_leaving = true;
        (0..=samples as usize).all(|k| {
            let step = line * (k as f32 / samples);
            let at_m = from_m + step;
            if !self.window.contains(at_m) || self.costs[self.window.cell(at_m)] <= max_cost {
                is_leaving = false;
                return true;
            }
            is_leaving && step.length() <= self.robot.unit_m
        })
    }

    /// Moves the window to the robot, and computes the extra costs of its cells.
    pub(crate) fn make_costs(&mut self) {
        let low = self.at(self.pose.translation_m) - self.side / 2;
        self.window.min_m = low.as_vec2() * self.cell_m;
        let mut costs = std::mem::take(&mut self.costs);
        costs.fill(0);
        for occupied in self.occupied() {
            for (offset, cost) in &self.stamp {
                let at = occupied - low + *offset;
                if (0..self.side).contains(&at.x) && (0..self.side).contains(&at.y) {
                    let cell = &mut costs[(at.y * self.side + at.x) as usize];
                    *cell = (*cell).max(*cost);
                }
            }
        }
        self.costs = costs;
    }
}

/// The extra costs around an occupied cell.
fn stamp(keep_out_m: f32, margin_m: f32, cell_m: f32) -> Vec<(IVec2, u16)> {
    let reach = ((keep_out_m + margin_m) / cell_m).ceil() as i32;
    let all = (-reach..=reach).flat_map(|y| (-reach..=reach).map(move |x| ivec2(x, y)));
    let cost = |offset: IVec2| closeness_cost(offset.as_vec2().length() * cell_m - keep_out_m, margin_m);
    all.map(|offset| (offset, cost(offset))).filter(|(_, cost)| *cost > 0).collect()
}

impl Map for RollingMap {
    fn update(&mut self, percept: &Percept) -> Odometry {
        self.pose = self.pose.then(&percept.odometry);
        self.add_scan(percept.ranges_m);
        self.pose
    }

    fn plan(&mut self, from_m: Vec2, to_m: Vec2) -> Vec<Vec2> {
        self.make_costs();
        self.cheapest_path(from_m, to_m)
    }

    fn sees(&self, from_m: Vec2, to_m: Vec2) -> bool {
        self.window.sees(from_m, to_m, |cell| self.costs[cell] < TOO_CLOSE)
    }

    fn clearance(&self, reach_m: f32) -> impl Fn(Vec2, f32) -> f32 {
        let cells = self.occupied().map(|at| (at.as_vec2() + 0.5) * self.cell_m);
        let points = cells.map(|at_m| self.pose.to_inner(at_m)).filter(move |at| at.length() <= reach_m);
        let points: Vec<MovingPoint> =
            points.map(|at_m| MovingPoint { at_m, velocity_m_s: Vec2::ZERO }).collect();
        move |at_m: Vec2, _: f32| {
            let squared = points.iter().map(|point| (point.at_m - at_m).length_squared());
            squared.fold(f32::INFINITY, f32::min).sqrt()
        }
    }

    fn built(&self) -> (Vec<Vec2>, f32) {
        (self.occupied().map(|at| (at.as_vec2() + 0.5) * self.cell_m).collect(), self.cell_m)
    }
}

#[cfg(test)]
mod tests {
    use glam::vec2;
    use wayfield_scenario::{Motion, Scenario};

    use super::*;

    fn percept<'a>(ranges_m: &'a [f32], odometry: Odometry) -> Percept<'a> {
        Percept {
            ranges_m,
            goal_distance_m: 1.0,
            goal_bearing_rad: 0.0,
            twist: Motion { v_m_s: 0.0, w_rad_s: 0.0 },
            odometry,
            truth: None,
        }
    }

    #[test]
    fn what_was_seen_stays_where_it_was_while_the_robot_drives_and_turns() {
        let robot = Robot::of(&Scenario::default());
        let mut map = RollingMap::new(&robot, 0.34, 1.0);
        let mut ranges_m = [3.5; 24];
        ranges_m[0] = 1.0;
        map.update(&percept(&ranges_m, Odometry::default()));
        let seen = map.at(vec2(1.0, 0.0));
        assert_eq!(map.occupied().collect::<Vec<_>>(), [seen]);
        // The robot drives 0.4 m ahead and turns left by one beam. Now the last beam hits the obstacle, 0.6 m away.
        let moved = Odometry { translation_m: vec2(0.4, 0.0), rotation_rad: std::f32::consts::TAU / 24.0 };
        ranges_m[0] = 3.5;
        ranges_m[23] = 0.6;
        map.update(&percept(&ranges_m, moved));
        assert_ne!(map.occupied().count(), 0, "the obstacle is still in the map");
        for at in map.occupied() {
            assert!((at - seen).abs().max_element() <= 1, "{at} is not near {seen}");
        }
        // The obstacle is gone: beams that pass through the cell clear it.
        ranges_m[23] = 3.5;
        for _ in 0..8 {
            map.update(&percept(&ranges_m, Odometry::default()));
        }
        assert_eq!(map.occupied().count(), 0);
    }

    #[test]
    fn a_path_to_a_goal_outside_the_window_costs_as_much_as_the_rest_of_an_earlier_one() {
        let mut map = RollingMap::new(&Robot::of(&Scenario::default()), 0.34, 1.0);
        let (goal_m, at_m) = (vec2(8.0, 0.0), vec2(1.0, 0.0));
        map.update(&percept(&[3.5; 24], Odometry::default()));
        map.make_costs();
        let mut earlier = map.cheapest_path(Vec2::ZERO, goal_m);
        assert!(
            earlier.last().is_some_and(|end| end.x < 6.0),
            "it ends at the edge of the window: {earlier:?}"
        );
        map.update(&percept(&[3.5; 24], Odometry { translation_m: at_m, rotation_rad: 0.0 }));
        map.make_costs();
        let found = map.cheapest_path(at_m, goal_m);
        earlier.retain(|point| point.x >= found[0].x);
        assert!(found.last() != earlier.last(), "the window has moved");
        assert_eq!(map.path_cost(at_m, &found, goal_m), map.path_cost(at_m, &earlier, goal_m));
    }
}
