//! The editor's backups in a browser: the page stores them, lists those that no other tab uses, and deletes old ones.

use std::path::Path;

use serde::Deserialize;

use super::Backup;
use crate::app::page;
use crate::run::RunError;

/// The backup of this tab.
pub(super) struct Store;

impl Store {
    /// A store without a backup.
    pub(super) fn new(_: &Path) -> Self {
        Self
    }

    /// A store that takes over the backup of an earlier visit.
    ///
    /// # Errors
    /// Never; only the store on disk can fail.
    pub(super) fn of(found: FoundBackup) -> Result<Self, RunError> {
        page::adopt_backup(&found.key);
        Ok(Self)
    }

    /// Replaces the backup.
    ///
    /// # Errors
    /// The browser does not store it.
    pub(super) fn write(&mut self, text: &str) -> Result<(), RunError> {
        page::store_backup(text).map_or(Ok(()), |error| Err(RunError::Failed(error)))
    }

    /// Deletes the backup.
    pub(super) fn delete(&mut self) {
        page::delete_backup();
    }
}

/// A backup of an earlier visit.
pub(super) struct FoundBackup {
    pub(super) backup: Backup,
    key: String,
    age_s: u64,
}

impl FoundBackup {
    /// Age in s, at the start of this visit.
    pub(super) fn age_s(&self) -> u64 {
        self.age_s
    }
}

/// The newest backup that can be read, if there is one.
pub(super) fn find(_: &Path) -> Option<FoundBackup> {
    #[derive(Deserialize)]
    struct Entry {
        key: String,
        text: String,
        age_s: u64,
    }
    let entries: Vec<Entry> = serde_json::from_str(&page::last_backups()).ok()?;
    entries.into_iter().find_map(|Entry { key, text, age_s }| {
        Some(FoundBackup { backup: Backup::parse(&text, Path::new("backup"))?, key, age_s })
    })
}
