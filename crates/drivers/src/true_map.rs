//! A map of the true scenario: the clearance of its static parts on a grid, and the exact poses of its moving obstacles.
//! Pedestrians are assumed to keep their velocities.

use glam::Vec2;
use wayfield_scenario::{
    Obstacle, ObstacleMotion, Scenario, Wall, enclosure_distance, pose_at, shape_distance,
};

use crate::config::PlannerParameters;
use crate::grid::Grid;
use crate::path_search::{PathSearch, TOO_CLOSE};
use crate::percept::{Odometry, Percept};
use crate::planned::{Map, closeness_cost};
use crate::robot::Robot;

/// The map of an episode. It is empty until the first percept with a `truth`.
pub(crate) struct TrueMap {
    keep_out_m: f32,
    margin_m: f32,
    cell_m: f32,
    period_s: f32,
    grid: Grid,
    /// Clearance of the static parts at the centre of each cell, in m, at most `reach_m`.
    clearances_m: Vec<f32>,
    reach_m: f32,
    /// The obstacles of the scenario that the map shows. The user of the app may move one during an episode.
    obstacles: Vec<Obstacle>,
    /// The extra cost of each cell in the last plan.
    costs: Vec<u16>,
    search: PathSearch,
    moving: Vec<Moving>,
    clock: u64,
    pose: Odometry,
}

/// A moving obstacle.
struct Moving {
    /// Its index in the scenario.
    index: usize,
    /// Position in m and velocity in m/s of a pedestrian; `None` for other obstacles.
    walk: Option<(Vec2, Vec2)>,
}

impl Moving {
    /// The pose of the `obstacle` at control step `clock + steps`; each step lasts `period_s`.
    fn pose(&self, obstacle: &Obstacle, clock: u64, steps: u64, period_s: f32) -> (f32, f32, f32) {
        match self.walk {
            Some((at_m, velocity_m_s)) => {
                let Vec2 { x, y } = at_m + velocity_m_s * (period_s * steps as f32);
                (x, y, 0.0)
            }
            None => pose_at(obstacle, clock + steps, period_s),
        }
    }
}

impl TrueMap {
    pub(crate) fn new(robot: &Robot, parameters: &PlannerParameters) -> Self {
        let (keep_out_m, margin_m) = (robot.unit_m, parameters.margin * robot.unit_m);
        let cell_m = parameters.cell * keep_out_m;
        let dwa_limit_m = keep_out_m * (1.0 + parameters.dwa.margin);
        Self {
            keep_out_m,
            margin_m,
            cell_m,
            period_s: robot.control_period_s,
            grid: Grid { min_m: Vec2::ZERO, cell_m, columns: 0, rows: 0 },
            clearances_m: Vec::new(),
            reach_m: dwa_limit_m.max(2.0 * (keep_out_m + margin_m)),
            obstacles: Vec::new(),
            costs: Vec::new(),
            search: PathSearch::default(),
            moving: Vec::new(),
            clock: 0,
            pose: Odometry::default(),
        }
    }

    /// Builds the map of `scenario`.
    fn build(&mut self, scenario: &Scenario) {
        let (low, high) = scenario.enclosure.bounds_m();
        self.grid = Grid::over(low, high, self.cell_m);
        let enclosure = |cell| enclosure_distance(&scenario.enclosure, self.grid.centre_m(cell));
        self.clearances_m = (0..self.grid.len()).map(|cell| enclosure(cell).min(self.reach_m)).collect();
        let is_static = |obstacle: &&Obstacle| obstacle.motion == ObstacleMotion::Static;
        let pieces = scenario.walls.iter().flat_map(Wall::pieces);
        for obstacle in pieces.chain(scenario.obstacles.iter().filter(is_static).cloned()) {
            self.lower(&obstacle);
        }
        let moving = scenario.obstacles.iter().enumerate().filter(|(_, obstacle)| !is_static(obstacle));
        self.moving = moving.map(|(index, _)| Moving { index, walk: None }).collect();
        self.obstacles.clone_from(&scenario.obstacles);
    }

