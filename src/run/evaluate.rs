//! Evaluation of a policy: success rates and times over rounds of episodes and on the benchmark route, and the comparison
//! with optimal times.
//!
//! In: a policy, a scenario, a seed. Out: the episodes and an [`Evaluation`]. Episode j depends only on the policy, the
//! scenario, the seed and j.
//!
//! **Success**: the robot gets closer to the goal than l_a (0.2 m) before a LIDAR range is below l_c (0.13 m) or its body
//! touches anything, within the scenario's time limit (500 steps, 100 s). An episode has one start and one goal, drawn from
//! random streams that training never uses, and starts at one moment of the obstacles' motion.

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

/// Maximum number of parallel episodes. In a browser it is smaller, because the simulation is built within a frame.
const MAX_PARALLEL: usize = if cfg!(target_arch = "wasm32") { 50 } else { 512 };

/// The result of one episode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EpisodeResult {
    /// The reason of its end.
    pub end: EpisodeEnd,
    /// Its length in control steps.
    pub steps: u32,
    /// The robot's initial pose.
    pub start: Pose,
    /// The goal.
    pub goal: Goal,
    /// The obstacles' clock at the start.
    pub clock: Clock,
    /// The seed of the generated obstacles' layout, if the scenario has generators.
    pub layout_seed: u64,
}

impl EpisodeResult {
    /// Whether the robot reached the goal.
    #[must_use]
    pub fn succeeded(&self) -> bool {
        self.end == EpisodeEnd::Reached
    }
}

/// The rates and mean times of a set of episodes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Evaluation {
    /// Share of episodes that succeeded, 0 to 1.
    pub success_rate: f64,
    /// The success rate of each round (tables 2 and 5 of the paper).
    pub rounds: Vec<f64>,
    /// Share of episodes that ended in a collision, 0 to 1.
    pub collision_rate: f64,
    /// Share of episodes that ended at the time limit, 0 to 1.
    pub timeout_rate: f64,
    /// Mean simulated time of the successful episodes, in s; `None` without any.
    pub mean_time_s: Option<f64>,
    /// Mean cost, in s: the simulated time of an episode, or the whole time limit if it failed. The best policy of a run is
    /// chosen by it.
    pub mean_cost_s: f64,
    /// Number of episodes.
    pub episodes: usize,
    /// The seed of their starts and goals.
    pub seed: u64,
}

