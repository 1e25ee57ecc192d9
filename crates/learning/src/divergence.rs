//! Learning that blows up: numbers that are none, told with their cause; and, before it comes to that, Q-values that no
//! return can reach.
//!
//! In: what a gradient step has computed. Out: [`DivergenceError`], after which the learner is of no more use; or
//! [`Overestimate`], a warning: learning goes on.

use super::config::{LearningConfig, Loss, TargetUpdate};
use super::network::QNetwork;

/// The learning blew up: a number is no longer finite.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "learning diverged at gradient step {gradient_step} (env step {env_step}): {what}; try {advice} in a new run"
)]
pub struct DivergenceError {
    /// The gradient step, counted from 1.
    pub gradient_step: u64,
    /// Env steps taken by then, of all arenas together.
    pub env_step: u64,
    /// Which number, and where it came from.
    pub what: String,
    /// What might help, by the config.
    pub advice: String,
}

/// Q-values beyond the largest return that there can be: a sum of discounted rewards, none larger than the largest seen
/// so far, is at most that reward / (1 - gamma).
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error(
    "learning seems to diverge at gradient step {gradient_step} (env step {env_step}): Q-values are {q:.4} in the mean, but no \
     return is beyond {largest_return:.4} (the largest reward so far, {largest_reward:.4}, / (1 - gamma)); try {advice}"
)]
pub struct Overestimate {
    /// The gradient step, counted from 1.
    pub gradient_step: u64,
    /// Env steps taken by then, of all arenas together.
    pub env_step: u64,
    /// Mean |Q(s, a)| of the batch, in units of scaled reward, as are all below.
    pub q: f32,
    /// The largest |reward| of an env step so far.
    pub largest_reward: f32,
    /// The largest |return| that there can be.
    pub largest_return: f32,
    /// What might help, by the config.
    pub advice: String,
}

/// What `config` could have otherwise against divergence.
pub(super) fn advice(config: &LearningConfig) -> String {
    let mut tries = vec!["a lower learning_rate or reward_scale"];
    if config.loss == Loss::MeanSquared {
        tries.push("loss: Huber(delta: 1.0)");
    }
    if !config.double {
        tries.push("double: true");
    }
    tries.push(match config.target_update {
        TargetUpdate::Hard { .. } => "a target_update that is made less often",
        TargetUpdate::Soft { .. } => "a target_update with a smaller tau",
    });
    tries.join(", ")
}

/// What a loss that is not finite was made of: rewards, values of next states, Q-values of the states.
pub(super) fn non_finite_loss_cause(rewards: &[f32], next_q: &[f32], q: &[f32], td_errors: &[f32]) -> String {
    for (what, values) in [
        ("a remembered reward is", rewards),
        ("the target network says of a next state that its Q-value is", next_q),
        ("a Q-value is", q),
    ] {
        if let Some(bad) = values.iter().find(|value| !value.is_finite()) {
            return format!("the loss is not finite, since {what} {bad}");
        }
    }
    let largest = td_errors.iter().fold(0.0, |largest: f32, error| largest.max(error.abs()));
    format!("the loss is not finite, with TD errors of up to {largest:e}")
}

/// Which weight is not finite, and by what step it became so.
pub(super) fn non_finite_weight_cause(network: &QNetwork, gradient: &[f32], learning_rate: f32) -> String {
    let weights = network.parameters();
    let Some(at) = weights.iter().position(|weight| !weight.is_finite()) else {
        return "a weight is not finite".into();
    };
    let views = network.shape().parameters();
    let name = views.iter().find(|view| view.range.contains(&at)).map_or("", |view| view.name.as_str());
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
    fn the_earliest_number_that_is_none_is_the_cause_of_the_loss() {
        let (nan, inf) = (f32::NAN, f32::INFINITY);
        let said = non_finite_loss_cause(&[1.0, inf], &[nan], &[nan], &[nan]);
        assert_eq!(said, "the loss is not finite, since a remembered reward is inf");
        let said = non_finite_loss_cause(&[1.0], &[0.0, nan], &[nan], &[nan]);
        assert!(said.ends_with("the target network says of a next state that its Q-value is NaN"), "{said}");
        assert!(non_finite_loss_cause(&[1.0], &[0.0], &[-inf], &[nan]).ends_with("a Q-value is -inf"));
        let said = non_finite_loss_cause(&[1.0], &[0.0], &[1.0], &[3.0, -2e30]);
        assert_eq!(said, "the loss is not finite, with TD errors of up to 2e30");
    }

    #[test]
    fn advice_is_what_the_config_does_not_do_yet() {
        let mut config = LearningConfig::default();
        (config.loss, config.double) = (Loss::MeanSquared, false);
        config.target_update = TargetUpdate::Hard { every: 100 };
        let said = advice(&config);
        for needle in ["learning_rate", "Huber", "double: true", "less often"] {
            assert!(said.contains(needle), "`{needle}` is not in: {said}");
        }
        (config.loss, config.double) = (Loss::Huber { delta: 1.0 }, true);
        config.target_update = TargetUpdate::Soft { tau: 0.01 };
        let said = advice(&config);
        assert_eq!(said, "a lower learning_rate or reward_scale, a target_update with a smaller tau");
    }
}
