//! Detection of divergence: non-finite values, and Q-values above the largest possible return.
//!
//! In: the results of a gradient step. Out: [`DivergenceError`], after which the learner cannot be used; or
//! [`Overestimate`], a warning after which learning continues.

use super::config::{LearningConfig, Loss, TargetUpdate};
use super::network::QNetwork;

/// The error of a learner that has diverged: a loss, a weight or the square of a gradient is NaN or infinite.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "learning diverged at gradient step {gradient_step} (env step {env_step}): {what}; help: try {advice} in a new run"
)]
pub struct DivergenceError {
    /// The number of the gradient step, from 1.
    pub gradient_step: u64,
    /// The env steps so far, of all environments together.
    pub env_step: u64,
    /// Which value is not finite, and its cause.
    pub what: String,
    /// Changes to the config that might help.
    pub advice: String,
}

/// A warning that Q-values exceed the largest possible return: the largest |reward| so far, divided by 1 - gamma. Advantage
/// learning with weight w makes Q-values up to (1 + w) / (1 - w) times as large, so with it the bound is higher by this factor.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "learning seems to diverge at gradient step {gradient_step} (env step {env_step}): the mean |Q-value| is {q:.4}, but no \
     return can exceed {largest_return:.4} = {largest_reward:.4} (the largest |reward| so far) / (1 - gamma); help: try \
     {advice}"
)]
pub struct Overestimate {
    /// The number of the gradient step, from 1.
    pub gradient_step: u64,
    /// The env steps so far, of all environments together.
    pub env_step: u64,
    /// The mean |Q(s, a)| of the batch. This and the next two values are in units of scaled reward.
    pub q: f32,
    /// The largest |reward| of an env step so far; after a restore, it starts at the largest stored |n-step return|.
    pub largest_reward: f32,
    /// The largest possible |return|.
    pub largest_return: f32,
    /// Changes to the config that might help.
    pub advice: String,
}

/// Changes to `config` that make divergence less likely, as text for a message.
pub(crate) fn advice(config: &LearningConfig) -> String {
    let mut changes = vec!["a lower learning_rate or reward_scale"];
    if config.loss == Loss::MeanSquared {
        changes.push("loss: Huber(delta: 1.0)");
    }
    if !config.double {
        changes.push("double: true");
    }
    changes.push(match config.target_update {
        TargetUpdate::Hard { .. } => "a less frequent target_update",
        TargetUpdate::Soft { .. } => "a target_update with a smaller tau",
    });
    changes.join(", ")
}

/// The cause of a non-finite loss, as text: the first non-finite value among the returns, the Q-values of the next states
/// and the Q-values; or the largest |TD error| if all of them are finite.
pub(crate) fn non_finite_loss_cause(returns: &[f32], next_q: &[f32], q: &[f32], td_errors: &[f32]) -> String {
    for (what, values) in [
        ("a stored return is", returns),
        ("the target network's Q-value of a next state is", next_q),
        ("a Q-value is", q),
    ] {
        if let Some(bad) = values.iter().find(|value| !value.is_finite()) {
            return format!("the loss is not finite, because {what} {bad}");
        }
    }
    let largest = td_errors.iter().fold(0.0, |largest: f32, error| largest.max(error.abs()));
    format!("the loss is not finite, with TD errors of up to {largest:e}")
}

/// The first non-finite weight, with the gradient and the learning rate of the step that caused it, as text.
pub(crate) fn non_finite_weight_cause(network: &QNetwork, gradient: &[f32], learning_rate: f32) -> String {
    let weights = network.parameters();
    let Some(at) = weights.iter().position(|weight| !weight.is_finite()) else {
        return "a weight is not finite".into();
    };
    let name = network.parameter_name(at);
    format!(
        "a weight of `{name}` is {} after a step along a gradient of {:e} with the learning rate {learning_rate}",
        weights[at],
        gradient.get(at).copied().unwrap_or_default()
    )
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_non_finite_input_is_reported_as_the_cause_of_a_non_finite_loss() {
        let (nan, inf) = (f32::NAN, f32::INFINITY);
        let message = non_finite_loss_cause(&[1.0, inf], &[nan], &[nan], &[nan]);
        assert_eq!(message, "the loss is not finite, because a stored return is inf");
        let message = non_finite_loss_cause(&[1.0], &[0.0, nan], &[nan], &[nan]);
        assert!(message.ends_with("the target network's Q-value of a next state is NaN"), "{message}");
        assert!(non_finite_loss_cause(&[1.0], &[0.0], &[-inf], &[nan]).ends_with("a Q-value is -inf"));
        let message = non_finite_loss_cause(&[1.0], &[0.0], &[1.0], &[3.0, -2e30]);
        assert_eq!(message, "the loss is not finite, with TD errors of up to 2e30");
    }

    #[test]
    fn advice_leaves_out_what_the_config_already_has() {
        let mut config = LearningConfig::default();
        (config.loss, config.double) = (Loss::MeanSquared, false);
        config.target_update = TargetUpdate::Hard { every: 100 };
        let message = advice(&config);
        for needle in ["learning_rate", "Huber", "double: true", "less frequent"] {
            assert!(message.contains(needle), "`{needle}` is not in: {message}");
        }
        (config.loss, config.double) = (Loss::Huber { delta: 1.0 }, true);
        config.target_update = TargetUpdate::Soft { tau: 0.01 };
        let message = advice(&config);
        assert_eq!(message, "a lower learning_rate or reward_scale, a target_update with a smaller tau");
    }
}
