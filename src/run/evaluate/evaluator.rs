//! The simulation that runs evaluation episodes.

use std::sync::Arc;

use bevy::prelude::*;

use super::path::{PathQuery, PathTracker};
use super::{EpisodeResult, Evaluated, Evaluation};
use crate::agent::{ActionSelection, ActionSource, ActionSources, DriverKind, DriverSource, GreedyPolicy};
use crate::drivers::DrivingPolicy;
use crate::learning::QNetwork;
use crate::limits::MAX_BODIES;
use crate::policy::{Encoding, Policy};
use crate::random;
use crate::run::memory::bodies_per_arena;
use crate::run::{RunError, policy_card};
use crate::scenario::Scenario;
use crate::sim;
use crate::simulation::{self, Extensions, Simulation, SimulationBuilder};
use crate::task::{
    ActiveActionSet, ArenaState, Clock, CommandedMotions, EpisodeEnd, EpisodeEnded, EpisodeSetup,
    ObservationLayout, Observations, ScenarioPool, Streams, TaskFault, TaskMode,
};

/// Maximum number of parallel episodes. In a browser it is smaller, because the simulation is built within a
/// frame.
const MAX_PARALLEL: usize = if cfg!(target_arch = "wasm32") { 50 } else { 512 };

/// An evaluation in progress.
pub struct EvaluationRun {
    seed: u64,
    count: usize,
    /// The number of the first episode, from 0.
    pub(super) first: usize,
    /// The episodes that have ended.
    pub episodes: Vec<EpisodeResult>,
    /// The initial states of the current episodes.
    initial: Vec<ArenaState>,
    /// For each current episode, why it ended and after how many control steps; `None` while it runs.
    ends: Vec<Option<(EpisodeEnd, u32)>>,
    /// The paths of the current episodes, if they are measured.
    paths: Vec<PathTracker>,
}

impl EvaluationRun {
    pub(super) fn new(seed: u64, count: usize) -> Self {
        Self {
            seed,
            count,
            first: 0,
            episodes: Vec::with_capacity(count),
            initial: Vec::new(),
            ends: Vec::new(),
            paths: Vec::new(),
        }
    }

    /// The number of episodes that run at present.
    #[must_use]
    pub fn parallel_episodes(&self) -> usize {
        self.ends.len()
    }
}

