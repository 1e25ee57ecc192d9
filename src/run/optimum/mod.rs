//! The least number of control steps from a start to a target: the yardstick that policies are measured by.
//!
//! In: a [`Scenario`], a start, a target, the clock. Out: a [`Plan`], whose actions can be replayed, and
//! [`lower_bound_steps`], which no plan can beat. No Bevy and no physics engine: the robot is a point that must keep
//! its distance.
//!
//! **The world as searched.** A motion (v, w) held for a control period takes the robot along an arc; the search
//! goes from arc's end to arc's end in f64, by the same formula as the world. A step is allowed when the true
//! distance from its end to every wall and obstacle (where `pose_at` puts it after that step) is at least
//! `collision_range_m`; the target is reached by an allowed step that ends nearer than `goal_radius_m`. What lies
//! between the ends of steps isn't judged. Both distances are kept with [`MARGIN_M`] to spare, so that a plan holds
//! in the world's f32 too.
//!
//! **How near the plan is to the optimum.** [`least_time`] is a best-first search over exact states that keeps one
//! state for each cell of a grid over (x, y, heading), and also step where anything moves. So a plan is always
//! feasible, an upper bound; merging states in a cell may cost steps, fewer the smaller the cells. Where `steps`
//! equals the lower bound the plan is proven optimal. Measured over 500 random navigations at the default resolution:
//! the mean is 0.16 % above the mean bound in the empty enclosure and in Scenario I (nine plans of ten proven optimal),
//! 2.4 % in Scenario II, where the bound knows little of what moves. The paper's course in Scenario I, heading 0:
//! 54 steps = 10.8 s, proven optimal.
//!
//! **What is proven below.** Everything that guides the search, and [`lower_bound_steps`], rests on bounds that
//! hold for the world with its margins on the other side (goal radius larger, collision range smaller by
//! [`MARGIN_M`]):
//! 1. *Geodesic.* A step moves the robot by the chord s of the fastest motion at most. Of two points at least R from
//!    an obstacle and at most s apart, every point between is at least sqrt(R^2 - s^2 / 4) from it (Stewart's
//!    theorem), so the polyline through the steps' ends keeps out of each obstacle grown by that much, and out of
//!    any convex polygon inscribed in it. The shortest way round these polygons, by their corners, less the goal
//!    radius, is no longer than s a step. Obstacles that move, that stand within the goal radius of the target, or
//!    that are too many, are left out, which can only shorten the way; so are all where R <= s / 2.
//! 2. *Turning.* Where every motion drives forward, the path bends no tighter than some radius r. The shortest
//!    such path to a point q outside both turning circles is an arc and its tangent (Bui et al. 1994), and its length
//!    changes by no more than q does. So if the goal's disc is clear of both circles, that length to the target less
//!    the goal radius is a bound.
//!
//! **The judge is a hair more lenient**: it takes the shortest of the LIDAR's beams, which may pass the nearest point
//! by. With 24 beams and a collision range of 0.13 m that is 2.1 mm at most at a cylinder of 0.15 m, 1.1 mm at a wall,
//! 18 mm at a box's corner. So the true optimum may seldom be a step shorter; take that off `collision_range_m` for a
//! bound on it too.

mod bound;
mod search;
mod world;

use bound::Bound;
use search::{Cells, LOOKAHEAD, Limits, look_ahead, search};
use world::{Goal, World};

use crate::scenario::Scenario;

/// How far, in m, a plan stays within the rules, and how far beyond them the lower bound still holds: more than the
/// world's f32 arithmetic adds up to in some hundred steps.
pub const MARGIN_M: f64 = 2e-5;
/// The first search gives up when it has made so many states.
const MOST_STATES: usize = 4_000_000;

