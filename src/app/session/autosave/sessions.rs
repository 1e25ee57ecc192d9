//! Autosaves of earlier sessions.
//!
//! In: the folder of all autosaves. Out: the newest ones that no running process uses. Older ones are deleted, and so
//! are abandoned unfinished ones.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

use super::retention::keep_newest;
use crate::app::app_status::LastSession;
use crate::app::session::run_snapshot::RunSnapshot;
use crate::run::folder::RunFolder;
use crate::run::lock::Lock;
use crate::scenario::read_ron;

/// The file with the metadata of an autosave. Other run folders do not have it.
pub(super) const METADATA_FILE: &str = "autosave.ron";

/// The prefix of the names of folders in which an autosave is being written or deleted.
pub(super) const TEMPORARY: &str = ".saving-";

/// Maximum number of folder entries that are read.
const MAX_ENTRIES: usize = 1000;

/// An autosave of this age that is unfinished, or not completely deleted, was left by a process that was killed.
const ABANDONED_AFTER: Duration = Duration::from_secs(600);

/// The metadata of an autosave.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct AutosaveMetadata {
    /// The scenario's name.
    scenario: String,
    /// The preset's title.
    preset: String,
    seed: u64,
    env_steps: u64,
    /// When it was saved, in s since 1970.
    saved_unix_s: u64,
}

impl AutosaveMetadata {
    /// The metadata of an autosave that is written now.
    pub(super) fn new(snapshot: &RunSnapshot) -> Self {
        let LastSession { scenario, preset, seed, env_steps, .. } = snapshot.describe();
        Self { scenario, preset, seed, env_steps, saved_unix_s: now_unix_s() }
    }
}

fn now_unix_s() -> u64 {
    SystemTime::now().duration_since(UNIX_EPOCH).unwrap_or_default().as_secs()
}

/// An autosave of an earlier session.
#[derive(Clone, Debug)]
pub(super) struct FoundSession {
    pub(super) path: PathBuf,
    metadata: AutosaveMetadata,
    /// Modification time of the metadata file, more precise than `saved_unix_s`; `None` if the file system has none.
    written: Option<SystemTime>,
}

impl FoundSession {
    /// The autosave at `path`; `None` if it has no readable metadata.
    fn read(path: PathBuf) -> Option<Self> {
        let file = path.join(METADATA_FILE);
        let written = fs::metadata(&file).and_then(|data| data.modified()).ok();
        Some(Self { metadata: read_ron(file).ok()?, path, written })
    }

    /// A key that orders sessions by the time of their autosave. No two sessions have the same.
    fn order(&self) -> (u64, Option<SystemTime>, PathBuf) {
        (self.metadata.saved_unix_s, self.written, self.path.clone())
    }

    /// The session as plain data to show.
    pub(super) fn describe(&self) -> LastSession {
        let AutosaveMetadata { scenario, preset, seed, env_steps, saved_unix_s } = self.metadata.clone();
        LastSession { scenario, preset, seed, env_steps, age_s: now_unix_s().saturating_sub(saved_unix_s) }
    }
}

/// The newest autosaves in `root` that no process is using, newest first. Deletes older ones, and those that killed processes
/// left unfinished.
pub(super) fn find(root: &Path) -> Vec<FoundSession> {
    let entries = fs::read_dir(root).into_iter().flatten().flatten().take(MAX_ENTRIES);
    let (unfinished, saved): (Vec<_>, Vec<_>) =
        entries.map(|entry| entry.path()).partition(|path| is_temporary(path));
    delete_abandoned(&unfinished);
    let mut found: Vec<FoundSession> = saved
        .into_iter()
        .filter(|path| path.join(RunFolder::CONFIG_FILE).exists())
        .filter_map(FoundSession::read)
        .filter(|session| is_unused(&session.path))
        .collect();
    // One that cannot be deleted does no harm.
    let delete = |session: FoundSession| drop(delete_autosave(&session.path));
    keep_newest(&mut found, FoundSession::order, delete);
    found
}

fn is_temporary(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(TEMPORARY))
}

/// Whether no process has locked the run folder at `path`.
fn is_unused(path: &Path) -> bool {
    Lock::acquire(path, &path.join(RunFolder::LOCK_FILE)).is_ok()
}

/// Deletes the autosave at `path`. It is renamed first, so that a later session deletes the rest if this process is killed
/// meanwhile.
///
/// # Errors
/// A file cannot be deleted.
pub(super) fn delete_autosave(path: &Path) -> io::Result<()> {
    let name = path.file_name().unwrap_or_default().to_string_lossy();
    let renamed = path.with_file_name(format!("{TEMPORARY}{name}"));
    let is_renamed = fs::rename(path, &renamed).is_ok();
    fs::remove_dir_all(if is_renamed { renamed.as_path() } else { path })
}

/// Deletes what killed processes left unfinished.
fn delete_abandoned(unfinished: &[PathBuf]) {
    let age = |path: &Path| -> io::Result<Duration> {
        let modified = fs::metadata(path)?.modified()?;
        Ok(SystemTime::now().duration_since(modified).unwrap_or_default())
    };
    for path in unfinished {
        if age(path).is_ok_and(|age| age >= ABANDONED_AFTER) {
            let _ = fs::remove_dir_all(path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::to_ron;

    #[test]
    fn autosaves_of_the_same_second_are_ordered_by_the_time_of_their_files_and_then_by_name() {
        let root = tempfile::tempdir().expect("a temporary folder");
        let second = UNIX_EPOCH + Duration::from_secs(1_700_000_000);
        for (name, after_ms) in [("a", 300), ("b", 900), ("c", 500), ("d", 500), ("e", 500)] {
            let folder = root.path().join(name);
            fs::create_dir_all(folder.join("checkpoint")).expect("a new folder");
            fs::write(folder.join(RunFolder::CONFIG_FILE), "").expect("a writable file");
            let metadata = AutosaveMetadata {
                scenario: name.into(),
                preset: "Fast".into(),
                seed: 0,
                env_steps: 16,
                saved_unix_s: 1_700_000_000,
            };
            let path = folder.join(METADATA_FILE);
            fs::write(&path, to_ron(&metadata).expect("RON")).expect("a writable file");
            let file = fs::File::options().write(true).open(path).expect("the file exists");
            file.set_modified(second + Duration::from_millis(after_ms)).expect("the time can be set");
        }
        let found: Vec<String> =
            find(root.path()).into_iter().map(|session| session.metadata.scenario).collect();
        assert_eq!(found, ["b", "e", "d"], "newest first");
        assert!(!root.path().join("a").exists() && !root.path().join("c").exists(), "older ones are deleted");
        assert_eq!(fs::read_dir(root.path()).expect("a folder").count(), 3, "nothing is left of them");
    }
}
