//! The learner: remembers what the arenas do, and takes the gradient steps that are due.
//!
//! In: experiences, one per env step of an arena. Out: Q-values, epsilon, statistics of each training, a
//! policy. This is algorithm 1 of the paper with every part switchable: (double) (dueling) DQN with
//! (prioritized) replay.

use super::config::{ConfigError, LearningConfig, TargetUpdate, within};
use super::divergence::{
    DivergenceError, Overestimate, advice, non_finite_loss_cause, non_finite_weight_cause,
};
use super::n_step::{NStepAccumulator, PendingStep, StepEnd};
use super::network::{Gradient, QNetwork, Regression};
use super::optimizer::OptimizerState;
use super::replay::{Batch, ReplayBuffer, StateId};
use serde::{Deserialize, Serialize};
use wayfield_policy::{Policy, PolicyError, greedy};
use wayfield_random::{Stream, stream};

/// The most numbers in all observations of a replay buffer: 8 GB of them, 1 GB where addresses have 32 bits.
pub const MAX_STORED_FLOATS: usize = if usize::BITS > 32 { 1 << 31 } else { 1 << 28 };

/// So many gradient steps with Q-values beyond any return are no passing fit.
const MIN_OVERESTIMATE_STEPS: u32 = 50;

/// One env step of one arena.
#[derive(Debug, Clone, Copy)]
pub struct Experience<'a> {
    /// Which arena, 0 up to the learner's number of arenas.
    pub env_index: usize,
    /// What was observed.
    pub observation: &'a [f32],
    /// The index of the action taken.
    pub action: usize,
    /// What it brought, before `reward_scale`.
    pub reward: f32,
    /// What the step led to, before any reset.
    pub next_observation: &'a [f32],
    /// The return ends here (collision, target reached): nothing to bootstrap from.
    pub terminated: bool,
    /// A time limit: bootstrap from `next_observation`, but the chain of observations ends.
    pub truncated: bool,
}

/// Means over the gradient steps of one training.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct UpdateStats {
    /// How many there were.
    pub gradient_steps: u32,
    /// The loss, weighted as it was descended.
    pub loss: f32,
    /// |Q(s, a) - y|, in units of scaled reward.
    pub td_error: f32,
    /// Q(s, a) of the transitions sampled, in units of scaled reward.
    pub q: f32,
    /// Q-values beyond what any return can be, for some time now.
    pub overestimate: Option<Overestimate>,
}

/// What is followed of one arena.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(super) struct Trajectory {
    /// The next state of the last step, if the chain goes on from there.
    pub(super) last: Option<StateId>,
    pub(super) n_step: NStepAccumulator,
}

/// What is counted, and where the random numbers are.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(super) struct Counters {
    pub(super) env_steps: u64,
    pub(super) episodes: u64,
    pub(super) gradient_steps: u64,
    /// Outstanding gradient steps.
    pub(super) pending_updates: u32,
    /// What replaces the schedule's start of epsilon, after a transfer.
    pub(super) epsilon_start: Option<f32>,
    /// The replay buffer's draws.
    pub(super) sampling: Stream,
}

/// A Q-learning agent, short of choosing its actions (see [`super::epsilon_greedy`]).
#[derive(Debug, Clone)]
pub struct Learner {
    pub(super) config: LearningConfig,
    pub(super) online: QNetwork,
    pub(super) target: QNetwork,
    pub(super) optimizer: OptimizerState,
    pub(super) replay: ReplayBuffer,
    pub(super) trajectories: Vec<Trajectory>,
    pub(super) counters: Counters,
    /// The largest |scaled reward| of an env step so far; after a checkpoint is read, of a return over n steps among the
    /// transitions kept.
    pub(super) largest_reward: f32,
    /// Gradient steps whose Q-values were beyond any return, less those whose were not, from zero on.
    steps_over_bound: u32,
    scratch: Scratch,
}

/// Memory reused from step to step; it holds nothing from one step to the next.
#[derive(Debug, Clone, Default)]
struct Scratch {
    batch: Batch,
    gradient: Gradient,
    online_q: Vec<f32>,
    target_q: Vec<f32>,
    targets: Vec<f32>,
}

