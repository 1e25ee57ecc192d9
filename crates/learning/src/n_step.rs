//! N-step returns, with one accumulator per environment.
//!
//! In: the steps of one environment. Out: transitions over m steps, with the return R = sum of gamma^i r_i and the discount
//! of the bootstrap value: gamma^m, or 0 if terminated. m is n, or less at the end of an episode (Sutton 1988; with replay:
//! Hessel et al. 2018).

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use super::state_ring::StateId;

/// A step that waits for its n-step return.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct PendingStep {
    /// The state before the step.
    pub state: StateId,
    /// The index of the action taken.
    pub action: u8,
    /// The scaled reward.
    pub reward: f32,
}

/// A transition over m steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transition {
    /// The state before the first step.
    pub state: StateId,
    /// The index of the action taken in it.
    pub action: u8,
    /// The return R, the sum of gamma^i r_i.
    pub reward: f32,
    /// The factor of Q(next): gamma^m, or 0 if terminated.
    pub discount: f32,
    /// The state m steps later; meaningless if terminated.
    pub next: StateId,
    /// Whether the last step reached a terminal state.
    pub terminated: bool,
    /// Whether a time limit or an unplanned reset ended the episode.
    pub truncated: bool,
}

/// The effect of a step on the episode.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum StepEnd {
    /// The episode continues.
    Ongoing,
    /// The episode ended in a terminal state: the return ends without bootstrapping.
    Terminated,
    /// The episode was cut off: the return bootstraps from the last observation.
    Truncated,
}

/// The steps of one environment that wait for their n-step return.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub(crate) struct NStepAccumulator {
    pending: VecDeque<PendingStep>,
}

impl NStepAccumulator {
    /// Adds a step that led to `next`. Passes the transitions that are now complete to `emit`, oldest first.
    pub fn push(
        &mut self,
        step: PendingStep,
        next: StateId,
        end: StepEnd,
        (n, gamma): (usize, f32),
        mut emit: impl FnMut(Transition),
    ) {
        self.pending.push_back(step);
        if end != StepEnd::Ongoing {
            self.flush(next, end, gamma, emit);
        } else if self.pending.len() >= n {
            emit(self.pop(next, end, gamma));
        }
    }

    /// Passes all pending steps to `emit` as transitions that lead to `next`.
    pub fn flush(&mut self, next: StateId, end: StepEnd, gamma: f32, mut emit: impl FnMut(Transition)) {
        while !self.pending.is_empty() {
            emit(self.pop(next, end, gamma));
        }
    }

    /// Removes the oldest pending step, and returns the transition over all pending steps.
    fn pop(&mut self, next: StateId, end: StepEnd, gamma: f32) -> Transition {
        // Horner's method, backward from the last reward: R = r_0 + gamma (r_1 + gamma (r_2 + ...)).
        let reward = self.pending.iter().rev().fold(0.0, |sum, step| step.reward + gamma * sum);
        let discount = self.pending.iter().fold(1.0, |product, _| product * gamma);
        let PendingStep { state, action, .. } = self.pending[0];
        self.pending.pop_front();
        Transition {
            state,
            action,
            reward,
            discount: if end == StepEnd::Terminated { 0.0 } else { discount },
            next,
            terminated: end == StepEnd::Terminated,
            truncated: end == StepEnd::Truncated,
        }
    }

    /// The pending steps, oldest first.
    pub fn pending(&self) -> &VecDeque<PendingStep> {
        &self.pending
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The transitions of an episode with the rewards 1, 2, 3, ..., with state i before step i. Its last step has the given
    /// `end`.
    fn run(n: usize, steps: u64, end: StepEnd) -> Vec<Transition> {
        let (mut accumulator, mut out) = (NStepAccumulator::default(), Vec::new());
        for i in 0..steps {
            let step = PendingStep { state: StateId(i), action: i as u8, reward: (i + 1) as f32 };
            let end = if i + 1 == steps { end } else { StepEnd::Ongoing };
            accumulator.push(step, StateId(i + 1), end, (n, 0.5), |t| out.push(t));
        }
        out
    }

    fn summary(transitions: &[Transition]) -> Vec<(u64, f32, f32, u64)> {
        transitions.iter().map(|t| (t.state.0, t.reward, t.discount, t.next.0)).collect()
    }

    #[test]
    fn one_step_returns_are_the_rewards() {
        assert_eq!(
            summary(&run(1, 3, StepEnd::Ongoing)),
            [(0, 1.0, 0.5, 1), (1, 2.0, 0.5, 2), (2, 3.0, 0.5, 3)]
        );
    }

    #[test]
    fn three_step_returns_wait_for_three_rewards() {
        // gamma 0.5: 1 + 0.5 x 2 + 0.25 x 3 = 2.75, then 2 + 1.5 + 1 = 4.5; discount 0.125.
        assert_eq!(summary(&run(3, 4, StepEnd::Ongoing)), [(0, 2.75, 0.125, 3), (1, 4.5, 0.125, 4)]);
    }

    #[test]
    fn termination_completes_all_pending_steps_without_bootstrapping() {
        let transitions = run(3, 3, StepEnd::Terminated);
        assert_eq!(summary(&transitions), [(0, 2.75, 0.0, 3), (1, 3.5, 0.0, 3), (2, 3.0, 0.0, 3)]);
        assert!(transitions.iter().all(|t| t.terminated && !t.truncated));
    }

    #[test]
    fn truncation_completes_all_pending_steps_and_bootstraps_from_the_last_state() {
        let transitions = run(3, 3, StepEnd::Truncated);
        assert_eq!(summary(&transitions), [(0, 2.75, 0.125, 3), (1, 3.5, 0.25, 3), (2, 3.0, 0.5, 3)]);
        assert!(transitions.iter().all(|t| t.truncated && !t.terminated));
    }
}
