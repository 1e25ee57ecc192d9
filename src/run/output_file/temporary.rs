//! Temporary files: files under a provisional name, until they are complete.

use std::fs::{self, DirEntry};
use std::path::Path;

/// The prefix of the names of temporary files.
pub(super) const PREFIX: &str = ".writing-";

/// Whether `entry` is a temporary file.
#[must_use]
pub fn is_temporary(entry: &DirEntry) -> bool {
    entry.file_name().to_string_lossy().starts_with(PREFIX)
}

/// Deletes the temporary files that a killed process left in `folder`, which the caller has locked.
pub fn remove_temporary_files(folder: &Path) {
    for entry in fs::read_dir(folder).into_iter().flatten().flatten().filter(is_temporary) {
        // A file that cannot be deleted does no harm.
        let _ = fs::remove_file(entry.path());
    }
}
