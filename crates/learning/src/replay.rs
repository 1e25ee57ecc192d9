//! The replay buffer: a ring of transitions, a ring of states, and sampling.
//!
//! In: observations and transitions; after a gradient step, TD errors. Out: batches with importance weights, sampled
//! uniformly or in proportion to priority (Schaul et al. 2016). The oldest transitions are removed first.
//!
//! Memory for 1,000,000 transitions with observations of 28 values: 126 MB for states (each is stored once), 9 MB for the last
//! reference to each state, 20 MB for transitions, 17 MB for the sum tree. Together 172 MB when full; an empty buffer
//! takes almost no memory.

use super::config::{ReplayConfig, Sampling};
pub use super::n_step::Transition;
pub use super::state_ring::StateId;
use super::state_ring::StateRing;
use super::sum_tree::SumTree;
use wayfield_random::{Stream, uniform_f64, uniform_index};

/// A transition as it is stored. `state` and `next` are slots of the state ring.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub(crate) struct StoredTransition {
    pub(crate) state: u32,
    pub(crate) next: u32,
    pub(crate) reward: f32,
    pub(crate) discount: f32,
    pub(crate) action: u8,
    /// Bit 0: terminated; bit 1: truncated.
    pub(crate) flags: u8,
}

/// The priorities of prioritized sampling.
#[derive(Debug, Clone)]
pub(crate) struct Priorities {
    /// p^alpha of each transition slot; 0 for a slot without a transition.
    pub(crate) tree: SumTree,
    /// The largest p^alpha so far, initially 1. New transitions start with it.
    pub(crate) largest: f64,
}

/// A ring buffer of the newest transitions.
#[derive(Debug, Clone)]
pub struct ReplayBuffer {
    sampling: Sampling,
    capacity: usize,
    /// Transitions may begin at the newest states, this many. A transition from an older one would soon be removed, with all older
    /// transitions.
    recent_states: u64,
    pub(crate) states: StateRing,
    pub(crate) transitions: Vec<StoredTransition>,
    pub(crate) priorities: Option<Priorities>,
    /// The sequence number of the oldest transition in the buffer. Modulo the capacity, it is the transition's slot.
    pub(crate) head: u64,
    /// The number of transitions ever stored: the sequence number of the next one.
    pub(crate) tail: u64,
}

/// A batch of n transitions.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Batch {
    /// Their slots in the buffer, for [`ReplayBuffer::update_priorities`].
    pub slots: Vec<usize>,
    /// The states, row-major, n x inputs.
    pub states: Vec<f32>,
    /// The indices of the actions taken.
    pub actions: Vec<u8>,
    /// The returns R, each over the m steps of its transition.
    pub returns: Vec<f32>,
    /// The factors of Q(next): gamma^m, or 0 if terminated.
    pub discounts: Vec<f32>,
    /// The next states, row-major, n x inputs; meaningless where the discount is 0.
    pub next_states: Vec<f32>,
    /// The importance weights, 0 to 1; the largest is 1.
    pub weights: Vec<f32>,
}

