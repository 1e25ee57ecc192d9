//! A ring buffer of observations.
//!
//! In: observations in the order of the env steps. Out: an id for each; by id, the observations that have not been
//! overwritten. Successive transitions share an observation, so storing each once halves the replay buffer's memory.

use serde::{Deserialize, Serialize};

/// The id of a stored observation: a sequence number, never reused.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
pub struct StateId(pub(crate) u64);

/// Observations of equal length.
#[derive(Debug, Clone)]
pub(crate) struct StateRing {
    /// Row-major, capacity x inputs. The zeroed memory takes no space until it is first written.
    pub(crate) values: Vec<f32>,
    /// Per slot: 1 + the sequence number of the last transition that refers to it; 0 if no transition does.
    pub(crate) last_reference: Vec<u64>,
    inputs: usize,
    capacity: usize,
    /// The number of observations ever stored.
    pub(crate) pushed: u64,
}

impl StateRing {
    pub(crate) fn new(inputs: usize, capacity: usize) -> Self {
        let values = vec![0.0; inputs * capacity];
        Self { values, last_reference: vec![0; capacity], inputs, capacity, pushed: 0 }
    }

    /// Whether the observation has been stored and not yet been overwritten.
    pub(crate) fn contains(&self, id: StateId) -> bool {
        id.0 < self.pushed && self.pushed - id.0 <= self.capacity as u64
    }

    pub(crate) fn slot(&self, id: StateId) -> usize {
        (id.0 % self.capacity as u64) as usize
    }

    /// The number of slots in use.
    pub(crate) fn used(&self) -> usize {
        self.pushed.min(self.capacity as u64) as usize
    }

    pub(crate) fn row(&self, slot: usize) -> &[f32] {
        &self.values[slot * self.inputs..][..self.inputs]
    }

    /// The `last_reference` of the slot that the next `push` writes.
    pub(crate) fn last_reference_to_oldest(&self) -> u64 {
        self.last_reference[self.slot(StateId(self.pushed))]
    }

    /// Stores an observation. If the ring is full, it overwrites the oldest one.
    pub(crate) fn push(&mut self, observation: &[f32]) -> StateId {
        let id = StateId(self.pushed);
        let slot = self.slot(id);
        self.values[slot * self.inputs..][..self.inputs].copy_from_slice(observation);
        self.last_reference[slot] = 0;
        self.pushed += 1;
        id
    }
}
