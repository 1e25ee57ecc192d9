//! Autosaves of earlier sessions.
//!
//! In: the folder of all autosaves. Out: those that no running process uses, newest first; of these, old ones are deleted.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime, UNIX_EPOCH};

use serde::{Deserialize, Serialize};

use crate::app::app_snapshot::LastSession;
use crate::app::session::run_snapshot::RunSnapshot;
use crate::run::lock::Lock;
use crate::scenario::read_ron;

/// The file in an autosave that describes it. Other run folders do not have it.
pub(super) const NOTE: &str = "autosave.ron";

/// The prefix of autosaves that are being written.
pub(super) const TEMPORARY: &str = ".saving-";

/// Number of autosaves that are kept, apart from those of running sessions.
const MAX_KEPT: usize = 3;

/// Number of folder entries that are looked at.
const MAX_ENTRIES: usize = 1000;

/// An unfinished autosave of this age was left by a process that was killed.
const ABANDONED_AFTER: Duration = Duration::from_secs(600);

/// The description of an autosave.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct SessionNote {
    /// The scenario's name.
    scenario: String,
    /// The preset's title.
    preset: String,
    seed: u64,
    env_steps: u64,
    /// When it was saved, in s since 1970.
    saved_unix_s: u64,
}

impl SessionNote {
    /// The description of an autosave that is written now.
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
    note: SessionNote,
}

impl FoundSession {
    /// The session as plain data to show.
    pub(super) fn describe(&self) -> LastSession {
        let SessionNote { scenario, preset, seed, env_steps, saved_unix_s } = self.note.clone();
        LastSession { scenario, preset, seed, env_steps, age_s: now_unix_s().saturating_sub(saved_unix_s) }
    }
}

/// The autosaves in `root` that no process is using, newest first.
pub(super) fn find(root: &Path) -> Vec<FoundSession> {
    let entries = fs::read_dir(root).into_iter().flatten().flatten().take(MAX_ENTRIES);
    let (unfinished, saved): (Vec<_>, Vec<_>) =
        entries.map(|entry| entry.path()).partition(|path| is_temporary(path));
    delete_abandoned(&unfinished);
    let mut found: Vec<FoundSession> = saved
        .into_iter()
        .filter(|path| path.join("config.ron").exists())
        .filter_map(|path| Some(FoundSession { note: read_ron(path.join(NOTE)).ok()?, path }))
        .filter(|session| is_unused(&session.path))
        .collect();
    found.sort_by_key(|session| std::cmp::Reverse(session.note.saved_unix_s));
    found
}

fn is_temporary(path: &Path) -> bool {
    path.file_name().is_some_and(|name| name.to_string_lossy().starts_with(TEMPORARY))
}

/// Whether no process has locked the run folder at `path`.
fn is_unused(path: &Path) -> bool {
    Lock::acquire(path, &path.join("checkpoint/lock")).is_ok()
}

/// Deletes all but the newest autosaves, and removes them from `found`.
pub(super) fn delete_old(found: &mut Vec<FoundSession>) {
    for session in found.drain(MAX_KEPT.min(found.len())..) {
        // One that cannot be deleted does no harm.
        let _ = fs::remove_dir_all(session.path);
    }
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
