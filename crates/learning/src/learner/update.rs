//! The gradient step: TD targets, loss, optimizer, priorities, target network.

use super::Learner;
use crate::config::TargetUpdate;
use crate::divergence::{
    DivergenceError, Overestimate, advice, non_finite_loss_cause, non_finite_weight_cause,
};
use crate::network::{Gradient, QNetwork, Regression};
use crate::optimizer::clip;
use crate::replay::Batch;
use wayfield_policy::greedy;

/// An overestimate is reported once `steps_over_bound` reaches this value.
const MIN_OVERESTIMATE_STEPS: u32 = 50;

/// The statistics of one call of [`Learner::train`]: means over its gradient steps.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct UpdateStats {
    /// The number of gradient steps.
    pub gradient_steps: u32,
    /// The loss, including importance weights.
    pub loss: f32,
    /// |Q(s, a) - y|, in units of scaled reward.
    pub td_error: f32,
    /// Q(s, a) of the sampled transitions, in units of scaled reward.
    pub q: f32,
    /// A warning if Q-values have exceeded the return bound for many gradient steps.
    pub overestimate: Option<Overestimate>,
}

/// Buffers that are reused by every gradient step. They hold no state.
#[derive(Debug, Clone, Default)]
pub(super) struct Scratch {
    batch: Batch,
    gradient: Gradient,
    /// Q(s', .) of the network that chooses the next action.
    choosing_q: Vec<f32>,
    /// The quantiles Z(s', .), or Q(s', .), of the target network.
    target_q: Vec<f32>,
    /// Q(s, .) of the target network, for advantage learning.
    gap_q: Vec<f32>,
    targets: Vec<f32>,
}

