//! The drivers with a map: they plan a path by A*, and steer along it by the dynamic window approach or pure pursuit.

use glam::Vec2;

use crate::config::{DwaParameters, PlannerParameters};
use crate::dwa::Dwa;
use crate::path::{point_ahead, pursue};
use crate::path_search::TOO_CLOSE;
use crate::percept::{Odometry, Percept};
use crate::robot::Robot;
use crate::{Driver, DriverPlan};

/// The largest extra cost of a cell within the margin.
const MARGIN_COST: f32 = 8.0;

/// A map of the surroundings.
pub(crate) trait Map {
    /// Updates the map with a percept. Returns the robot's pose in the map's frame.
    fn update(&mut self, percept: &Percept) -> Odometry;

    /// A path from `from_m` to `to_m`; empty if there is no map yet.
    fn plan(&mut self, from_m: Vec2, to_m: Vec2) -> Vec<Vec2>;

    /// Whether the straight line from `from_m` to `to_m` is free in the map of the last plan.
    fn sees(&self, from_m: Vec2, to_m: Vec2) -> bool;

    /// The argument `clearance` of [`Dwa::choose`]. Obstacles farther than `reach_m` from the robot may be left out.
    fn clearance(&self, reach_m: f32) -> impl Fn(Vec2, f32) -> f32;

    /// The centres of the occupied cells of a map that was built from scans, and the side of a cell, in m.
    fn built(&self) -> (Vec<Vec2>, f32) {
        (Vec::new(), 0.0)
    }
}

/// The extra cost of a cell whose centre is `distance_m` beyond the keep-out distance from the nearest surface.
pub(crate) fn closeness_cost(distance_m: f32, margin_m: f32) -> u16 {
    if distance_m < 0.0 {
        TOO_CLOSE
    } else if distance_m < margin_m {
        (MARGIN_COST * (1.0 - distance_m / margin_m)).ceil() as u16
    } else {
        0
    }
}

/// A method of steering along a path.
#[derive(Clone, Copy)]
pub(crate) enum Steering {
    /// The dynamic window approach.
    Dwa(DwaParameters),
    /// Pure pursuit.
    Pursuit,
}

/// A driver that plans on a map.
pub(crate) struct Planned<M> {
    map: M,
    robot: Robot,
    /// The dynamic window approach; `None` for pure pursuit.
    dwa: Option<Dwa>,
    reach_m: f32,
    lookahead_m: f32,
    replan_steps: u32,
    /// The robot's pose in the map's frame.
    pose: Odometry,
    path: Vec<Vec2>,
    /// Control steps since the last plan.
    age: u32,
}

impl<M: Map> Planned<M> {
    pub(crate) fn new(map: M, steering: Steering, robot: Robot, parameters: &PlannerParameters) -> Self {
        let dwa = match steering {
            Steering::Dwa(parameters) => Some(Dwa::new(robot.clone(), parameters)),
            Steering::Pursuit => None,
        };
        let PlannerParameters { replan_steps, lookahead, dwa: window, .. } = parameters;
        let reach_m = robot.unit_m * (1.0 + window.margin) + robot.max_speed_m_s() * window.horizon_s;
        Self {
            map,
            dwa,
            reach_m,
            lookahead_m: lookahead * robot.unit_m,
            replan_steps: *replan_steps,
            robot,
            pose: Odometry::default(),
            path: Vec::new(),
            age: 0,
        }
    }
}

impl<M: Map + Send + Sync> Driver for Planned<M> {
    fn act(&mut self, percept: &Percept) -> usize {
        let pose = self.map.update(percept);
        self.pose = pose;
        let (at_m, goal_m) = (pose.translation_m, pose.to_outer(percept.goal_m()));
        if self.path.is_empty() || self.age >= self.replan_steps {
            self.path = self.map.plan(at_m, goal_m);
            self.age = 0;
        }
        self.age += 1;
        let ahead = point_ahead(&self.path, at_m, self.lookahead_m, |point| self.map.sees(at_m, point));
        let is_close = percept.goal_distance_m <= self.lookahead_m && self.map.sees(at_m, goal_m);
        let aim_m = if is_close { goal_m } else { ahead.unwrap_or(goal_m) };
        let aim_m = pose.to_inner(aim_m);
        match &self.dwa {
            Some(dwa) => {
                let radius_m = if is_close { self.robot.goal_radius_m } else { 0.0 };
                dwa.choose(&percept.twist, aim_m, radius_m, self.map.clearance(self.reach_m))
            }
            None => pursue(&self.robot, aim_m),
        }
    }

    fn plan(&self, pose: (f32, f32, f32)) -> Option<DriverPlan> {
        Some(DriverPlan::seen_from(pose, &self.pose, &self.path, self.map.built()))
    }
}
