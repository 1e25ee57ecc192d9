//! The files of the editor's backups: `1.ron`, `2.ron`, ... in one folder, each locked by the process that writes it.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use super::{Backup, MAX_BACKUP_BYTES};
use crate::app::session::autosave::retention::keep_newest;
use crate::run::RunError;
use crate::run::lock::Lock;
use crate::run::output_file::write_atomic;
use crate::scenario::read_text_with_limit;

/// The maximum number of backups.
const MAX_BACKUPS: usize = 1000;

/// The backup of this process.
pub(super) struct Store {
    folder: PathBuf,
    /// Its file, once there is one.
    file: Option<LockedFile>,
}

struct LockedFile {
    path: PathBuf,
    _lock: Lock,
}

impl LockedFile {
    fn lock(path: PathBuf) -> Result<Self, RunError> {
        // The lock's own messages are about an output folder.
        let in_use =
            |_| RunError::failed(&path, "another wayfield process uses this backup, or it can't be locked");
        Ok(Self { _lock: Lock::acquire(&path, &lock_path(&path)).map_err(in_use)?, path })
    }
}

fn lock_path(path: &Path) -> PathBuf {
    path.with_extension("lock")
}

impl Store {
    /// A store without a backup yet.
    pub(super) fn new(folder: &Path) -> Self {
        Self { folder: folder.into(), file: None }
    }

    /// A store that takes over the backup of an earlier session.
    ///
    /// # Errors
    /// Another process uses it.
    pub(super) fn of(found: FoundBackup) -> Result<Self, RunError> {
        let folder = found.path.parent().unwrap_or(&found.path).into();
        Ok(Self { folder, file: Some(LockedFile::lock(found.path)?) })
    }

    /// The file, if there is one.
    pub(super) fn path(&self) -> Option<PathBuf> {
        self.file.as_ref().map(|file| file.path.clone())
    }

    /// Replaces the backup.
    ///
    /// # Errors
    /// No file can be locked, or the file cannot be written; an earlier backup stays.
    pub(super) fn write(&mut self, text: &str) -> Result<(), RunError> {
        let file = match self.file.take() {
            Some(file) => file,
            None => self.lock_unused()?,
        };
        let file = self.file.insert(file);
        write_atomic(&file.path, |out| out.write_all(text.as_bytes()))
            .map_err(|error| RunError::failed(&file.path, error.to_string()))
    }

    fn lock_unused(&self) -> Result<LockedFile, RunError> {
        fs::create_dir_all(&self.folder)
            .map_err(|error| RunError::failed(&self.folder, error.to_string()))?;
        let numbered = (1..=MAX_BACKUPS).map(|number| self.folder.join(format!("{number}.ron")));
        let unused = numbered.filter(|path| !path.exists()).find_map(|path| LockedFile::lock(path).ok());
        unused.ok_or_else(|| RunError::failed(&self.folder, "no file can be locked there"))
    }

    /// Deletes the backup.
    pub(super) fn delete(&mut self) {
        if let Some(file) = self.file.take() {
            delete(&file.path);
        }
    }
}

/// Deletes a backup. One that cannot be deleted is offered at the next start, which does no harm. The lock file stays, because
/// another process may lock it at any moment.
fn delete(path: &Path) {
    let _ = fs::remove_file(path);
}

/// A backup of an earlier session.
pub(super) struct FoundBackup {
    pub(super) backup: Backup,
    path: PathBuf,
    written: SystemTime,
}

impl FoundBackup {
    /// Age in s.
    pub(super) fn age_s(&self) -> u64 {
        self.written.elapsed().unwrap_or_default().as_secs()
    }
}

/// The newest backup in `folder` that no process is using. Of the others, [`keep_newest`] keeps a few and deletes the rest.
pub(super) fn find(folder: &Path) -> Option<FoundBackup> {
    let entries = fs::read_dir(folder).into_iter().flatten().flatten().take(2 * MAX_BACKUPS);
    let read = |path: PathBuf| {
        let text = read_text_with_limit(&path, MAX_BACKUP_BYTES).ok()?;
        let written = fs::metadata(&path).and_then(|data| data.modified()).ok()?;
        Some(FoundBackup { backup: Backup::parse(&text, &path)?, path, written })
    };
    let mut found: Vec<FoundBackup> = entries
        .map(|entry| entry.path())
        .filter(|path| path.extension().is_some_and(|extension| extension == "ron"))
        .filter(|path| Lock::acquire(path, &lock_path(path)).is_ok())
        .filter_map(read)
        .collect();
    keep_newest(&mut found, |backup| backup.written, |backup| delete(&backup.path));
    found.into_iter().next()
}
