//! The replay buffer: a ring of transitions over a ring of states, and batches drawn from it.
//!
//! In: observations and transitions; after a training, TD errors. Out: batches, drawn evenly or in proportion
//! to priority (Schaul et al. 2016), with importance weights. First in, first out.
//!
//! Memory, for the paper's 1,000,000 transitions of 28 numbers: 126 MB of states (each stored once), 9 MB of
//! their last users, 18 MB of transitions, 17 MB of sum tree: 170 MB when full, and nothing to speak of
//! before.

use super::config::{ReplayConfig, Sampling};
use super::n_step::Transition;
pub use super::state_ring::StateId;
use super::state_ring::StateRing;
use super::sum_tree::SumTree;
use wayfield_random::{Stream, uniform_index};

/// A transition as it is kept: states by their slot.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(super) struct StoredTransition {
    pub(super) state: u32,
    pub(super) next: u32,
    pub(super) reward: f32,
    pub(super) discount: f32,
    pub(super) action: u8,
    /// Bit 0: terminated; bit 1: truncated.
    pub(super) flags: u8,
}

/// The priorities of prioritized sampling.
#[derive(Debug, Clone)]
pub(super) struct Priorities {
    /// p^alpha of each transition slot; 0 where there is none.
    pub(super) tree: SumTree,
    /// The largest p^alpha so far, at first 1: what new transitions enter with.
    pub(super) largest: f64,
}

/// Transitions to learn from, the oldest replaced by the newest.
#[derive(Debug, Clone)]
pub struct ReplayBuffer {
    sampling: Sampling,
    capacity: usize,
    pub(super) states: StateRing,
    pub(super) transitions: Vec<StoredTransition>,
    pub(super) priorities: Option<Priorities>,
    /// The number of the oldest transition kept; slots are numbers modulo the capacity.
    pub(super) head: u64,
    /// How many transitions were ever stored.
    pub(super) tail: u64,
}

/// A batch of n transitions; one is reused for all batches.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Batch {
    /// Slots in the buffer, for [`ReplayBuffer::update_priorities`].
    pub slots: Vec<usize>,
    /// Row-major, n x inputs.
    pub states: Vec<f32>,
    /// Indices of the actions taken.
    pub actions: Vec<u8>,
    /// Returns R of up to n steps.
    pub rewards: Vec<f32>,
    /// What Q(next) is multiplied by; 0 if terminated.
    pub discounts: Vec<f32>,
    /// Row-major, n x inputs; of no meaning where the discount is 0.
    pub next_states: Vec<f32>,
    /// Importance weights, 0 to 1, the largest of the batch 1.
    pub weights: Vec<f32>,
}

impl ReplayBuffer {
    /// An empty buffer for observations of `inputs` numbers. At most `pending` steps may be awaiting their
    /// n-step return at a time.
    ///
    /// There are 1/8 more states than transitions, since an episode of k steps has k + 1 states. When
    /// episodes average fewer than 8 steps, the oldest transitions are dropped before the capacity is
    /// reached.
    #[must_use]
    pub fn new(config: &ReplayConfig, inputs: usize, pending: usize) -> Self {
        let capacity = config.capacity;
        let priorities = match config.sampling {
            Sampling::Uniform => None,
            Sampling::Prioritized { .. } => Some(Priorities { tree: SumTree::new(capacity), largest: 1.0 }),
        };
        Self {
            sampling: config.sampling,
            capacity,
            states: StateRing::new(inputs, capacity + capacity / 8 + pending + 2),
            transitions: Vec::new(),
            priorities,
            head: 0,
            tail: 0,
        }
    }

    /// Transitions kept.
    #[must_use]
    pub fn len(&self) -> usize {
        (self.tail - self.head) as usize
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.tail == self.head
    }

    /// The most transitions kept.
    #[must_use]
    pub fn capacity(&self) -> usize {
        self.capacity
    }

    /// Whether the state is still kept.
    #[must_use]
    pub fn holds(&self, id: StateId) -> bool {
        self.states.holds(id)
    }

    /// Stores an observation of `inputs` numbers. Transitions that refer to the one it replaces go first, and
    /// with them all older ones.
    pub fn push_state(&mut self, observation: &[f32]) -> StateId {
        let users = self.states.last_reference_to_oldest();
        while self.head < users {
            self.drop_oldest();
        }
        self.states.push(observation)
    }

    /// Stores a transition, with the largest priority so far; drops the oldest if full. A transition whose
    /// states are gone already (its arena stood still for more than a whole buffer) is not stored.
    pub fn push(&mut self, transition: &Transition) {
        let next = if transition.terminated { transition.state } else { transition.next };
        if !self.holds(transition.state) || !self.holds(next) {
            return;
        }
        if self.len() == self.capacity {
            self.drop_oldest();
        }
        let slots = [self.states.slot(transition.state), self.states.slot(next)];
        let stored = StoredTransition {
            state: slots[0] as u32,
            next: slots[1] as u32,
            reward: transition.reward,
            discount: transition.discount,
            action: transition.action,
            flags: u8::from(transition.terminated) | u8::from(transition.truncated) << 1,
        };
        let slot = self.slot(self.tail);
        if slot == self.transitions.len() {
            self.transitions.push(stored);
        } else {
            self.transitions[slot] = stored;
        }
        self.tail += 1;
        for slot in slots {
            self.states.last_reference[slot] = self.tail;
        }
        if let Some(Priorities { tree, largest }) = &mut self.priorities {
            tree.set(slot, *largest);
        }
    }

