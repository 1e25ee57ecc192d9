//! The options of the learning algorithm: the `learning:` part of a preset.
//!
//! In: a RON (or any serde) document. Out: a [`LearningConfig`], or a [`ConfigError`] with the field, the problem and the
//! fix. The default is Table 1 of the paper; each option sets one part of the algorithm.

mod check;
mod defaults;

use std::f64::consts::PI;

use serde::{Deserialize, Serialize};
pub use wayfield_policy::ConfigError;
use wayfield_policy::{Activation, NetworkShape};

/// All options of the learning algorithm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct LearningConfig {
    /// The layers of the Q-network.
    pub network: NetworkConfig,
    /// Double DQN: the online network selects the next action, the target network evaluates it (van Hasselt et al. 2016).
    /// `false`: the target network does both (Mnih et al. 2015).
    pub double: bool,
    /// The discount per step, 0 to 1. Table 1: 0.99.
    pub gamma: f32,
    /// The number of rewards in a return before it bootstraps, 1 to 100. The paper: 1.
    pub n_step: usize,
    /// The factor by which rewards are multiplied before they are stored, above 0, at most 10^20. The paper: 1.
    pub reward_scale: f32,
    /// The loss of a TD error.
    pub loss: Loss,
    /// The optimizer.
    pub optimizer: Optimizer,
    /// The optimizer's step size, 0 to 10, as a function of env steps. Table 1: 0.00025.
    pub learning_rate: Schedule,
    /// The largest norm of the gradient of all parameters together, above 0; a longer gradient is scaled down to it, as by
    /// PyTorch's `clip_grad_norm_`. The norm depends on the scale of the rewards; with scaled rewards of the order of one, 10 is
    /// usual. The paper: `None`, no limit.
    pub max_gradient_norm: Option<f32>,
    /// The decoupled weight decay, 0 to 1: before each gradient step, all parameters are multiplied by 1 - learning rate x
    /// `weight_decay` (AdamW, Loshchilov and Hutter 2019; here also with RMSProp). PyTorch's AdamW: 0.01. The paper: 0.
    pub weight_decay: f32,
    /// The number of transitions per gradient step, 1 to 65536. Table 1: 64.
    pub batch_size: usize,
    /// The replay buffer.
    pub replay: ReplayConfig,
    /// The number of env steps, of all environments together, between two updates, at least 1. The paper: 1.
    pub train_freq: u64,
    /// The number of gradient steps per update, 1 to 10000. The paper: 1.
    pub gradient_steps: u32,
    /// The update of the target network.
    pub target_update: TargetUpdate,
    /// The decay of epsilon, the probability of a random action.
    pub exploration: Exploration,
    /// Mirror augmentation: each sampled transition is mirrored, left for right, with probability 1/2. It needs an observation
    /// and actions that can be mirrored. The paper: `false`.
    pub mirror: bool,
    /// Advantage learning (Bellemare et al. 2016): the weight, at least 0 and below 1, of the gap max Q(s, .) - Q(s, a) that is
    /// subtracted from each TD target; Q is the target network's. The best action stays the best and keeps its value; the gaps
    /// to the other actions grow by the factor 1 / (1 - weight), so that small errors of the network change the greedy action
    /// less often. The paper: 0.
    pub advantage_learning: f32,
    /// The number of quantiles of the return that are learned for each action, 1 to 200 (QR-DQN, Dabney et al. 2018). Their
    /// mean is the Q-value, and the policy keeps only that. More than 1 requires a `Huber` loss. The paper: 1, the Q-value
    /// itself.
    pub quantiles: usize,
}

/// The layers of the Q-network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct NetworkConfig {
    /// The widths of the hidden layers: at most 8 layers, each of 1 to 4096 units. Fig. 5: [64, 64].
    pub hidden: Vec<usize>,
    /// Dueling head: a value and one advantage per action (Wang et al. 2016). `false`: the last layer outputs Q-values.
    pub dueling: bool,
    /// Layer normalization of each hidden layer before its activation (Ba et al. 2016), with a learned scale and shift per
    /// unit. The paper: `false`.
    pub layer_norm: bool,
    /// The activation function of the hidden layers: `Relu` (fig. 5), `Elu`, `Silu` or `Tanh`.
    pub activation: Activation,
}

/// The loss of a TD error d = Q(s, a) - y. The loss of a batch is the mean over its transitions, each multiplied by its
/// importance weight if `importance_weights` is `true`.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Loss {
    /// d^2 (Table 1).
    MeanSquared,
    /// d^2 / 2 up to |d| = `delta` (above 0), linear beyond.
    Huber {
        /// The |d| at which the loss becomes linear, in units of scaled reward.
        #[serde(default = "defaults::one")]
        delta: f32,
    },
}

