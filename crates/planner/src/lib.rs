//! The least number of control steps from a start to a target: the yardstick that policies are measured by.
//!
//! In: a [`Scenario`], a start, a target, the clock. Out: a [`TimedPath`], whose actions can be replayed, and
//! [`lower_bound_steps`], which no plan can beat. No Bevy and no physics engine: the robot is a point that must keep
//! its distance.
//!
//! **The world as searched.** From arc's end to arc's end in f64, by the same formula as the world. A step is allowed
//! when the true distance from its end to every wall and obstacle (where `pose_at` puts it after that step) is at least
//! `collision_range_m`; the target is reached by an allowed step that ends nearer than `goal_radius_m`. A plan keeps
//! both with [`MARGIN_M`] to spare, so that it holds in the world's f32; the lower bound has the margin on the other side.
//!
//! **Plan and bound.** A plan is feasible, so an upper bound of the optimum: the search merges states by cells, which
//! may cost steps, fewer the smaller the cells. All that guides it, and [`lower_bound_steps`], rests on two proven bounds:
//! the way round the obstacles that stand still, and the turning. Where both agree the optimum is known.
//!
//! **What is not modelled** ([`is_supported`]): of such a scenario the planner says nothing. A lag of the drive, for both
//! the search and the bounds take a motion to be driven from its first moment on; a LIDAR that doesn't see all around, for
//! the judge lets a robot pass nearer by what it doesn't see; polygons, as enclosures or as obstacles.
//!
//! The proofs, what they leave out, how lenient the judge is, how near plan and bound are, and what all this says
//! of the paper's times: docs/optimum.md.

mod bound;
mod configuration_space;
mod search;

use glam::Vec2;
use bound::LowerBound;
use configuration_space::{ConfigurationSpace, GoalRegion};
use search::{LOOKAHEAD_STATES, SearchLimits, StateGrid, search, search_lower_bound};

use serde::{Deserialize, Serialize};

use wayfield_scenario::{Enclosure, Scenario, Shape};

/// How far, in m, a plan stays within the rules, and how far beyond them the lower bound still holds: more than the
/// world's f32 arithmetic adds up to in some hundred steps.
pub const MARGIN_M: f64 = 2e-5;
/// The first search gives up when it has made so many states.
const MAX_STATES: usize = 4_000_000;

/// A way to the target.
#[derive(Clone, Debug, PartialEq)]
pub struct TimedPath {
    /// Control steps until the target is reached.
    pub steps: u32,
    /// The same as simulated time, in s.
    pub time_s: f32,
    /// The motion of each step, as an index into the robot's motions.
    pub actions: Vec<u8>,
    /// Where the robot is after 0, 1, ... steps, as the search has it: x in m, y in m, heading in rad in [-pi, pi].
    /// One more than there are steps.
    pub poses: Vec<(f32, f32, f32)>,
}

/// What is known of the least number of control steps: it is `lower_steps` at least and `plan_steps` at most.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct StepBounds {
    /// Proven: see [`lower_bound_steps`].
    pub lower_steps: u32,
    /// What the planner needs; None where it finds no way (see [`plan_path`]).
    pub plan_steps: Option<u32>,
}

/// How finely states are told apart. The search is run with the coarsest cells first, then with halved ones.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Resolution {
    /// Side of the coarsest cells along x and y, in m.
    pub cell_m: f64,
    /// Their extent in heading, in rad.
    pub heading_rad: f64,
    /// How often all sides are halved. Each search has only to beat the one before, so one more is never worse.
    pub refinements: u32,
    /// A search with halved cells gives up, and what the coarser ones found stands, when it has made so many states
    /// (48 bytes and about 0.3 us each). Only moving obstacles make it need so many. The first search may make
    /// 4,000,000.
    pub max_refinement_states: usize,
}

impl Default for Resolution {
    /// 0.04 m and 0.16 rad, then 0.02 m and 0.08 rad. (From 0.08 m on cells are too coarse: a step of 0.03 m that
    /// ends in its own cell is lost.)
    fn default() -> Self {
        Self { cell_m: 0.04, heading_rad: 0.16, refinements: 1, max_refinement_states: 100_000 }
    }
}

/// Whether plans and bounds hold in `scenario` ([`unsupported_reason`]).
#[must_use]
pub fn is_supported(scenario: &Scenario) -> bool {
    unsupported_reason(scenario).is_none()
}

