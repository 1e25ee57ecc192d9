//! The learner: DQN with prioritized replay, double Q-learning and dueling networks (algorithm 1 of the paper), each of
//! them optional.
//!
//! In: experiences, one per env step of each environment. Out: Q-values, epsilon, statistics of the gradient steps, a
//! policy.

mod update;

use super::config::{ConfigError, LearningConfig};
use super::limits::{MAX_ENVS, MAX_STORED_FLOATS};
use super::mirror::{Mirror, MirrorError};
use super::n_step::{NStepAccumulator, PendingStep, StepEnd};
use super::network::QNetwork;
use super::optimizer::OptimizerState;
use super::replay::ReplayBuffer;
use super::state_ring::StateId;
use serde::{Deserialize, Serialize};
use wayfield_policy::range::within;
use wayfield_policy::{Policy, PolicyError};
use wayfield_random::{Stream, stream};

use self::update::Scratch;
pub use self::update::UpdateStats;

/// One env step of one environment.
#[derive(Debug, Clone, Copy)]
pub struct Experience<'a> {
    /// The index of the environment, from 0.
    pub env_index: usize,
    /// The observation before the step.
    pub observation: &'a [f32],
    /// The index of the action taken.
    pub action: usize,
    /// The reward of the step, before `reward_scale`.
    pub reward: f32,
    /// The observation after the step, before any reset.
    pub next_observation: &'a [f32],
    /// Whether the step reached a terminal state (collision, goal reached): the return ends here, without bootstrapping.
    pub terminated: bool,
    /// Whether a time limit ended the episode: the return bootstraps from `next_observation`, but the next experience does
    /// not start there.
    pub truncated: bool,
}

/// The unfinished part of one environment's episode.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct Trajectory {
    /// The state after the last step, if the episode continues from there.
    pub(crate) last: Option<StateId>,
    pub(crate) n_step: NStepAccumulator,
}

/// Counters and the random stream.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct Counters {
    pub(crate) env_steps: u64,
    pub(crate) episodes: u64,
    pub(crate) gradient_steps: u64,
    /// Gradient steps that the next [`Learner::train`] will take.
    pub(crate) pending_updates: u32,
    /// The initial epsilon after a transfer; it replaces that of the schedule.
    pub(crate) epsilon_start: Option<f32>,
    /// The stream for sampling batches.
    pub(crate) sampling: Stream,
}

/// A DQN learner. It computes Q-values; the caller chooses the actions, for example with
/// [`epsilon_greedy`](super::epsilon_greedy).
///
/// The [crate documentation](crate) has an example.
#[derive(Debug, Clone)]
pub struct Learner {
    pub(crate) config: LearningConfig,
    pub(crate) online: QNetwork,
    pub(crate) target: QNetwork,
    pub(crate) optimizer: OptimizerState,
    pub(crate) replay: ReplayBuffer,
    pub(crate) trajectories: Vec<Trajectory>,
    pub(crate) counters: Counters,
    /// The largest |scaled reward| of an env step so far. In a learner restored from a checkpoint it starts at the largest
    /// |n-step return| of the stored transitions.
    pub(crate) largest_reward: f32,
    /// A counter: each gradient step with Q-values above the return bound adds 1, and every other gradient step subtracts 1,
    /// down to 0.
    steps_over_bound: u32,
    /// The stream that chooses the transitions to mirror; `None` without mirror augmentation.
    pub(crate) mirror_stream: Option<Stream>,
    mirror: Option<Mirror>,
    scratch: Scratch,
}

/// An error from loading a policy's weights into a learner.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LoadWeightsError {
    /// The policy's network has a different shape from the learner's.
    #[error(
        "the policy's network is {found}, but the learner's is {expected}; help: use a config with the network {found}"
    )]
    NetworkMismatch {
        /// The learner's network.
        expected: String,
        /// The policy's network.
        found: String,
    },
    /// A weight is NaN or infinite.
    #[error(transparent)]
    Policy(#[from] PolicyError),
    /// Epsilon is not a probability.
    #[error("epsilon is {0}; help: give 0 to 1")]
    InvalidEpsilon(f32),
}

