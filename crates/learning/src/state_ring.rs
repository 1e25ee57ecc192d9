//! The state ring: every observation once, found again by an id.
//!
//! In: observations in the order they are seen. Out: ids, and the observations behind those still kept.
//! Successive transitions share a state (one's next is the other's first), so this halves a replay buffer's
//! memory.

use serde::{Deserialize, Serialize};

/// The running number of a stored observation; never used twice.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct StateId(pub(super) u64);

/// A ring of observations of equal length.
#[derive(Debug, Clone)]
pub(super) struct StateRing {
    /// Row-major, capacity x inputs. Zeroed memory that the operating system hands out as it is touched.
    pub(super) values: Vec<f32>,
    /// Per slot: 1 + the number of the last transition that refers to it.
    pub(super) last_reference: Vec<u64>,
    inputs: usize,
    capacity: usize,
    /// Observations ever stored.
    pub(super) pushed: u64,
}

impl StateRing {
    pub(super) fn new(inputs: usize, capacity: usize) -> Self {
        let values = vec![0.0; inputs * capacity];
        Self { values, last_reference: vec![0; capacity], inputs, capacity, pushed: 0 }
    }

    /// Whether the observation has not been overwritten.
    pub(super) fn holds(&self, id: StateId) -> bool {
        id.0 < self.pushed && self.pushed - id.0 <= self.capacity as u64
    }

    pub(super) fn slot(&self, id: StateId) -> usize {
        (id.0 % self.capacity as u64) as usize
    }

    /// How many slots hold something.
    pub(super) fn used(&self) -> usize {
        self.pushed.min(self.capacity as u64) as usize
    }

    pub(super) fn row(&self, slot: usize) -> &[f32] {
        &self.values[slot * self.inputs..][..self.inputs]
    }

    /// The number up to which transitions refer to the observation that the next `push` overwrites.
    pub(super) fn last_reference_to_oldest(&self) -> u64 {
        self.last_reference[self.slot(StateId(self.pushed))]
    }

    /// Stores an observation over the oldest.
    pub(super) fn push(&mut self, observation: &[f32]) -> StateId {
        let id = StateId(self.pushed);
        let slot = self.slot(id);
        self.values[slot * self.inputs..][..self.inputs].copy_from_slice(observation);
        self.last_reference[slot] = 0;
        self.pushed += 1;
        id
    }
}
