//! The waypoint: the point to drive to while the goal is out of sight. The map is built as the robot drives.
//!
//! While the straight line to the goal is free in the map, there is no waypoint. Otherwise it is the farthest point in sight on
//! the cheapest path, up to a lookahead distance along it. Unknown cells are free.

use glam::Vec2;

use crate::DriverPlan;
use crate::path_search::TOO_CLOSE;
use crate::percept::{Odometry, Percept};
use crate::planned::Map;
use crate::robot::Robot;
use crate::rolling_map::RollingMap;

/// Side of a cell of the map, in keep-out distances.
const CELL: f32 = 0.34;
/// Distance that a path keeps beyond the keep-out distance if it can, in keep-out distances.
const MARGIN: f32 = 1.0;
/// Control steps between two plans.
const REPLAN_STEPS: u32 = 3;
/// The farthest waypoint along the path, in keep-out distances.
const LOOKAHEAD: f32 = 8.0;
/// Points up to this distance along the path count as in sight, so that the waypoint is not right in front of the robot; in
/// keep-out distances.
const NEAREST: f32 = 2.0;
/// The highest extra cost of a cell on a line that counts as in sight: just below that of a cell too close to an obstacle.
const IN_SIGHT: u16 = TOO_CLOSE - 1;
/// Like [`IN_SIGHT`], for a goal that was out of sight: the cost at half the margin, so that a goal on the edge of sight does
/// not come and go.
const IN_SIGHT_AGAIN: u16 = 4;
/// A path is kept until another costs less than this fraction of its cost, so that the robot does not waver between equal paths.
const BETTER: f32 = 0.8;

/// A point to drive to.
pub(crate) struct Waypoint {
    /// The point in the robot's frame, in m.
    pub(crate) at_m: Vec2,
    /// The length of the path to the goal through the point, in m. A policy that observes it as the goal distance does not hurry
    /// to the point as if the episode ended there.
    pub(crate) path_length_m: f32,
}

/// The choice of waypoints in one episode, and its map.
pub(crate) struct Waypoints {
    map: RollingMap,
    keep_out_m: f32,
    goal_radius_m: f32,
    /// The robot's pose in the map's frame. The points below are in the same frame.
    pose: Odometry,
    goal_m: Vec2,
    /// The path to the goal; empty while the goal is in sight.
    path: Vec<Vec2>,
    waypoint_m: Option<Vec2>,
    /// The length of the path from the waypoint on, in m.
    rest_m: f32,
    /// Control steps until the next plan.
    steps_left: u32,
}

impl Waypoints {
    pub(crate) fn new(robot: &Robot) -> Self {
        Self {
            map: RollingMap::new(robot, CELL, MARGIN),
            keep_out_m: robot.unit_m,
            goal_radius_m: robot.goal_radius_m,
            pose: Odometry::default(),
            goal_m: Vec2::ZERO,
            path: Vec::new(),
            waypoint_m: None,
            rest_m: 0.0,
            steps_left: 0,
        }
    }

    /// Updates the map with a percept. Returns the waypoint; `None` if the robot is to drive to its goal.
    pub(crate) fn update(&mut self, percept: &Percept) -> Option<Waypoint> {
        self.pose = self.map.update(percept);
        let goal_m = self.pose.to_outer(percept.goal_m());
        if (goal_m - self.goal_m).length() > self.goal_radius_m {
            (self.steps_left, self.waypoint_m) = (0, None);
            self.path.clear();
        }
        if self.steps_left == 0 {
            self.goal_m = goal_m;
            self.choose();
            self.steps_left = REPLAN_STEPS;
        }
        self.steps_left -= 1;
        self.waypoint_m.map(|point_m| Waypoint {
            at_m: self.pose.to_inner(point_m),
            path_length_m: (point_m - self.pose.translation_m).length() + self.rest_m,
        })
    }

    /// The path and the map, as for [`crate::Driver::plan`].
    pub(crate) fn plan(&self, pose: (f32, f32, f32)) -> DriverPlan {
        DriverPlan::seen_from(pose, &self.pose, &self.path, self.map.built())
    }

    fn choose(&mut self) {
        self.map.make_costs();
        let at_m = self.pose.translation_m;
        let max_cost = if self.waypoint_m.is_some() { IN_SIGHT_AGAIN } else { IN_SIGHT };
        if self.map.is_clear(at_m, self.goal_edge_m(), max_cost) {
            self.waypoint_m = None;
            self.path.clear();
            return;
        }
        let found = self.map.cheapest_path(at_m, self.goal_m);
        self.path.drain(..nearest(&self.path, at_m));
        // If the goal was outside the window when the path was planned, the path ends at the edge of that window.
        self.map.continue_path(&mut self.path, self.goal_m);
        let [cost, kept] = [&found, &self.path].map(|path| self.map.path_cost(at_m, path, self.goal_m));
        if self.path.is_empty() || (cost as f32) < BETTER * kept as f32 {
            self.path = found;
        }
        let point_m = self.farthest_in_sight(at_m);
        let rest = &self.path[nearest(&self.path, point_m)..];
        let beyond = rest.last().filter(|_| point_m != self.goal_m);
        self.rest_m = length(rest) + beyond.map_or(0.0, |end| end.distance(self.goal_m));
        self.waypoint_m = Some(point_m);
    }

