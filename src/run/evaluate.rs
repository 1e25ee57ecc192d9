//! Evaluation: how well a policy drives, greedily, in a world and with seeds of its own.
//!
//! In: a policy, a scenario, a seed. Out: [`Evaluation`]: success, collision and time-out rates, times.
//!
//! **Success**: the robot comes nearer to the target than l_a (0.2 m) before anything is nearer to it than l_c
//! (0.13 m) by LIDAR or touches its body, within the scenario's time limit (500 steps, 100 s). One navigation is one
//! start and one target, drawn from streams that training never uses, and one moment of the obstacles' motion.

use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};

use bevy::prelude::*;
use serde::Serialize;

use super::preset::{MOST_BODIES, bodies_in};
use super::{RunError, policy_card, simulation};
use crate::agent::GreedyPolicy;
use crate::learning::Policy;
use crate::planner::{self, Bounds, Resolution};
use crate::random;
use crate::scenario::{Scenario, TaskRules};
use crate::sim;
use crate::task::{
    Arena, ArenaState, Clock, EpisodeEnd, EpisodeEnded, Places, Pose, Streams, Target, observation,
};

/// The most navigations that are driven side by side; in a browser fewer, whose world is built within a frame.
const SIDE_BY_SIDE: usize = if cfg!(target_arch = "wasm32") { 50 } else { 512 };

/// How one navigation went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Navigation {
    /// How it ended.
    pub end: EpisodeEnd,
    /// Control steps until then.
    pub steps: u32,
    /// Where it started.
    pub start: Pose,
    /// Where it was to go.
    pub target: Target,
    /// The obstacles' clock at its start.
    pub clock: Clock,
    /// The layout's number, where the scenario has generators.
    pub layout: u64,
}

impl Navigation {
    /// Whether the target was reached.
    #[must_use]
    pub fn succeeded(&self) -> bool {
        self.end == EpisodeEnd::Reached
    }
}

/// How a set of navigations went.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Evaluation {
    /// Share of navigations that succeeded, 0 to 1.
    pub success_rate: f64,
    /// The same round by round (tables 2 and 5).
    pub rounds: Vec<f64>,
    /// Share that ended in a collision.
    pub collision_rate: f64,
    /// Share that ran out of time.
    pub timeout_rate: f64,
    /// Mean simulated time of the successful ones, in s; null without any.
    pub mean_time_s: Option<f64>,
    /// Mean simulated time of all, in s, where one that failed counts as the whole time limit: by it the best policy
    /// of a run is chosen.
    pub mean_cost_s: f64,
    /// How many navigations.
    pub navigations: usize,
    /// The seed of their starts and targets.
    pub seed: u64,
}

impl Evaluation {
    /// The rates and means of `navigations`, in rounds of `round` each.
    #[must_use]
    pub fn of(navigations: &[Navigation], round: usize, rules: &TaskRules, seed: u64) -> Self {
        let rate =
            |of: &[Navigation], end| of.iter().filter(|n| n.end == end).count() as f64 / of.len() as f64;
        Self {
            success_rate: rate(navigations, EpisodeEnd::Reached),
            rounds: navigations.chunks(round).map(|chunk| rate(chunk, EpisodeEnd::Reached)).collect(),
            collision_rate: rate(navigations, EpisodeEnd::Collided),
            timeout_rate: rate(navigations, EpisodeEnd::TimedOut),
            mean_time_s: mean_time_s(navigations, rules.control_period_s),
            mean_cost_s: mean_cost_s(navigations, rules),
            navigations: navigations.len(),
            seed,
        }
    }
}

/// The simulated time of each successful navigation, in s.
pub fn times_s(navigations: &[Navigation], control_period_s: f32) -> impl Iterator<Item = f64> {
    navigations
        .iter()
        .filter(|n| n.succeeded())
        .map(move |n| to_microsecond(f64::from(n.steps) * period_s(control_period_s)))
}

fn mean_time_s(navigations: &[Navigation], control_period_s: f32) -> Option<f64> {
    let (count, sum) =
        times_s(navigations, control_period_s).fold((0_u32, 0.0), |(n, sum), t| (n + 1, sum + t));
    (count > 0).then(|| to_microsecond(sum / f64::from(count)))
}

fn mean_cost_s(navigations: &[Navigation], rules: &TaskRules) -> f64 {
    let steps = |n: &Navigation| if n.succeeded() { n.steps } else { rules.time_limit_steps };
    let sum: u64 = navigations.iter().map(|n| u64::from(steps(n))).sum();
    to_microsecond(sum as f64 / navigations.len() as f64 * period_s(rules.control_period_s))
}

/// The control period in s without its f32 rounding showing (0.2 is meant, not 0.200000003).
#[must_use]
pub fn period_s(control_period_s: f32) -> f64 {
    to_microsecond(f64::from(control_period_s))
}

/// Rounded to a microsecond: sums of a period's decimals do not come out even.
#[must_use]
pub fn to_microsecond(seconds: f64) -> f64 {
    (seconds * 1e6).round() / 1e6
}