/// Why a policy's weights cannot be loaded into a learner.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum LoadWeightsError {
    /// The policy's network has another shape than the learner's.
    #[error(
        "the policy's network is {found}, but the preset's is {expected}; train with the policy's own shape"
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
    #[error("epsilon {0} is out of range; give 0 to 1")]
    InvalidEpsilon(f32),
}

impl Learner {
    /// A learner for observations of `inputs` numbers, `actions` actions and `num_envs` parallel environments, whose weights
    /// and draws are those of `seed`.
    ///
    /// # Errors
    /// A value of `config` or a size makes no sense.
    pub fn new(
        config: &LearningConfig,
        inputs: usize,
        actions: usize,
        num_envs: usize,
        seed: u64,
    ) -> Result<Self, ConfigError> {
        config.check()?;
        within("arenas", num_envs, 1..=65536)?;
        let shape = config.network.shape(inputs, actions)?;
        within("replay.capacity", config.replay.capacity, 1..=MAX_STORED_FLOATS / inputs)?;
        let online = QNetwork::new(shape, &mut stream(seed, "learning: weights", 0))?;
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
            scratch: Scratch::default(),
            online,
        })
    }

    /// The Q-values of `n` observations (row-major, n x inputs) into `out` (row-major, n x actions).
    pub fn q_values(&self, observations: &[f32], n: usize, out: &mut Vec<f32>) {
        self.online.q_values(observations, n, out);
    }

    /// Stores one env step and counts it. While an arena's chain is unbroken, `observation` is taken to be
    /// the last `next_observation` and not stored again.
    ///
    /// # Panics
    /// `env_index`, `action` or an observation's length is not what the learner was made for.
    pub fn store(&mut self, e: &Experience<'_>) {
        assert!(e.action < self.online.shape().actions, "action {} does not exist", e.action);
        let Self { trajectories, replay, config, largest_reward, .. } = self;
        let trajectory = &mut trajectories[e.env_index];
        let state = match trajectory.last {
            Some(id) if replay.holds(id) => id,
            _ => replay.push_state(e.observation),
        };
        let (next, end) = match (e.terminated, e.truncated) {
            (true, _) => (state, StepEnd::Terminated),
            (false, true) => (replay.push_state(e.next_observation), StepEnd::Truncated),
            (false, false) => (replay.push_state(e.next_observation), StepEnd::Ongoing),
        };
        trajectory.last = (end == StepEnd::Ongoing).then_some(next);
        let reward = e.reward * config.reward_scale;
        *largest_reward = largest_reward.max(reward.abs());
        let step = PendingStep { state, action: e.action as u8, reward };
        trajectory.n_step.push(step, next, end, (config.n_step, config.gamma), |t| replay.push(&t));

        let counters = &mut self.counters;
        counters.env_steps += 1;
        let warm = counters.env_steps >= config.replay.learning_starts && replay.len() >= config.batch_size;
        if warm && counters.env_steps.is_multiple_of(config.train_freq) {
            counters.pending_updates = counters.pending_updates.saturating_add(config.gradient_steps);
        }
    }

    /// Outstanding gradient steps: `gradient_steps` for every `train_freq` env steps since the last training,
    /// once warm-up is over and the replay buffer can fill a batch.
    #[must_use]
    pub fn pending_updates(&self) -> u32 {
        self.counters.pending_updates
    }

    /// Takes the outstanding gradient steps. `None` if there are none.
    ///
    /// # Errors
    /// The loss or a weight is no longer finite; the learner is of no more use then.
    pub fn train(&mut self) -> Result<Option<UpdateStats>, DivergenceError> {
        let pending_updates = std::mem::take(&mut self.counters.pending_updates);
        if pending_updates == 0 {
            return Ok(None);
        }
        let mut sum = UpdateStats { gradient_steps: pending_updates, ..UpdateStats::default() };
        for _ in 0..pending_updates {
            let step = self.gradient_step()?;
            sum.loss += step.loss;
            sum.td_error += step.td_error;
            sum.q += step.q;
            sum.overestimate = sum.overestimate.or(step.overestimate);
        }
        let n = pending_updates as f32;
        Ok(Some(UpdateStats { loss: sum.loss / n, td_error: sum.td_error / n, q: sum.q / n, ..sum }))
    }

    fn gradient_step(&mut self) -> Result<UpdateStats, DivergenceError> {
        let Self {
            config,
            online,
            target,
            optimizer,
            replay,
            counters,
            largest_reward,
            steps_over_bound,
            scratch,
            ..
        } = self;
        let Scratch { batch, gradient, online_q, target_q, targets } = scratch;
        let n = config.batch_size;
        counters.gradient_steps += 1;

        replay.sample(n, counters.env_steps, &mut counters.sampling, batch);
        target.q_values(&batch.next_states, n, target_q);
        if config.double {
            online.q_values(&batch.next_states, n, online_q);
        }
        let chooser = if config.double { &*online_q } else { &*target_q };
        td_targets(batch, chooser, target_q, targets);

        let on = Regression { actions: &batch.actions, targets, weights: &batch.weights, loss: config.loss };
        online.gradient(&batch.states, on, gradient);
        let (gradient_step, env_step) = (counters.gradient_steps, counters.env_steps);
        let diverged = |what| DivergenceError { gradient_step, env_step, what, advice: advice(config) };
        if !gradient.loss.is_finite() {
            let what = non_finite_loss_cause(&batch.rewards, target_q, &gradient.q, &gradient.td_errors);
            return Err(diverged(what));
        }
        let learning_rate = config.learning_rate.at(counters.env_steps);
        online.update(|weights| optimizer.step(&config.optimizer, learning_rate, weights, &gradient.values));
        if !all_finite(online.parameters()) {
            return Err(diverged(non_finite_weight_cause(online, &gradient.values, learning_rate)));
        }
        if !all_finite(&optimizer.second) {
            return Err(diverged("the square of a gradient is not finite".into()));
        }
        replay.update_priorities(&batch.slots, &gradient.td_errors);
        follow(config.target_update, counters.gradient_steps, online, target);

        let mean = |values: &[f32]| values.iter().sum::<f32>() / n as f32;
        let mean_size = |values: &[f32]| values.iter().map(|value| value.abs()).sum::<f32>() / n as f32;
        let (q, largest_reward) = (mean_size(&gradient.q), *largest_reward);
        let largest_return = largest_reward / (1.0 - config.gamma);
        // (Before the first reward that is one, nothing is known of any return.)
        let is_over_bound = largest_reward > 0.0 && q > largest_return;
        *steps_over_bound = if is_over_bound {
            steps_over_bound.saturating_add(1)
        } else {
            steps_over_bound.saturating_sub(1)
        };
        let overestimate =
            (is_over_bound && *steps_over_bound >= MIN_OVERESTIMATE_STEPS).then(|| Overestimate {
                gradient_step,
                env_step,
                q,
                largest_reward,
                largest_return,
                advice: advice(config),
            });
        let td_error = mean_size(&gradient.td_errors);
        let (loss, q) = (gradient.loss, mean(&gradient.q));
        Ok(UpdateStats { gradient_steps: 1, loss, td_error, q, overestimate })
    }

    /// Counts an episode, for the schedule of epsilon.
    pub fn episode_ended(&mut self) {
        self.counters.episodes += 1;
    }

    /// The chance of a random action now, 0 to 1.
    #[must_use]
    pub fn epsilon(&self) -> f32 {
        let Counters { env_steps, episodes, epsilon_start, .. } = self.counters;
        self.config.exploration.epsilon(env_steps, episodes, epsilon_start)
    }

    /// Env steps remembered, of all arenas together.
    #[must_use]
    pub fn env_steps(&self) -> u64 {
        self.counters.env_steps
    }

    /// Episodes ended.
    #[must_use]
    pub fn episodes(&self) -> u64 {
        self.counters.episodes
    }

    /// Gradient steps taken.
    #[must_use]
    pub fn gradient_steps(&self) -> u64 {
        self.counters.gradient_steps
    }

    /// How it was told to learn.
    #[must_use]
    pub fn config(&self) -> &LearningConfig {
        &self.config
    }

    /// What it has to learn from.
    #[must_use]
    pub fn replay(&self) -> &ReplayBuffer {
        &self.replay
    }

    /// The network that acts.
    #[must_use]
    pub fn network(&self) -> &QNetwork {
        &self.online
    }

    /// The network that values next states.
    #[must_use]
    pub fn target_network(&self) -> &QNetwork {
        &self.target
    }

    /// Takes `policy`'s weights as the start of both networks (knowledge transfer, section 3.2), with fresh
    /// optimizer moments. `epsilon` (0 to 1; the paper: 0.5) replaces the start of the exploration's
    /// schedule.
    ///
    /// # Errors
    /// The policy's network has another shape, a weight of it is not finite, or `epsilon` is out of range.
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
            network.update(|parameters| parameters.copy_from_slice(policy.parameters()));
        }
        self.optimizer = OptimizerState::new(&self.config.optimizer, self.online.parameters().len());
        self.counters.epsilon_start = epsilon;
        Ok(())
    }

    /// The acting network as a policy, without metadata.
    #[must_use]
    pub fn policy(&self) -> Policy {
        self.online.to_policy(Default::default())
    }

    /// The arenas were reset from outside: their next observations do not follow from the last. Steps still
    /// awaiting their n-step return are closed as if truncated.
    pub fn truncate_trajectories(&mut self) {
        let Self { trajectories, replay, config, .. } = self;
        for trajectory in trajectories {
            if let Some(last) = trajectory.last.take() {
                trajectory.n_step.flush(last, StepEnd::Truncated, config.gamma, |t| replay.push(&t));
            }
        }
    }
}

