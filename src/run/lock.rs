//! The lock on a folder that a process writes in: two that wrote there at once would spoil each other's files.
//!
//! In: a folder. Out: a [`Lock`] while it is ours, or that somebody else has it. The system gives it back when the process
//! ends, however that happens; the file itself is empty, stays, and means nothing.

use std::fs::{File, OpenOptions, TryLockError};
use std::path::Path;

use super::RunError;

/// A folder is ours as long as this lives.
#[derive(Debug)]
pub struct Lock(#[expect(dead_code, reason = "it is held, not read")] File);

impl Lock {
    /// Locks `folder` by `file`, which is made if it is not there.
    ///
    /// # Errors
    /// Another process has it, or the file cannot be made.
    pub fn acquire(folder: &Path, file: &Path) -> Result<Self, RunError> {
        let lock =
            OpenOptions::new().create(true).truncate(false).write(true).open(file).map_err(|error| {
                RunError::invalid_input(
                    folder,
                    format!("can't be written ({error}): give --out another folder"),
                )
            })?;
        match lock.try_lock() {
            // A file system without locks: better unlocked than not at all.
            Ok(()) | Err(TryLockError::Error(_)) => Ok(Self(lock)),
            Err(TryLockError::WouldBlock) => {
                let why =
                    "another wayfield is at work in it: wait until that has ended, or use another folder";
                Err(RunError::invalid_input(folder, why))
            }
        }
    }
}