    /// Lowers the clearances around a static obstacle.
    fn lower(&mut self, obstacle: &Obstacle) {
        let pose = pose_at(obstacle, 0, self.period_s);
        let (origin, radius_m) = (Vec2::new(pose.0, pose.1), obstacle.shape.bounding_radius_m());
        for cell in self.grid.cells_near(origin - radius_m, origin + radius_m, self.reach_m) {
            let distance_m = shape_distance(&obstacle.shape, pose, self.grid.centre_m(cell));
            self.clearances_m[cell] = self.clearances_m[cell].min(distance_m);
        }
    }

    /// The clearance of the static parts at a point, in m: bilinear between the centres of four cells.
    fn static_clearance_m(&self, point_m: Vec2) -> f32 {
        let at = (point_m - self.grid.min_m) / self.grid.cell_m - 0.5;
        let (low, fraction) = (at.floor(), at - at.floor());
        let value = |dx: f32, dy: f32| {
            let corner = self.grid.min_m + (low + Vec2::new(dx, dy) + 0.5) * self.grid.cell_m;
            self.clearances_m[self.grid.cell(corner)]
        };
        let along = |dy| value(0.0, dy) * (1.0 - fraction.x) + value(1.0, dy) * fraction.x;
        along(0.0) * (1.0 - fraction.y) + along(1.0) * fraction.y
    }

    /// The distance in m from a point to the nearest moving obstacle at the last whole control step within `after_s` seconds
    /// from now.
    fn moving_clearance_m(&self, point_m: Vec2, after_s: f32) -> f32 {
        // DWA adds up times, whose rounding errors must not lose a step.
        let steps = (after_s / self.period_s + 1e-3) as u64;
        let distance = |moving: &Moving| {
            let obstacle = &self.obstacles[moving.index];
            let pose = moving.pose(obstacle, self.clock, steps, self.period_s);
            shape_distance(&obstacle.shape, pose, point_m)
        };
        self.moving.iter().map(distance).fold(f32::INFINITY, f32::min)
    }
}

impl Map for TrueMap {
    fn update(&mut self, percept: &Percept) -> Odometry {
        if let Some(truth) = &percept.truth {
            let scenario = truth.layout.scenario;
            if self.clearances_m.is_empty() || self.obstacles != scenario.obstacles {
                self.build(scenario);
            }
            self.clock = truth.clock;
            for moving in &mut self.moving {
                let pedestrian = truth.layout.pedestrian(moving.index);
                moving.walk = pedestrian.map(|walker| (walker.position_m, walker.velocity_m_s));
            }
            let (x, y, rotation_rad) = truth.pose;
            self.pose = Odometry { translation_m: Vec2::new(x, y), rotation_rad };
        }
        self.pose
    }

    fn plan(&mut self, from_m: Vec2, to_m: Vec2) -> Vec<Vec2> {
        if self.clearances_m.is_empty() {
            return Vec::new();
        }
        let cost = |clearance_m: f32| closeness_cost(clearance_m - self.keep_out_m, self.margin_m);
        let mut costs: Vec<u16> = self.clearances_m.iter().map(|clearance| cost(*clearance)).collect();
        for moving in &self.moving {
            let obstacle = &self.obstacles[moving.index];
            let pose = moving.pose(obstacle, self.clock, 0, self.period_s);
            let (origin, radius_m) = (Vec2::new(pose.0, pose.1), obstacle.shape.bounding_radius_m());
            for cell in self.grid.cells_near(origin - radius_m, origin + radius_m, self.reach_m) {
                let distance_m = shape_distance(&obstacle.shape, pose, self.grid.centre_m(cell));
                costs[cell] = costs[cell].max(cost(distance_m));
            }
        }
        self.costs = costs;
        let (from, to) = (self.grid.cell(from_m), self.grid.cell(to_m));
        let path = self.search.cheapest_path(self.grid.columns, &self.costs, from, to);
        path.into_iter().map(|cell| self.grid.centre_m(cell)).collect()
    }

    fn sees(&self, from_m: Vec2, to_m: Vec2) -> bool {
        !self.costs.is_empty() && self.grid.sees(from_m, to_m, |cell| self.costs[cell] < TOO_CLOSE)
    }

