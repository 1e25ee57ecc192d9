//! The best-first searches over exact states, for a plan and for a lower bound.
//!
//! In: the configuration space, the lower bound as heuristic, the goal. Out: the actions of the shortest plan found, or the
//! proven number of steps. The search for a plan keeps only the best states of each grid cell.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};
use std::f64::consts::TAU;
use std::hash::{BuildHasherDefault, Hasher};

use super::MARGIN_M;
use super::bound::{LowerBound, ceil_steps};
use super::configuration_space::{ConfigurationSpace, GoalRegion, State};
use glam::Vec2;
use wayfield_scenario::Scenario;

/// The maximum number of states in the search for a lower bound, in which no states are merged.
pub(super) const LOWER_BOUND_STATES: usize = 5_000;
/// The number of cost units per step. Costs are integers.
const COST_PER_STEP: f64 = 64.0;

/// A search node: a state, the step that led to it, and the index of its parent.
struct Node {
    state: State,
    steps: u32,
    parent: u32,
    action: u8,
}

/// The open nodes, by ascending cost; among equal costs, the newest comes first.
#[derive(Default)]
struct Queue(BinaryHeap<Reverse<(u32, Reverse<u32>)>>);

impl Queue {
    fn push(&mut self, cost: u32, node: usize) {
        self.0.push(Reverse((cost, Reverse(node as u32))));
    }

    fn pop(&mut self) -> Option<(u32, usize)> {
        self.0.pop().map(|Reverse((cost, Reverse(node)))| (cost, node as usize))
    }
}

/// The cost of a state, in 1/64 step: the `steps` taken plus `to_go`, the lower bound on the remaining steps.
fn cost(steps: u32, to_go: f64) -> u32 {
    ((f64::from(steps) + to_go) * COST_PER_STEP) as u32
}

/// The grid that merges states. It stores the lowest cost in each cell.
pub(super) struct StateGrid {
    per_metre: f64,
    per_radian: f64,
    /// Whether states after different numbers of steps are in different cells.
    by_step: bool,
    best: HashMap<(i32, i32, i32, u32), u32, BuildHasherDefault<CellHasher>>,
}

impl StateGrid {
    pub(super) fn new(cell_m: f64, heading_rad: f64, by_step: bool) -> Self {
        let (per_metre, per_radian) = (1.0 / cell_m.max(1e-6), 1.0 / heading_rad.max(1e-6));
        Self { per_metre, per_radian, by_step, best: HashMap::default() }
    }

    fn key(&self, state: &State, steps: u32) -> (i32, i32, i32, u32) {
        (
            (state.x * self.per_metre).floor() as i32,
            (state.y * self.per_metre).floor() as i32,
            (state.heading.rem_euclid(TAU) * self.per_radian) as i32,
            if self.by_step { steps } else { 0 },
        )
    }

    /// Whether the state's cost is lower than that of any previous state in its cell; if so, it becomes the cell's best.
    fn admit(&mut self, state: &State, steps: u32, cost: u32) -> bool {
        let best = self.best.entry(self.key(state, steps)).or_insert(u32::MAX);
        let better = cost < *best;
        if better {
            *best = cost;
        }
        better
    }

    /// Whether a better state has been admitted to the cell after this one.
    fn is_stale(&self, state: &State, steps: u32, cost: u32) -> bool {
        self.best.get(&self.key(state, steps)).is_some_and(|&best| best < cost)
    }
}

/// A fast hash by multiplication and rotation, good enough for grid cells (FxHash, as in rustc, with folded halves).
#[derive(Default)]
struct CellHasher(u64);

impl Hasher for CellHasher {
    fn finish(&self) -> u64 {
        self.0 ^ (self.0 >> 32)
    }

    fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.write_u32(byte.into());
        }
    }

    fn write_i32(&mut self, number: i32) {
        self.write_u32(number as u32);
    }

    fn write_u32(&mut self, number: u32) {
        self.0 = (self.0.rotate_left(5) ^ u64::from(number)).wrapping_mul(0x517C_C1B7_2722_0A95);
    }
}

/// The limits of a search.
pub(super) struct SearchLimits {
    /// Only plans with fewer steps are searched for.
    pub(super) step_limit: u32,
    /// The approximate maximum number of states.
    pub(super) max_states: usize,
}

