//! The main part of a checkpoint's header: all but the config before it and the mirror's random stream after it.

use serde::{Deserialize, Serialize};

use super::CheckpointError;
use super::arrays::is_priority;
use crate::learner::{Counters, Learner, Trajectory};
use crate::limits::MAX_COUNT;
use crate::optimizer::OptimizerState;
use crate::state_ring::StateId;

/// The main part of the header.
#[derive(Serialize, Deserialize)]
pub(super) struct Header {
    inputs: usize,
    actions: usize,
    counters: Counters,
    online: Vec<f32>,
    target: Vec<f32>,
    optimizer: OptimizerState,
    trajectories: Vec<Trajectory>,
    /// The number of states ever stored.
    pub(super) states: u64,
    /// The sequence number, from 0, of the oldest transition in the buffer.
    pub(super) first_transition: u64,
    /// The number of transitions ever stored.
    pub(super) transitions: u64,
    pub(super) largest_priority: f64,
}

impl Header {
    pub(super) fn of(learner: &Learner) -> Self {
        let (replay, shape) = (&learner.replay, learner.online.shape());
        Self {
            inputs: shape.inputs,
            actions: shape.actions,
            counters: learner.counters.clone(),
            online: learner.online.parameters().to_vec(),
            target: learner.target.parameters().to_vec(),
            optimizer: learner.optimizer.clone(),
            trajectories: learner.trajectories.clone(),
            states: replay.states.pushed,
            first_transition: replay.head,
            transitions: replay.tail,
            largest_priority: replay.priorities.as_ref().map_or(1.0, |p| p.largest),
        }
    }

    /// Restores `learner`, whose replay buffer has already been read.
    pub(super) fn apply_to(self, learner: &mut Learner) {
        learner.online.update(|weights| weights.copy_from_slice(&self.online));
        learner.target.update(|weights| weights.copy_from_slice(&self.target));
        learner.optimizer = self.optimizer;
        learner.trajectories = self.trajectories;
        learner.counters = self.counters;
        learner.largest_reward =
            learner.replay.transitions.iter().fold(0.0, |largest, t| largest.max(t.reward.abs()));
    }

    /// Checks that the sizes are those of `learner`, a new learner, and that all values are valid.
    pub(super) fn check(&self, learner: &Learner) -> Result<(), CheckpointError> {
        self.check_sizes(learner)?;
        let parameters = learner.online.parameters().len();
        let finite = |values: &[f32]| values.iter().all(|value| value.is_finite());
        let Counters { env_steps, episodes, gradient_steps, epsilon_start, sampling, .. } = &self.counters;
        let counts =
            [self.states, self.transitions, *env_steps, *episodes, *gradient_steps, self.optimizer.steps];
        let OptimizerState { first, second, steps: _ } = &self.optimizer;
        let has_all_moments = first.len() == learner.optimizer.first.len() && second.len() == parameters;
        let valid_moments = finite(first) && second.iter().all(|m| m.is_finite() && *m >= 0.0);
        for (problem, valid) in [
            (
                "its number of weights does not match the config",
                self.online.len() == parameters && self.target.len() == parameters,
            ),
            ("a weight is not finite", finite(&self.online) && finite(&self.target)),
            ("its number of optimizer moments does not match the config", has_all_moments),
            ("an optimizer moment is invalid", valid_moments),
            ("its number of transitions is invalid", self.stored_transitions(learner).is_some()),
            ("a counter is too large", counts.iter().all(|&count| count < MAX_COUNT)),
            ("its number of pending updates is invalid", self.has_valid_pending_updates(learner)),
            (
                "its epsilon is not between 0 and 1",
                epsilon_start.is_none_or(|epsilon| (0.0..=1.0).contains(&epsilon)),
            ),
            ("the state of its random stream is invalid", wayfield_random::is_valid(sampling)),
            ("its largest priority is invalid", is_priority(self.largest_priority)),
            (
                "a trajectory is invalid",
                self.trajectories.iter().all(|t| self.is_valid_trajectory(t, learner)),
            ),
        ] {
            if !valid {
                return Err(CheckpointError::Corrupt(problem));
            }
        }
        Ok(())
    }

    fn check_sizes(&self, learner: &Learner) -> Result<(), CheckpointError> {
        let shape = learner.online.shape();
        for (field, same) in [
            ("observation", self.inputs == shape.inputs),
            ("actions", self.actions == shape.actions),
            ("num_envs", self.trajectories.len() == learner.trajectories.len()),
        ] {
            if !same {
                return Err(CheckpointError::ConfigMismatch { field });
            }
        }
        Ok(())
    }

    /// The number of transitions in the buffer; `None` if it is negative or exceeds the capacity.
    fn stored_transitions(&self, learner: &Learner) -> Option<u64> {
        let stored = self.transitions.checked_sub(self.first_transition)?;
        Some(stored).filter(|&n| n <= learner.replay.capacity() as u64)
    }

    /// Whether the number of pending updates is plausible: each env step adds at most `gradient_steps` updates, and an update
    /// needs a transition to sample.
    fn has_valid_pending_updates(&self, learner: &Learner) -> bool {
        let Counters { env_steps, pending_updates, .. } = self.counters;
        let max_pending = env_steps.saturating_mul(u64::from(learner.config.gradient_steps));
        let has_transitions = self.stored_transitions(learner).is_some_and(|n| n > 0);
        u64::from(pending_updates) <= max_pending && (pending_updates == 0 || has_transitions)
    }

    fn is_valid_trajectory(&self, trajectory: &Trajectory, learner: &Learner) -> bool {
        let pending = trajectory.n_step.pending();
        let exists = |id: StateId| id.0 < self.states;
        pending.len() < learner.config.n_step
            && trajectory.last.is_none_or(exists)
            && pending.iter().all(|step| {
                usize::from(step.action) < self.actions && exists(step.state) && step.reward.is_finite()
            })
    }
}
