//! The search: best first over exact states, of which one is kept for each cell of a grid.
//!
//! In: the world as searched, the bound that guides, the goal. Out: the motions of the shortest way found.

use std::cmp::Reverse;
use std::collections::{BinaryHeap, HashMap};
use std::f64::consts::TAU;
use std::hash::{BuildHasherDefault, Hasher};

use super::MARGIN_M;
use super::bound::{LowerBound, ceil_steps};
use super::configuration_space::{ConfigurationSpace, GoalRegion, State};
use glam::Vec2;
use wayfield_scenario::Scenario;

/// So many states are looked at, without merging any, for the lower bound.
pub(super) const LOOKAHEAD_STATES: usize = 5_000;
/// Parts of a step that the queue tells apart.
const PARTS: f64 = 64.0;

/// A state reached, and how.
struct Node {
    state: State,
    steps: u32,
    parent: u32,
    action: u8,
}

/// The nodes not yet gone on from, the most hopeful first: by the bound on the whole way, in parts of a step, then
/// the newest.
#[derive(Default)]
struct Queue(BinaryHeap<Reverse<(u32, Reverse<u32>)>>);

impl Queue {
    fn push(&mut self, parts: u32, node: usize) {
        self.0.push(Reverse((parts, Reverse(node as u32))));
    }

    fn pop(&mut self) -> Option<(u32, usize)> {
        self.0.pop().map(|Reverse((parts, Reverse(node)))| (parts, node as usize))
    }
}

/// The bound on the whole way in parts of a step.
fn parts(steps: u32, to_go: f64) -> u32 {
    ((f64::from(steps) + to_go) * PARTS) as u32
}

/// The grid that merges states: each cell knows the best bound on a whole way through it.
pub(super) struct StateGrid {
    pub(super) per_metre: f64,
    pub(super) per_radian: f64,
    pub(super) by_step: bool,
    best: HashMap<(i32, i32, i32, u32), u32, BuildHasherDefault<CellHasher>>,
}

impl StateGrid {
    pub(super) fn new(cell_m: f64, heading_rad: f64, by_step: bool) -> Self {
        let (per_metre, per_radian) = (1.0 / cell_m.max(1e-6), 1.0 / heading_rad.max(1e-6));
        Self { per_metre, per_radian, by_step, best: HashMap::default() }
    }

    pub(super) fn key(&self, state: &State, steps: u32) -> (i32, i32, i32, u32) {
        (
            (state.x * self.per_metre).floor() as i32,
            (state.y * self.per_metre).floor() as i32,
            (state.heading.rem_euclid(TAU) * self.per_radian) as i32,
            if self.by_step { steps } else { 0 },
        )
    }

    /// Whether no state as good as this has been in its cell; if so, it is now the cell's best.
    pub(super) fn admit(&mut self, state: &State, steps: u32, parts: u32) -> bool {
        let best = self.best.entry(self.key(state, steps)).or_insert(u32::MAX);
        let better = parts < *best;
        if better {
            *best = parts;
        }
        better
    }

    /// Whether a state that was admitted has since been bettered.
    pub(super) fn is_stale(&self, state: &State, steps: u32, parts: u32) -> bool {
        self.best.get(&self.key(state, steps)).is_some_and(|&best| best < parts)
    }
}

/// Multiplies and turns: quick, and good enough for cells.
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

/// What a search may not exceed.
pub(super) struct SearchLimits {
    /// Only plans with fewer steps are of use.
    pub(super) step_limit: u32,
    /// How many states may be made, about.
    pub(super) states: usize,
}

/// The actions of the best plan within `limits` that leads through `cells`, if any.
pub(super) fn search(
    world: &mut ConfigurationSpace<'_>,
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
    while let Some((parts_here, index)) = queue.pop() {
        let Node { state, steps, .. } = nodes[index];
        if ceil_steps(f64::from(parts_here) / PARTS) >= step_limit || nodes.len() > limits.states {
            break;
        }
        if index > 0 && cells.is_stale(&state, steps, parts_here) {
            continue;
        }
        let steps = steps + 1;
        world.prepare(steps);
        let facing = libm::sincos(state.heading);
        for (action, step) in world.motion_primitives.iter().enumerate() {
            let state = state.after(step, facing);
            if !world.is_clear(state.x, state.y, steps) {
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
                && cells.admit(&state, steps, parts(steps, to_go))
            {
                queue.push(parts(steps, to_go), nodes.len());
                nodes.push(node);
            }
        }
    }
    let mut at = reached?;
    let mut actions = vec![0; step_limit as usize];
    while at > 0 {
        actions[nodes[at].steps as usize - 1] = nodes[at].action;
        at = nodes[at].parent as usize;
    }
    Some(actions)
}

/// The least bound, in whole steps, over the ends of every sequence of motions that is looked at, `states` in all:
/// the most hopeful are gone on from first, and none is left out. The greatest that this has been on the way holds,
/// and `enough` steps are as many as are asked for.
pub(super) fn search_lower_bound(
    scenario: &Scenario,
    start: (f32, f32, f32),
    goal: Vec2,
    clock: u64,
    bound: &LowerBound,
    states: usize,
    enough: u32,
) -> u32 {
    let mut world = ConfigurationSpace::new(scenario, clock, -MARGIN_M);
    let goal_region = GoalRegion::new(scenario, goal, MARGIN_M);
    let mut nodes = vec![(State::new(start), 0)];
    let mut queue = Queue::default();
    queue.push(0, 0);
    let mut proven = 1;
    while let Some((parts_here, index)) = queue.pop() {
        let (state, steps) = nodes[index];
        proven = proven.max(ceil_steps(f64::from(parts_here) / PARTS));
        // A target that has been reached is queued with just its steps.
        if nodes.len() >= states || proven >= enough || (index > 0 && goal_region.contains(state.x, state.y))
        {
            return proven;
        }
        let steps = steps + 1;
        world.prepare(steps);
        let facing = libm::sincos(state.heading);
        for step in &world.motion_primitives {
            let state = state.after(step, facing);
            if !world.is_clear(state.x, state.y, steps) {
                continue;
            }
            let reached = goal_region.contains(state.x, state.y);
            let to_go = if reached { 0.0 } else { bound.steps(&state).max(1.0) };
            if to_go.is_finite() {
                queue.push(parts(steps, to_go), nodes.len());
                nodes.push((state, steps));
            }
        }
    }
    u32::MAX
}
