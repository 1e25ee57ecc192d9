//! How to learn: the `learning:` part of a preset, and the check of every value in it.
//!
//! In: a RON (or any serde) document. Out: a [`LearningConfig`], or a [`ConfigError`] that names the field,
//! what is wrong with it and how to mend it. The paper's Table 1 is one such document; every algorithm choice
//! beside it is a switch here.

use std::fmt::Display;
use std::ops::RangeInclusive;

use serde::{Deserialize, Serialize};
use wayfield_policy::{NetworkShape, ShapeError};

/// The largest `reward_scale`: rewards as large as they may be are still numbers after it, and so are their sums.
const MAX_REWARD_SCALE: f32 = 1e20;

/// Every choice of the learning algorithm.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LearningConfig {
    /// The Q-network's layers.
    pub network: NetworkConfig,
    /// Double DQN: the online network chooses the next action, the target network values it (van Hasselt et
    /// al. 2016). `false`: the target network does both (Mnih et al. 2015).
    pub double: bool,
    /// The discount per step, 0 to 1. Table 1: 0.99.
    pub gamma: f32,
    /// Steps of reward in a return before it bootstraps, 1 to 100. The paper: 1.
    pub n_step: usize,
    /// Rewards are multiplied by this before they are stored, above 0, at most 10^20. The paper: 1.
    pub reward_scale: f32,
    /// What a TD error costs.
    pub loss: Loss,
    /// How a gradient moves the weights.
    pub optimizer: Optimizer,
    /// The optimizer's step size, by env steps. Table 1: 0.00025.
    pub learning_rate: Schedule,
    /// Transitions per gradient step, 1 to 65536. Table 1: 64.
    pub batch_size: usize,
    /// The replay buffer.
    pub replay: ReplayConfig,
    /// Env steps (of all arenas together) between two trainings, at least 1. The paper: 1.
    pub train_freq: u64,
    /// Gradient steps of one training, 1 to 10000. The paper: 1.
    pub gradient_steps: u32,
    /// How the target network follows the online network.
    pub target_update: TargetUpdate,
    /// How epsilon, the share of random actions, falls.
    pub exploration: Exploration,
}

/// The layers of the Q-network.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NetworkConfig {
    /// Widths of the hidden layers (each followed by a ReLU), at most 8 of 1 to 4096 units. Fig. 5: [64, 64].
    pub hidden: Vec<usize>,
    /// A dueling head: one value and one advantage per action (Wang et al. 2016). `false`: Q-values directly.
    pub dueling: bool,
}

/// What a TD error d = Q(s, a) - y costs; a batch's loss is the mean over its (weighted) errors.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Loss {
    /// d^2 (Table 1).
    MeanSquared,
    /// d^2 / 2 up to |d| = `delta` (above 0), linear beyond.
    Huber {
        /// Where the loss turns linear, in units of scaled reward.
        delta: f32,
    },
}

/// How a gradient moves the weights; formulas and meaning of `epsilon` as in PyTorch.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Optimizer {
    /// RMSProp (Table 1), neither centred nor with momentum.
    RmsProp {
        /// How much of the mean square gradient is kept each step, 0 up to but not 1. PyTorch: 0.99.
        smoothing: f32,
        /// Added to the root of the mean square, above 0. PyTorch: 1e-8.
        epsilon: f32,
    },
    /// Adam (Kingma and Ba 2015).
    Adam {
        /// How much of the mean gradient is kept each step, 0 up to but not 1. PyTorch: 0.9.
        beta1: f32,
        /// How much of the mean square gradient is kept each step, 0 up to but not 1. PyTorch: 0.999.
        beta2: f32,
        /// Added to the root of the mean square, above 0. PyTorch: 1e-8.
        epsilon: f32,
    },
}

/// A value as a function of env steps alone, so that a run resumed with a longer budget is the same run.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Schedule {
    /// Always this value.
    Constant(f32),
    /// A straight line, then level.
    Linear {
        /// The value at env step 0.
        from: f32,
        /// The value at `env_steps` and ever after.
        to: f32,
        /// Where the line ends, at least 1.
        env_steps: u64,
    },
}

/// The replay buffer's size and how batches are drawn from it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ReplayConfig {
    /// Transitions kept, `batch_size` to 2^24. Table 1: 1,000,000.
    pub capacity: usize,
    /// Env steps before the first training.
    pub learning_starts: u64,
    /// How batches are drawn.
    pub sampling: Sampling,
}

