//! Time-optimal paths of a differential-drive robot among obstacles, and proven lower bounds on the number of steps.
//!
//! Evaluation compares a policy's travel time with a plan and a bound. [`plan_path`] returns a plan, a [`TimedPath`] whose
//! actions can be replayed in the simulation. [`lower_bound_steps`] returns a number of control steps: no trajectory to the
//! goal is shorter. There is no physics engine: the robot is a point that keeps its distance from walls and obstacles.
//!
//! ```
//! use wayfield_planner::{Resolution, StepBounds, plan_path, step_bounds};
//! use wayfield_scenario::{Scenario, Vec2};
//!
//! // The default scenario: an empty arena. The goal is 1.2 m straight ahead and has a radius of 0.2 m, so 1.0 m remain.
//! let scenario = Scenario::default();
//! let (start, goal) = ((0.0, 0.0, 0.0), Vec2::new(1.2, 0.0));
//! let path = plan_path(&scenario, start, goal, 0, Resolution::default()).ok_or("no path")?;
//! assert_eq!(path.steps, 34); // 0.03 m per step
//! assert_eq!(path.poses.len(), 35);
//!
//! let bounds = step_bounds(&scenario, start, goal, 0, Resolution::default());
//! assert_eq!(bounds, StepBounds { lower_steps: 34, plan_steps: Some(34) }); // optimal
//! # Ok::<(), &str>(())
//! ```
//!
//! | module | purpose |
//! |---|---|
//! | `configuration_space` | robot states, the effect of each motion, inflated obstacles, the goal region |
//! | `visibility_graph` | the length of the shortest path around static obstacles |
//! | `bound` | the lower bound on the remaining steps, from that length and the turning radius |
//! | `search` | the best-first searches for a plan and for a lower bound |
//!
//! # Model
//!
//! A state is the robot's pose after a control step, in f64, computed by the simulation's formula for arcs. A step is
//! allowed if the robot is then at least `collision_range_m` from every wall and every obstacle; moving obstacles have
//! their poses after the same step ([`wayfield_scenario::pose_at`]). The goal is reached by an allowed step that ends
//! within `goal_radius_m` of it. For a robot that is not a disc, a plan keeps the circle around its body free
//! ([`Scenario::keep_out_m`]), and the bounds only the circle inside it ([`Scenario::sure_collision_m`]). A plan keeps an extra
//! [`MARGIN_M`] from surfaces and inside the goal radius, so that it is also valid in the simulation's f32 arithmetic. The
//! lower bound relaxes both limits by the same margin.
//!
//! A plan's length is an upper bound on the optimum. The search merges the states in a grid cell, which can make a plan
//! longer; smaller cells reduce that loss. The heuristic of the search and [`lower_bound_steps`] are proven lower bounds. A
//! plan as long as the lower bound is optimal. The proofs and their limits are in `docs/optimum.md`.
//!
//! # Unsupported scenarios
//!
//! [`unsupported_reason`] names the part of a scenario that the model lacks:
//!
//! - actuator lag, limited accelerations and slip, because search and bounds assume that the robot drives exactly the
//!   commanded motion from the start of a step;
//! - a LIDAR with a field of view below a full turn, because collisions are detected from its ranges;
//! - polygons, as enclosure or as obstacles;
//! - pedestrians, whose path depends on others and may depend on the robot.

mod bound;
mod configuration_space;
mod search;
mod visibility_graph;

use bound::LowerBound;
use configuration_space::{ConfigurationSpace, GoalRegion};
use glam::Vec2;
use search::{LOWER_BOUND_STATES, SearchLimits, StateGrid, search, search_lower_bound};

use serde::{Deserialize, Serialize};

use wayfield_scenario::{Enclosure, Scenario};

/// The margin, in m, that a plan keeps to the collision range and the goal radius, and by which the lower bound relaxes
/// them. It exceeds the rounding errors of the simulation's f32 arithmetic over a few hundred steps.
pub const MARGIN_M: f64 = 2e-5;
/// The maximum number of states of the first search.
const MAX_STATES: usize = 4_000_000;
/// The maximum number of states in the quick search for a lower bound. A plan as long as that bound is not refined.
const QUICK_STATES: usize = 64;

/// A plan: a path to the goal with its actions and times.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedPath {
    /// The number of control steps until the goal is reached.
    pub steps: u32,
    /// The simulated time until the goal is reached, in s.
    pub time_s: f32,
    /// The action of each step: an index into the robot's motions.
    pub actions: Vec<u8>,
    /// The planned pose after 0, 1, ..., `steps` steps: x in m, y in m, heading in rad in [-pi, pi].
    pub poses: Vec<(f32, f32, f32)>,
}

