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

use std::sync::Arc;

use bevy::prelude::*;

use crate::control_step::{ControlSet, ControlStep};
use crate::policy::Encoding;
use crate::scenario::Scenario;
use crate::sim;
use crate::simulation::{Extensions, Simulation, SimulationBuilder, StepError};
use crate::task::{
    Actions, Clock, EpisodeEnded, ObservationLayout, Observations, RewardConfig, StepOutcome, StepOutcomes,
    Streams, TaskFault, TaskMode,
};

/// The options of a [`VecEnv`].
#[derive(Clone, Debug)]
pub struct VecEnvConfig {
    /// The number of environments, at least 1. The results of environment k do not depend on it.
    pub num_envs: usize,
    /// The units of the observation, eq. (8).
    pub encoding: Encoding,
    /// The parameters of the reward, eqs. (3) to (7).
    pub reward: RewardConfig,
    /// What happens when a robot reaches its goal. [`TaskMode::Episodic`] ends the episode. [`TaskMode::Continuing`] is the
    /// paper's training, in which the episode continues with a new goal.
    pub mode: TaskMode,
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
            extensions: Extensions::default(),
        }
    }
}

/// An error of a [`VecEnv`].
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum VecEnvError {
    /// The number of actions is not the number of environments.
    #[error("{given} actions were given for {num_envs} environments; give one action per environment")]
    ActionCount {
        /// The number of actions given.
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
    /// The simulation failed.
    #[error(transparent)]
    Step(#[from] StepError),
}

/// The results of one step, one element per environment. Observations are rows of `observation_width()` numbers.
#[derive(Clone, Copy, Debug)]
pub struct Step<'a> {
    /// The observations for the next actions: `num_envs` rows. After the end of an episode, the first observation of the
    /// next episode.
    pub observations: &'a [f32],
    /// The rewards.
    pub rewards: &'a [f32],
    /// Whether the return ends with this step, because the robot collided or reached its goal.
    pub terminated: &'a [bool],
    /// Whether the time limit ended the episode.
    pub truncated: &'a [bool],
    /// The observations after the step and before any reset: `num_envs` rows. Bootstrap truncated returns from these.
    pub final_observations: &'a [f32],
    /// The outcomes in detail: reward terms, goal reached, collision.
    pub outcomes: &'a [StepOutcome],
    /// The episodes that ended with this step, in the order of the environments.
    pub ended: &'a [EpisodeEnded],
}

/// Environments of one scenario, stepped together. When an episode ends, the next one starts in the same step.
///
/// Without plugins, a step allocates no memory except inside rapier.
pub struct VecEnv {
    simulation: Simulation,
    num_envs: usize,
    num_actions: usize,
    observation_width: usize,
    rewards: Vec<f32>,
    terminated: Vec<bool>,
    truncated: Vec<bool>,
    ended: Vec<EpisodeEnded>,
}

/// A copy of the observations after the step and before any reset.
#[derive(Resource, Default)]
struct FinalObservations(Vec<f32>);

impl VecEnv {
    /// Environments of `scenario`, ready to step with seed 0. [`reset`](Self::reset) sets another seed.
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
            num_actions: scenario.robot.motions.len(),
            observation_width: width,
            rewards: vec![0.0; num_envs],
            terminated: vec![false; num_envs],
            truncated: vec![false; num_envs],
            ended: Vec::new(),
        };
        env.simulation.world_mut().resource_mut::<FinalObservations>().0 = vec![0.0; num_envs * width];
        env.check_fault()?;
        Ok(env)
    }

    /// Starts a new episode in every environment with the random streams of `seed`. Returns the first observations:
    /// `num_envs` rows.
    ///
    /// # Errors
    /// No free space was found for a start or goal.
    pub fn reset(&mut self, seed: u64) -> Result<&[f32], VecEnvError> {
        let world = self.simulation.world_mut();
        world.insert_resource(TaskFault::default());
        sim::reset_arenas(world, |arena| Some((Streams::new(seed, arena as u64), Clock::default())));
        self.check_fault()?;
        Ok(self.observations())
    }

    /// Runs one control step (0.2 s by default) in every environment. `actions[k]` is the action of environment k, an index
    /// into the robot's motions.
    ///
    /// # Errors
    /// The number of actions is wrong, an action is out of range, or the simulation failed.
    pub fn step(&mut self, actions: &[usize]) -> Result<Step<'_>, VecEnvError> {
        self.check_actions(actions)?;
        self.simulation.world_mut().resource_mut::<Actions>().0.copy_from_slice(actions);
        self.simulation.step()?;
        self.ended.clear();
        self.ended.extend(self.simulation.world_mut().resource_mut::<Messages<EpisodeEnded>>().drain());
        let outcomes = &self.simulation.world().resource::<StepOutcomes>().0;
        for (env, outcome) in outcomes.iter().enumerate() {
            self.rewards[env] = outcome.total_reward();
            self.terminated[env] = outcome.terminated();
            self.truncated[env] = outcome.truncated();
        }
        Ok(Step {
            observations: self.observations(),
            rewards: &self.rewards,
            terminated: &self.terminated,
            truncated: &self.truncated,
            final_observations: &self.simulation.world().resource::<FinalObservations>().0,
            outcomes,
            ended: &self.ended,
        })
    }

    /// The observations for the next actions: `num_envs` rows of `observation_width()` numbers.
    #[must_use]
    pub fn observations(&self) -> &[f32] {
        &self.simulation.world().resource::<Observations>().current
    }

    /// The number of environments.
    #[must_use]
    pub fn num_envs(&self) -> usize {
        self.num_envs
    }

    /// The number of discrete actions, which is the number of the robot's motions.
    #[must_use]
    pub fn num_actions(&self) -> usize {
        self.num_actions
    }

    /// The length of an observation: 28 with the paper's 24 beams, plus the slices of plugins' sensors.
    #[must_use]
    pub fn observation_width(&self) -> usize {
        self.observation_width
    }

    /// The underlying simulation, which gives access to everything else: poses, scans, states of arenas.
    pub fn simulation_mut(&mut self) -> &mut Simulation {
        &mut self.simulation
    }

    fn check_actions(&self, actions: &[usize]) -> Result<(), VecEnvError> {
        let (num_envs, num_actions) = (self.num_envs, self.num_actions);
        if actions.len() != num_envs {
            return Err(VecEnvError::ActionCount { given: actions.len(), num_envs });
        }
        match actions.iter().enumerate().find(|(_, action)| **action >= num_actions) {
            Some((env, &action)) => Err(VecEnvError::Action { env, action, num_actions }),
            None => Ok(()),
        }
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
