//! The slot of a training run in a browser: its autosave in the browser's database, through the page.
//!
//! In: copies of the training run. Out: files that the page stores. The page reports the result later
//! (`browser_sessions.rs`).

use std::path::Path;

use super::sessions;
use crate::app::page;
use crate::app::session::run_snapshot::RunSnapshot;
use crate::run::RunError;
use crate::run::folder::{INITIAL_POLICY_FILE, RunFolder};
use crate::scenario::to_ron;

/// The autosave of a training run.
pub(super) struct Slot;

impl Slot {
    /// A slot without an autosave. The page keeps the autosave of the previous training run.
    pub(super) fn new(_: &Path) -> Self {
        page::begin_autosave();
        Self
    }

    /// The slot of the session that the page has offered.
    pub(super) fn of_last_session() -> Self {
        page::adopt_last_session();
        Self
    }

    /// `None`: a page has no paths.
    pub(super) fn path(&self) -> Option<&Path> {
        None
    }

    /// 0: every copy of the training run must be complete.
    pub(super) fn known_bytes(&self) -> u64 {
        0
    }

    /// Passes the files to the page, which replaces the autosave.
    ///
    /// # Errors
    /// A file cannot be encoded.
    pub(super) fn replace(&mut self, snapshot: &RunSnapshot) -> Result<(), RunError> {
        let failed = |error: &dyn std::fmt::Display| RunError::Failed(error.to_string());
        let config = to_ron(&snapshot.config).map_err(|error| failed(&error))?;
        page::autosave_file(RunFolder::CONFIG_FILE, config.as_bytes());
        if let Some(policy) = &snapshot.initial_policy {
            page::autosave_file(INITIAL_POLICY_FILE, policy);
        }
        snapshot.each_file(|name, write| {
            let mut bytes = Vec::new();
            write(&mut bytes).map_err(|error| failed(&error))?;
            page::autosave_file(name, &bytes);
            Ok(())
        })?;
        let note = serde_json::to_string(&snapshot.describe()).map_err(|error| failed(&error))?;
        page::autosave(sessions::next_number(), &note);
        Ok(())
    }

    /// Deletes the autosave.
    pub(super) fn delete(&mut self) {
        page::delete_autosave();
    }
}