    /// The point within the goal's radius that is closest to the robot.
    fn goal_edge_m(&self) -> Vec2 {
        let to_goal_m = self.goal_m - self.pose.translation_m;
        self.pose.translation_m
            + to_goal_m * (1.0 - self.goal_radius_m / to_goal_m.length().max(self.goal_radius_m))
    }

    /// The farthest point in sight on the path, up to [`LOOKAHEAD`] along it. Points up to [`NEAREST`] count as in sight. The
    /// last point is the goal.
    fn farthest_in_sight(&self, at_m: Vec2) -> Vec2 {
        let mut chosen = None;
        let mut along_m = 0.0;
        for (k, ends) in self.path.windows(2).enumerate() {
            along_m += (ends[1] - ends[0]).length();
            let is_last = k + 2 == self.path.len();
            let point = if is_last { self.goal_m } else { ends[1] };
            if along_m > LOOKAHEAD * self.keep_out_m {
                break;
            }
            if along_m <= NEAREST * self.keep_out_m || self.map.is_clear(at_m, point, IN_SIGHT) {
                chosen = Some(point);
            }
        }
        chosen.unwrap_or(self.goal_m)
    }
}

/// The index of the point of `path` nearest to `at_m`, the first if several are; 0 if `path` is empty.
fn nearest(path: &[Vec2], at_m: Vec2) -> usize {
    let distance = |index: &usize| (path[*index] - at_m).length_squared();
    (0..path.len()).min_by(|a, b| distance(a).total_cmp(&distance(b))).unwrap_or(0)
}

/// The length of a path, in m.
fn length(path: &[Vec2]) -> f32 {
    path.windows(2).map(|ends| (ends[1] - ends[0]).length()).sum()
}

#[cfg(test)]
mod tests {
    use glam::vec2;
    use wayfield_scenario::{Lidar, Motion, Scenario};

    use super::*;

    /// A robot that keeps 0.13 m from walls and has 360 beams.
    fn robot() -> Robot {
        Robot::of(&Scenario { lidar: Lidar { beams: 360, ..Lidar::default() }, ..Scenario::default() })
    }

    /// A robot at `at_m` that always faces along x, and its goal, at (2, 0) unless a test moves it. A wall, if any, is on the line
    /// x = 1.
    struct Scene {
        robot: Robot,
        waypoints: Waypoints,
        at_m: Vec2,
        goal_m: Vec2,
        /// The length of the path through the last waypoint.
        path_length_m: f32,
    }

    impl Scene {
        fn new(at_m: Vec2) -> Self {
            Self::of(robot(), at_m)
        }

        fn of(robot: Robot, at_m: Vec2) -> Self {
            Self {
                waypoints: Waypoints::new(&robot),
                robot,
                at_m,
                goal_m: vec2(2.0, 0.0),
                path_length_m: 0.0,
            }
        }

        /// The waypoint in the world frame after the robot has moved to `to_m` and seen the wall, if any.
        fn waypoint(&mut self, to_m: Vec2, wall: Option<(f32, f32)>) -> Option<Vec2> {
            let range = |beam: &Vec2| {
                let range_m = (1.0 - to_m.x) / beam.x;
                let y = to_m.y + range_m * beam.y;
                let is_hit = wall.is_some_and(|(low, high)| (low..=high).contains(&y));
                let max_range_m = self.robot.max_range_m;
                if is_hit && range_m > 0.0 { range_m.min(max_range_m) } else { max_range_m }
            };
            let ranges_m: Vec<f32> = self.robot.beams.iter().map(range).collect();
            let goal_m = self.goal_m - to_m;
            let percept = Percept {
                ranges_m: &ranges_m,
                goal_distance_m: goal_m.length(),
                goal_bearing_rad: goal_m.to_angle(),
                twist: Motion { v_m_s: 0.0, w_rad_s: 0.0 },
                odometry: Odometry { translation_m: to_m - self.at_m, rotation_rad: 0.0 },
                truth: None,
            };
            self.at_m = to_m;
            let waypoint = self.waypoints.update(&percept)?;
            self.path_length_m = waypoint.path_length_m;
            Some(waypoint.at_m + to_m)
        }

        /// The waypoint after the robot has stood at `to_m` until the next plan.
        fn planned(&mut self, to_m: Vec2, wall: Option<(f32, f32)>) -> Option<Vec2> {
            (0..=REPLAN_STEPS).map(|_| self.waypoint(to_m, wall)).last().flatten()
        }
    }

