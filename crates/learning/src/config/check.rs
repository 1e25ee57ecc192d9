//! Range checks of all config values.

use std::ops::RangeInclusive;

use super::{
    ConfigError, Exploration, LearningConfig, Loss, Optimizer, ReplayConfig, Sampling, Schedule, TargetUpdate,
};
use crate::limits::*;
use wayfield_policy::NetworkShape;
use wayfield_policy::range::{above_zero, within, within_above_zero};

impl LearningConfig {
    /// Checks that every value is in range.
    ///
    /// # Errors
    /// The first field that is out of range.
    pub fn check(&self) -> Result<(), ConfigError> {
        NetworkShape::check_hidden(&self.network.hidden)?;
        within("gamma", self.gamma, 0.0..=1.0)?;
        within("n_step", self.n_step, 1..=MAX_N_STEP)?;
        within_above_zero("reward_scale", self.reward_scale, MAX_REWARD_SCALE)?;
        if let Loss::Huber { delta } = self.loss {
            above_zero("loss.delta", delta)?;
        }
        match self.optimizer {
            Optimizer::RmsProp { smoothing, epsilon } => {
                within("optimizer.smoothing", smoothing, 0.0..1.0)?;
                above_zero("optimizer.epsilon", epsilon)?;
            }
            Optimizer::Adam { beta1, beta2, epsilon } => {
                within("optimizer.beta1", beta1, 0.0..1.0)?;
                within("optimizer.beta2", beta2, 0.0..1.0)?;
                above_zero("optimizer.epsilon", epsilon)?;
            }
        }
        self.learning_rate.check("learning_rate", 0.0..=MAX_LEARNING_RATE)?;
        if let Some(norm) = self.max_gradient_norm {
            above_zero("max_gradient_norm", norm)?;
        }
        within("weight_decay", self.weight_decay, 0.0..=1.0)?;
        within("batch_size", self.batch_size, 1..=MAX_BATCH_SIZE)?;
        self.replay.check(self.batch_size)?;
        within("train_freq", self.train_freq, 1..)?;
        within("gradient_steps", self.gradient_steps, 1..=MAX_GRADIENT_STEPS)?;
        match self.target_update {
            TargetUpdate::Hard { every } => within("target_update.every", every, 1..)?,
            TargetUpdate::Soft { tau } => within_above_zero("target_update.tau", tau, 1.0)?,
        }
        self.exploration.check()
    }
}

impl ReplayConfig {
    fn check(&self, batch_size: usize) -> Result<(), ConfigError> {
        within("replay.capacity", self.capacity, 1..=MAX_REPLAY_CAPACITY)?;
        if self.capacity < batch_size {
            return Err(ConfigError {
                field: "replay.capacity".into(),
                problem: format!(
                    "is {}, less than batch_size ({batch_size}); help: raise it, or lower batch_size",
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
                within_above_zero("exploration.decay", decay, 1.0)?;
                (start, end)
            }
            Self::Linear { start, end, env_steps } => {
                within("exploration.env_steps", env_steps, 1..)?;
                (start, end)
            }
        };
        within("exploration.start", start, 0.0..=1.0)?;
        within("exploration.end", end, 0.0..=1.0)
    }
}

impl Schedule {
    fn check(&self, field: &str, range: RangeInclusive<f32>) -> Result<(), ConfigError> {
        match *self {
            Self::Constant(value) => within(field, value, range),
            Self::Linear { from, to, env_steps }
            | Self::Exponential { from, to, env_steps }
            | Self::Cosine { from, to, env_steps } => {
                for (end, value) in [("from", from), ("to", to)] {
                    let field = format!("{field}.{end}");
                    if matches!(self, Self::Exponential { .. }) {
                        within_above_zero(&field, value, *range.end())?;
                    } else {
                        within(&field, value, range.clone())?;
                    }
                }
                within(&format!("{field}.env_steps"), env_steps, 1..)
            }
            Self::Step { from, factor, every_env_steps } => {
                within(&format!("{field}.from"), from, range)?;
                within_above_zero(&format!("{field}.factor"), factor, 1.0)?;
                within(&format!("{field}.every_env_steps"), every_env_steps, 1..)
            }
        }
    }
}
