//! The report's folder: opening it, the checks before any work is done in it, and the time spent on the report.

use std::fs::{self, DirEntry};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::time::Instant;

use serde::{Deserialize, Serialize};

use super::report_contents::{OTHER_FOLDER, ReportContents};
use super::report_files;
use super::shard::Shard;
use crate::report::page::Page;
use crate::run::RunError;
use crate::run::lock::Lock;
use crate::run::output_file::{check_entry, is_temporary, replace};

/// The prefix of the names of the files with the wall time spent, one for the report and one for each shard. They also mark the
/// folder as that of a report, and the report as quick or full.
const SPENT: &str = "spent";
/// The prefix of the names of the files that processes lock.
pub const LOCK: &str = "lock";

/// The folder of a report, locked by this process.
pub struct ReportFolder {
    path: PathBuf,
    /// The file with the wall time spent on the report, or on the shard that this process works on.
    spent: PathBuf,
    /// Wall time that earlier processes recorded in that file, in s.
    earlier_s: f64,
    /// Wall time of all shards, in s; 0 if this process works on a shard.
    of_shards_s: f64,
    /// What the full report in the folder is made of; `None` if there is none.
    shown: Option<ReportContents>,
    /// What the report to be written is made of.
    contents: ReportContents,
    _locks: Vec<Lock>,
}

/// The time spent so far on a report, or on a shard of it, as stored in `spent*.json`.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Spent {
    /// Wall time of all processes that worked on it, in s.
    wall_s: f64,
    /// Whether all of them made quick reports.
    #[serde(default)]
    quick: bool,
    /// What the full report in the folder is made of; absent before it is written.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    report: Option<ReportContents>,
}

impl ReportFolder {
    /// Creates the folder, or continues one that an earlier reproduction created. Checks that the report can be written to it. A
    /// full report must not be replaced by a quick one, nor by one that leaves out experiments, seeds or (with `--only`) figures
    /// or tables. Several shards can use the folder at the same time.
    ///
    /// # Errors
    /// Another process uses the folder, it holds other files or a report that must not be replaced, or it cannot be written.
    pub fn open(path: &Path, contents: ReportContents, shard: Option<Shard>) -> Result<Self, RunError> {
        check_own(path)?;
        let unwritable = |error: io::Error| {
            let why = format!("cannot be written ({error}); help: choose another folder with --out");
            RunError::invalid_input(path, why)
        };
        fs::create_dir_all(path).map_err(unwritable)?;
        let locks = lock(path, shard)?;
        if shard.is_none() {
            // A shard writes no report, and must leave the temporary files of the others alone.
            report_files::prepare(path)?;
        }
        let earlier = Spent::read(&path.join(spent_file(None)));
        if let Some(why) = earlier.as_ref().and_then(|earlier| earlier.keeps_out(&contents)) {
            return Err(RunError::invalid_input(path, why));
        }
        let shown = earlier.and_then(|earlier| earlier.report);
        let spent = path.join(spent_file(shard));
        let earlier_s = Spent::read(&spent).unwrap_or_default().wall_s;
        let of_shards_s = if shard.is_none() { shards_wall_s(path) } else { 0.0 };
        let path = path.to_path_buf();
        let folder = Self { path, spent, earlier_s, of_shards_s, shown, contents, _locks: locks };
        // From now on, this file tells other processes that the folder is a report's.
        folder.write_spent(earlier_s).map_err(unwritable)?;
        fs::create_dir_all(folder.join("runs")).map_err(unwritable)?;
        Ok(folder)
    }

    /// The path of `name` in this folder.
    pub fn join(&self, name: &str) -> PathBuf {
        self.path.join(name)
    }

