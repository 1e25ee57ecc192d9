//! Training (`Store` and `Learn`): transitions enter the replay buffer, and the learner takes its gradient steps.
//!
//! In: observations, actions and outcomes of the step. Out: the learner in [`ActiveLearner`], statistics of its gradient
//! steps ([`TrainingStats`]), a [`TrainingFault`] if learning diverged, and a [`TrainingWarning`] if it may diverge.

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use crate::learning::{DivergenceError, Experience, Learner, Overestimate};
use crate::task::{Actions, Observations, StepOutcomes, TaskMode};

/// The learner in training.
#[derive(Resource)]
pub struct ActiveLearner(pub Learner);

/// The divergence error, if learning diverged. The caller of a step must check it and stop.
#[derive(Resource, Default)]
pub struct TrainingFault(pub Option<DivergenceError>);

/// A warning that Q-values exceed the largest possible return. The caller of a step should report it to the user.
#[derive(Resource, Default)]
pub struct TrainingWarning {
    first: Option<Overestimate>,
    reported: bool,
}

impl TrainingWarning {
    /// Returns the first warning of the run, once; `None` afterwards.
    pub(crate) fn take_new(&mut self) -> Option<Overestimate> {
        let warning = self.first.clone().filter(|_| !self.reported);
        self.reported |= warning.is_some();
        warning
    }
}

/// Sums over the gradient steps since the last call of `take_means`.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TrainingStats {
    /// The number of gradient steps in the sums.
    pub gradient_steps: u32,
    /// The sum of the losses.
    pub loss: f64,
    /// The sum of the mean absolute TD errors.
    pub td_error: f64,
    /// The sum of the mean Q-values of the actions taken.
    pub q_value: f64,
}

impl TrainingStats {
    /// Returns the means of loss, absolute TD error and Q-value, and resets the sums. `None` without a gradient step.
    pub(crate) fn take_means(&mut self) -> Option<(f64, f64, f64)> {
        let sums = std::mem::take(self);
        let n = f64::from(sums.gradient_steps);
        (sums.gradient_steps > 0).then(|| (sums.loss / n, sums.td_error / n, sums.q_value / n))
    }
}

/// `Store`: stores one experience per active arena.
pub(super) fn store(
    mode: Res<TaskMode>,
    observations: Res<Observations>,
    actions: Res<Actions>,
    outcomes: Res<StepOutcomes>,
    mut learner: ResMut<ActiveLearner>,
) {
    for (env_index, outcome) in outcomes.0.iter().enumerate() {
        if outcome.inactive {
            continue;
        }
        learner.0.store(&Experience {
            env_index,
            observation: observations.row(env_index),
            action: actions.0[env_index],
            reward: outcome.total_reward(),
            next_observation: observations.next_row(env_index),
            terminated: outcome.terminated(),
            truncated: outcome.truncated(),
        });
        if outcome.episode_end(*mode).is_some() {
            learner.0.episode_ended();
        }
    }
}

/// `Learn`: takes the pending gradient steps.
pub(super) fn learn(
    mut learner: ResMut<ActiveLearner>,
    mut stats: ResMut<TrainingStats>,
    mut fault: ResMut<TrainingFault>,
    mut warning: ResMut<TrainingWarning>,
) {
    match learner.0.train() {
        Ok(Some(step)) => {
            let n = f64::from(step.gradient_steps);
            stats.gradient_steps += step.gradient_steps;
            stats.loss += n * f64::from(step.loss);
            stats.td_error += n * f64::from(step.td_error);
            stats.q_value += n * f64::from(step.q);
            if let (None, Some(overestimate)) = (&warning.first, step.overestimate) {
                warning.first = Some(overestimate);
            }
        }
        Ok(None) => {}
        Err(diverged) => fault.0 = Some(diverged),
    }
}
