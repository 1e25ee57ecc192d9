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

use super::limits::MAX_BODIES;
use super::memory::bodies_per_arena;
use super::{RunError, policy_card};
use crate::agent::{ActionSelection, GreedyPolicy};
use crate::learning::QNetwork;
use crate::planner::{self, Resolution, StepBounds};
use crate::policy::Policy;
use crate::random;
use crate::scenario::{Scenario, TaskRules};
use crate::sim;
use crate::simulation::{self, Extensions, Simulation, SimulationBuilder};
use crate::task::{
    Arena, ArenaState, Clock, EpisodeEnd, EpisodeEnded, EpisodeSetup, Goal, ObservationLayout, Pose, Streams,
    TaskMode,
};

/// The most episodes that are driven side by side; in a browser fewer, whose world is built within a frame.
const SIDE_BY_SIDE: usize = if cfg!(target_arch = "wasm32") { 50 } else { 512 };

/// How one navigation went.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EpisodeResult {
    /// How it ended.
    pub end: EpisodeEnd,
    /// Control steps until then.
    pub steps: u32,
    /// Where it started.
    pub start: Pose,
    /// Where it was to go.
    pub goal: Goal,
    /// The obstacles' clock at its start.
    pub clock: Clock,
    /// The layout's number, where the scenario has generators.
    pub layout_seed: u64,
}

impl EpisodeResult {
    /// Whether the target was reached.
    #[must_use]
    pub fn succeeded(&self) -> bool {
        self.end == EpisodeEnd::Reached
    }
}

/// How a set of episodes went.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Evaluation {
    /// Share of episodes that succeeded, 0 to 1.
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
    /// How many episodes.
    pub episodes: usize,
    /// The seed of their starts and goals.
    pub seed: u64,
}

impl Evaluation {
    /// The rates and means of `episodes`, in rounds of `round` each.
    #[must_use]
    pub fn from_episodes(episodes: &[EpisodeResult], round: usize, rules: &TaskRules, seed: u64) -> Self {
        let rate =
            |of: &[EpisodeResult], end| of.iter().filter(|n| n.end == end).count() as f64 / of.len() as f64;
        Self {
            success_rate: rate(episodes, EpisodeEnd::Reached),
            rounds: episodes.chunks(round).map(|chunk| rate(chunk, EpisodeEnd::Reached)).collect(),
            collision_rate: rate(episodes, EpisodeEnd::Collided),
            timeout_rate: rate(episodes, EpisodeEnd::TimedOut),
            mean_time_s: mean_time_s(episodes, rules.control_period_s),
            mean_cost_s: mean_cost_s(episodes, rules),
            episodes: episodes.len(),
            seed,
        }
    }
}

/// The simulated time of each successful navigation, in s.
pub fn times_s(episodes: &[EpisodeResult], control_period_s: f32) -> impl Iterator<Item = f64> {
    episodes
        .iter()
        .filter(|n| n.succeeded())
        .map(move |n| round_to_microsecond(f64::from(n.steps) * period_s(control_period_s)))
}

fn mean_time_s(episodes: &[EpisodeResult], control_period_s: f32) -> Option<f64> {
    let (count, sum) = times_s(episodes, control_period_s).fold((0_u32, 0.0), |(n, sum), t| (n + 1, sum + t));
    (count > 0).then(|| round_to_microsecond(sum / f64::from(count)))
}

fn mean_cost_s(episodes: &[EpisodeResult], rules: &TaskRules) -> f64 {
    let steps = |n: &EpisodeResult| if n.succeeded() { n.steps } else { rules.max_episode_steps };
    let sum: u64 = episodes.iter().map(|n| u64::from(steps(n))).sum();
    round_to_microsecond(sum as f64 / episodes.len() as f64 * period_s(rules.control_period_s))
}

/// The control period in s without its f32 rounding showing (0.2 is meant, not 0.200000003).
#[must_use]
pub fn period_s(control_period_s: f32) -> f64 {
    round_to_microsecond(f64::from(control_period_s))
}

/// Rounded to a microsecond: sums of a period's decimals do not come out even.
#[must_use]
pub fn round_to_microsecond(seconds: f64) -> f64 {
    (seconds * 1e6).round() / 1e6
}