/// The optimizer. The formulas and the meaning of `epsilon` are those of PyTorch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Optimizer {
    /// RMSProp (Table 1), not centred and without momentum.
    RmsProp {
        /// The decay of the mean square gradient per step, at least 0 and below 1. PyTorch: 0.99.
        #[serde(default = "defaults::decay")]
        smoothing: f32,
        /// The constant added to the root of the mean square gradient, above 0. PyTorch: 1e-8.
        #[serde(default = "defaults::optimizer_epsilon")]
        epsilon: f32,
    },
    /// Adam (Kingma and Ba 2015).
    Adam {
        /// The decay of the mean gradient per step, at least 0 and below 1. PyTorch: 0.9.
        #[serde(default = "defaults::beta1")]
        beta1: f32,
        /// The decay of the mean square gradient per step, at least 0 and below 1. PyTorch: 0.999.
        #[serde(default = "defaults::beta2")]
        beta2: f32,
        /// The constant added to the root of the mean square gradient, above 0. PyTorch: 1e-8.
        #[serde(default = "defaults::optimizer_epsilon")]
        epsilon: f32,
    },
}

/// A value as a function of the env steps n, of all environments together. It does not depend on the total number of steps,
/// so a run that is resumed with a larger budget continues unchanged.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Schedule {
    /// A constant value.
    Constant(f32),
    /// Linear up to `env_steps`, then constant: from + (to - from) n / env_steps.
    Linear {
        /// The value at env step 0.
        from: f32,
        /// The value from `env_steps` on.
        to: f32,
        /// The env step at which `to` is reached, at least 1.
        env_steps: u64,
    },
    /// Exponential up to `env_steps`, then constant: from x (to / from)^(n / env_steps), the same factor in every env step (as
    /// PyTorch's `ExponentialLR` in every epoch).
    Exponential {
        /// The value at env step 0, above 0.
        from: f32,
        /// The value from `env_steps` on, above 0.
        to: f32,
        /// The env step at which `to` is reached, at least 1.
        env_steps: u64,
    },
    /// Half a cosine wave up to `env_steps`, then constant: to + (from - to) (1 + cos(pi n / env_steps)) / 2 (Loshchilov and
    /// Hutter 2017, without restarts; PyTorch's `CosineAnnealingLR`).
    Cosine {
        /// The value at env step 0.
        from: f32,
        /// The value from `env_steps` on.
        to: f32,
        /// The env step at which `to` is reached, at least 1.
        env_steps: u64,
    },
    /// Steps down: `from` x `factor`^k after k times `every_env_steps` (PyTorch's `StepLR`).
    Step {
        /// The value before the first step down.
        from: f32,
        /// The factor of each step down, above 0, at most 1.
        factor: f32,
        /// The number of env steps between steps down, at least 1.
        every_env_steps: u64,
    },
}

/// The size of the replay buffer, and the sampling of batches.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct ReplayConfig {
    /// The maximum number of stored transitions, `batch_size` to 2^24. Table 1: 1,000,000.
    pub capacity: usize,
    /// The number of env steps before the first update, which also waits for `batch_size` transitions.
    pub learning_starts: u64,
    /// The sampling of batches.
    pub sampling: Sampling,
}

/// The sampling of batches from the replay buffer.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Sampling {
    /// Every transition has the same probability.
    Uniform,
    /// The probability of transition i is proportional to a power of its priority p_i = |last TD error| + `epsilon` (Schaul et
    /// al. 2016).
    Prioritized {
        /// The exponent in P(i) = p_i^alpha / sum of p^alpha, 0 (uniform) to 1. Algorithm 1 as printed: 1.
        #[serde(default = "defaults::one")]
        alpha: f32,
        /// The exponent of the importance weights, 0 to 1, as a function of env steps.
        #[serde(default = "defaults::beta")]
        beta: Schedule,
        /// Whether the loss is weighted by (N P(i))^-beta, divided by the largest weight of the batch. N is the number of
        /// stored transitions. Algorithm 1 has no weights.
        #[serde(default)]
        importance_weights: bool,
        /// The constant in the priority, above 0, so that every transition can be drawn again.
        #[serde(default = "defaults::priority_epsilon")]
        epsilon: f32,
    },
}