/// The actions of the best plan within `limits` from `start` (x in m, y in m, heading in rad); `None` if there is none.
pub(super) fn search(
    space: &mut ConfigurationSpace<'_>,
    bound: &LowerBound,
    goal_region: &GoalRegion,
    start: (f32, f32, f32),
    cells: &mut StateGrid,
    limits: &SearchLimits,
) -> Option<Vec<u8>> {
    let mut step_limit = limits.step_limit;
    let mut nodes = vec![Node { state: State::new(start), steps: 0, parent: 0, action: 0 }];
    let mut queue = Queue::default();
    queue.push(0, 0);
    let mut reached = None;
    while let Some((cost_here, index)) = queue.pop() {
        let Node { state, steps, .. } = nodes[index];
        if ceil_steps(f64::from(cost_here) / COST_PER_STEP) >= step_limit || nodes.len() > limits.max_states {
            break;
        }
        if index > 0 && cells.is_stale(&state, steps, cost_here) {
            continue;
        }
        let steps = steps + 1;
        space.prepare(steps);
        let facing = libm::sincos(state.heading);
        for (action, step) in space.motion_primitives.iter().enumerate() {
            let state = state.after(step, facing);
            if !space.is_clear(state.x, state.y, steps) {
                continue;
            }
            let node = Node { state, steps, parent: index as u32, action: action as u8 };
            if goal_region.contains(state.x, state.y) {
                if steps < step_limit {
                    step_limit = steps;
                    reached = Some(nodes.len());
                    nodes.push(node);
                }
                continue;
            }
            let to_go = bound.steps(&state);
            if steps.saturating_add(ceil_steps(to_go)) < step_limit
                && cells.admit(&state, steps, cost(steps, to_go))
            {
                queue.push(cost(steps, to_go), nodes.len());
                nodes.push(node);
            }
        }
    }
    reached.map(|last| actions_to(&nodes, last))
}

/// The actions from the start to the node `last`.
fn actions_to(nodes: &[Node], last: usize) -> Vec<u8> {
    let mut at = last;
    let mut actions = vec![0; nodes[last].steps as usize];
    while at > 0 {
        actions[nodes[at].steps as usize - 1] = nodes[at].action;
        at = nodes[at].parent as usize;
    }
    actions
}

/// The lower bound on the steps from `start` to `goal`, by a best-first search of up to `max_states` states. `start`, `goal` and
/// `clock` have the same meaning as in [`plan_path`](super::plan_path).
///
/// No states are merged, so every trajectory to the goal passes through an open node. Therefore the lowest cost among the
/// open nodes is a lower bound, and so is the largest such value during the search. The search stops early once the bound
/// reaches `stop_at` steps. Returns `u32::MAX` if no trajectory reaches the goal.
pub(super) fn search_lower_bound(
    scenario: &Scenario,
    start: (f32, f32, f32),
    goal: Vec2,
    clock: u64,
    bound: &LowerBound,
    max_states: usize,
    stop_at: u32,
) -> u32 {
    let mut space =
        ConfigurationSpace::new(scenario, clock, f64::from(scenario.sure_collision_m()) - MARGIN_M);
    let goal_region = GoalRegion::new(scenario, goal, MARGIN_M);
    let mut nodes = vec![(State::new(start), 0)];
    let mut queue = Queue::default();
    queue.push(0, 0);
    let mut proven = 1;
    while let Some((cost_here, index)) = queue.pop() {
        let (state, steps) = nodes[index];
        proven = proven.max(ceil_steps(f64::from(cost_here) / COST_PER_STEP));
        // The cost of a state in the goal region is exactly the number of its steps.
        let is_reached = index > 0 && goal_region.contains(state.x, state.y);
        if nodes.len() >= max_states || proven >= stop_at || is_reached {
            return proven;
        }
        let steps = steps + 1;
        space.prepare(steps);
        let facing = libm::sincos(state.heading);
        for step in &space.motion_primitives {
            let state = state.after(step, facing);
            if !space.is_clear(state.x, state.y, steps) {
                continue;
            }
            let reached = goal_region.contains(state.x, state.y);
            let to_go = if reached { 0.0 } else { bound.steps(&state).max(1.0) };
            if to_go.is_finite() {
                queue.push(cost(steps, to_go), nodes.len());
                nodes.push((state, steps));
            }
        }
    }
    u32::MAX
}