    /// Writes the wall time that this process, which started at `began`, and earlier ones have spent. Returns the
    /// sum of this time and that of the shards, in s.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn record_time(&self, began: Instant) -> Result<f64, RunError> {
        let wall_s = self.earlier_s + began.elapsed().as_secs_f64();
        self.write_spent(wall_s).map_err(|error| RunError::failed(&self.spent, error))?;
        Ok(self.of_shards_s + wall_s)
    }

    /// Writes the report.
    ///
    /// # Errors
    /// As for [`report_files::write`].
    pub fn write(&mut self, page: &Page) -> Result<(), RunError> {
        report_files::write(&self.path, page)?;
        self.shown = (!self.contents.quick).then(|| self.contents.clone());
        Ok(())
    }

    fn write_spent(&self, wall_s: f64) -> io::Result<()> {
        let spent = Spent { wall_s, quick: self.contents.quick, report: self.shown.clone() };
        let text = serde_json::to_string(&spent)?;
        check_entry(&self.spent)?;
        replace(&self.spent, |file| file.write_all(text.as_bytes()))
    }
}

impl Spent {
    /// Reads the file at `path`; `None` if that cannot be read, the default if its contents are invalid.
    fn read(path: &Path) -> Option<Self> {
        let text = fs::read_to_string(path).ok()?;
        Some(serde_json::from_str(&text).unwrap_or_default())
    }

    /// Why a report of `contents` must not be made in the folder of this file, with the fix; `None` if it may.
    fn keeps_out(&self, contents: &ReportContents) -> Option<String> {
        if contents.quick && !self.quick {
            return Some(format!(
                "holds a full reproduction, which --quick would overwrite; help: {OTHER_FOLDER}"
            ));
        }
        contents.cannot_replace(self.report.as_ref()?)
    }
}

/// The name of the file with the time that was spent on the report or on a shard.
fn spent_file(shard: Option<Shard>) -> String {
    format!("{SPENT}{}.json", shard.map(Shard::suffix).unwrap_or_default())
}

/// The wall time of all shards, in s.
fn shards_wall_s(folder: &Path) -> f64 {
    let files =
        entries(folder).filter(|entry| is_named(entry, SPENT) && entry.file_name() != *spent_file(None));
    files.filter_map(|entry| Spent::read(&entry.path())).map(|spent| spent.wall_s).sum()
}

/// Locks `folder`: exclusively for a report; for a shard, shared with the other shards.
fn lock(folder: &Path, shard: Option<Shard>) -> Result<Vec<Lock>, RunError> {
    let all = folder.join(LOCK);
    let Some(shard) = shard else { return Ok(vec![Lock::acquire(folder, &all)?]) };
    let own = folder.join(format!("{LOCK}{}", shard.suffix()));
    Ok(vec![Lock::share(folder, &all)?, Lock::acquire(folder, &own)?])
}

/// Whether `folder` is missing or empty, or holds only the remains of a process that was killed before it wrote its first file: a
/// lock, perhaps with a temporary file.
#[must_use]
pub fn is_vacant(folder: &Path) -> bool {
    entries(folder).all(|entry| is_named(&entry, LOCK) || is_temporary(&entry))
}

/// Checks that `folder` is [vacant](is_vacant), or holds a reproduction.
fn check_own(folder: &Path) -> Result<(), RunError> {
    if !is_vacant(folder) && !entries(folder).any(|entry| is_named(&entry, SPENT)) {
        // If a process that has just started holds the lock, that is the error to report.
        if folder.join(LOCK).exists() {
            Lock::acquire(folder, &folder.join(LOCK))?;
        }
        let why = "is not empty and holds no reproduction; help: choose another folder with --out";
        return Err(RunError::invalid_input(folder, why));
    }
    Ok(())
}

fn entries(folder: &Path) -> impl Iterator<Item = DirEntry> {
    fs::read_dir(folder).into_iter().flatten().flatten()
}

/// Whether an entry is the `name` file of the report or of a shard.
fn is_named(entry: &DirEntry, name: &str) -> bool {
    let file = entry.file_name();
    let rest = file.to_str().and_then(|file| file.strip_prefix(name));
    rest.is_some_and(|rest| rest.is_empty() || rest == ".json" || rest.starts_with('-'))
}