/// A simulation for evaluations. It is built once and can be reused with other policies and drivers.
pub struct Evaluator {
    simulation: Simulation,
    scenario: Arc<Scenario>,
    arenas: usize,
    /// Set if paths are measured.
    path_query: Option<PathQuery>,
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
        let arenas = Self::parallel_arenas(scenario, episodes);
        let simulation = SimulationBuilder::new(scenario)
            .arenas(arenas)
            .mode(TaskMode::SingleGoal)
            .agent(ActionSelection::Greedy)
            .extensions(extensions)
            .build();
        Self { simulation, scenario: scenario.clone(), arenas, path_query: None }
    }

    /// The number of arenas for an evaluation of `episodes` episodes: fewer if each has thousands of bodies. It does not change
    /// any result.
    pub(crate) fn parallel_arenas(scenario: &Scenario, episodes: usize) -> usize {
        episodes.min(MAX_PARALLEL).min(MAX_BODIES / bodies_per_arena(scenario)).max(1)
    }

    /// This evaluator, but with [measures of the robot's path](EpisodeResult::path) in its results. This takes a little time,
    /// and changes nothing else.
    #[must_use]
    pub fn measuring_paths(mut self) -> Self {
        self.path_query = Some(PathQuery::new(self.simulation.world_mut()));
        self
    }

    /// Runs `count` episodes with `evaluated`. The card of a policy sets the encoding of its observations
    /// ([`policy_card::encoding`]). `setup` sets the starts and goals. Those of episode j depend only on the
    /// scenario, `seed` and j.
    ///
    /// # Errors
    /// The policy's observations or actions are not those of the scenario, or a step failed ([`simulation::step`]).
    pub fn run<'a>(
        &mut self,
        evaluated: impl Into<Evaluated<'a>>,
        seed: u64,
        count: usize,
        setup: EpisodeSetup,
    ) -> Result<Vec<EpisodeResult>, RunError> {
        let mut run = self.start(evaluated, seed, count, setup)?;
        while !self.step(&mut run)? {}
        Ok(run.episodes)
    }

    /// Starts an evaluation that [`Evaluator::step`] continues one control step at a time.
    ///
    /// # Errors
    /// The policy's observations or actions are not those of the scenario.
    pub fn start<'a>(
        &mut self,
        evaluated: impl Into<Evaluated<'a>>,
        seed: u64,
        count: usize,
        setup: EpisodeSetup,
    ) -> Result<EvaluationRun, RunError> {
        match evaluated.into() {
            Evaluated::Policy(policy) => self.use_policy(policy)?,
            Evaluated::PolicyWithMap(policy) => self.use_policy_with_map(policy)?,
            Evaluated::Driver(driver) => self.use_driver(&DriverKind::Classical(driver.clone())),
        }
        let world = self.simulation.world_mut();
        world.resource_mut::<CommandedMotions>().0.clear();
        world.insert_resource(setup);
        Ok(EvaluationRun::new(seed, count))
    }

    /// Takes one control step of `run`, which must be the evaluation that was started last. Returns whether
    /// all episodes have ended.
    ///
    /// # Errors
    /// The step failed, as in [`simulation::step`].
    pub fn step(&mut self, run: &mut EvaluationRun) -> Result<bool, RunError> {
        if run.episodes.len() >= run.count {
            return Ok(true);
        }
        self.begin_if_needed(run);
        self.advance(run)?;
        Ok(run.episodes.len() >= run.count)
    }

    /// Begins the next parallel episodes of `run`, if none are in progress and some remain.
    pub(super) fn begin_if_needed(&mut self, run: &mut EvaluationRun) {
        let remaining = run.count - run.episodes.len();
        if run.ends.is_empty() && remaining > 0 {
            self.begin(run, self.arenas.min(remaining));
        }
    }

    /// Starts the next `batch` episodes of `run`, one per arena.
    pub(super) fn begin(&mut self, run: &mut EvaluationRun, batch: usize) {
        let (seed, first) = (run.seed, run.first + run.episodes.len());
        let world = self.simulation.world_mut();
        // An evaluation that failed must not make this one fail, too.
        world.insert_resource(TaskFault::default());
        world.resource_mut::<Messages<EpisodeEnded>>().clear();
        if let Some(pool) = world.get_resource::<ScenarioPool>() {
            let scenarios = pool.evaluation(seed, first + batch);
            sim::assign_scenarios(world, |arena| scenarios.get(first + arena).copied().unwrap_or_default());
        }
        sim::reset_arenas(world, |arena| {
            (arena < batch).then(|| episode_streams(seed, (first + arena) as u64))
        });
        run.initial = sim::snapshot(world);
        run.ends = vec![None; batch];
        if let Some(query) = &mut self.path_query {
            let mut starts = Vec::new();
            query.read(world, |arena, pose, clearance| {
                starts.push((arena, PathTracker::new(pose, clearance())));
            });
            starts.sort_by_key(|(arena, _)| *arena);
            run.paths = starts.into_iter().map(|(_, path)| path).collect();
        }
    }

    /// Takes one control step of the current episodes of `run`, and adds their results when all of them have ended.
    pub(super) fn advance(&mut self, run: &mut EvaluationRun) -> Result<(), RunError> {
        let world = self.simulation.world_mut();
        simulation::step(world)?;
        if let Some(query) = &mut self.path_query {
            query.read(world, |arena, pose, clearance| {
                if let (Some(None), Some(path)) = (run.ends.get(arena), run.paths.get_mut(arena)) {
                    path.add(pose, clearance());
                }
            });
        }
        for ended in world.resource_mut::<Messages<EpisodeEnded>>().drain() {
            run.ends[ended.arena] = Some((ended.end, ended.steps));
        }
        // The time limit ends every episode.
        if run.ends.iter().all(Option::is_some) {
            let ended = run.ends.drain(..).flatten().zip(run.initial.drain(..)).enumerate();
            run.episodes.extend(ended.map(|(arena, ((end, steps), state))| EpisodeResult {
                end,
                steps,
                start: state.pose,
                goal: state.goal,
                clock: state.clock,
                layout_seed: state.layout_seed,
                path: run.paths.get(arena).map(|path| path.finish(end)),
            }));
        }
        Ok(())
    }

    /// The evaluation of all `episodes` of a run with `seed`, with `round` episodes per round.
    #[must_use]
    pub fn evaluation(&self, episodes: &[EpisodeResult], round: usize, seed: u64) -> Evaluation {
        match self.simulation.world().get_resource::<ScenarioPool>() {
            Some(pool) => Evaluation::over_pool(episodes, round, pool, seed),
            None => Evaluation::from_episodes(episodes, round, &self.scenario.task, seed),
        }
    }

    pub(super) fn world_mut(&mut self) -> &mut World {
        self.simulation.world_mut()
    }

    pub(super) fn arenas(&self) -> usize {
        self.arenas
    }

    pub(super) fn scenario(&self) -> &Scenario {
        &self.scenario
    }

    /// Makes a driver choose the actions of the next episodes.
    fn use_driver(&mut self, driver: &DriverKind) {
        let source = |_| ActionSource::Driver(DriverSource::new(driver.clone()));
        let arenas = (0..self.arenas).map(source).collect();
        let world = self.simulation.world_mut();
        world.insert_resource(ActiveActionSet::default());
        world.insert_resource(ActionSources { arenas, num_actions: self.scenario.robot.motions.len() });
        world.insert_resource(ActionSelection::PerArena);
    }

    /// Makes `policy` with a map choose the actions of the next episodes.
    fn use_policy_with_map(&mut self, policy: &DrivingPolicy) -> Result<(), RunError> {
        self.check_policy(&policy.policy)?;
        policy_card::check_without_sensors(&policy.policy)?;
        self.use_driver(&DriverKind::Policy(policy.clone()));
        Ok(())
    }

    /// Checks that `policy` fits the scenario, or all scenarios of the pool.
    fn check_policy(&self, policy: &Policy) -> Result<(), RunError> {
        let world = self.simulation.world();
        let layout = world.resource::<ObservationLayout>();
        check_compatible(policy, &self.scenario, layout)?;
        match world.get_resource::<ScenarioPool>() {
            Some(pool) => pool.tasks().try_for_each(|scenario| check_compatible(policy, &scenario, layout)),
            None => Ok(()),
        }
    }

    /// Makes `policy` choose the actions of the next episodes.
    fn use_policy(&mut self, policy: &Policy) -> Result<(), RunError> {
        self.check_policy(policy)?;
        let network = QNetwork::from_policy(policy).map_err(|error| RunError::Failed(error.to_string()))?;
        let world = self.simulation.world_mut();
        set_observation(world, policy_card::encoding(policy)?, self.scenario.lidar.beams, self.arenas);
        world.insert_resource(ActiveActionSet(policy_card::action_set(policy)));
        world.insert_resource(GreedyPolicy(network));
        world.insert_resource(ActionSelection::Greedy);
        Ok(())
    }
}