impl Evaluation {
    /// The evaluation of `episodes`, with `round` episodes per round.
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

/// The simulated time of each successful episode, in s.
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

/// The control period in s, without the rounding error of `f32`: 0.2, not 0.200000003.
#[must_use]
pub fn period_s(control_period_s: f32) -> f64 {
    round_to_microsecond(f64::from(control_period_s))
}

/// `seconds`, rounded to a microsecond, which removes the rounding errors of sums.
#[must_use]
pub fn round_to_microsecond(seconds: f64) -> f64 {
    (seconds * 1e6).round() / 1e6
}

/// Bounds on the optimal time of each episode, in the order of `episodes`: those of the planner, which knows the whole
/// scenario ([`planner::step_bounds`]), at its default resolution. The number of `threads` (0: one per core) does not change
/// the result.
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
    // Some plans take a hundred times as long as others, so threads take episodes one at a time.
    let next = AtomicUsize::new(0);
    let work = || {
        let next_bounds = || {
            let index = next.fetch_add(1, Ordering::Relaxed);
            episodes.get(index).map(|episode| (index, of(episode)))
        };
        std::iter::from_fn(next_bounds).collect::<Vec<_>>()
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

/// The comparison of successful episodes with optimal times.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OptimumComparison {
    /// Number of compared episodes: those that succeeded and for which the planner found a path.
    pub episodes: usize,
    /// Mean time of the planned paths, in s.
    pub optimum_mean_time_s: f64,
    /// Mean time of the policy divided by that of the planned paths. 1 is optimal if the planned paths are.
    pub time_ratio: f64,
    /// Mean time of the policy divided by the mean of the proven lower bounds, 1 or more. The ratio to the true optimum lies
    /// between `time_ratio` and this.
    pub lower_bound_ratio: f64,
}

impl OptimumComparison {
    /// Compares each of `episodes` with its [`bounds`]. `None` if there is nothing to compare.
    #[must_use]
    pub fn from_episodes(
        episodes: &[EpisodeResult],
        bounds: &[StepBounds],
        rules: &TaskRules,
    ) -> Option<Self> {
        let (mut count, mut actual, mut planned, mut proven) = (0_usize, 0_u64, 0_u64, 0_u64);
        for (episode, bounds) in episodes.iter().zip(bounds).filter(|(n, _)| n.succeeded()) {
            let Some(plan_steps) = bounds.plan_steps else { continue };
            count += 1;
            actual += u64::from(episode.steps);
            planned += u64::from(plan_steps);
            proven += u64::from(bounds.lower_steps);
        }
        (count > 0).then(|| Self {
            episodes: count,
            optimum_mean_time_s: round_to_microsecond(
                planned as f64 / count as f64 * period_s(rules.control_period_s),
            ),
            time_ratio: actual as f64 / planned as f64,
            lower_bound_ratio: actual as f64 / proven as f64,
        })
    }
}

/// Compares the successful episodes with their [`bounds`], computed on all cores. `None` if there is nothing to compare, or
/// the planner does not model the scenario ([`planner::is_supported`]; it does not model actuator lag).
#[must_use]
pub fn compare_with_optimum(scenario: &Scenario, episodes: &[EpisodeResult]) -> Option<OptimumComparison> {
    let succeeded: Vec<EpisodeResult> = episodes.iter().filter(|n| n.succeeded()).copied().collect();
    OptimumComparison::from_episodes(&succeeded, &bounds(scenario, &succeeded, 0), &scenario.task)
}

/// An evaluation in progress.
pub struct EvaluationRun {
    seed: u64,
    count: usize,
    /// The episodes that have ended.
    pub episodes: Vec<EpisodeResult>,
    /// The initial states of the current episodes.
    initial: Vec<ArenaState>,
    /// The reason and number of control steps of each current episode that has ended.
    ends: Vec<Option<(EpisodeEnd, u32)>>,
}

/// A simulation for evaluations. It is built once and can be reused with other policies.
pub struct Evaluator {
    simulation: Simulation,
    scenario: Arc<Scenario>,
    arenas: usize,
}

impl Evaluator {
    /// An evaluator of up to `episodes` parallel episodes.
    #[must_use]
    pub fn new(scenario: &Arc<Scenario>, episodes: usize) -> Self {
        Self::with_extensions(scenario, episodes, &Extensions::default())
    }

    /// An evaluator with the plugins that the policy was trained with.
    #[must_use]
    pub fn with_extensions(scenario: &Arc<Scenario>, episodes: usize, extensions: &Extensions) -> Self {
        // Fewer arenas if each has thousands of bodies. The number of arenas does not change any result.
        let arenas = episodes.min(MAX_PARALLEL).min(MAX_BODIES / bodies_per_arena(scenario)).max(1);
        let simulation = SimulationBuilder::new(scenario)
            .arenas(arenas)
            .mode(TaskMode::SingleGoal)
            .agent(ActionSelection::Greedy)
            .extensions(extensions)
            .build();
        Self { simulation, scenario: scenario.clone(), arenas }
    }

    /// Runs `count` episodes with `policy`, whose card sets the encoding of its observations ([`policy_card::encoding`]).
    /// `setup` sets the starts and goals. Those of episode j depend only on the scenario, `seed` and j.
    ///
    /// # Errors
    /// The policy's observations or actions are not those of the scenario, or there is no free space for a start.
    pub fn run(
        &mut self,
        policy: &Policy,
        seed: u64,
        count: usize,
        setup: EpisodeSetup,
    ) -> Result<Vec<EpisodeResult>, RunError> {
        let mut run = self.start(policy, seed, count, setup)?;
        while !self.step(&mut run)? {}
        Ok(run.episodes)
    }

    /// Starts an evaluation that [`Evaluator::step`] continues one control step at a time.
    ///
    /// # Errors
    /// The policy's observations or actions are not those of the scenario.
    pub fn start(
        &mut self,
        policy: &Policy,
        seed: u64,
        count: usize,
        setup: EpisodeSetup,
    ) -> Result<EvaluationRun, RunError> {
        self.use_policy(policy, setup)?;
        Ok(EvaluationRun {
            seed,
            count,
            episodes: Vec::with_capacity(count),
            initial: Vec::new(),
            ends: Vec::new(),
        })
    }