impl Learner {
    /// A learner for observations of `inputs` values, `actions` actions and `num_envs` parallel environments. `seed`
    /// determines the initial weights and the sampled batches.
    ///
    /// # Errors
    /// A value of `config` or a size is out of range.
    pub fn new(
        config: &LearningConfig,
        inputs: usize,
        actions: usize,
        num_envs: usize,
        seed: u64,
    ) -> Result<Self, ConfigError> {
        config.check()?;
        within("num_envs", num_envs, 1..=MAX_ENVS)?;
        let shape = config.network.shape(inputs, actions)?;
        within("replay.capacity", config.replay.capacity, 1..=MAX_STORED_FLOATS / inputs)?;
        let online =
            QNetwork::with_quantiles(shape, config.quantiles, &mut stream(seed, "learning: weights", 0))?;
        Ok(Self {
            config: config.clone(),
            target: online.clone(),
            optimizer: OptimizerState::new(&config.optimizer, online.parameters().len()),
            replay: ReplayBuffer::new(&config.replay, inputs, num_envs * (config.n_step + 1)),
            trajectories: vec![Trajectory::default(); num_envs],
            counters: Counters {
                env_steps: 0,
                episodes: 0,
                gradient_steps: 0,
                pending_updates: 0,
                epsilon_start: None,
                sampling: stream(seed, "learning: sampling", 0),
            },
            largest_reward: 0.0,
            steps_over_bound: 0,
            mirror_stream: config.mirror.then(|| stream(seed, "learning: mirror", 0)),
            mirror: None,
            scratch: Scratch::default(),
            online,
        })
    }

    /// Sets the mirror image of observations and actions. Call it before [`Learner::train`] if the config has `mirror`; without
    /// `mirror` in the config, it has no effect.
    ///
    /// # Errors
    /// `mirror` has a different number of inputs or actions from the learner.
    pub fn set_mirror(&mut self, mirror: Mirror) -> Result<(), MirrorError> {
        let expected = (self.online.shape().inputs, self.online.shape().actions);
        if mirror.size() != expected {
            return Err(MirrorError::Size { expected, found: mirror.size() });
        }
        self.mirror = Some(mirror);
        Ok(())
    }

    /// Writes the Q-values of `n` observations (row-major, n x inputs) into `out` (row-major, n x actions).
    pub fn q_values(&self, observations: &[f32], n: usize, out: &mut Vec<f32>) {
        self.online.q_values(observations, n, out);
    }

    /// Stores and counts one env step. Within an episode, `observation` must equal the previous `next_observation` of the
    /// same environment: it is not stored again.
    ///
    /// # Panics
    /// If `env_index`, `action` or the length of an observation that is stored does not match the sizes given to
    /// [`Learner::new`].
    pub fn store(&mut self, experience: &Experience<'_>) {
        let Experience { env_index, observation, action, next_observation, .. } = *experience;
        assert!(action < self.online.shape().actions, "action {action} does not exist");
        let Self { trajectories, replay, config, largest_reward, .. } = self;
        let trajectory = &mut trajectories[env_index];
        let state = match trajectory.last {
            Some(id) if replay.can_begin_at(id) => id,
            _ => replay.push_state(observation),
        };
        let (next, end) = match (experience.terminated, experience.truncated) {
            (true, _) => (state, StepEnd::Terminated),
            (false, true) => (replay.push_state(next_observation), StepEnd::Truncated),
            (false, false) => (replay.push_state(next_observation), StepEnd::Ongoing),
        };
        trajectory.last = (end == StepEnd::Ongoing).then_some(next);
        let reward = experience.reward * config.reward_scale;
        *largest_reward = largest_reward.max(reward.abs());
        let step = PendingStep { state, action: action as u8, reward };
        trajectory.n_step.push(step, next, end, (config.n_step, config.gamma), |t| replay.push(&t));
        self.count_env_step();
    }

