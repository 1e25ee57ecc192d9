//! An autosave that is being written in the background.

use bevy::tasks::{IoTaskPool, Task, block_on, poll_once};

use super::slot::Slot;
use crate::app::session::run_snapshot::RunSnapshot;
use crate::run::RunError;

/// The slot, and whether the autosave was written.
pub(super) type Written = (Slot, Result<(), RunError>);

/// An autosave that is being written.
pub(super) struct Writing(Task<Written>);

impl Writing {
    /// Begins to write `snapshot` to `slot`.
    pub(super) fn start(mut slot: Slot, snapshot: RunSnapshot) -> Self {
        Self(IoTaskPool::get().spawn(async move {
            let written = slot.replace(&snapshot);
            (slot, written)
        }))
    }

    /// The slot and the result, or `self` if the autosave is not written yet; with `wait`, waits until it is.
    pub(super) fn poll(mut self, wait: bool) -> Result<Written, Self> {
        if wait {
            return Ok(block_on(self.0));
        }
        block_on(poll_once(&mut self.0)).ok_or(self)
    }
}