/// y = R + discount Q_target(s', a*) into `targets`, where a* is the best action by `chooser`: the online
/// network's Q(s', .) in double DQN, the target network's own else.
fn td_targets(batch: &Batch, chooser: &[f32], target_q: &[f32], targets: &mut Vec<f32>) {
    let actions = target_q.len() / batch.rewards.len();
    let rows = chooser.chunks_exact(actions).zip(target_q.chunks_exact(actions));
    let steps = batch.rewards.iter().zip(&batch.discounts);
    targets.clear();
    targets
        .extend(steps.zip(rows).map(|((r, discount), (choose, value))| r + discount * value[greedy(choose)]));
}

/// Lets the target network follow the online network after gradient step `step`.
fn follow(update: TargetUpdate, step: u64, online: &QNetwork, target: &mut QNetwork) {
    match update {
        TargetUpdate::Hard { every } if step.is_multiple_of(every) => {
            target.update(|weights| weights.copy_from_slice(online.parameters()));
        }
        TargetUpdate::Hard { .. } => {}
        TargetUpdate::Soft { tau } => target.update(|weights| {
            for (weight, online) in weights.iter_mut().zip(online.parameters()) {
                *weight += tau * (online - *weight);
            }
        }),
    }
}

/// Whether no value is NaN or infinite; without early exit, so that it is a loop of plain vector
/// instructions.
fn all_finite(values: &[f32]) -> bool {
    values.iter().map(|v| v.to_bits() & 0x7FFF_FFFF).fold(0, u32::max) < f32::INFINITY.to_bits()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Schedule;

    /// Two transitions; rewards 1 and 2, discounts 0.9 and (terminated) 0.
    fn batch() -> Batch {
        Batch { rewards: vec![1.0, 2.0], discounts: vec![0.9, 0.0], ..Batch::default() }
    }

    #[test]
    fn a_single_dqn_target_takes_the_largest_value_of_the_target_network() {
        let (target_q, mut y) = ([3.0, 5.0, 4.0, 70.0, 80.0, 90.0], Vec::new());
        td_targets(&batch(), &target_q, &target_q, &mut y);
        assert_eq!(y, [1.0 + 0.9 * 5.0, 2.0], "r + 0.9 x max, and r alone where the return has ended");
    }

    #[test]
    fn a_double_dqn_target_takes_the_target_networks_value_of_the_online_networks_choice() {
        let (target_q, online_q, mut y) =
            ([3.0, 5.0, 4.0, 70.0, 80.0, 90.0], [9.0, 1.0, 2.0, 0.0, 0.0, 1.0], Vec::new());
        td_targets(&batch(), &online_q, &target_q, &mut y);
        assert_eq!(
            y,
            [1.0 + 0.9 * 3.0, 2.0],
            "online prefers action 0, which the target network values at 3"
        );
    }

    #[test]
    fn q_values_are_beyond_any_return_from_the_largest_reward_over_one_less_gamma_on() {
        let mut config = LearningConfig { gamma: 0.9, batch_size: 1, ..LearningConfig::default() };
        (config.replay.learning_starts, config.train_freq, config.gradient_steps) = (1, 1, 1);
        (config.reward_scale, config.learning_rate) = (0.5, Schedule::Constant(1e-6));
        let mut learner = Learner::new(&config, 1, 2, 1, 0).expect("a sound config");
        // All Q-values are 10.5: rewards of up to 2, scaled 1, make returns of up to 1 / (1 - 0.9) = 10.
        learner.online.update(|weights| weights.fill(0.0));
        let bias = learner.online.shape().parameters().into_iter().find(|view| view.name == "value.bias");
        let bias = bias.expect("the paper's network is dueling").range.start;
        learner.online.update(|weights| weights[bias] = 10.5);
        let step = |reward| Experience {
            env_index: 0,
            observation: &[0.0],
            action: 0,
            reward,
            next_observation: &[0.0],
            terminated: true,
            truncated: false,
        };
        let mut after = |reward, times: u64| {
            let mut last = None;
            for _ in 0..times {
                learner.store(&step(reward));
                last = learner.train().expect("all finite").expect("a gradient step was due").overestimate;
            }
            last
        };
        assert_eq!(after(0.0, 60), None, "before the first reward nothing is known of returns");
        assert_eq!(after(-2.0, 49), None, "it may pass");
        let found = after(-2.0, 1).expect("10.5 is more than 10, fifty times now");
        assert_eq!((found.gradient_step, found.env_step, found.largest_reward), (110, 110, 1.0));
        assert!((found.q - 10.5).abs() < 1e-3, "{found}");
        assert!((found.largest_return - 10.0).abs() < 1e-5, "{found}");
        // A reward of 2.2, scaled 1.1, makes 11 of it: 10.5 can be, then.
        assert_eq!(after(2.2, 1), None);
    }

    #[test]
    fn a_gradient_whose_square_is_no_number_stops_the_learner_before_it_is_saved() {
        let mut config = LearningConfig { batch_size: 1, ..LearningConfig::default() };
        (config.replay.learning_starts, config.train_freq, config.gradient_steps) = (1, 1, 1);
        let mut learner = Learner::new(&config, 1, 2, 1, 0).expect("a sound config");
        // The error is some 4e18, of which the square is still a number; that of its gradient, through inputs of 100, is none.
        let (observation, next_observation) = (&[100.0], &[0.0]);
        let reward = 4e18;
        learner.store(&Experience {
            env_index: 0,
            observation,
            action: 0,
            reward,
            next_observation,
            terminated: true,
            truncated: false,
        });
        let diverged = learner.train().expect_err("it cannot go on").to_string();
        assert!(diverged.contains("the square of a gradient is not finite"), "{diverged}");
    }

    #[test]
    fn numbers_that_are_not_finite_are_seen() {
        assert!(all_finite(&[0.0, -1.0, f32::MAX, f32::MIN_POSITIVE / 2.0]));
        for bad in [f32::NAN, -f32::NAN, f32::INFINITY, f32::NEG_INFINITY] {
            assert!(!all_finite(&[1.0, bad, 1.0]), "{bad}");
        }
    }

    #[test]
    fn a_replay_buffer_larger_than_any_machine_is_refused() {
        let mut config = LearningConfig::default();
        config.replay.capacity = 1 << 24;
        let error = Learner::new(&config, 1000, 5, 1, 0).expect_err("2^24 observations of 1000 numbers");
        assert_eq!(error.field, "replay.capacity", "{error}");
    }

    #[test]
    fn a_learner_can_be_shared_between_threads() {
        fn shareable<T: Send + Sync + 'static>() {}
        shareable::<Learner>();
        shareable::<Policy>();
    }
}