/// How batches are drawn from the replay buffer.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Sampling {
    /// Every transition alike.
    Uniform,
    /// Proportional to a power of the last TD error (Schaul et al. 2016).
    Prioritized {
        /// P(i) = p_i^alpha / sum of p^alpha, 0 (uniform) to 1. Algorithm 1 as printed: 1.
        alpha: f32,
        /// The exponent of the importance weights, 0 to 1, by env steps.
        beta: Schedule,
        /// Whether errors are weighted by (N P(i))^-beta, over the batch's largest. Algorithm 1 has no
        /// weights.
        importance_weights: bool,
        /// Added to |TD error| to make a priority, above 0, so that none is never drawn again.
        epsilon: f32,
    },
}

/// How the target network follows the online network.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum TargetUpdate {
    /// A copy every so many gradient steps, at least 1. Table 1: 2000.
    Hard {
        /// Gradient steps between copies.
        every: u64,
    },
    /// After each gradient step, this share of the way.
    Soft {
        /// The share, above 0 and at most 1.
        tau: f32,
    },
}

/// How epsilon, the share of random actions, falls. All values 0 to 1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Exploration {
    /// Multiplied after each episode, eq. (10): max(end, start decay^episodes). The paper: 1, 0.99, 0.05.
    PerEpisode {
        /// Epsilon of the first episode.
        start: f32,
        /// The factor after each episode, above 0.
        decay: f32,
        /// The floor.
        end: f32,
    },
    /// A straight line over env steps, then level.
    Linear {
        /// Epsilon at env step 0.
        start: f32,
        /// Epsilon at `env_steps` and ever after.
        end: f32,
        /// Where the line ends, at least 1.
        env_steps: u64,
    },
}

/// A value that makes no sense, with the field's path below `learning:`.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{field}: {problem}")]
pub struct ConfigError {
    /// The field, as in `replay.capacity`.
    pub field: String,
    /// What is wrong, and the mend.
    pub problem: String,
}

impl Default for LearningConfig {
    /// PER-D3QN as in Table 1 and algorithm 1 of the paper; where they are silent, PyTorch's optimizer
    /// defaults and training from the first full batch on.
    fn default() -> Self {
        Self {
            network: NetworkConfig { hidden: vec![64, 64], dueling: true },
            double: true,
            gamma: 0.99,
            n_step: 1,
            reward_scale: 1.0,
            loss: Loss::MeanSquared,
            optimizer: Optimizer::RmsProp { smoothing: 0.99, epsilon: 1e-8 },
            learning_rate: Schedule::Constant(0.000_25),
            batch_size: 64,
            replay: ReplayConfig {
                capacity: 1_000_000,
                learning_starts: 0,
                sampling: Sampling::Prioritized {
                    alpha: 1.0,
                    beta: Schedule::Constant(0.0),
                    importance_weights: false,
                    epsilon: 0.01,
                },
            },
            train_freq: 1,
            gradient_steps: 1,
            target_update: TargetUpdate::Hard { every: 2000 },
            exploration: Exploration::PerEpisode { start: 1.0, decay: 0.99, end: 0.05 },
        }
    }
}

impl Schedule {
    /// The value at `env_steps`.
    #[must_use]
    pub fn at(&self, env_steps: u64) -> f32 {
        match *self {
            Self::Constant(value) => value,
            Self::Linear { to, env_steps: end, .. } if env_steps >= end => to,
            Self::Linear { from, to, env_steps: end } => {
                from + (to - from) * (env_steps as f64 / end as f64) as f32
            }
        }
    }

    fn check(&self, field: &str, range: RangeInclusive<f32>) -> Result<(), ConfigError> {
        match *self {
            Self::Constant(value) => within(field, value, range),
            Self::Linear { from, to, env_steps } => {
                within(&format!("{field}.from"), from, range.clone())?;
                within(&format!("{field}.to"), to, range)?;
                within(&format!("{field}.env_steps"), env_steps, 1..=u64::MAX)
            }
        }
    }
}

