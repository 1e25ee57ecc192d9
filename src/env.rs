//! A vectorized environment with Gymnasium's interface: many robots, stepped together by the caller's actions.
//!
//! ```
//! use wayfield::env::{VecEnv, VecEnvConfig};
//! use wayfield::scenario::Scenario;
//!
//! let mut env = VecEnv::new(&Scenario::default(), VecEnvConfig { num_envs: 16, ..VecEnvConfig::default() })?;
//! env.reset(7)?;
//! let mut total = 0.0;
//! for _ in 0..100 {
//!     // Action 2 of the default robot: straight ahead at 0.15 m/s.
//!     let step = env.step(&[2; 16])?;
//!     total += step.rewards.iter().sum::<f32>();
//! }
//! assert!(total.is_finite());
//! # Ok::<(), wayfield::env::VecEnvError>(())
//! ```

mod commands;

use std::sync::Arc;

use bevy::prelude::*;

pub(crate) use commands::CommandRules;
pub use commands::Commands;

use crate::control_step::{ControlSet, ControlStep};
use crate::policy::Encoding;
use crate::scenario::{Motion, Scenario};
use crate::sim;
use crate::simulation::{Extensions, Simulation, SimulationBuilder, StepError};
use crate::task::{
    DeferResets, EpisodeEnded, ObservationLayout, Observations, PendingReset, RewardConfig, StepOutcome,
    StepOutcomes, Streams, TaskFault, TaskMode,
};

/// When the next episode, or with [`TaskMode::Continuing`] the next goal, begins: Gymnasium's autoreset modes. The episodes are
/// the same in every mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Autoreset {
    /// In the step that ends the episode or reaches the goal.
    #[default]
    SameStep,
    /// In the following step, which ignores the environment's action and has a reward of 0.
    NextStep,
    /// When the caller asks for it ([`VecEnv::reset_selected`]). Until then, no environment can be stepped.
    Disabled,
}

/// The options of a [`VecEnv`].
#[derive(Clone, Debug)]
pub struct VecEnvConfig {
    /// The number of environments, at least 1. The results of environment k do not depend on it.
    pub num_envs: usize,
    /// The encoding of the observation.
    pub encoding: Encoding,
    /// The parameters of the reward, eqs. (3) to (7).
    pub reward: RewardConfig,
    /// What happens when a robot reaches its goal. [`TaskMode::Episodic`] ends the episode. [`TaskMode::Continuing`] is the
    /// paper's training, in which the episode continues with a new goal.
    pub mode: TaskMode,
    /// When the next episode, or with [`TaskMode::Continuing`] the next goal, begins.
    pub autoreset: Autoreset,
    /// Plugins with sensors and reward terms.
    pub extensions: Extensions,
}

impl Default for VecEnvConfig {
    fn default() -> Self {
        Self {
            num_envs: 1,
            encoding: Encoding::default(),
            reward: RewardConfig::default(),
            mode: TaskMode::Episodic,
            autoreset: Autoreset::default(),
            extensions: Extensions::default(),
        }
    }
}

/// An error of a [`VecEnv`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum VecEnvError {
    /// The number of actions, or of other values, is not the number of environments.
    #[error("{given} values were given for {num_envs} environments; help: give one per environment")]
    ActionCount {
        /// The number of values given.
        given: usize,
        /// The number of environments.
        num_envs: usize,
    },
    /// An action is out of range.
    #[error("action {action} of environment {env} is out of range: the robot has actions 0 to {}", .num_actions - 1)]
    Action {
        /// The environment's index.
        env: usize,
        /// The action.
        action: usize,
        /// The number of actions.
        num_actions: usize,
    },
    /// The speed or the turning rate of a commanded motion is not finite.
    #[error("the motion of environment {env} is not finite; help: give finite numbers in m/s and rad/s")]
    Motion {
        /// The environment's index.
        env: usize,
    },
    /// With [`Autoreset::Disabled`], a step was requested while an environment waits for its reset.
    #[error("the episode of environment {env} has ended; help: reset it before the next step")]
    Ended {
        /// The environment's index.
        env: usize,
    },
    /// The simulation failed.
    #[error(transparent)]
    Step(#[from] StepError),
}