    /// Counts an env step, and adds its gradient steps to the pending ones.
    fn count_env_step(&mut self) {
        let Self { counters, config, replay, .. } = self;
        counters.env_steps += 1;
        let has_started =
            counters.env_steps >= config.replay.learning_starts && replay.len() >= config.batch_size;
        if has_started && counters.env_steps.is_multiple_of(config.train_freq) {
            counters.pending_updates = counters.pending_updates.saturating_add(config.gradient_steps);
        }
    }

    /// The number of gradient steps that [`Learner::train`] would take: `gradient_steps` for every `train_freq` env steps
    /// since its last call. Before `learning_starts` env steps, or with less than a batch in the replay buffer, no gradient
    /// steps are added.
    #[must_use]
    pub fn pending_updates(&self) -> u32 {
        self.counters.pending_updates
    }

    /// Counts a finished episode, for the schedule of epsilon.
    pub fn episode_ended(&mut self) {
        self.counters.episodes += 1;
    }

    /// The current probability of a random action, 0 to 1.
    #[must_use]
    pub fn epsilon(&self) -> f32 {
        let Counters { env_steps, episodes, epsilon_start, .. } = self.counters;
        self.config.exploration.epsilon(env_steps, episodes, epsilon_start)
    }

    /// The number of env steps stored so far, of all environments together.
    #[must_use]
    pub fn env_steps(&self) -> u64 {
        self.counters.env_steps
    }

    /// The number of finished episodes.
    #[must_use]
    pub fn episodes(&self) -> u64 {
        self.counters.episodes
    }

    /// The number of gradient steps taken.
    #[must_use]
    pub fn gradient_steps(&self) -> u64 {
        self.counters.gradient_steps
    }

    /// The config given to [`Learner::new`].
    #[must_use]
    pub fn config(&self) -> &LearningConfig {
        &self.config
    }

    /// The replay buffer.
    #[must_use]
    pub fn replay(&self) -> &ReplayBuffer {
        &self.replay
    }

    /// The online network, which selects the actions.
    #[must_use]
    pub fn network(&self) -> &QNetwork {
        &self.online
    }

    /// The target network.
    #[must_use]
    pub fn target_network(&self) -> &QNetwork {
        &self.target
    }

    /// Loads `policy`'s weights into both networks and resets the optimizer (knowledge transfer, section 3.2 of the
    /// paper). `epsilon` (0 to 1; 0.5 in the paper) replaces the initial epsilon of the exploration schedule.
    ///
    /// # Errors
    /// The policy's network has another shape, one of its weights is not finite, or `epsilon` is out of range.
    pub fn load_weights(&mut self, policy: &Policy, epsilon: Option<f32>) -> Result<(), LoadWeightsError> {
        let (expected, found) = (self.online.shape(), policy.shape());
        if expected != found {
            let (expected, found) = (expected.to_string(), found.to_string());
            return Err(LoadWeightsError::NetworkMismatch { expected, found });
        }
        policy.check_finite()?;
        if let Some(epsilon) = epsilon.filter(|e| !(0.0..=1.0).contains(e)) {
            return Err(LoadWeightsError::InvalidEpsilon(epsilon));
        }
        for network in [&mut self.online, &mut self.target] {
            network.load(policy);
        }
        self.optimizer = OptimizerState::new(&self.config.optimizer, self.online.parameters().len());
        self.counters.epsilon_start = epsilon;
        Ok(())
    }

    /// The online network as a policy, without a card.
    #[must_use]
    pub fn policy(&self) -> Policy {
        self.online.to_policy()
    }

    /// Ends the trajectories of all environments, for an unplanned reset of the environments. Steps that still wait for
    /// their n-step return are stored as truncated transitions.
    pub fn truncate_trajectories(&mut self) {
        let Self { trajectories, replay, config, .. } = self;
        for trajectory in trajectories {
            if let Some(last) = trajectory.last.take() {
                trajectory.n_step.flush(last, StepEnd::Truncated, config.gamma, |t| replay.push(&t));
            }
        }
    }
}

#[cfg(test)]
mod tests;
