//! The arrays of the replay buffer in a checkpoint: states, transitions, leaves of the sum tree.

use std::io::{self, Read, Write};

use super::CheckpointError;
use super::header::Header;
use crate::replay::{Priorities, ReplayBuffer, StoredTransition};

/// The size of a chunk that is read or written at once, in bytes.
const CHUNK_BYTES: usize = 1 << 16;
/// The size of a transition in the file, in bytes.
const TRANSITION_BYTES: usize = 18;

impl ReplayBuffer {
    /// Reads the arrays into this empty buffer.
    pub(super) fn read(
        &mut self,
        header: &Header,
        inputs: usize,
        actions: usize,
        file: &mut impl Read,
    ) -> Result<(), CheckpointError> {
        self.states.pushed = header.states;
        (self.head, self.tail) = (header.first_transition, header.transitions);
        self.read_states(inputs, file)?;
        let slots = self.tail.min(self.capacity() as u64) as usize;
        self.read_transitions(slots, actions, file)?;
        let mut leaves = Vec::new();
        read_array(file, slots, |bytes| leaves.push(f64::from_le_bytes(bytes)))?;
        self.check_leaves(&leaves)?;
        self.restore_last_references();
        if let Some(Priorities { tree, largest }) = &mut self.priorities {
            tree.set_all(leaves.into_iter());
            *largest = header.largest_priority;
        }
        Ok(())
    }

    fn read_states(&mut self, inputs: usize, file: &mut impl Read) -> Result<(), CheckpointError> {
        let count = self.states.used() * inputs;
        let mut values = self.states.values.iter_mut();
        read_array(file, count, |bytes| {
            if let Some(value) = values.next() {
                *value = f32::from_le_bytes(bytes);
            }
        })?;
        if !self.states.values[..count].iter().all(|value| value.is_finite()) {
            return Err(CheckpointError::Corrupt("an observation is not finite"));
        }
        Ok(())
    }

    fn read_transitions(
        &mut self,
        slots: usize,
        actions: usize,
        file: &mut impl Read,
    ) -> Result<(), CheckpointError> {
        read_array(file, slots, |bytes| self.transitions.push(StoredTransition::from_bytes(bytes)))?;
        let states = self.states.used();
        if !self.transitions.iter().all(|t| t.refers_to_existing(states, actions)) {
            return Err(CheckpointError::Corrupt("a transition refers to a missing state or action"));
        }
        if !self.transitions.iter().all(StoredTransition::is_valid) {
            return Err(CheckpointError::Corrupt("a transition's reward or discount is invalid"));
        }
        Ok(())
    }

    /// Checks that every stored transition has a valid priority. If sampling is prioritized, every removed one must have
    /// priority 0, so that it is never drawn.
    fn check_leaves(&self, leaves: &[f64]) -> Result<(), CheckpointError> {
        if !(self.head..self.tail).all(|number| is_priority(leaves[self.slot(number)])) {
            return Err(CheckpointError::Corrupt("a priority is invalid"));
        }
        let mut removed = (self.tail - leaves.len() as u64..self.head).map(|number| self.slot(number));
        if self.priorities.is_some() && removed.any(|slot| leaves[slot] != 0.0) {
            return Err(CheckpointError::Corrupt("a removed transition has a priority"));
        }
        Ok(())
    }

    /// Recomputes the last reference to each state from the stored transitions.
    fn restore_last_references(&mut self) {
        for number in self.head..self.tail {
            let StoredTransition { state, next, .. } = self.transitions[self.slot(number)];
            for state in [state, next] {
                self.states.last_reference[state as usize] = number + 1;
            }
        }
    }
}

/// Whether `priority` is positive and small enough that sums of priorities stay finite.
pub(super) fn is_priority(priority: f64) -> bool {
    priority > 0.0 && priority <= f64::from(f32::MAX)
}

impl StoredTransition {
    /// Whether [`ReplayBuffer::push`] could have stored these values.
    fn is_valid(&self) -> bool {
        self.reward.is_finite() && (0.0..=1.0).contains(&self.discount) && self.flags < 4
    }

    /// Whether its states and its action exist.
    fn refers_to_existing(&self, states: usize, actions: usize) -> bool {
        (self.state.max(self.next) as usize) < states && usize::from(self.action) < actions
    }

    pub(super) fn to_bytes(self) -> [u8; TRANSITION_BYTES] {
        let mut bytes = [0; TRANSITION_BYTES];
        bytes[0..4].copy_from_slice(&self.state.to_le_bytes());
        bytes[4..8].copy_from_slice(&self.next.to_le_bytes());
        bytes[8..12].copy_from_slice(&self.reward.to_le_bytes());
        bytes[12..16].copy_from_slice(&self.discount.to_le_bytes());
        bytes[16] = self.action;
        bytes[17] = self.flags;
        bytes
    }

    fn from_bytes(bytes: [u8; TRANSITION_BYTES]) -> Self {
        let four = |at: usize| [bytes[at], bytes[at + 1], bytes[at + 2], bytes[at + 3]];
        Self {
            state: u32::from_le_bytes(four(0)),
            next: u32::from_le_bytes(four(4)),
            reward: f32::from_le_bytes(four(8)),
            discount: f32::from_le_bytes(four(12)),
            action: bytes[16],
            flags: bytes[17],
        }
    }
}

/// Writes elements of `N` bytes in large chunks, so that an unbuffered writer is fast too.
pub(super) fn write_array<const N: usize>(
    out: &mut impl Write,
    elements: impl Iterator<Item = [u8; N]>,
) -> io::Result<()> {
    let mut chunk = Vec::with_capacity(CHUNK_BYTES + N);
    for element in elements {
        chunk.extend_from_slice(&element);
        if chunk.len() >= CHUNK_BYTES {
            out.write_all(&chunk)?;
            chunk.clear();
        }
    }
    out.write_all(&chunk)
}

/// Reads `count` elements of `N` bytes in large chunks.
fn read_array<const N: usize>(
    file: &mut impl Read,
    count: usize,
    mut each: impl FnMut([u8; N]),
) -> io::Result<()> {
    let mut chunk = vec![0; CHUNK_BYTES / N * N];
    let mut left = count * N;
    while left > 0 {
        let bytes = left.min(chunk.len());
        file.read_exact(&mut chunk[..bytes])?;
        chunk[..bytes].as_chunks().0.iter().for_each(|&element| each(element));
        left -= bytes;
    }
    Ok(())
}