/// The results of one step, one element per environment. Observations are rows of `observation_width()` numbers.
#[derive(Clone, Copy, Debug)]
pub struct Step<'a> {
    /// The observations for the next actions: `num_envs` rows. After the end of an episode, the first observation of the
    /// next episode, if it begins in the same step.
    pub observations: &'a [f32],
    /// The rewards.
    pub rewards: &'a [f32],
    /// Whether the return ends with this step, because the robot collided or reached its goal.
    pub terminated: &'a [bool],
    /// Whether the time limit ended the episode, and the robot neither collided nor reached its goal in this step.
    pub truncated: &'a [bool],
    /// The observations after the step and before any reset: `num_envs` rows. Bootstrap truncated returns from these.
    pub final_observations: &'a [f32],
    /// The outcomes in detail: reward terms, goal reached, collision.
    pub outcomes: &'a [StepOutcome],
    /// The episodes that ended with this step, in the order of the environments.
    pub ended: &'a [EpisodeEnded],
}

/// Environments of one scenario, stepped together. [`Autoreset`] determines when the next episode begins.
pub struct VecEnv {
    simulation: Simulation,
    num_envs: usize,
    observation_width: usize,
    command_rules: CommandRules,
    mode: TaskMode,
    autoreset: Autoreset,
    /// The resets that ended environments wait for.
    pending: Vec<PendingReset>,
    rewards: Vec<f32>,
    terminated: Vec<bool>,
    truncated: Vec<bool>,
    ended: Vec<EpisodeEnded>,
}

/// A copy of the observations after the step and before any reset.
#[derive(Resource, Default)]
struct FinalObservations(Vec<f32>);

impl VecEnv {
    /// Creates environments of `scenario`, ready to step with seed 0. [`reset`](Self::reset) sets another seed.
    ///
    /// # Errors
    /// No free space was found for a start or goal.
    pub fn new(scenario: &Scenario, config: VecEnvConfig) -> Result<Self, VecEnvError> {
        let num_envs = config.num_envs.max(1);
        let simulation = SimulationBuilder::new(&Arc::new(scenario.clone()))
            .arenas(num_envs)
            .encoding(config.encoding)
            .reward(config.reward)
            .mode(config.mode)
            .extensions(&config.extensions.plugin(KeepFinalObservations))
            .build();
        let width = simulation.world().resource::<ObservationLayout>().width(scenario.lidar.beams);
        let mut env = Self {
            simulation,
            num_envs,
            observation_width: width,
            command_rules: CommandRules::of(scenario),
            mode: config.mode,
            autoreset: config.autoreset,
            pending: vec![PendingReset::None; num_envs],
            rewards: vec![0.0; num_envs],
            terminated: vec![false; num_envs],
            truncated: vec![false; num_envs],
            ended: Vec::new(),
        };
        let world = env.simulation.world_mut();
        world.resource_mut::<FinalObservations>().0 = vec![0.0; num_envs * width];
        world.insert_resource(DeferResets(config.autoreset != Autoreset::SameStep));
        env.check_fault()?;
        Ok(env)
    }

    /// Starts a new episode in every environment with the random streams of `seed`. Returns the first observations:
    /// `num_envs` rows.
    ///
    /// # Errors
    /// No free space was found for a start or goal.
    pub fn reset(&mut self, seed: u64) -> Result<&[f32], VecEnvError> {
        self.restart(Some(seed), |_| true)
    }

    /// Starts a new episode in the environments k for which `selected[k]` is true; the others stay as they are. With a seed,
    /// the selected environments get its random streams; otherwise theirs continue, and with [`TaskMode::Continuing`] a robot
    /// that has just reached its goal stays where it is and gets a new goal. Returns the observations of all environments:
    /// `num_envs` rows.
    ///
    /// # Errors
    /// The length of `selected` is wrong, or no free space was found for a start or goal.
    pub fn reset_selected(&mut self, selected: &[bool], seed: Option<u64>) -> Result<&[f32], VecEnvError> {
        commands::check_count(selected.len(), self.num_envs)?;
        self.restart(seed, |env| selected[env])
    }