impl ReplayBuffer {
    /// An empty buffer for observations of `inputs` values. `pending` is the maximum number of steps that wait for their
    /// n-step return at the same time.
    ///
    /// The state ring is 1/8 larger than the transition ring, because an episode of k steps has up to k + 1 states. If episodes
    /// have fewer than 8 steps on average, the oldest transitions may be removed before the capacity is reached.
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
            // Environments that all go on at the same pace never begin at a state older than twice the pending steps.
            recent_states: (capacity / 2).max(2 * pending) as u64,
            states: StateRing::new(inputs, capacity + capacity / 8 + pending + 2),
            transitions: Vec::new(),
            priorities,
            head: 0,
            tail: 0,
        }
    }

    /// The number of transitions in the buffer.
    #[must_use]
    pub fn len(&self) -> usize {
        (self.tail - self.head) as usize
    }

    /// Whether the buffer has no transitions.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.tail == self.head
    }

    /// The maximum number of transitions.
    #[must_use]
    pub fn capacity(&self) -> usize {
        self.capacity
    }

    /// Whether the state is still in the buffer.
    #[must_use]
    pub fn contains_state(&self, id: StateId) -> bool {
        self.states.contains(id)
    }

    /// Whether a transition may begin at the state and end at the one that is stored next: the state is in the buffer, and is not so
    /// old that it will soon be overwritten.
    #[must_use]
    pub fn can_begin_at(&self, id: StateId) -> bool {
        self.age(id) < self.recent_states && self.contains_state(id)
    }

    /// The number of states that have been stored since, this one included.
    fn age(&self, id: StateId) -> u64 {
        self.states.pushed - id.0
    }

    /// Stores an observation of `inputs` values. If the state ring is full, the oldest observation is overwritten; the
    /// transitions that refer to it are removed first, with all older transitions.
    pub fn push_state(&mut self, observation: &[f32]) -> StateId {
        let last_reference = self.states.last_reference_to_oldest();
        while self.head < last_reference {
            self.remove_oldest();
        }
        self.states.push(observation)
    }

    /// Stores a transition, and gives it the largest priority so far. A full buffer removes its oldest transition. A
    /// transition from an old state (because its environment paused while others filled the buffer) is not stored.
    pub fn push(&mut self, transition: &Transition) {
        let next = if transition.terminated { transition.state } else { transition.next };
        let is_old = self.age(transition.state) > self.recent_states;
        if is_old || !self.contains_state(transition.state) || !self.contains_state(next) {
            return;
        }
        if self.len() == self.capacity {
            self.remove_oldest();
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

    fn remove_oldest(&mut self) {
        let slot = self.slot(self.head);
        self.head += 1;
        if let Some(priorities) = &mut self.priorities {
            priorities.tree.set(slot, 0.0);
        }
    }

    pub(crate) fn slot(&self, sequence_number: u64) -> usize {
        (sequence_number % self.capacity as u64) as usize
    }

    /// Samples `n` transitions with replacement into `batch`. `env_steps` determines beta by its schedule.
    ///
    /// Prioritized sampling is stratified: the priorities are laid end to end and cut into n equal segments, and one point
    /// is drawn from each. The importance weights are (N P(i))^-beta, divided by the largest in the batch; that is,
    /// (smallest P in the batch / P(i))^beta.
    ///
    /// # Panics
    /// If the buffer is empty.
    pub fn sample(&self, n: usize, env_steps: u64, stream: &mut Stream, batch: &mut Batch) {
        batch.clear();
        match (&self.priorities, self.sampling) {
            (Some(Priorities { tree, .. }), Sampling::Prioritized { beta, importance_weights, .. }) => {
                let segment = tree.total() / n as f64;
                tree.find_all((0..n).map(|i| segment * (i as f64 + uniform_f64(stream))), &mut batch.slots);
                if importance_weights {
                    let beta = beta.at(env_steps);
                    let priority = |&slot: &usize| tree.get(slot);
                    let smallest = batch.slots.iter().map(priority).fold(f64::INFINITY, f64::min);
                    let weights = batch.slots.iter().map(|s| power((smallest / priority(s)) as f32, beta));
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
            batch.returns.push(reward);
            batch.discounts.push(discount);
        }
    }

    /// Sets the priorities of the sampled transitions in `slots` to (|TD error| + epsilon)^alpha. Does nothing if sampling is
    /// uniform.
    pub fn update_priorities(&mut self, slots: &[usize], td_errors: &[f32]) {
        let Some(Priorities { tree, largest }) = &mut self.priorities else { return };
        let Sampling::Prioritized { alpha, epsilon, .. } = self.sampling else { return };
        for (&slot, error) in slots.iter().zip(td_errors) {
            let priority = f64::from(power(error.abs() + epsilon, alpha));
            *largest = largest.max(priority);
            tree.set(slot, priority);
        }
    }

    /// The priority p^alpha of the transition in `slot`; 1 if sampling is uniform.
    #[must_use]
    pub fn priority(&self, slot: usize) -> f64 {
        self.priorities.as_ref().map_or(1.0, |priorities| priorities.tree.get(slot))
    }
}

impl Batch {
    fn clear(&mut self) {
        let Self { slots, states, actions, returns, discounts, next_states, weights } = self;
        slots.clear();
        actions.clear();
        for values in [states, returns, discounts, next_states, weights] {
            values.clear();
        }
    }
}

/// base^exponent for a base of at least 0 and a moderate exponent. A base of 0 is replaced by the smallest normal number.
/// The result has a relative error of less than 1e-5 for exponents up to 1, is the same on every platform, and takes less
/// than half the time of `libm::powf`.
fn power(base: f32, exponent: f32) -> f32 {
    libm::exp2f(exponent * libm::log2f(base.max(f32::MIN_POSITIVE)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_have_a_small_relative_error() {
        for exponent in [0.0, 0.1, 0.4, 0.6, 1.0] {
            for base in [1e-30, 1e-6, 0.001, 0.3, 0.999, 1.0, 1.7, 42.0, 1e9] {
                let exact = f64::from(base).powf(f64::from(exponent));
                let error = (f64::from(power(base, exponent)) / exact - 1.0).abs();
                assert!(error < 1e-5, "{base}^{exponent}: off by {error}");
            }
            let smallest = power(f32::MIN_POSITIVE, exponent);
            assert_eq!(power(0.0, exponent), smallest, "0 counts as the smallest normal number");
            assert_eq!(power(1.0, exponent), 1.0);
        }
        assert!(power(0.0, 1.0) > 0.0, "a transition with priority 0 would never be drawn");
    }
}