    /// Takes one control step of `run`, which must be the evaluation that was started last. Returns whether all episodes have
    /// ended.
    ///
    /// # Errors
    /// There is no free space for a start.
    pub fn step(&mut self, run: &mut EvaluationRun) -> Result<bool, RunError> {
        if run.episodes.len() >= run.count {
            return Ok(true);
        }
        let world = self.simulation.world_mut();
        if run.ends.is_empty() {
            let (seed, first) = (run.seed, run.episodes.len());
            let batch = self.arenas.min(run.count - first);
            sim::reset_arenas(world, |arena| {
                (arena < batch).then(|| episode_streams(seed, (first + arena) as u64))
            });
            run.initial = sim::snapshot(world);
            run.ends = vec![None; batch];
        }
        simulation::step(world)?;
        for ended in world.resource_mut::<Messages<EpisodeEnded>>().drain() {
            run.ends[ended.arena] = Some((ended.end, ended.steps));
        }
        // The time limit ends every episode.
        if run.ends.iter().all(Option::is_some) {
            let ended = run.ends.drain(..).flatten().zip(run.initial.drain(..));
            run.episodes.extend(ended.map(|((end, steps), state)| EpisodeResult {
                end,
                steps,
                start: state.pose,
                goal: state.goal,
                clock: state.clock,
                layout_seed: state.layout_seed,
            }));
        }
        Ok(run.episodes.len() >= run.count)
    }

    /// Runs only episode 0 of [`Evaluator::run`]. Returns its result and the robot's poses after 0, 1, ... control steps.
    ///
    /// # Errors
    /// As for [`Evaluator::run`].
    pub fn trace(
        &mut self,
        policy: &Policy,
        seed: u64,
        setup: EpisodeSetup,
    ) -> Result<(EpisodeResult, Vec<Pose>), RunError> {
        self.use_policy(policy, setup)?;
        let world = self.simulation.world_mut();
        sim::reset_arenas(world, |arena| (arena == 0).then(|| episode_streams(seed, 0)));
        let initial = sim::snapshot(world).swap_remove(0);
        let mut robots = world.query::<(&Arena, &Pose)>();
        let mut poses = vec![initial.pose];
        // The time limit ends the episode.
        loop {
            self.simulation.step()?;
            let world = self.simulation.world_mut();
            poses.extend(robots.iter(world).find(|(arena, _)| arena.0 == 0).map(|(_, pose)| *pose));
            let ended = world.resource_mut::<Messages<EpisodeEnded>>().drain().last();
            if let Some(EpisodeEnded { end, steps, .. }) = ended {
                let ArenaState { pose: start, goal, clock, layout_seed, .. } = initial;
                return Ok((EpisodeResult { end, steps, start, goal, clock, layout_seed }, poses));
            }
        }
    }

    /// Makes `policy` choose the actions and `setup` the starts and goals of the next episodes.
    fn use_policy(&mut self, policy: &Policy, setup: EpisodeSetup) -> Result<(), RunError> {
        let layout = self.simulation.world().resource::<ObservationLayout>();
        check_compatible(policy, &self.scenario, layout)?;
        let network = QNetwork::from_policy(policy).map_err(|error| RunError::Failed(error.to_string()))?;
        let world = self.simulation.world_mut();
        world.resource_mut::<ObservationLayout>().encoding = policy_card::encoding(policy)?;
        world.insert_resource(GreedyPolicy(network));
        world.insert_resource(setup);
        Ok(())
    }
}

/// The random streams of episode `index` of the evaluation with `seed`, and the obstacles' clock at its start.
#[must_use]
pub fn episode_streams(seed: u64, index: u64) -> (Streams, Clock) {
    let clock = random::uniform_index(&mut random::stream(seed, "navigation: clock", index), 100_000);
    let streams = Streams {
        places: random::stream(seed, "navigation: places", index),
        sensor: random::stream(seed, "navigation: sensor", index),
    };
    (streams, Clock(clock as u64))
}

/// Checks that `policy` fits the observations (`layout`) and actions of `scenario`.
///
/// # Errors
/// The policy's inputs or actions, and those of the scenario.
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
         ({} beams and 4) and has {actions} motions; help: use the scenario it was trained in, or one with as many beams \
         and motions",
        shape.inputs, shape.actions, scenario.name, scenario.lidar.beams
    )))
}
