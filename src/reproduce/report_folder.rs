//! The report's folder: opening it, what must be true before any work is done in it, and the time spent on it.

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::report_files;
use crate::report::page::Page;
use crate::run::RunError;
use crate::run::lock::Lock;
use crate::run::output_file::{check_entry, is_temporary, replace};

/// The file with the wall time spent. It also marks the folder as that of a report, quick or full.
const SPENT: &str = "spent.json";
/// The file that a process locks.
const LOCK: &str = "lock";

/// The folder of a report, locked by this process.
pub struct ReportFolder {
    path: PathBuf,
    /// Wall time that earlier processes spent on the report, in s.
    earlier_s: f64,
    quick: bool,
    _lock: Lock,
}

/// The time spent on a report so far, as stored in `spent.json`.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Spent {
    /// Wall time of all processes, in s.
    wall_s: f64,
    /// Whether all of them made quick reports.
    #[serde(default)]
    quick: bool,
}

impl ReportFolder {
    /// Creates the folder, or continues one that an earlier reproduction created. Checks that the report can be written to it,
    /// and that a `quick` report does not replace a full one.
    ///
    /// # Errors
    /// Another process uses the folder, it holds something else, or it cannot be written.
    pub fn open(path: &Path, quick: bool) -> Result<Self, RunError> {
        check_own(path)?;
        let unwritable = |error: io::Error| {
            let why = format!("cannot be written ({error}); help: choose another folder with --out");
            RunError::invalid_input(path, why)
        };
        fs::create_dir_all(path).map_err(unwritable)?;
        let lock = Lock::acquire(path, &path.join(LOCK))?;
        report_files::prepare(path)?;
        let spent = match fs::read_to_string(path.join(SPENT)) {
            Ok(text) => serde_json::from_str(&text).unwrap_or_default(),
            Err(_) => Spent { wall_s: 0.0, quick },
        };
        if quick && !spent.quick {
            let why =
                "holds a full report, which --quick would overwrite; help: choose another folder with --out";
            return Err(RunError::invalid_input(path, why));
        }
        let folder = Self { path: path.into(), earlier_s: spent.wall_s, quick, _lock: lock };
        // The first file marks the folder: a process that is started now must not take it for another's.
        folder.write_spent(spent.wall_s).map_err(unwritable)?;
        fs::create_dir_all(folder.join("runs")).map_err(unwritable)?;
        Ok(folder)
    }

    /// The path of `name` in this folder.
    pub fn join(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Writes the wall time that all processes have spent, of which this one `began` then. Returns it, in s.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn record_time(&self, began: Instant) -> Result<f64, RunError> {
        let wall_s = self.earlier_s + began.elapsed().as_secs_f64();
        self.write_spent(wall_s).map_err(|error| RunError::failed(&self.join(SPENT), error))?;
        Ok(wall_s)
    }

    /// Writes the report.
    ///
    /// # Errors
    /// A figure cannot be drawn, or a file cannot be written. An earlier report then is as it was.
    pub fn write(&self, page: &Page) -> Result<(), RunError> {
        report_files::write(&self.path, page)
    }

    fn write_spent(&self, wall_s: f64) -> io::Result<()> {
        let text = serde_json::to_string(&Spent { wall_s, quick: self.quick })?;
        let path = self.join(SPENT);
        check_entry(&path)?;
        replace(&path, |file| file.write_all(text.as_bytes()))
    }
}

/// Checks that `folder` is missing or empty, or holds a reproduction. (One that was killed before it wrote its first file has
/// left a lock, perhaps with a temporary file.)
fn check_own(folder: &Path) -> Result<(), RunError> {
    let mut entries = fs::read_dir(folder).into_iter().flatten().flatten();
    let is_foreign = entries.any(|entry| entry.file_name() != LOCK && !is_temporary(&entry));
    if is_foreign && !folder.join(SPENT).exists() {
        // A process that has just started holds the lock.
        if folder.join(LOCK).exists() {
            Lock::acquire(folder, &folder.join(LOCK))?;
        }
        let why = "is not empty and holds no reproduction; help: choose another folder with --out";
        return Err(RunError::invalid_input(folder, why));
    }
    Ok(())
}