/// Bounds on the smallest possible number of control steps.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StepBounds {
    /// The proven lower bound ([`lower_bound_steps`]).
    pub lower_steps: u32,
    /// The length of the plan, an upper bound; `None` if the planner finds no path ([`plan_path`]).
    pub plan_steps: Option<u32>,
}

/// The sizes of the grid cells in which the searches merge states, and the limits of the searches. The first search uses the
/// coarsest cells; each further search halves them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// The side of the coarsest cells along x and y, in m.
    pub cell_m: f64,
    /// The extent of the coarsest cells in heading, in rad.
    pub heading_rad: f64,
    /// The number of halvings. Each search only accepts plans shorter than the best so far, so a halving never makes the
    /// result worse.
    pub refinements: u32,
    /// The maximum number of states of a search with halved cells; each takes 48 bytes and about 0.3 us. A search that
    /// reaches the limit keeps the best plan so far. Only scenarios with moving obstacles need that many. The limit of
    /// the first search is 4,000,000.
    pub max_refinement_states: usize,
}

impl Default for Resolution {
    /// Cells of 0.04 m and 0.16 rad, then of 0.02 m and 0.08 rad. Cells of 0.08 m or more are too coarse: a step of 0.03 m
    /// that ends in the cell where it began is discarded.
    fn default() -> Self {
        Self { cell_m: 0.04, heading_rad: 0.16, refinements: 1, max_refinement_states: 100_000 }
    }
}

/// Whether the planner supports `scenario` ([`unsupported_reason`]).
#[must_use]
pub fn is_supported(scenario: &Scenario) -> bool {
    unsupported_reason(scenario).is_none()
}

/// The first part of `scenario` that the planner does not support, as text for a message; `None` if it supports all.
///
/// Generated obstacles must be added to the scenario first ([`Scenario::with_generated_obstacles`]).
#[must_use]
pub fn unsupported_reason(scenario: &Scenario) -> Option<String> {
    let Scenario { robot, lidar, .. } = scenario;
    if robot.actuator_lag_s.ends() != [0.0; 2] {
        return Some(format!("actuator lag: robot.actuator_lag_s is {}", robot.actuator_lag_s));
    }
    for (field, limit) in [
        ("max_acceleration_m_s2", robot.max_acceleration_m_s2),
        ("max_angular_acceleration_rad_s2", robot.max_angular_acceleration_rad_s2),
    ] {
        if let Some(limit) = limit {
            return Some(format!("limited accelerations: robot.{field} is {limit}"));
        }
    }
    if robot.slip.is_some() {
        return Some("slip: robot.slip is given".into());
    }
    if !lidar.is_all_around() {
        let field_of_view = lidar.field_of_view_rad;
        return Some(format!("a limited field of view: lidar.field_of_view_rad is {field_of_view}"));
    }
    let pedestrian = scenario.obstacles.iter().position(|o| o.motion.is_pedestrian());
    let pedestrian = pedestrian.map(|index| format!("pedestrians: obstacles[{index}] is a pedestrian"));
    pedestrian.or_else(|| polygon(scenario))
}

/// The first polygon of `scenario`, as text for a message.
fn polygon(scenario: &Scenario) -> Option<String> {
    if matches!(scenario.enclosure, Enclosure::Polygon { .. }) {
        return Some("polygons: the enclosure is a polygon".into());
    }
    let polygon = scenario.obstacles.iter().position(|o| o.shape.rounded_box().is_none());
    polygon.map(|index| format!("polygons: obstacles[{index}] is a polygon"))
}

/// The shortest plan that the searches find from `start` (x in m, y in m, heading in rad) to `goal` (x, y in m). `clock` is
/// the number of steps that moving obstacles have already made. A plan has at least one step.
///
/// `None` if no path is found: there is none within the scenario's time limit, the cells are too coarse, a search reaches
/// its maximum number of states, or the scenario is unsupported ([`is_supported`]).
#[must_use]
pub fn plan_path(
    scenario: &Scenario,
    start: (f32, f32, f32),
    goal: Vec2,
    clock: u64,
    resolution: Resolution,
) -> Option<TimedPath> {
    if !is_supported(scenario) {
        return None;
    }
    shortest_plan(scenario, start, goal, clock, resolution, &LowerBound::new(scenario, start, goal))
}