/// What is known of the least time of each navigation, however it went: the planner's bounds, with full knowledge of
/// the world ([`planner::bounds`]), at its default resolution. In order; the same on any number of `threads` (0: one a
/// core).
#[must_use]
pub fn bounds(scenario: &Scenario, navigations: &[Navigation], threads: usize) -> Vec<Bounds> {
    let of = |n: &Navigation| {
        let start = (n.start.x_m, n.start.y_m, n.start.heading_rad);
        let target = (n.target.x_m, n.target.y_m);
        if scenario.generators.is_empty() {
            return planner::bounds(scenario, start, target, n.clock.0, Resolution::default());
        }
        planner::bounds(&scenario.furnished(n.layout), start, target, n.clock.0, Resolution::default())
    };
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let threads = if threads == 0 { cores() } else { threads }.min(navigations.len());
    // Some take a hundred times as long as others, so each thread takes whichever is next.
    let next = AtomicUsize::new(0);
    let work = || {
        let left = || {
            let index = next.fetch_add(1, Ordering::Relaxed);
            navigations.get(index).map(|navigation| (index, of(navigation)))
        };
        std::iter::from_fn(left).collect::<Vec<_>>()
    };
    let mut found: Vec<_> = std::thread::scope(|scope| {
        let workers: Vec<_> = (0..threads).map(|_| scope.spawn(work)).collect();
        workers
            .into_iter()
            .flat_map(|worker| worker.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic)))
            .collect()
    });
    found.sort_by_key(|(index, _)| *index);
    found.into_iter().map(|(_, bounds)| bounds).collect()
}

/// How the successful navigations compare with the least possible times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AgainstOptimum {
    /// How many were compared: those that succeeded and for which the planner found a way.
    pub navigations: usize,
    /// Mean time of the planner's ways, in s.
    pub optimum_mean_time_s: f64,
    /// Mean time of the policy over that: 1 is the optimum, if the planner found it.
    pub time_ratio: f64,
    /// Mean time of the policy over the mean of the proven lower bounds, 1 or more: the ratio to the true optimum is
    /// between `time_ratio` and this.
    pub lower_bound_ratio: f64,
}

impl AgainstOptimum {
    /// Compares `navigations` with their `bounds`, one for each ([`bounds`]). None if there is nothing to compare.
    #[must_use]
    pub fn of(navigations: &[Navigation], bounds: &[Bounds], rules: &TaskRules) -> Option<Self> {
        let (mut count, mut driven, mut planned, mut proven) = (0_usize, 0_u64, 0_u64, 0_u64);
        for (navigation, bounds) in navigations.iter().zip(bounds).filter(|(n, _)| n.succeeded()) {
            let Some(plan_steps) = bounds.plan_steps else { continue };
            count += 1;
            driven += u64::from(navigation.steps);
            planned += u64::from(plan_steps);
            proven += u64::from(bounds.lower_steps);
        }
        (count > 0).then(|| Self {
            navigations: count,
            optimum_mean_time_s: to_microsecond(
                planned as f64 / count as f64 * period_s(rules.control_period_s),
            ),
            time_ratio: driven as f64 / planned as f64,
            lower_bound_ratio: driven as f64 / proven as f64,
        })
    }
}

/// Plans every successful navigation anew with full knowledge of the world ([`bounds`]), on all cores. None if there
/// is nothing to compare, or the planner does not model the scenario ([`planner::is_modelled`]: a lag of the drive).
#[must_use]
pub fn against_optimum(scenario: &Scenario, navigations: &[Navigation]) -> Option<AgainstOptimum> {
    let succeeded: Vec<Navigation> = navigations.iter().filter(|n| n.succeeded()).copied().collect();
    AgainstOptimum::of(&succeeded, &bounds(scenario, &succeeded, 0), &scenario.task)
}

/// Navigations that are being driven.
pub struct Drive {
    seed: u64,
    count: usize,
    /// Those that are done.
    pub navigations: Vec<Navigation>,
    /// How those under way began.
    begun: Vec<ArenaState>,
    /// How, and after how many steps, those under way ended.
    ends: Vec<Option<(EpisodeEnd, u32)>>,
}

/// A world in which policies are tried, built once and used again.
pub struct Evaluator {
    world: World,
    scenario: Arc<Scenario>,
    arenas: usize,
}

impl Evaluator {
    /// An evaluator for up to `navigations` navigations at a time.
    #[must_use]
    pub fn new(scenario: &Arc<Scenario>, navigations: usize) -> Self {
        // (No result depends on how many are driven at once: fewer, where each has thousands of bodies.)
        let arenas = navigations.min(SIDE_BY_SIDE).min(MOST_BODIES / bodies_in(scenario)).max(1);
        // Its world alone: that may go from thread to thread, an app may not.
        let world = std::mem::take(simulation::navigating(scenario, arenas).world_mut());
        Self { world, scenario: scenario.clone(), arenas }
    }

    /// Drives `count` navigations with `policy`, which sees what its card says ([`policy_card::encoding`]); `places`
    /// says where from and to. Where navigation j starts and goes to depends on the scenario, `seed` and j alone.
    ///
    /// # Errors
    /// The policy is for other observations or actions than the scenario's; or no place was found for a start.
    pub fn run(
        &mut self,
        policy: &Policy,
        seed: u64,
        count: usize,
        places: Places,
    ) -> Result<Vec<Navigation>, RunError> {
        let mut drive = self.start(policy, seed, count, places)?;
        while !self.go_on(&mut drive)? {}
        Ok(drive.navigations)
    }

