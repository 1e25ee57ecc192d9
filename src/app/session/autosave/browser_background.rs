//! An autosave that the page is storing.

use super::sessions;
use super::slot::Slot;
use crate::app::session::run_snapshot::RunSnapshot;
use crate::run::RunError;

/// The slot (the place where this session's autosave is kept), and whether the autosave was stored.
pub(super) type Written = (Slot, Result<(), RunError>);

/// An autosave that is being stored.
pub(super) struct Writing {
    slot: Slot,
    /// The reason why it could not even be passed to the page.
    failed: Option<RunError>,
}

impl Writing {
    /// Passes `snapshot` to the page.
    pub(super) fn start(mut slot: Slot, snapshot: RunSnapshot) -> Self {
        let failed = slot.replace(&snapshot).err();
        Self { slot, failed }
    }

    /// The slot and the result, or `self` if the page has not stored the autosave yet. Natively, `wait` makes the caller wait for
    /// the result. In a browser nothing can wait, so with `wait` success is assumed.
    pub(super) fn poll(self, wait: bool) -> Result<Written, Self> {
        let Self { slot, failed } = self;
        match failed.map(Err).or_else(sessions::take_stored).or(wait.then_some(Ok(()))) {
            Some(stored) => Ok((slot, stored)),
            None => Err(Self { slot, failed: None }),
        }
    }
}