/// What is known of the least time of each navigation, however it went: the planner's bounds, with full knowledge of
/// the world ([`planner::step_bounds`]), at its default resolution. In order; the same on any number of `threads` (0: one a
/// core).
#[must_use]
pub fn bounds(scenario: &Scenario, episodes: &[EpisodeResult], threads: usize) -> Vec<StepBounds> {
    let of = |n: &EpisodeResult| {
        let start = (n.start.x_m, n.start.y_m, n.start.heading_rad);
        let goal = vec2(n.goal.x_m, n.goal.y_m);
        if scenario.generators.is_empty() {
            return planner::step_bounds(scenario, start, goal, n.clock.0, Resolution::default());
        }
        planner::step_bounds(
            &scenario.with_generated_obstacles(n.layout_seed),
            start,
            goal,
            n.clock.0,
            Resolution::default(),
        )
    };
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let threads = if threads == 0 { cores() } else { threads }.min(episodes.len());
    // Some take a hundred times as long as others, so each thread takes whichever is next.
    let next = AtomicUsize::new(0);
    let work = || {
        let left = || {
            let index = next.fetch_add(1, Ordering::Relaxed);
            episodes.get(index).map(|episode| (index, of(episode)))
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

/// How the successful episodes compare with the least possible times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OptimumComparison {
    /// How many were compared: those that succeeded and for which the planner found a way.
    pub episodes: usize,
    /// Mean time of the planner's ways, in s.
    pub optimum_mean_time_s: f64,
    /// Mean time of the policy over that: 1 is the optimum, if the planner found it.
    pub time_ratio: f64,
    /// Mean time of the policy over the mean of the proven lower bounds, 1 or more: the ratio to the true optimum is
    /// between `time_ratio` and this.
    pub lower_bound_ratio: f64,
}

impl OptimumComparison {
    /// Compares `episodes` with their `bounds`, one for each ([`bounds`]). None if there is nothing to compare.
    #[must_use]
    pub fn from_episodes(
        episodes: &[EpisodeResult],
        bounds: &[StepBounds],
        rules: &TaskRules,
    ) -> Option<Self> {
        let (mut count, mut driven, mut planned, mut proven) = (0_usize, 0_u64, 0_u64, 0_u64);
        for (episode, bounds) in episodes.iter().zip(bounds).filter(|(n, _)| n.succeeded()) {
            let Some(plan_steps) = bounds.plan_steps else { continue };
            count += 1;
            driven += u64::from(episode.steps);
            planned += u64::from(plan_steps);
            proven += u64::from(bounds.lower_steps);
        }
        (count > 0).then(|| Self {
            episodes: count,
            optimum_mean_time_s: round_to_microsecond(
                planned as f64 / count as f64 * period_s(rules.control_period_s),
            ),
            time_ratio: driven as f64 / planned as f64,
            lower_bound_ratio: driven as f64 / proven as f64,
        })
    }
}

/// Plans every successful navigation anew with full knowledge of the world ([`bounds`]), on all cores. None if there
/// is nothing to compare, or the planner does not model the scenario ([`planner::is_supported`]: a lag of the drive).
#[must_use]
pub fn compare_with_optimum(scenario: &Scenario, episodes: &[EpisodeResult]) -> Option<OptimumComparison> {
    let succeeded: Vec<EpisodeResult> = episodes.iter().filter(|n| n.succeeded()).copied().collect();
    OptimumComparison::from_episodes(&succeeded, &bounds(scenario, &succeeded, 0), &scenario.task)
}

/// Navigations that are being driven.
pub struct EvaluationRun {
    seed: u64,
    count: usize,
    /// Those that are done.
    pub episodes: Vec<EpisodeResult>,
    /// How those under way began.
    begun: Vec<ArenaState>,
    /// How, and after how many steps, those under way ended.
    ends: Vec<Option<(EpisodeEnd, u32)>>,
}

/// A world in which policies are tried, built once and used again.
pub struct Evaluator {
    simulation: Simulation,
    scenario: Arc<Scenario>,
    arenas: usize,
}

impl Evaluator {
    /// An evaluator for up to `episodes` episodes at a time.
    #[must_use]
    pub fn new(scenario: &Arc<Scenario>, episodes: usize) -> Self {
        Self::with_extensions(scenario, episodes, &Extensions::default())
    }

    /// The same, with the plugins that the policy was trained with.
    #[must_use]
    pub fn with_extensions(scenario: &Arc<Scenario>, episodes: usize, extensions: &Extensions) -> Self {
        // (No result depends on how many are driven at once: fewer, where each has thousands of bodies.)
        let arenas = episodes.min(SIDE_BY_SIDE).min(MAX_BODIES / bodies_per_arena(scenario)).max(1);
        let simulation = SimulationBuilder::new(scenario)
            .arenas(arenas)
            .mode(TaskMode::SingleGoal)
            .agent(ActionSelection::Greedy)
            .extensions(extensions)
            .build();
        Self { simulation, scenario: scenario.clone(), arenas }
    }

    /// Drives `count` episodes with `policy`, which sees what its card says ([`policy_card::encoding`]); `places`
    /// says where from and to. Where navigation j starts and goes to depends on the scenario, `seed` and j alone.
    ///
    /// # Errors
    /// The policy is for other observations or actions than the scenario's; or no place was found for a start.
    pub fn run(
        &mut self,
        policy: &Policy,
        seed: u64,
        count: usize,
        places: EpisodeSetup,
    ) -> Result<Vec<EpisodeResult>, RunError> {
        let mut drive = self.start(policy, seed, count, places)?;
        while !self.step(&mut drive)? {}
        Ok(drive.episodes)
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
        places: EpisodeSetup,
    ) -> Result<EvaluationRun, RunError> {
        self.follow(policy, places)?;
        Ok(EvaluationRun {
            seed,
            count,
            episodes: Vec::with_capacity(count),
            begun: Vec::new(),
            ends: Vec::new(),
        })
    }

    /// One control step of `drive`, which must be the one that was started last; gives whether all is driven.
    ///
    /// # Errors
    /// No place was found for a start.
    pub fn step(&mut self, drive: &mut EvaluationRun) -> Result<bool, RunError> {
        if drive.episodes.len() >= drive.count {
            return Ok(true);
        }
        let world = self.simulation.world_mut();
        if drive.ends.is_empty() {
            let (seed, first) = (drive.seed, drive.episodes.len());
            let batch = self.arenas.min(drive.count - first);
            sim::reset_arenas(world, |arena| {
                (arena < batch).then(|| episode_streams(seed, (first + arena) as u64))
            });
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
            drive.episodes.extend(driven.map(|((end, steps), state)| EpisodeResult {
                end,
                steps,
                start: state.pose,
                goal: state.goal,
                clock: state.clock,
                layout_seed: state.layout_seed,
            }));
        }
        Ok(drive.episodes.len() >= drive.count)
    }

    /// Drives navigation 0 of [`Evaluator::run`] alone: how it went, and the robot's pose after 0, 1, ... steps.
    ///
    /// # Errors
    /// As [`Evaluator::run`].
    pub fn trace(
        &mut self,
        policy: &Policy,
        seed: u64,
        places: EpisodeSetup,
    ) -> Result<(EpisodeResult, Vec<Pose>), RunError> {
        self.follow(policy, places)?;
        let world = self.simulation.world_mut();
        sim::reset_arenas(world, |arena| (arena == 0).then(|| episode_streams(seed, 0)));
        let begun = sim::snapshot(world).swap_remove(0);
        let mut robots = world.query::<(&Arena, &Pose)>();
        let mut poses = vec![begun.pose];
        // The time limit ends it.
        loop {
            self.simulation.step()?;
            let world = self.simulation.world_mut();
            poses.extend(robots.iter(world).find(|(arena, _)| arena.0 == 0).map(|(_, pose)| *pose));
            let ended = world.resource_mut::<Messages<EpisodeEnded>>().drain().last();
            if let Some(EpisodeEnded { end, steps, .. }) = ended {
                let ArenaState { pose: start, goal, clock, layout_seed, .. } = begun;
                return Ok((EpisodeResult { end, steps, start, goal, clock, layout_seed }, poses));
            }
        }
    }

    /// From now on `policy` drives, from and to where `places` says.
    fn follow(&mut self, policy: &Policy, places: EpisodeSetup) -> Result<(), RunError> {
        let layout = self.simulation.world().resource::<ObservationLayout>();
        check_compatible(policy, &self.scenario, layout)?;
        let network = QNetwork::from_policy(policy).map_err(|error| RunError::Failed(error.to_string()))?;
        let world = self.simulation.world_mut();
        world.resource_mut::<ObservationLayout>().encoding = policy_card::encoding(policy)?;
        world.insert_resource(GreedyPolicy(network));
        world.insert_resource(places);
        Ok(())
    }
}

/// The streams of navigation `index` of the test with `seed`, and the obstacles' clock at its start.
#[must_use]
pub fn episode_streams(seed: u64, index: u64) -> (Streams, Clock) {
    let clock = random::uniform_index(&mut random::stream(seed, "navigation: clock", index), 100_000);
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
pub fn check_compatible(
    policy: &Policy,
    scenario: &Scenario,
    layout: &ObservationLayout,
) -> Result<(), RunError> {
    policy_card::encoding(policy)?;
    policy_card::check_sensors(policy, layout)?;
    let shape = policy.shape();
    let inputs = layout.width(scenario.lidar.beams);
    let actions = scenario.robot.motions.len();
    if (shape.inputs, shape.actions) == (inputs, actions) {
        return Ok(());
    }
    Err(RunError::InvalidInput(format!(
        "the policy takes {} numbers and chooses among {} motions, but scenario \"{}\" gives {inputs} numbers \
         ({} beams and 4) and has {actions} motions: use the scenario it was trained in, or one with as many beams \
         and motions",
        shape.inputs, shape.actions, scenario.name, scenario.lidar.beams
    )))
}
