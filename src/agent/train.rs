//! `Store` and `Learn`: transitions go into the replay buffer, gradient steps come out of it.
//!
//! In: observations, actions and outcomes of the step. Out: the learner in [`ActiveLearner`], what its gradient steps
//! looked like ([`TrainingStats`]), [`TrainingFault`] if a number went wrong, and [`TrainingWarning`] if one is about to.

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use crate::learning::{DivergenceError, Experience, Learner, Overestimate};
use crate::task::{Actions, Observations, StepOutcomes, TaskMode};

/// The learner in training.
#[derive(Resource)]
pub struct ActiveLearner(pub Learner);

/// Set when a loss or weight is no longer a number: the caller of the step must look, and stop.
#[derive(Resource, Default)]
pub struct TrainingFault(pub Option<DivergenceError>);

/// Set when Q-values are beyond what any return can be: the caller of the step should tell the user.
#[derive(Resource, Default)]
pub struct TrainingWarning {
    first: Option<Overestimate>,
    reported: bool,
}

impl TrainingWarning {
    /// The first such warning of the training, once.
    pub fn take_new(&mut self) -> Option<Overestimate> {
        let news = self.first.clone().filter(|_| !self.reported);
        self.reported |= news.is_some();
        news
    }
}

/// Sums over the gradient steps since they were last taken.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TrainingStats {
    /// Gradient steps in the sums.
    pub gradient_steps: u32,
    /// Sum of the losses.
    pub loss: f64,
    /// Sum of the mean absolute TD errors.
    pub td_error: f64,
    /// Sum of the mean Q-values of the actions taken.
    pub q: f64,
}

impl TrainingStats {
    /// The means of loss, absolute TD error and Q, and the sums back at zero; None if no gradient step was taken.
    pub fn take_means(&mut self) -> Option<(f64, f64, f64)> {
        let sums = std::mem::take(self);
        let n = f64::from(sums.gradient_steps);
        (sums.gradient_steps > 0).then(|| (sums.loss / n, sums.td_error / n, sums.q / n))
    }
}

/// `Store`: one experience per environment.
pub(super) fn store(
    mode: Res<TaskMode>,
    observations: Res<Observations>,
    actions: Res<Actions>,
    outcomes: Res<StepOutcomes>,
    mut trainer: ResMut<ActiveLearner>,
) {
    for (env_index, outcome) in outcomes.0.iter().enumerate() {
        if outcome.inactive {
            continue;
        }
        trainer.0.store(&Experience {
            env_index,
            observation: observations.row(env_index),
            action: actions.0[env_index],
            reward: outcome.total_reward(),
            next_observation: observations.next_row(env_index),
            terminated: outcome.terminated(),
            truncated: outcome.truncated(),
        });
        if outcome.episode_end(*mode).is_some() {
            trainer.0.episode_ended();
        }
    }
}

/// `Learn`: the gradient steps that are due.
pub(super) fn learn(
    mut trainer: ResMut<ActiveLearner>,
    mut stats: ResMut<TrainingStats>,
    mut fault: ResMut<TrainingFault>,
    mut warning: ResMut<TrainingWarning>,
) {
    match trainer.0.train() {
        Ok(Some(step)) => {
            let n = f64::from(step.gradient_steps);
            stats.gradient_steps += step.gradient_steps;
            stats.loss += n * f64::from(step.loss);
            stats.td_error += n * f64::from(step.td_error);
            stats.q += n * f64::from(step.q);
            if let (None, Some(overestimate)) = (&warning.first, step.overestimate) {
                warning.first = Some(overestimate);
            }
        }
        Ok(None) => {}
        Err(diverged) => fault.0 = Some(diverged),
    }
}