/// The results of [`lower_bound_steps`] and [`plan_path`] together, in less time than two calls take.
#[must_use]
pub fn step_bounds(
    scenario: &Scenario,
    start: (f32, f32, f32),
    goal: Vec2,
    clock: u64,
    resolution: Resolution,
) -> StepBounds {
    if !is_supported(scenario) {
        return StepBounds { lower_steps: 1, plan_steps: None };
    }
    let bound = LowerBound::new(scenario, start, goal);
    let plan = shortest_plan(scenario, start, goal, clock, resolution, &bound);
    let plan_steps = plan.map(|plan| plan.steps);
    // The lower bound cannot exceed the plan's length, so the search may stop there.
    let stop_at = plan_steps.unwrap_or(u32::MAX);
    StepBounds {
        lower_steps: search_lower_bound(scenario, start, goal, clock, &bound, LOWER_BOUND_STATES, stop_at),
        plan_steps,
    }
}

/// [`plan_path`] with a known `bound`.
fn shortest_plan(
    scenario: &Scenario,
    start: (f32, f32, f32),
    goal: Vec2,
    clock: u64,
    resolution: Resolution,
    bound: &LowerBound,
) -> Option<TimedPath> {
    let mut space = ConfigurationSpace::new(scenario, clock, f64::from(scenario.keep_out_m()) + MARGIN_M);
    let goal_region = GoalRegion::new(scenario, goal, -MARGIN_M);
    let lower_steps = search_lower_bound(scenario, start, goal, clock, bound, QUICK_STATES, u32::MAX);
    let mut best = None;
    let mut step_limit = scenario.task.max_episode_steps.saturating_add(1);
    for halvings in 0..=resolution.refinements {
        let scale = 0.5_f64.powi(i32::try_from(halvings).unwrap_or(i32::MAX));
        let mut cells = StateGrid::new(
            resolution.cell_m * scale,
            resolution.heading_rad * scale,
            space.has_moving_obstacles(),
        );
        let max_states = if halvings == 0 { MAX_STATES } else { resolution.max_refinement_states };
        let limits = SearchLimits { step_limit, max_states };
        if let Some(actions) = search(&mut space, bound, &goal_region, start, &mut cells, &limits) {
            step_limit = actions.len() as u32;
            best = Some(actions);
        }
        if step_limit <= lower_steps {
            break;
        }
    }
    best.map(|actions| timed_path(scenario, &space, start, actions))
}

/// The plan that consists of `actions`.
fn timed_path(
    scenario: &Scenario,
    space: &ConfigurationSpace,
    start: (f32, f32, f32),
    actions: Vec<u8>,
) -> TimedPath {
    let steps = actions.len() as u32;
    let time_s = (f64::from(steps) * f64::from(scenario.task.control_period_s)) as f32;
    let poses = space.rollout(start, &actions).map(|state| state.pose()).collect();
    TimedPath { steps, time_s, actions, poses }
}

/// A proven lower bound on the number of steps of any trajectory to the goal, whatever the resolution. `start`, `goal` and
/// `clock` have the same meaning as in [`plan_path`].
///
/// The bound is the smallest sum of the steps taken and the bound on the remaining steps, over all sequences of the first few
/// motions; the proof is in `docs/optimum.md`. It is `u32::MAX` if there is no path, and 1 if the scenario is unsupported
/// ([`is_supported`]).
#[must_use]
pub fn lower_bound_steps(scenario: &Scenario, start: (f32, f32, f32), goal: Vec2, clock: u64) -> u32 {
    if !is_supported(scenario) {
        return 1;
    }
    let bound = LowerBound::new(scenario, start, goal);
    search_lower_bound(scenario, start, goal, clock, &bound, LOWER_BOUND_STATES, u32::MAX)
}

/// The length, in m, of the shortest path of the robot's centre around the static obstacles and walls, from `start` (x in m,
/// y in m, heading in rad) to the edge of the goal region. Turning radius and moving obstacles are ignored.
///
/// Each inflated obstacle is replaced by a polygon inside it, so the length is a lower bound; for circles, it is at most 0.5 %
/// below the shortest path. Among very many obstacles, the most distant ones are left out. Because a step may cut a corner,
/// obstacles are inflated not by the collision range R but by sqrt(R² - s²/4), where s is the length of the longest step; if
/// s >= 2 R, all obstacles are left out. `None` if there is no path, or if the scenario has polygons.
///
/// Generated obstacles must be added to the scenario first ([`Scenario::with_generated_obstacles`]).
#[must_use]
pub fn shortest_path_m(scenario: &Scenario, start: (f32, f32, f32), goal: Vec2) -> Option<f64> {
    if polygon(scenario).is_some() {
        return None;
    }
    let length = LowerBound::new(scenario, start, goal).path_m((start.0.into(), start.1.into()));
    length.is_finite().then_some(length)
}

#[cfg(test)]
mod tests;