/// What of `scenario` the planner doesn't know, in words, if there is something: a lag of the drive, a LIDAR that doesn't
/// see all around, polygons. (One with generators is planned in with its layout, [`Scenario::with_generated_obstacles`].)
#[must_use]
pub fn unsupported_reason(scenario: &Scenario) -> Option<String> {
    let Scenario { robot, lidar, .. } = scenario;
    if robot.actuator_lag_s != 0.0 {
        return Some(format!("a lag of the drive: robot.actuator_lag_s is {}", robot.actuator_lag_s));
    }
    if !lidar.is_all_around() {
        return Some(format!("what isn't seen: lidar.field_of_view_rad is {}", lidar.field_of_view_rad));
    }
    if matches!(scenario.enclosure, Enclosure::Polygon { .. }) {
        return Some("polygons: the enclosure is one".into());
    }
    let polygon = scenario.obstacles.iter().position(|o| matches!(o.shape, Shape::Polygon { .. }));
    polygon.map(|index| format!("polygons: obstacles[{index}] is one"))
}

/// The shortest plan found from `start` (x in m, y in m, heading in rad) to `goal` (in m) when the obstacles are
/// where `clock` steps have brought them. At least one step is taken. None when there is no way within the
/// scenario's time limit, or none at this resolution and within some million states; and when the scenario is not one
/// that [`is_supported`].
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
    shortest(scenario, start, goal, clock, resolution, &LowerBound::new(scenario, start, goal))
}

/// [`lower_bound_steps`] and the steps of [`plan_path`] in one, sooner than both apart.
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
    let plan = shortest(scenario, start, goal, clock, resolution, &bound);
    let plan_steps = plan.map(|plan| plan.steps);
    // More than a plan takes can't be proven.
    let enough = plan_steps.unwrap_or(u32::MAX);
    StepBounds {
        lower_steps: search_lower_bound(scenario, start, goal, clock, &bound, LOOKAHEAD_STATES, enough),
        plan_steps,
    }
}

/// [`plan_path`] by bounds that are known already.
fn shortest(
    scenario: &Scenario,
    start: (f32, f32, f32),
    goal: Vec2,
    clock: u64,
    resolution: Resolution,
    bound: &LowerBound,
) -> Option<TimedPath> {
    let mut world = ConfigurationSpace::new(scenario, clock, MARGIN_M);
    let goal_region = GoalRegion::new(scenario, goal, -MARGIN_M);
    let least = search_lower_bound(scenario, start, goal, clock, bound, 64, u32::MAX);
    let mut best = None;
    let mut step_limit = scenario.task.max_episode_steps.saturating_add(1);
    for halving in 0..=resolution.refinements {
        let part = 0.5_f64.powi(i32::try_from(halving).unwrap_or(i32::MAX));
        let mut cells = StateGrid::new(
            resolution.cell_m * part,
            resolution.heading_rad * part,
            world.has_moving_obstacles(),
        );
        let limits = SearchLimits {
            step_limit,
            states: if halving == 0 { MAX_STATES } else { resolution.max_refinement_states },
        };
        if let Some(actions) = search(&mut world, bound, &goal_region, start, &mut cells, &limits) {
            step_limit = actions.len() as u32;
            best = Some(actions);
        }
        if step_limit <= least {
            break;
        }
    }
    best.map(|actions| {
        let steps = actions.len() as u32;
        let time_s = (f64::from(steps) * f64::from(scenario.task.control_period_s)) as f32;
        let poses = world.rollout(start, &actions).map(|state| state.pose()).collect();
        TimedPath { steps, time_s, actions, poses }
    })
}

/// A number of steps that no plan undercuts, whatever the resolution: proven in docs/optimum.md, by the
/// geodesic and the turning bound after every sequence of the first few motions. `u32::MAX` where there is no way. In a
/// scenario that is not one that [`is_supported`] all that is known is that it takes a step: 1.
#[must_use]
pub fn lower_bound_steps(scenario: &Scenario, start: (f32, f32, f32), goal: Vec2, clock: u64) -> u32 {
    if !is_supported(scenario) {
        return 1;
    }
    search_lower_bound(
        scenario,
        start,
        goal,
        clock,
        &LowerBound::new(scenario, start, goal),
        LOOKAHEAD_STATES,
        u32::MAX,
    )
}

#[cfg(test)]
mod tests;
