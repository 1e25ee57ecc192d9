//! What the session had saved and opened in the last frame.

use std::sync::Arc;

use crate::scenario::Scenario;

/// The last scenario that the session saved, and the serial number of the last one it opened.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct SessionState {
    saved: Option<(String, Arc<Scenario>)>,
    draft: Option<u64>,
}

impl SessionState {
    pub fn new(saved: Option<(String, Arc<Scenario>)>, draft: Option<u64>) -> Self {
        Self { saved, draft }
    }

    /// Whether the session had saved `scenario` to `path`.
    pub fn has_saved(&self, path: &str, scenario: &Arc<Scenario>) -> bool {
        self.saved.as_ref().is_some_and(|(before, old)| before == path && Arc::ptr_eq(old, scenario))
    }

    /// Whether the session had opened the scenario with this serial number.
    pub fn has_opened(&self, serial: u64) -> bool {
        self.draft == Some(serial)
    }
}