impl LearningConfig {
    /// Checks every value.
    ///
    /// # Errors
    /// The first field out of its range.
    pub fn check(&self) -> Result<(), ConfigError> {
        NetworkShape::check_hidden(&self.network.hidden)?;
        within("gamma", self.gamma, 0.0..=1.0)?;
        within("n_step", self.n_step, 1..=100)?;
        above_zero("reward_scale", self.reward_scale)?;
        within("reward_scale", self.reward_scale, 0.0..=MAX_REWARD_SCALE)?;
        if let Loss::Huber { delta } = self.loss {
            above_zero("loss.delta", delta)?;
        }
        match self.optimizer {
            Optimizer::RmsProp { smoothing, epsilon } => {
                share_below_one("optimizer.smoothing", smoothing)?;
                above_zero("optimizer.epsilon", epsilon)?;
            }
            Optimizer::Adam { beta1, beta2, epsilon } => {
                share_below_one("optimizer.beta1", beta1)?;
                share_below_one("optimizer.beta2", beta2)?;
                above_zero("optimizer.epsilon", epsilon)?;
            }
        }
        self.learning_rate.check("learning_rate", 0.0..=10.0)?;
        within("batch_size", self.batch_size, 1..=65536)?;
        self.replay.check(self.batch_size)?;
        within("train_freq", self.train_freq, 1..=u64::MAX)?;
        within("gradient_steps", self.gradient_steps, 1..=10_000)?;
        match self.target_update {
            TargetUpdate::Hard { every } => within("target_update.every", every, 1..=u64::MAX)?,
            TargetUpdate::Soft { tau } => {
                above_zero("target_update.tau", tau)?;
                within("target_update.tau", tau, 0.0..=1.0)?;
            }
        }
        self.exploration.check()
    }
}

impl ReplayConfig {
    fn check(&self, batch_size: usize) -> Result<(), ConfigError> {
        within("replay.capacity", self.capacity, 1..=1 << 24)?;
        if self.capacity < batch_size {
            return Err(ConfigError {
                field: "replay.capacity".into(),
                problem: format!(
                    "{} transitions cannot fill a batch of {batch_size}; raise it, or lower batch_size",
                    self.capacity
                ),
            });
        }
        if let Sampling::Prioritized { alpha, beta, epsilon, .. } = self.sampling {
            within("replay.sampling.alpha", alpha, 0.0..=1.0)?;
            beta.check("replay.sampling.beta", 0.0..=1.0)?;
            above_zero("replay.sampling.epsilon", epsilon)?;
        }
        Ok(())
    }
}

impl Exploration {
    fn check(&self) -> Result<(), ConfigError> {
        let (start, end) = match *self {
            Self::PerEpisode { start, decay, end } => {
                above_zero("exploration.decay", decay)?;
                within("exploration.decay", decay, 0.0..=1.0)?;
                (start, end)
            }
            Self::Linear { start, end, env_steps } => {
                within("exploration.env_steps", env_steps, 1..=u64::MAX)?;
                (start, end)
            }
        };
        within("exploration.start", start, 0.0..=1.0)?;
        within("exploration.end", end, 0.0..=1.0)
    }
}

impl NetworkConfig {
    /// The shape of a network from observations of `inputs` numbers to `actions` Q-values.
    ///
    /// # Errors
    /// A size out of its range; see [`NetworkShape::check`].
    pub fn shape(&self, inputs: usize, actions: usize) -> Result<NetworkShape, ConfigError> {
        let shape = NetworkShape { inputs, hidden: self.hidden.clone(), actions, dueling: self.dueling };
        shape.check()?;
        Ok(shape)
    }
}

impl From<ShapeError> for ConfigError {
    fn from(ShapeError { field, problem }: ShapeError) -> Self {
        Self { field, problem }
    }
}

/// `value` lies in `range` (NaN lies in none).
pub(super) fn within<T: PartialOrd + Display>(
    field: &str,
    value: T,
    range: RangeInclusive<T>,
) -> Result<(), ConfigError> {
    if range.contains(&value) {
        return Ok(());
    }
    let problem = if value < *range.start() {
        format!("{value} is too small; give at least {}", range.start())
    } else {
        format!("{value} is out of range; give {} to {}", range.start(), range.end())
    };
    Err(ConfigError { field: field.into(), problem })
}

fn above_zero(field: &str, value: f32) -> Result<(), ConfigError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    Err(ConfigError { field: field.into(), problem: format!("{value} will not do; give a number above 0") })
}