    /// Runs one control step (0.2 s by default) in every environment. `actions[k]` is the action of environment k, an index
    /// into the robot's motions.
    ///
    /// # Errors
    /// The number of actions is wrong, an action is out of range, an environment waits for its reset, or the simulation
    /// failed.
    pub fn step(&mut self, actions: &[usize]) -> Result<Step<'_>, VecEnvError> {
        self.step_by(Commands::Actions(actions))
    }

    /// Runs one control step in every environment. `motions[k]` is the speed and turning rate commanded in environment k,
    /// limited as [`Commands::Motions`] describes.
    ///
    /// # Errors
    /// As for [`step`](Self::step), or a motion is not finite.
    pub fn step_motions(&mut self, motions: &[Motion]) -> Result<Step<'_>, VecEnvError> {
        self.step_by(Commands::Motions(motions))
    }

    /// The observations for the next actions: `num_envs` rows of `observation_width()` numbers.
    #[must_use]
    pub fn observations(&self) -> &[f32] {
        &self.simulation.world().resource::<Observations>().current
    }

    /// The observations after the last step and before any reset: `num_envs` rows.
    #[must_use]
    pub fn final_observations(&self) -> &[f32] {
        &self.simulation.world().resource::<FinalObservations>().0
    }

    /// The number of environments.
    #[must_use]
    pub fn num_envs(&self) -> usize {
        self.num_envs
    }

    /// The number of discrete actions, which is the number of the robot's motions.
    #[must_use]
    pub fn num_actions(&self) -> usize {
        self.command_rules.num_actions
    }

    /// The length of an observation: 28 for the paper's observation with 24 beams, plus the readings of plugin sensors.
    #[must_use]
    pub fn observation_width(&self) -> usize {
        self.observation_width
    }

    /// The underlying simulation, which gives access to everything else: poses, scans, states of arenas.
    pub fn simulation_mut(&mut self) -> &mut Simulation {
        &mut self.simulation
    }

    /// The limits of commanded motions: the smallest and the largest speed and turning rate among the robot's motions and 0.
    #[must_use]
    pub fn motion_limits(&self) -> (Motion, Motion) {
        (self.command_rules.low, self.command_rules.high)
    }

    /// Resets the selected environments, as [`reset_selected`](Self::reset_selected) describes.
    fn restart(
        &mut self,
        seed: Option<u64>,
        selected: impl Fn(usize) -> bool,
    ) -> Result<&[f32], VecEnvError> {
        let world = self.simulation.world_mut();
        world.insert_resource(TaskFault::default());
        // A failed step may leave its messages behind.
        world.resource_mut::<Messages<EpisodeEnded>>().clear();
        if let Some(seed) = seed {
            sim::seed_scenarios(world, seed, &selected);
        }
        let pending = &self.pending;
        sim::restart_arenas(world, |env| {
            selected(env).then(|| match (seed, pending[env]) {
                (Some(seed), _) => (PendingReset::Full, Some(Streams::new(seed, env as u64))),
                (None, PendingReset::Goal) => (PendingReset::Goal, None),
                (None, _) => (PendingReset::Episode, None),
            })
        });
        let restarted = self.pending.iter_mut().enumerate().filter(|(env, _)| selected(*env));
        restarted.for_each(|(_, pending)| *pending = PendingReset::None);
        self.check_fault()?;
        Ok(self.observations())
    }

    fn step_by(&mut self, commands: Commands<'_>) -> Result<Step<'_>, VecEnvError> {
        self.command_rules.apply(commands, self.num_envs, self.simulation.world_mut())?;
        let waits = |pending: &PendingReset| *pending != PendingReset::None;
        let first_waiting = self.pending.iter().position(waits);
        if let (Autoreset::Disabled, Some(env)) = (self.autoreset, first_waiting) {
            return Err(VecEnvError::Ended { env });
        }
        self.simulation.step()?;
        if first_waiting.is_some() {
            let pending = &self.pending;
            sim::restart_arenas(self.simulation.world_mut(), |env| {
                waits(&pending[env]).then_some((pending[env], None))
            });
            self.check_fault()?;
        }
        self.ended.clear();
        self.ended.extend(self.simulation.world_mut().resource_mut::<Messages<EpisodeEnded>>().drain());
        let outcomes = &self.simulation.world().resource::<StepOutcomes>().0;
        for (env, outcome) in outcomes.iter().enumerate() {
            self.rewards[env] = outcome.total_reward();
            self.terminated[env] = outcome.terminated();
            self.truncated[env] = outcome.truncated();
            if self.autoreset != Autoreset::SameStep {
                self.pending[env] = outcome.reset(self.mode);
            }
        }
        Ok(Step {
            observations: self.observations(),
            rewards: &self.rewards,
            terminated: &self.terminated,
            truncated: &self.truncated,
            final_observations: self.final_observations(),
            outcomes,
            ended: &self.ended,
        })
    }

    fn check_fault(&self) -> Result<(), VecEnvError> {
        match &self.simulation.world().resource::<TaskFault>().0 {
            Some(fault) => Err(StepError::from(fault.clone()).into()),
            None => Ok(()),
        }
    }
}

/// Copies the observations after each step, before arenas are reset.
#[derive(Clone)]
struct KeepFinalObservations;

impl Plugin for KeepFinalObservations {
    fn build(&self, app: &mut App) {
        app.init_resource::<FinalObservations>()
            .add_systems(ControlStep, keep_final_observations.in_set(ControlSet::Store));
    }
}

fn keep_final_observations(observations: Res<Observations>, mut kept: ResMut<FinalObservations>) {
    if kept.0.len() == observations.next.len() {
        kept.0.copy_from_slice(&observations.next);
    }
}