    fn clearance(&self, _: f32) -> impl Fn(Vec2, f32) -> f32 {
        |at_m: Vec2, after_s: f32| {
            let point_m = self.pose.to_outer(at_m);
            if self.clearances_m.is_empty() {
                return f32::INFINITY;
            }
            self.static_clearance_m(point_m).min(self.moving_clearance_m(point_m, after_s))
        }
    }
}

#[cfg(test)]
mod tests {
    use glam::vec2;
    use wayfield_scenario::{Motion, Shape, clearance};

    use super::*;
    use crate::config::DwaParameters;
    use crate::percept::Truth;

    fn circle(motion: ObstacleMotion) -> Obstacle {
        Obstacle {
            shape: Shape::Circle { radius_m: 0.15 },
            position_m: vec2(0.6, 0.6),
            rotation_rad: 0.0,
            motion,
        }
    }

    /// Updates `map` with `scenario` at step 10, with the robot at (0, 0).
    fn update(map: &mut TrueMap, scenario: &Scenario) {
        let truth =
            Truth { layout: scenario.into(), clock: 10, pose: (0.0, 0.0, 0.0), goal_m: vec2(1.0, 0.0) };
        map.update(&Percept {
            ranges_m: &[],
            goal_distance_m: 1.0,
            goal_bearing_rad: 0.0,
            twist: Motion { v_m_s: 0.0, w_rad_s: 0.0 },
            odometry: Odometry::default(),
            truth: Some(truth),
        });
    }

    #[test]
    fn the_clearance_of_the_map_is_that_of_the_scenario() {
        let orbit = ObstacleMotion::Orbit { centre_m: Vec2::ZERO, speed_rad_s: (-0.5).into() };
        let scenario = Scenario {
            obstacles: vec![circle(ObstacleMotion::Static), circle(orbit)],
            walls: vec![Wall {
                corners_m: vec![vec2(-1.0, -1.0), vec2(0.0, -1.0)],
                thickness_m: 0.1,
                ..Wall::default()
            }],
            ..Scenario::default()
        };
        let robot = Robot::of(&scenario);
        let mut map = TrueMap::new(&robot, &PlannerParameters::default());
        update(&mut map, &scenario);
        let of_map = map.clearance(1.0);
        for point in [vec2(0.3, 0.5), vec2(-0.5, -0.8), vec2(1.8, -1.7), vec2(0.5, -0.4), vec2(0.7, 0.65)] {
            for steps in [0, 3, 5] {
                let expected = clearance(&scenario, point, 10 + steps).min(map.reach_m);
                let value = of_map(point, steps as f32 * 0.2);
                assert!((value - expected).abs() < 0.02, "{point} after {steps}: {value}, not {expected}");
            }
        }
    }

    #[test]
    fn an_obstacle_that_is_moved_during_an_episode_moves_in_the_map() {
        let mut scenario =
            Scenario { obstacles: vec![circle(ObstacleMotion::Static)], ..Scenario::default() };
        let mut map = TrueMap::new(&Robot::of(&scenario), &PlannerParameters::default());
        update(&mut map, &scenario);
        let (before, after) = (vec2(0.6, 0.6), vec2(-0.6, -0.6));
        assert!(map.clearance(1.0)(before, 0.0) < 0.0 && map.clearance(1.0)(after, 0.0) > 0.13);
        scenario.obstacles[0].position_m = after;
        update(&mut map, &scenario);
        assert!(map.clearance(1.0)(before, 0.0) > 0.13 && map.clearance(1.0)(after, 0.0) < 0.0);
    }

    #[test]
    fn the_map_reaches_as_far_as_the_margin_of_the_dynamic_window_approach() {
        let scenario = Scenario::default();
        let dwa = DwaParameters { margin: 5.0, ..DwaParameters::default() };
        let parameters = PlannerParameters { margin: 0.0, dwa, ..PlannerParameters::default() };
        let mut map = TrueMap::new(&Robot::of(&scenario), &parameters);
        update(&mut map, &scenario);
        let clearance_m = map.clearance(1.0)(Vec2::ZERO, 0.0);
        assert!(clearance_m > 5.9 * 0.13, "the walls are over a metre away: {clearance_m} m");
    }
}