/// A way to the target.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
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
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bounds {
    /// Proven: see [`lower_bound_steps`].
    pub lower_steps: u32,
    /// What the planner needs; None where it finds no way (see [`least_time`]).
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
    pub halvings: u32,
    /// A search with halved cells gives up, and what the coarser ones found stands, when it has made so many states
    /// (48 bytes and about 0.3 us each). Only moving obstacles make it need so many. The first search may make
    /// 4,000,000.
    pub refining_states: usize,
}

impl Default for Resolution {
    /// 0.04 m and 0.16 rad, then 0.02 m and 0.08 rad. (From 0.08 m on cells are too coarse: a step of 0.03 m that
    /// ends in its own cell is lost.)
    fn default() -> Self {
        Self { cell_m: 0.04, heading_rad: 0.16, halvings: 1, refining_states: 100_000 }
    }
}

/// The shortest plan found from `start` (x in m, y in m, heading in rad) to `target` (in m) when the obstacles are
/// where `clock` steps have brought them. At least one step is taken. None when there is no way within the
/// scenario's time limit, or none at this resolution and within some million states.
#[must_use]
pub fn least_time(
    scenario: &Scenario,
    start: (f32, f32, f32),
    target: (f32, f32),
    clock: u64,
    resolution: Resolution,
) -> Option<Plan> {
    shortest(scenario, start, target, clock, resolution, &Bound::new(scenario, start, target))
}

/// [`lower_bound_steps`] and the steps of [`least_time`] in one, sooner than both apart.
#[must_use]
pub fn bounds(
    scenario: &Scenario,
    start: (f32, f32, f32),
    target: (f32, f32),
    clock: u64,
    resolution: Resolution,
) -> Bounds {
    let bound = Bound::new(scenario, start, target);
    let plan = shortest(scenario, start, target, clock, resolution, &bound);
    let plan_steps = plan.map(|plan| plan.steps);
    // More than a plan takes can't be proven.
    let enough = plan_steps.unwrap_or(u32::MAX);
    Bounds { lower_steps: look_ahead(scenario, start, target, clock, &bound, LOOKAHEAD, enough), plan_steps }
}

/// [`least_time`] by bounds that are known already.
fn shortest(
    scenario: &Scenario,
    start: (f32, f32, f32),
    target: (f32, f32),
    clock: u64,
    resolution: Resolution,
    bound: &Bound,
) -> Option<Plan> {
    let mut world = World::new(scenario, clock, MARGIN_M);
    let goal = Goal::new(scenario, target, -MARGIN_M);
    let least = look_ahead(scenario, start, target, clock, bound, 64, u32::MAX);
    let mut best = None;
    let mut fewer_than = scenario.task.time_limit_steps.saturating_add(1);
    for halving in 0..=resolution.halvings {
        let part = 0.5_f64.powi(i32::try_from(halving).unwrap_or(i32::MAX));
        let mut cells =
            Cells::new(resolution.cell_m * part, resolution.heading_rad * part, world.anything_moves());
        let limits = Limits {
            fewer_than,
            states: if halving == 0 { MOST_STATES } else { resolution.refining_states },
        };
        if let Some(actions) = search(&mut world, bound, &goal, start, &mut cells, &limits) {
            fewer_than = actions.len() as u32;
            best = Some(actions);
        }
        if fewer_than <= least {
            break;
        }
    }
    best.map(|actions| {
        let steps = actions.len() as u32;
        let time_s = (f64::from(steps) * f64::from(scenario.task.control_period_s)) as f32;
        let poses = world.drive(start, &actions).map(|state| state.pose()).collect();
        Plan { steps, time_s, actions, poses }
    })
}

/// A number of steps that no plan undercuts, whatever the resolution: proven as the module's docs say, by the
/// geodesic and the turning bound after every sequence of the first few motions. `u32::MAX` where there is no way.
#[must_use]
pub fn lower_bound_steps(scenario: &Scenario, start: (f32, f32, f32), target: (f32, f32), clock: u64) -> u32 {
    look_ahead(scenario, start, target, clock, &Bound::new(scenario, start, target), LOOKAHEAD, u32::MAX)
}

#[cfg(test)]
mod tests;
