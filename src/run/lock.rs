//! A lock on an output folder or a backup of the editor: only one process at a time may write there.
//!
//! It is an advisory lock on an empty file. The operating system releases it when the process exits or crashes. The file
//! remains; only the lock on it matters. On a file system without locks, nothing is locked.

use std::fs::{File, OpenOptions, TryLockError};
use std::path::Path;

use super::RunError;
use super::folder::folder_not_writable;

/// A held lock, released on drop.
#[derive(Debug)]
pub struct Lock(#[expect(dead_code, reason = "it is held, not read")] File);

impl Lock {
    /// Locks `folder` with the lock file `file`, which is created if it does not exist.
    ///
    /// # Errors
    /// Another process holds the lock, or the file cannot be created.
    pub fn acquire(folder: &Path, file: &Path) -> Result<Self, RunError> {
        Self::open(folder, file, File::try_lock)
    }

    /// Like [`acquire`](Self::acquire), but other processes can share the lock.
    ///
    /// # Errors
    /// Another process holds the lock exclusively, or the file cannot be created.
    pub fn share(folder: &Path, file: &Path) -> Result<Self, RunError> {
        Self::open(folder, file, File::try_lock_shared)
    }

    fn open(
        folder: &Path,
        file: &Path,
        try_lock: impl Fn(&File) -> Result<(), TryLockError>,
    ) -> Result<Self, RunError> {
        let mut options = OpenOptions::new();
        let file = options.create(true).truncate(false).write(true).open(file);
        let file = file.map_err(|error| folder_not_writable(folder, &error))?;
        match try_lock(&file) {
            // On a file system without locks, an unlocked folder is better than no run.
            Ok(()) | Err(TryLockError::Error(_)) => Ok(Self(file)),
            Err(TryLockError::WouldBlock) => {
                let why = "another wayfield process is writing in it; help: wait until that ends, or use another folder";
                Err(RunError::invalid_input(folder, why))
            }
        }
    }
}
