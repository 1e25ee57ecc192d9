//! Range checks of all config values.

use std::ops::RangeInclusive;

use super::{
    ConfigError, Exploration, LearningConfig, Loss, Optimizer, ReplayConfig, Sampling, Schedule, TargetUpdate,
};
use crate::limits::*;
use wayfield_policy::NetworkShape;
use wayfield_policy::range::{above_zero, within, within_above_zero};

/// The problems found so far.
struct Problems(Vec<ConfigError>);

impl Problems {
    fn add(&mut self, checked: Result<(), ConfigError>) {
        self.0.extend(checked.err());
    }
}

impl LearningConfig {
    /// Checks that every value is in range.
    ///
    /// # Errors
    /// The first of the [`problems`](Self::problems).
    pub fn check(&self) -> Result<(), ConfigError> {
        self.problems().into_iter().next().map_or(Ok(()), Err)
    }

    /// All values that are out of range or do not fit together.
    #[must_use]
    pub fn problems(&self) -> Vec<ConfigError> {
        let mut problems = self.range_problems();
        let is_valid = |name: &str| !problems.iter().any(|problem| problem.field == name);
        let (capacity, batch_size) = (self.replay.capacity, self.batch_size);
        if capacity < batch_size && is_valid("replay.capacity") && is_valid("batch_size") {
            problems.push(ConfigError {
                field: "replay.capacity".into(),
                problem: format!(
                    "is {capacity}, less than batch_size ({batch_size}); help: raise it, or lower batch_size"
                ),
            });
        }
        if self.quantiles > 1 && self.loss == Loss::MeanSquared {
            problems.push(ConfigError {
                field: "loss".into(),
                problem: "is MeanSquared, but quantiles are learned with Huber; help: write loss: Huber(delta: 1.0)".into(),
            });
        }
        problems
    }

    /// The values that are out of range, each by itself.
    #[must_use]
    pub fn range_problems(&self) -> Vec<ConfigError> {
        let mut found = Problems(NetworkShape::hidden_problems(&self.network.hidden));
        found.add(within("gamma", self.gamma, 0.0..=1.0));
        found.add(within("n_step", self.n_step, 1..=MAX_N_STEP));
        found.add(within_above_zero("reward_scale", self.reward_scale, MAX_REWARD_SCALE));
        if let Loss::Huber { delta } = self.loss {
            found.add(above_zero("loss.delta", delta));
        }
        self.optimizer.check(&mut found);
        self.learning_rate.check("learning_rate", 0.0..=MAX_LEARNING_RATE, &mut found);
        if let Some(norm) = self.max_gradient_norm {
            found.add(above_zero("max_gradient_norm", norm));
        }
        found.add(within("weight_decay", self.weight_decay, 0.0..=1.0));
        found.add(within("advantage_learning", self.advantage_learning, 0.0..1.0));
        found.add(within("quantiles", self.quantiles, 1..=MAX_QUANTILES));
        found.add(within("batch_size", self.batch_size, 1..=MAX_BATCH_SIZE));
        self.replay.check(&mut found);
        found.add(within("train_freq", self.train_freq, 1..));
        found.add(within("gradient_steps", self.gradient_steps, 1..=MAX_GRADIENT_STEPS));
        found.add(match self.target_update {
            TargetUpdate::Hard { every } => within("target_update.every", every, 1..),
            TargetUpdate::Soft { tau } => within_above_zero("target_update.tau", tau, 1.0),
        });
        self.exploration.check(&mut found);
        found.0
    }
}

impl Optimizer {
    fn check(&self, found: &mut Problems) {
        let epsilon = match *self {
            Self::RmsProp { smoothing, epsilon } => {
                found.add(within("optimizer.smoothing", smoothing, 0.0..1.0));
                epsilon
            }
            Self::Adam { beta1, beta2, epsilon } => {
                found.add(within("optimizer.beta1", beta1, 0.0..1.0));
                found.add(within("optimizer.beta2", beta2, 0.0..1.0));
                epsilon
            }
        };
        found.add(above_zero("optimizer.epsilon", epsilon));
    }
}

impl ReplayConfig {
    fn check(&self, found: &mut Problems) {
        found.add(within("replay.capacity", self.capacity, 1..=MAX_REPLAY_CAPACITY));
        if let Sampling::Prioritized { alpha, beta, epsilon, .. } = self.sampling {
            found.add(within("replay.sampling.alpha", alpha, 0.0..=1.0));
            beta.check("replay.sampling.beta", 0.0..=1.0, found);
            found.add(above_zero("replay.sampling.epsilon", epsilon));
        }
    }
}

impl Exploration {
    fn check(&self, found: &mut Problems) {
        let (start, end) = match *self {
            Self::PerEpisode { start, decay, end } => {
                found.add(within_above_zero("exploration.decay", decay, 1.0));
                (start, end)
            }
            Self::Linear { start, end, env_steps } => {
                found.add(within("exploration.env_steps", env_steps, 1..));
                (start, end)
            }
        };
        found.add(within("exploration.start", start, 0.0..=1.0));
        found.add(within("exploration.end", end, 0.0..=1.0));
    }
}

impl Schedule {
    fn check(&self, field: &str, range: RangeInclusive<f32>, found: &mut Problems) {
        match *self {
            Self::Constant(value) => found.add(within(field, value, range)),
            Self::Linear { from, to, env_steps }
            | Self::Exponential { from, to, env_steps }
            | Self::Cosine { from, to, env_steps } => {
                for (end, value) in [("from", from), ("to", to)] {
                    let field = format!("{field}.{end}");
                    found.add(if matches!(self, Self::Exponential { .. }) {
                        within_above_zero(&field, value, *range.end())
                    } else {
                        within(&field, value, range.clone())
                    });
                }
                found.add(within(&format!("{field}.env_steps"), env_steps, 1..));
            }
            Self::Step { from, factor, every_env_steps } => {
                found.add(within(&format!("{field}.from"), from, range));
                found.add(within_above_zero(&format!("{field}.factor"), factor, 1.0));
                found.add(within(&format!("{field}.every_env_steps"), every_env_steps, 1..));
            }
        }
    }
}