    #[test]
    fn the_waypoint_is_the_farthest_point_in_sight_on_the_path_around() {
        let wall = Some((-0.9, 0.3));
        let mut scene = Scene::new(Vec2::ZERO);
        assert_eq!(scene.waypoint(Vec2::ZERO, None), None, "the goal is in sight");
        // The shorter path leads past the upper end, (1, 0.3), and turns there at the keep-out distance, after 1.04 m or more. So
        // the waypoint is near the end of the lookahead, 8 x 0.13 = 1.04 m along the path.
        let point = scene.planned(Vec2::ZERO, wall).expect("the wall is in the way");
        assert!((0.9..=1.05).contains(&point.length()), "{point}");
        assert!((0.35..=0.75).contains(&point.y), "{point}");
        // The whole path leads around the end at a distance of 0.13 to 0.26 m.
        assert!((2.1..=2.5).contains(&scene.path_length_m), "{}", scene.path_length_m);
        // The straight line to the waypoint keeps clear of the end of the wall.
        let end = vec2(1.0, 0.3);
        let along = end.dot(point.normalize()).min(point.length());
        assert!((end - point.normalize() * along).length() > 0.13 - 0.03, "{point}");
        // From (1, 0.75) the line to the goal passes the end at 0.36 m.
        assert_eq!(scene.planned(vec2(1.0, 0.75), wall), None);
    }

    #[test]
    fn with_a_lidar_that_reaches_very_far_the_waypoint_is_still_near_the_robot() {
        for max_range_m in [100.0, 300.0, 1000.0] {
            let mut scene = Scene::of(Robot { max_range_m, ..robot() }, Vec2::ZERO);
            let point = scene.planned(vec2(0.1, 0.1), Some((-0.9, 0.3))).expect("the wall is in the way");
            // The largest cells have sides of 4 x 0.13 = 0.52 m. The path leads through the cell above the wall.
            assert!(point.distance(vec2(0.78, 0.78)) < 0.02, "{point} with a range of {max_range_m} m");
        }
    }

    #[test]
    fn a_goal_on_the_edge_of_sight_does_not_come_and_go() {
        // From (0.6, 0.67) the line to the goal passes the wall's end at (0.67 x 1 - 0.3 x 1.4) / |(1.4, 0.67)| = 0.16 m:
        // farther than the keep-out distance, but within half the margin beyond it.
        let (wall, edge) = (Some((-0.9, 0.3)), vec2(0.6, 0.67));
        assert_eq!(Scene::new(edge).planned(edge, wall), None, "it was never out of sight");
        let mut scene = Scene::new(Vec2::ZERO);
        assert!(scene.planned(Vec2::ZERO, wall).is_some());
        assert!(scene.planned(edge, wall).is_some(), "it is not yet in sight again");
    }

    #[test]
    fn of_two_equally_good_paths_the_first_is_kept_until_it_is_blocked() {
        let wall = Some((-0.6, 0.6));
        let mut scene = Scene::new(Vec2::ZERO);
        let side = scene.planned(Vec2::ZERO, wall).expect("out of sight").y.signum();
        // Four small moves to the other side, which make the path there the shorter one.
        for step in 1..5 {
            let point = scene.planned(vec2(0.0, -0.02 * side * step as f32), wall).expect("out of sight");
            assert_eq!(point.y.signum(), side, "{point}");
        }
        // The wall turns out to continue on this side.
        let longer = Some(if side > 0.0 { (-0.6, 3.0) } else { (-3.0, 0.6) });
        let point = scene.planned(Vec2::ZERO, longer).expect("out of sight");
        assert_eq!(point.y.signum(), -side, "{point}");
    }

    #[test]
    fn a_kept_path_to_a_far_goal_grows_with_the_map() {
        let wall = Some((-0.9, 0.3));
        let mut scene = Scene::new(Vec2::ZERO);
        scene.goal_m = vec2(12.0, 0.0);
        // The map reaches 1.5 times the range of the LIDAR, 5.25 m, and moves with the robot.
        for x in [0.0, 0.3, 0.6] {
            assert!(scene.planned(vec2(x, 0.6 * x), wall).is_some(), "the wall is in the way");
            let end = scene.waypoints.path.last().expect("a path around the wall");
            assert!((end.x - x - 5.25).abs() < 0.1, "{end} at {x}");
            // The straight line to the goal is 12 - x long.
            assert!((12.0 - x..12.6 - x).contains(&scene.path_length_m), "{} at {x}", scene.path_length_m);
        }
    }

    #[test]
    fn a_wall_that_has_gone_is_forgotten() {
        let mut scene = Scene::new(Vec2::ZERO);
        assert!(scene.planned(Vec2::ZERO, Some((-0.9, 0.3))).is_some());
        for _ in 0..10 {
            scene.waypoint(Vec2::ZERO, None);
        }
        assert_eq!(scene.waypoint(Vec2::ZERO, None), None);
        let plan = scene.waypoints.plan((0.0, 0.0, 0.0));
        assert!(plan.path_m.is_empty() && plan.occupied_m.is_empty(), "{plan:?}");
    }
}