/// Sets the encoding of the observations of `arenas` arenas with `beams` LIDAR beams, from the next reset on.
pub(super) fn set_observation(world: &mut World, encoding: Encoding, beams: usize, arenas: usize) {
    let mut layout = world.resource_mut::<ObservationLayout>();
    layout.encoding = encoding;
    let width = layout.width(beams);
    let mut observations = world.resource_mut::<Observations>();
    if observations.width != width {
        observations.resize(arenas, width);
    }
}

/// The random streams of episode `index` of the evaluation with `seed`, and the obstacles' clock at its
/// start.
#[must_use]
pub fn episode_streams(seed: u64, index: u64) -> (Streams, Clock) {
    let clock = random::uniform_index(&mut random::stream(seed, "navigation: clock", index), 100_000);
    let streams = Streams {
        placement: random::stream(seed, "navigation: places", index),
        sensor: random::stream(seed, "navigation: sensor", index),
    };
    (streams, Clock(clock as u64))
}

/// Checks that `policy` fits the observations (`layout`) and actions of `scenario`.
///
/// # Errors
/// The policy's inputs or actions differ from those of the scenario, or an action means something else there. The message
/// names both.
pub fn check_compatible(
    policy: &Policy,
    scenario: &Scenario,
    layout: &ObservationLayout,
) -> Result<(), RunError> {
    policy_card::check_sensors(policy, layout)?;
    let shape = policy.shape();
    let layout = ObservationLayout::new(policy_card::encoding(policy)?, layout.slices().to_vec());
    let inputs = layout.width(scenario.lidar.beams);
    let actions = policy_card::action_set(policy).len(scenario.robot.motions.len());
    if (shape.inputs, shape.actions) == (inputs, actions) {
        return policy_card::check_actions(policy, scenario);
    }
    let beams = scenario.lidar.beams;
    let (parts, needed) = if layout.encoding.sectors().is_some() {
        (String::new(), "motions")
    } else {
        (format!(" ({beams} beams and {})", inputs - beams), "beams and motions")
    };
    Err(RunError::InvalidInput(format!(
        "the policy takes {} numbers and chooses among {} motions, but scenario \"{}\" gives {inputs} numbers{parts} \
         and has {actions} motions; help: use the scenario it was trained in, or one with as many {needed}",
        shape.inputs, shape.actions, scenario.name
    )))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::shipped;
    use crate::task::Fault;

    #[test]
    fn an_evaluation_after_a_failed_one_has_the_usual_result() {
        let scenario = Arc::new(shipped::scenario("scenario-1").expect("shipped"));
        let policy = &shipped::policies()[0].policy;
        let mut evaluator = Evaluator::new(&scenario, 4);
        let expected = evaluator.run(policy, 4, 4, EpisodeSetup::Random).expect("episodes");
        let fault = Fault::NonFinite { arena: 0, step: 0, what: "the goal".into() };
        evaluator.world_mut().insert_resource(TaskFault(Some(fault)));
        assert_eq!(evaluator.run(policy, 4, 4, EpisodeSetup::Random), Ok(expected));
    }
}