    fn drop_oldest(&mut self) {
        let slot = self.slot(self.head);
        self.head += 1;
        if let Some(priorities) = &mut self.priorities {
            priorities.tree.set(slot, 0.0);
        }
    }

    pub(super) fn slot(&self, number: u64) -> usize {
        (number % self.capacity as u64) as usize
    }

    /// Draws `n` transitions, with replacement, into `batch`. `env_steps` is for beta's schedule. The buffer
    /// must not be empty.
    ///
    /// Prioritized: the priorities laid end to end are cut into n equal pieces and a point drawn from each
    /// (stratified proportional sampling). The importance weights (N P(i))^-beta over the batch's largest are
    /// (smallest P in the batch / P(i))^beta: N and the sum cancel.
    pub fn sample(&self, n: usize, env_steps: u64, stream: &mut Stream, batch: &mut Batch) {
        batch.clear();
        match (&self.priorities, self.sampling) {
            (Some(Priorities { tree, .. }), Sampling::Prioritized { beta, importance_weights, .. }) => {
                let piece = tree.total() / n as f64;
                tree.find_all((0..n).map(|i| piece * (i as f64 + fine(stream))), &mut batch.slots);
                if importance_weights {
                    let beta = beta.at(env_steps);
                    let weight = |&slot: &usize| tree.get(slot);
                    let least = batch.slots.iter().map(weight).fold(f64::INFINITY, f64::min);
                    let weights = batch.slots.iter().map(|s| power((least / weight(s)) as f32, beta));
                    batch.weights.extend(weights);
                }
            }
            _ => {
                let len = self.len();
                batch.slots.extend((0..n).map(|_| self.slot(self.head + uniform_index(stream, len) as u64)));
            }
        }
        batch.weights.resize(n, 1.0);
        for &slot in &batch.slots {
            let StoredTransition { state, next, reward, discount, action, .. } = self.transitions[slot];
            batch.states.extend_from_slice(self.states.row(state as usize));
            batch.next_states.extend_from_slice(self.states.row(next as usize));
            batch.actions.push(action);
            batch.rewards.push(reward);
            batch.discounts.push(discount);
        }
    }

    /// Gives the transitions in `slots`, just sampled, the priority (|TD error| + epsilon)^alpha. Does
    /// nothing when sampling is uniform.
    pub fn update_priorities(&mut self, slots: &[usize], td_errors: &[f32]) {
        let Some(Priorities { tree, largest }) = &mut self.priorities else { return };
        let Sampling::Prioritized { alpha, epsilon, .. } = self.sampling else { return };
        for (&slot, error) in slots.iter().zip(td_errors) {
            let priority = f64::from(power(error.abs() + epsilon, alpha));
            *largest = largest.max(priority);
            tree.set(slot, priority);
        }
    }

    /// The weight p^alpha by which the transition in `slot` is drawn; 1 when sampling is uniform.
    #[must_use]
    pub fn priority(&self, slot: usize) -> f64 {
        self.priorities.as_ref().map_or(1.0, |priorities| priorities.tree.get(slot))
    }
}

impl Batch {
    fn clear(&mut self) {
        let Self { slots, states, actions, rewards, discounts, next_states, weights } = self;
        slots.clear();
        actions.clear();
        for values in [states, rewards, discounts, next_states, weights] {
            values.clear();
        }
    }
}

/// A draw from [0, 1) in steps of 2^-53: fine enough to reach every one of 10^6 transitions.
fn fine(stream: &mut Stream) -> f64 {
    (wayfield_random::random_u64(stream) >> 11) as f64 * (1.0 / (1_u64 << 53) as f64)
}

/// base^exponent for a base of at least 0 (0 counts as the least normal number) and a moderate exponent: some
/// units in the last place off, the same on every platform, and more than twice as fast as `libm::powf`.
fn power(base: f32, exponent: f32) -> f32 {
    libm::exp2f(exponent * libm::log2f(base.max(f32::MIN_POSITIVE)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_are_right_to_rounding() {
        for exponent in [0.0, 0.1, 0.4, 0.6, 1.0] {
            for base in [1e-30, 1e-6, 0.001, 0.3, 0.999, 1.0, 1.7, 42.0, 1e9] {
                let exact = f64::from(base).powf(f64::from(exponent));
                let error = (f64::from(power(base, exponent)) / exact - 1.0).abs();
                assert!(error < 1e-5, "{base}^{exponent}: off by {error}");
            }
            let least = power(f32::MIN_POSITIVE, exponent);
            assert_eq!(power(0.0, exponent), least, "0 counts as the least normal number");
            assert_eq!(power(1.0, exponent), 1.0);
        }
        assert!(power(0.0, 1.0) > 0.0, "no priority is 0, or it would never be drawn again");
    }
}