impl Learner {
    /// Takes the pending gradient steps, and returns their statistics; `None` if no step is pending or the replay buffer is empty.
    ///
    /// # Errors
    /// The loss, a weight or the square of a gradient is not finite. The learner can no longer be used.
    ///
    /// # Panics
    /// If the config has `mirror`, and no mirror was set ([`Learner::set_mirror`]).
    pub fn train(&mut self) -> Result<Option<UpdateStats>, DivergenceError> {
        let pending_updates = std::mem::take(&mut self.counters.pending_updates);
        if pending_updates == 0 || self.replay.is_empty() {
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
        self.counters.gradient_steps += 1;
        self.compute_gradient();
        self.apply_gradient()?;
        let Self { config, online, target, replay, counters, scratch, .. } = self;
        let Scratch { batch, gradient, .. } = &*scratch;
        replay.update_priorities(&batch.slots, &gradient.td_errors);
        update_target(config.target_update, counters.gradient_steps, online, target);

        let n = config.batch_size as f32;
        let mean = |values: &[f32]| values.iter().sum::<f32>() / n;
        let mean_abs = |values: &[f32]| values.iter().map(|value| value.abs()).sum::<f32>() / n;
        let (loss, td_error) = (gradient.loss, mean_abs(&gradient.td_errors));
        let (q, mean_abs_q) = (mean(&gradient.q), mean_abs(&gradient.q));
        let overestimate = self.check_return_bound(mean_abs_q);
        Ok(UpdateStats { gradient_steps: 1, loss, td_error, q, overestimate })
    }

    /// Samples a batch and computes its TD targets, loss and gradient.
    fn compute_gradient(&mut self) {
        let Self { config, online, target, replay, counters, mirror_stream, mirror, scratch, .. } = self;
        let Scratch { batch, gradient, choosing_q, target_q, gap_q, targets } = scratch;
        let n = config.batch_size;
        replay.sample(n, counters.env_steps, &mut counters.sampling, batch);
        if let Some(stream) = mirror_stream {
            mirror.as_ref().expect("a learner with mirror augmentation has a mirror").augment(batch, stream);
        }
        target.quantile_values(&batch.next_states, n, target_q);
        let chooser = if config.double { &*online } else { &*target };
        if config.double || config.quantiles > 1 {
            chooser.q_values(&batch.next_states, n, choosing_q);
        } else {
            choosing_q.clone_from(target_q);
        }
        td_targets(batch, choosing_q, target_q, targets);
        if config.advantage_learning > 0.0 {
            target.q_values(&batch.states, n, gap_q);
            widen_gaps(&batch.actions, gap_q, config.advantage_learning, targets);
        }
        let regression =
            Regression { actions: &batch.actions, targets, weights: &batch.weights, loss: config.loss };
        online.gradient(&batch.states, regression, gradient);
    }

    /// Clips the gradient, and moves the weights against it.
    fn apply_gradient(&mut self) -> Result<(), DivergenceError> {
        let Self { config, online, optimizer, counters, scratch, .. } = self;
        let Scratch { batch, gradient, target_q, .. } = scratch;
        let (gradient_step, env_step) = (counters.gradient_steps, counters.env_steps);
        let diverged = |what| DivergenceError { gradient_step, env_step, what, advice: advice(config) };
        if !gradient.loss.is_finite() {
            let what = non_finite_loss_cause(&batch.returns, target_q, &gradient.q, &gradient.td_errors);
            return Err(diverged(what));
        }
        if let Some(max_norm) = config.max_gradient_norm {
            clip(&mut gradient.values, max_norm);
        }
        let learning_rate = config.learning_rate.at(env_step);
        let rates = (learning_rate, config.weight_decay);
        online.update(|weights| optimizer.step(&config.optimizer, rates, weights, &gradient.values));
        if !all_finite(online.parameters()) {
            return Err(diverged(non_finite_weight_cause(online, &gradient.values, learning_rate)));
        }
        if !all_finite(&optimizer.second) {
            return Err(diverged("the square of a gradient is not finite".into()));
        }
        Ok(())
    }

    /// A warning if `q`, the mean |Q(s, a)| of this batch, exceeds the largest Q-value that the rewards so far allow, and
    /// `steps_over_bound` has reached [`MIN_OVERESTIMATE_STEPS`].
    fn check_return_bound(&mut self, q: f32) -> Option<Overestimate> {
        let Self { config, counters, largest_reward, steps_over_bound, .. } = self;
        let largest_return = *largest_reward / (1.0 - config.gamma);
        // The fixed point of advantage learning with weight w is (Q - w max Q) / (1 - w), where Q is the fixed point for w = 0.
        let w = config.advantage_learning;
        let largest_q = largest_return * (1.0 + w) / (1.0 - w);
        // Before the first reward other than 0, nothing is known about returns.
        let is_over_bound = *largest_reward > 0.0 && q > largest_q;
        *steps_over_bound = if is_over_bound {
            steps_over_bound.saturating_add(1)
        } else {
            steps_over_bound.saturating_sub(1)
        };
        (is_over_bound && *steps_over_bound >= MIN_OVERESTIMATE_STEPS).then(|| Overestimate {
            gradient_step: counters.gradient_steps,
            env_step: counters.env_steps,
            q,
            largest_reward: *largest_reward,
            largest_return,
            advice: advice(config),
        })
    }
}

/// Writes the TD targets y = R + discount Z_target(s', a*) into `targets`, one for each quantile of a transition. `chooser` holds
/// the Q-values of which a* is the argmax: Q(s', .) of the online network in double DQN, of the target network otherwise.
/// `target_q` holds the quantiles Z(s', .), or Q(s', .), of the target network (n x quantiles x actions).
pub(super) fn td_targets(batch: &Batch, chooser: &[f32], target_q: &[f32], targets: &mut Vec<f32>) {
    let n = batch.returns.len();
    let actions = chooser.len() / n;
    let rows = chooser.chunks_exact(actions).zip(target_q.chunks_exact(target_q.len() / n));
    let steps = batch.returns.iter().zip(&batch.discounts);
    targets.clear();
    for ((r, discount), (choose, quantiles)) in steps.zip(rows) {
        let best = greedy(choose);
        targets.extend(quantiles.chunks_exact(actions).map(|value| r + discount * value[best]));
    }
}

/// Subtracts `weight` times the gap max Q(s, .) - Q(s, a) from the targets of each transition: advantage learning. `q` holds
/// Q(s, .).
pub(super) fn widen_gaps(actions: &[u8], q: &[f32], weight: f32, targets: &mut [f32]) {
    let n = actions.len();
    let (rows, each) = (q.chunks_exact(q.len() / n), targets.len() / n);
    for ((targets, row), &action) in targets.chunks_exact_mut(each).zip(rows).zip(actions) {
        let gap = weight * (row[greedy(row)] - row[usize::from(action)]);
        targets.iter_mut().for_each(|target| *target -= gap);
    }
}

/// Updates the target network after gradient step `step`.
fn update_target(update: TargetUpdate, step: u64, online: &QNetwork, target: &mut QNetwork) {
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

/// Whether all values are finite. The loop has no early exit, so that the compiler can vectorize it.
pub(super) fn all_finite(values: &[f32]) -> bool {
    values.iter().map(|v| v.to_bits() & 0x7FFF_FFFF).fold(0, u32::max) < f32::INFINITY.to_bits()
}
