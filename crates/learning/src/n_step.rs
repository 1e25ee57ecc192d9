//! Returns over n steps, one accumulator per arena.
//!
//! In: the steps of one arena as they come. Out: transitions whose return is R = sum of gamma^i r_i over m
//! steps, m = n within an episode and fewer at its end, with the discount that the bootstrap value is due:
//! gamma^m, or 0 where the return has ended (Sutton 1988; with replay: Hessel et al. 2018).

use std::collections::VecDeque;

use serde::{Deserialize, Serialize};

use super::replay::StateId;

/// One step that is still waiting for its return.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct PendingStep {
    /// Where it was taken.
    pub state: StateId,
    /// What was done.
    pub action: u8,
    /// What it brought (scaled).
    pub reward: f32,
}

/// A transition over m steps.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Transition {
    /// Where it starts.
    pub state: StateId,
    /// The action taken there.
    pub action: u8,
    /// R, the sum of gamma^i r_i.
    pub reward: f32,
    /// What Q(next) is multiplied by: gamma^m, 0 if terminated.
    pub discount: f32,
    /// The state m steps later; of no meaning if terminated.
    pub next: StateId,
    /// The return ended here.
    pub terminated: bool,
    /// A time limit (or a break from outside) cut the chain here.
    pub truncated: bool,
}

/// How a step ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StepEnd {
    /// It did not: the episode goes on.
    Ongoing,
    /// The return ended; nothing to bootstrap from.
    Terminated,
    /// The chain was cut; bootstrap from the last observation.
    Truncated,
}

/// The last n steps of one arena.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct NStepAccumulator {
    pending: VecDeque<PendingStep>,
}

impl NStepAccumulator {
    /// Adds a step that led to `next`, and hands every transition thereby complete to `emit`, oldest first.
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

    /// Hands out all that is pending, with `next` as the last state known.
    pub fn flush(&mut self, next: StateId, end: StepEnd, gamma: f32, mut emit: impl FnMut(Transition)) {
        while !self.pending.is_empty() {
            emit(self.pop(next, end, gamma));
        }
    }

    /// The oldest pending step as a transition over all that is pending.
    fn pop(&mut self, next: StateId, end: StepEnd, gamma: f32) -> Transition {
        // Horner's rule, from the last reward back: R = r_0 + gamma (r_1 + gamma (r_2 + ...)).
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

    /// The steps still waiting, oldest first.
    #[must_use]
    pub fn pending(&self) -> &VecDeque<PendingStep> {
        &self.pending
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Feeds rewards 1, 2, 3, ... with state i before step i, the last step ending as `end`.
    fn run(n: usize, steps: u64, end: StepEnd) -> Vec<Transition> {
        let (mut accumulator, mut out) = (NStepAccumulator::default(), Vec::new());
        for i in 0..steps {
            let step = PendingStep { state: StateId(i), action: i as u8, reward: (i + 1) as f32 };
            let end = if i + 1 == steps { end } else { StepEnd::Ongoing };
            accumulator.push(step, StateId(i + 1), end, (n, 0.5), |t| out.push(t));
        }
        out
    }

    fn brief(transitions: &[Transition]) -> Vec<(u64, f32, f32, u64)> {
        transitions.iter().map(|t| (t.state.0, t.reward, t.discount, t.next.0)).collect()
    }

    #[test]
    fn one_step_returns_are_the_rewards() {
        assert_eq!(
            brief(&run(1, 3, StepEnd::Ongoing)),
            [(0, 1.0, 0.5, 1), (1, 2.0, 0.5, 2), (2, 3.0, 0.5, 3)]
        );
    }

    #[test]
    fn three_step_returns_wait_for_three_rewards() {
        // gamma 0.5: 1 + 0.5 x 2 + 0.25 x 3 = 2.75, then 2 + 1.5 + 1 = 4.5; discount 0.125.
        assert_eq!(brief(&run(3, 4, StepEnd::Ongoing)), [(0, 2.75, 0.125, 3), (1, 4.5, 0.125, 4)]);
    }

    #[test]
    fn termination_closes_all_that_is_pending_without_bootstrap() {
        let transitions = run(3, 3, StepEnd::Terminated);
        assert_eq!(brief(&transitions), [(0, 2.75, 0.0, 3), (1, 3.5, 0.0, 3), (2, 3.0, 0.0, 3)]);
        assert!(transitions.iter().all(|t| t.terminated && !t.truncated));
    }

    #[test]
    fn truncation_bootstraps_from_the_last_state_over_fewer_steps() {
        let transitions = run(3, 3, StepEnd::Truncated);
        assert_eq!(brief(&transitions), [(0, 2.75, 0.125, 3), (1, 3.5, 0.25, 3), (2, 3.0, 0.5, 3)]);
        assert!(transitions.iter().all(|t| t.truncated && !t.terminated));
    }
}