    /// Begins what [`Evaluator::run`] does, to be gone on with step by step.
    ///
    /// # Errors
    /// The policy is for other observations or actions than the scenario's.
    pub fn start(
        &mut self,
        policy: &Policy,
        seed: u64,
        count: usize,
        places: Places,
    ) -> Result<Drive, RunError> {
        self.follow(policy, places)?;
        Ok(Drive { seed, count, navigations: Vec::with_capacity(count), begun: Vec::new(), ends: Vec::new() })
    }

    /// One control step of `drive`, which must be the one that was started last; gives whether all is driven.
    ///
    /// # Errors
    /// No place was found for a start.
    pub fn go_on(&mut self, drive: &mut Drive) -> Result<bool, RunError> {
        if drive.navigations.len() >= drive.count {
            return Ok(true);
        }
        let world = &mut self.world;
        if drive.ends.is_empty() {
            let (seed, first) = (drive.seed, drive.navigations.len());
            let batch = self.arenas.min(drive.count - first);
            sim::rewind(world, |arena| (arena < batch).then(|| fresh(seed, (first + arena) as u64)));
            drive.begun = sim::snapshot(world);
            drive.ends = vec![None; batch];
        }
        simulation::step(world)?;
        for ended in world.resource_mut::<Messages<EpisodeEnded>>().drain() {
            drive.ends[ended.arena] = Some((ended.end, ended.steps));
        }
        // The time limit ends every navigation.
        if drive.ends.iter().all(Option::is_some) {
            let driven = drive.ends.drain(..).flatten().zip(drive.begun.drain(..));
            drive.navigations.extend(driven.map(|((end, steps), state)| Navigation {
                end,
                steps,
                start: state.pose,
                target: state.target,
                clock: state.clock,
                layout: state.layout,
            }));
        }
        Ok(drive.navigations.len() >= drive.count)
    }

    /// Drives navigation 0 of [`Evaluator::run`] alone: how it went, and the robot's pose after 0, 1, ... steps.
    ///
    /// # Errors
    /// As [`Evaluator::run`].
    pub fn trace(
        &mut self,
        policy: &Policy,
        seed: u64,
        places: Places,
    ) -> Result<(Navigation, Vec<Pose>), RunError> {
        self.follow(policy, places)?;
        let world = &mut self.world;
        sim::rewind(world, |arena| (arena == 0).then(|| fresh(seed, 0)));
        let begun = sim::snapshot(world).swap_remove(0);
        let mut robots = world.query::<(&Arena, &Pose)>();
        let mut poses = vec![begun.pose];
        // The time limit ends it.
        loop {
            simulation::step(&mut self.world)?;
            let world = &mut self.world;
            poses.extend(robots.iter(world).find(|(arena, _)| arena.0 == 0).map(|(_, pose)| *pose));
            let ended = world.resource_mut::<Messages<EpisodeEnded>>().drain().last();
            if let Some(EpisodeEnded { end, steps, .. }) = ended {
                let ArenaState { pose: start, target, clock, layout, .. } = begun;
                return Ok((Navigation { end, steps, start, target, clock, layout }, poses));
            }
        }
    }

    /// From now on `policy` drives, from and to where `places` says.
    fn follow(&mut self, policy: &Policy, places: Places) -> Result<(), RunError> {
        fits(policy, &self.scenario)?;
        let world = &mut self.world;
        world.insert_resource(policy_card::encoding(policy)?);
        world.insert_resource(GreedyPolicy(policy.clone()));
        world.insert_resource(places);
        Ok(())
    }
}

/// The streams of navigation `index` of the test with `seed`, and the obstacles' clock at its start.
#[must_use]
pub fn fresh(seed: u64, index: u64) -> (Streams, Clock) {
    let clock = random::below(&mut random::stream(seed, "navigation: clock", index), 100_000);
    let streams = Streams {
        places: random::stream(seed, "navigation: places", index),
        sensor: random::stream(seed, "navigation: sensor", index),
    };
    (streams, Clock(clock as u64))
}

/// Whether `policy` can drive in `scenario`.
///
/// # Errors
/// It cannot; what differs.
pub fn fits(policy: &Policy, scenario: &Scenario) -> Result<(), RunError> {
    policy_card::encoding(policy)?;
    let shape = policy.network.shape();
    let inputs = observation::width(scenario.lidar.beams);
    let actions = scenario.robot.motions.len();
    if (shape.inputs, shape.actions) == (inputs, actions) {
        return Ok(());
    }
    Err(RunError::Unusable(format!(
        "the policy takes {} numbers and chooses among {} motions, but scenario \"{}\" gives {inputs} numbers \
         ({} beams and 4) and has {actions} motions: use the scenario it was trained in, or one with as many beams \
         and motions",
        shape.inputs, shape.actions, scenario.name, scenario.lidar.beams
    )))
}