fn share_below_one(field: &str, value: f32) -> Result<(), ConfigError> {
    if (0.0..1.0).contains(&value) {
        return Ok(());
    }
    Err(ConfigError {
        field: field.into(),
        problem: format!("{value} is out of range; give 0 up to, but not, 1"),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A change to the default config, and the field that must be blamed for it.
    type Breakage = (&'static str, fn(&mut LearningConfig));

    #[test]
    fn a_document_says_everything_and_comes_back_the_same() {
        let config = LearningConfig {
            loss: Loss::Huber { delta: 1.0 },
            optimizer: Optimizer::Adam { beta1: 0.9, beta2: 0.999, epsilon: 1e-8 },
            learning_rate: Schedule::Linear { from: 5e-4, to: 1e-5, env_steps: 150_000 },
            exploration: Exploration::Linear { start: 1.0, end: 0.05, env_steps: 40_000 },
            target_update: TargetUpdate::Soft { tau: 0.005 },
            ..LearningConfig::default()
        };
        for config in [config, LearningConfig::default()] {
            assert_eq!(config.check(), Ok(()));
            let text = ron::to_string(&config).expect("a config is RON");
            let back: LearningConfig = ron::from_str(&text).expect("and RON a config");
            assert_eq!(back, config, "{text}");
        }
        let text = ron::to_string(&LearningConfig::default()).expect("a config is RON");
        let mistyped = text.replace("gamma", "gama");
        assert!(ron::from_str::<LearningConfig>(&mistyped).is_err(), "a mistyped field is no field");
    }

    #[test]
    fn every_value_out_of_its_range_is_blamed_by_name() {
        let breakages: &[Breakage] = &[
            ("network.hidden", |c| c.network.hidden = vec![1; 9]),
            ("network.hidden[1]", |c| c.network.hidden = vec![64, 0]),
            ("gamma", |c| c.gamma = 1.01),
            ("gamma", |c| c.gamma = f32::NAN),
            ("n_step", |c| c.n_step = 0),
            ("reward_scale", |c| c.reward_scale = 0.0),
            ("loss.delta", |c| c.loss = Loss::Huber { delta: -1.0 }),
            ("optimizer.smoothing", |c| c.optimizer = Optimizer::RmsProp { smoothing: 1.0, epsilon: 1e-8 }),
            ("optimizer.epsilon", |c| c.optimizer = Optimizer::RmsProp { smoothing: 0.9, epsilon: 0.0 }),
            ("optimizer.beta2", |c| c.optimizer = Optimizer::Adam { beta1: 0.9, beta2: 2.0, epsilon: 1e-8 }),
            ("learning_rate", |c| c.learning_rate = Schedule::Constant(-1e-3)),
            ("learning_rate.env_steps", |c| {
                c.learning_rate = Schedule::Linear { from: 1e-3, to: 1e-4, env_steps: 0 };
            }),
            ("batch_size", |c| c.batch_size = 0),
            ("replay.capacity", |c| c.replay.capacity = 63),
            ("replay.capacity", |c| c.replay.capacity = usize::MAX),
            ("replay.sampling.beta", |c| {
                c.replay.sampling = Sampling::Prioritized {
                    alpha: 0.6,
                    beta: Schedule::Constant(1.5),
                    importance_weights: true,
                    epsilon: 1e-3,
                };
            }),
            ("train_freq", |c| c.train_freq = 0),
            ("gradient_steps", |c| c.gradient_steps = 0),
            ("target_update.every", |c| c.target_update = TargetUpdate::Hard { every: 0 }),
            ("target_update.tau", |c| c.target_update = TargetUpdate::Soft { tau: 0.0 }),
            ("exploration.decay", |c| {
                c.exploration = Exploration::PerEpisode { start: 1.0, decay: 0.0, end: 0.05 };
            }),
            ("exploration.start", |c| {
                c.exploration = Exploration::Linear { start: 2.0, end: 0.05, env_steps: 10 };
            }),
        ];
        for (field, breakage) in breakages {
            let mut config = LearningConfig::default();
            breakage(&mut config);
            let error = config.check().expect_err(field);
            assert_eq!(&error.field, field, "{error}");
            assert!(error.problem.contains("give") || error.problem.contains("raise"), "a mend: {error}");
        }
    }

    #[test]
    fn a_linear_schedule_is_a_line_and_then_level() {
        let schedule = Schedule::Linear { from: 1.0, to: 0.5, env_steps: 100 };
        for (step, value) in [(0, 1.0), (50, 0.75), (99, 0.505), (100, 0.5), (1_000_000, 0.5)] {
            assert!((schedule.at(step) - value).abs() < 1e-6, "at {step}: {}", schedule.at(step));
        }
    }
}