/// The update of the target network.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum TargetUpdate {
    /// Copies the online network every `every` gradient steps. Table 1: 2000.
    Hard {
        /// The number of gradient steps between copies, at least 1.
        #[serde(default = "defaults::copy_interval")]
        every: u64,
    },
    /// Moves by the fraction `tau` towards the online network after each gradient step.
    Soft {
        /// The fraction, above 0 and at most 1.
        tau: f32,
    },
}

/// The decay of epsilon, the probability of a random action. All values of epsilon are 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Exploration {
    /// Exponential decay per episode, equation (10): max(end, start x decay^episodes). The paper: 1, 0.99, 0.05.
    PerEpisode {
        /// Epsilon in the first episode.
        #[serde(default = "defaults::one")]
        start: f32,
        /// The factor after each episode, above 0, at most 1.
        #[serde(default = "defaults::decay")]
        decay: f32,
        /// The minimum.
        #[serde(default = "defaults::least_epsilon")]
        end: f32,
    },
    /// Linear decay up to `env_steps`, then constant.
    Linear {
        /// Epsilon at env step 0.
        start: f32,
        /// Epsilon from `env_steps` on.
        end: f32,
        /// The env step at which `end` is reached, at least 1.
        env_steps: u64,
    },
}

impl Default for LearningConfig {
    /// PER-D3QN as in Table 1 and algorithm 1 of the paper. These leave some values open: those of the optimizer are PyTorch's
    /// defaults, the `epsilon` of priorities is 0.01, and learning starts with the first full batch.
    fn default() -> Self {
        Self {
            network: NetworkConfig::default(),
            double: true,
            gamma: 0.99,
            n_step: 1,
            reward_scale: 1.0,
            loss: Loss::MeanSquared,
            optimizer: Optimizer::RmsProp { smoothing: 0.99, epsilon: 1e-8 },
            learning_rate: Schedule::Constant(0.000_25),
            max_gradient_norm: None,
            weight_decay: 0.0,
            batch_size: 64,
            replay: ReplayConfig::default(),
            train_freq: 1,
            gradient_steps: 1,
            target_update: TargetUpdate::Hard { every: 2000 },
            exploration: Exploration::PerEpisode { start: 1.0, decay: 0.99, end: 0.05 },
            mirror: false,
            advantage_learning: 0.0,
            quantiles: 1,
        }
    }
}

impl Default for ReplayConfig {
    /// The replay buffer of PER-D3QN, Table 1 and algorithm 1 of the paper.
    fn default() -> Self {
        let sampling = Sampling::Prioritized {
            alpha: 1.0,
            beta: Schedule::Constant(0.0),
            importance_weights: false,
            epsilon: 0.01,
        };
        Self { capacity: 1_000_000, learning_starts: 0, sampling }
    }
}

impl Default for NetworkConfig {
    /// The network of PER-D3QN, fig. 5 of the paper.
    fn default() -> Self {
        Self { hidden: vec![64, 64], dueling: true, layer_norm: false, activation: Activation::Relu }
    }
}

impl Schedule {
    /// The value at `env_steps`.
    #[must_use]
    pub fn at(&self, env_steps: u64) -> f32 {
        let fraction = |end: u64| env_steps as f64 / end as f64;
        match *self {
            Self::Constant(value) => value,
            Self::Linear { to, env_steps: end, .. }
            | Self::Exponential { to, env_steps: end, .. }
            | Self::Cosine { to, env_steps: end, .. }
                if env_steps >= end =>
            {
                to
            }
            Self::Linear { from, to, env_steps: end } => from + (to - from) * fraction(end) as f32,
            Self::Exponential { from, to, env_steps: end } => {
                let [from, to] = [from, to].map(f64::from);
                (from * libm::pow(to / from, fraction(end))) as f32
            }
            Self::Cosine { from, to, env_steps: end } => {
                let [from, to] = [from, to].map(f64::from);
                (to + (from - to) * (1.0 + libm::cos(PI * fraction(end))) / 2.0) as f32
            }
            Self::Step { from, factor, every_env_steps } => {
                let steps = env_steps / every_env_steps.max(1);
                (f64::from(from) * libm::pow(f64::from(factor), steps as f64)) as f32
            }
        }
    }
}

impl NetworkConfig {
    /// The shape of a network that maps observations of `inputs` values to `actions` Q-values.
    ///
    /// # Errors
    /// A size is out of range; see [`NetworkShape::check`].
    pub fn shape(&self, inputs: usize, actions: usize) -> Result<NetworkShape, ConfigError> {
        let Self { hidden, dueling, layer_norm, activation } = self.clone();
        let shape = NetworkShape { inputs, hidden, actions, dueling, layer_norm, activation };
        shape.check()?;
        Ok(shape)
    }
}

#[cfg(test)]
mod tests;
