//! A run folder: the files of one training run. Rows and events are appended; every other file is written atomically.
//!
//! | file | contents |
//! |---|---|
//! | `config.ron` | the resolved configuration: scenario, preset, seed, version, commit ([`RunConfig`]) |
//! | `episodes.csv`, `evaluations.csv` | one row per episode and per evaluation ([`metric_rows`](super::metric_rows)) |
//! | `events.out.tfevents.*` | the same metrics for TensorBoard |
//! | `policy.safetensors`, `policy-last.safetensors` | the best policy by evaluation, the last policy |
//! | `policy-init.safetensors` | the policy that training started from, if any |
//! | `policy-after-N-episodes.safetensors`, `policy-after-N-env-steps.safetensors` | the policy after N episodes or env steps, if the configuration asks for it |
//! | `checkpoint/` | the last three checkpoints ([`checkpoint`](super::checkpoint)) and a lock |
//! | `summary.json`, `learning-curve.svg` | the summary, and the learning curves |
//! | `processors.json` | the kinds of processor that the run was trained on |
//! | `journal.ron` | the intervention journal, in runs saved from the app |
//! | `autosave.ron` | the session that the app offers to continue, in autosaves |

mod config;
mod csv_file;

use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
#[cfg(not(target_arch = "wasm32"))]
use std::sync::Arc;

use super::RunError;
#[cfg(not(target_arch = "wasm32"))]
use super::lock::Lock;
use super::output_file::{Sink, is_temporary, replace};
#[cfg(not(target_arch = "wasm32"))]
use super::output_file::{check_entry, remove_temporary_files};
use super::preset::Budget;
use super::write_points::write_point;
use crate::limits::MAX_CONFIG_BYTES;
use crate::scenario::to_ron;

pub use config::{DEFAULT_SCENARIO, PAPER_TRANSFER_EPSILON, RunConfig, Transfer};
pub use csv_file::header;

/// The name of the folder of checkpoints.
pub const CHECKPOINT_FOLDER: &str = "checkpoint";
/// The name of the best policy's file.
pub const POLICY_FILE: &str = "policy.safetensors";
/// The name of the file with a row per training episode.
pub const EPISODES_FILE: &str = "episodes.csv";
/// The name of the file with a row per evaluation.
pub const EVALUATIONS_FILE: &str = "evaluations.csv";
/// The name of the initial policy's file.
pub const INITIAL_POLICY_FILE: &str = "policy-init.safetensors";

/// The extensions of the files that runs read or write.
const EXTENSIONS: [&str; 6] = ["ron", "csv", "json", "safetensors", "bin", "svg"];

/// The files that a resumed run replaces or continues.
#[cfg(not(target_arch = "wasm32"))]
const REPLACED: [&str; 8] = [
    RunFolder::CONFIG_FILE,
    EPISODES_FILE,
    EVALUATIONS_FILE,
    POLICY_FILE,
    "policy-last.safetensors",
    "processors.json",
    "summary.json",
    "learning-curve.svg",
];

/// A run folder on disk.
#[derive(Clone, Debug)]
pub struct RunFolder {
    path: PathBuf,
    /// The lock that allows writing; `None` if the folder is read-only.
    #[cfg(not(target_arch = "wasm32"))]
    _lock: Option<Arc<Lock>>,
}

impl RunFolder {
    /// The path of the configuration in a run folder.
    pub(crate) const CONFIG_FILE: &str = "config.ron";
    /// The path of the lock in a run folder.
    pub(crate) const LOCK_FILE: &str = "checkpoint/lock";

    /// Creates the folder of a new run. Writes the file of the initial policy, if there is one, and then `config.ron`: a
    /// folder with `config.ron` can be resumed. Without a path the folder is `runs/<scenario>-<preset>-<seed>`, with a number
    /// appended if that exists.
    ///
    /// # Errors
    /// The folder already holds a run or other files, another process has its lock, or it cannot be written.
    pub fn create(
        path: Option<PathBuf>,
        config: &RunConfig,
        initial_policy: Option<&[u8]>,
    ) -> Result<Self, RunError> {
        let folder = match path {
            Some(path) => Self::new(path),
            None => Self::new(create_default_folder(config)?),
        };
        folder.check_vacant()?;
        fs::create_dir_all(folder.path.join(CHECKPOINT_FOLDER))
            .map_err(|error| folder_not_writable(&folder.path, &error))?;
        write_point("run folder: created");
        let folder = folder.locked()?;
        // Another process may have created a run before the lock was taken.
        folder.check_vacant()?;
        let written = match initial_policy {
            Some(bytes) => folder.write(INITIAL_POLICY_FILE, |file| file.write_all(bytes)),
            None => Ok(()),
        };
        written
            .and_then(|()| folder.write_config(config))
            .map_err(|error| RunError::InvalidInput(error.to_string()))?;
        Ok(folder)
    }

    fn new(path: PathBuf) -> Self {
        Self {
            path,
            #[cfg(not(target_arch = "wasm32"))]
            _lock: None,
        }
    }

    /// Checks that a new run can be created here: the folder is missing or empty, or holds the remains of a
    /// run that was killed before it wrote `config.ron`.
    fn check_vacant(&self) -> Result<(), RunError> {
        if self.config_path().exists() {
            let why = "already holds a run; help: continue it with --resume, or give --out another folder";
            return Err(RunError::invalid_input(&self.path, why));
        }
        let is_started = self.path.join(CHECKPOINT_FOLDER).exists();
        let is_leftover = |entry: fs::DirEntry| {
            let is = |name: &str| entry.path() == self.path.join(name);
            is(CHECKPOINT_FOLDER)
                || is(Self::LOCK_FILE)
                || is_temporary(&entry)
                || (is_started && is(INITIAL_POLICY_FILE))
        };
        if !self.entries().all(is_leftover) {
            let why = "is not empty; help: give --out a new or an empty folder";
            return Err(RunError::invalid_input(&self.path, why));
        }
        Ok(())
    }

    /// Locks this folder for writing, and deletes temporary files that a killed process left.
    ///
    /// # Errors
    /// Another process has the lock, or the folder or one of the run's files cannot be written.
    pub fn locked(self) -> Result<Self, RunError> {
        #[cfg(not(target_arch = "wasm32"))]
        {
            let lock = Arc::new(Lock::acquire(&self.path, &self.path.join(Self::LOCK_FILE))?);
            for path in REPLACED.iter().map(|name| self.path.join(name)) {
                check_entry(&path).map_err(|error| RunError::not_writable(&path, error))?;
            }
            remove_temporary_files(&self.path);
            remove_temporary_files(&self.path.join(CHECKPOINT_FOLDER));
            Ok(Self { _lock: Some(lock), ..self })
        }
        #[cfg(target_arch = "wasm32")]
        Ok(self)
    }

    /// Opens the folder of an existing run, and reads its configuration. The folder is read-only until it is
    /// [`locked`](Self::locked).
    ///
    /// # Errors
    /// The folder has no `config.ron`, or it is unreadable or invalid; one of the run's files is a link or a pipe; or the run
    /// needs too much memory.
    pub fn open(path: &Path) -> Result<(Self, RunConfig), RunError> {
        let folder = Self::new(path.into());
        if !folder.config_path().exists() {
            let why = "is not a run folder (it has no config.ron); help: give the folder of a run";
            return Err(RunError::invalid_input(path, why));
        }
        folder.check_files_are_regular()?;
        let config = RunConfig::load(&folder.config_path())?;
        config.check_memory().map_err(|error| RunError::invalid_input(&folder.config_path(), error))?;
        Ok((folder, config))
    }

    /// Checks that the run's files are regular files. A link in a folder from an untrusted source could make the
    /// run overwrite any file of the user, and reading a pipe would block forever.
    ///
    /// # Errors
    /// A file is a link or a pipe. The error names the first one.
    fn check_files_are_regular(&self) -> Result<(), RunError> {
        for entry in self.entries().filter(is_run_file) {
            // `file_type` does not follow links.
            if !entry.file_type().is_ok_and(|kind| kind.is_file() || kind.is_dir()) {
                let why = "is a link or a pipe; help: put the file itself into the run folder";
                return Err(RunError::invalid_input(&entry.path(), why));
            }
        }
        Ok(())
    }

    /// The entries of this folder and of its folder `checkpoint`.
    fn entries(&self) -> impl Iterator<Item = fs::DirEntry> {
        let folders = [self.path.clone(), self.path.join(CHECKPOINT_FOLDER)];
        folders.into_iter().flat_map(|folder| fs::read_dir(folder).into_iter().flatten().flatten())
    }

    /// Writes `config.ron`, replacing the old one.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write_config(&self, config: &RunConfig) -> Result<(), RunError> {
        let text = to_ron(config).map_err(|error| RunError::failed(&self.config_path(), error))?;
        if text.len() as u64 > MAX_CONFIG_BYTES {
            let why = format!(
                "would have {} bytes, more than {MAX_CONFIG_BYTES}; help: use fewer or smaller scenarios",
                text.len()
            );
            return Err(RunError::invalid_input(&self.config_path(), why));
        }
        self.write(Self::CONFIG_FILE, |file| file.write_all(text.as_bytes()))
    }

    /// Writes the file `name` atomically with `write`.
    ///
    /// # Errors
    /// The file cannot be written.
    pub fn write(&self, name: &str, write: impl FnOnce(&mut Sink) -> io::Result<()>) -> Result<(), RunError> {
        let path = self.path.join(name);
        replace(&path, write).map_err(|error| RunError::not_written(&path, error))
    }

    /// The name of the file with the policy after a number of episodes or env steps.
    #[must_use]
    pub fn policy_after_file(after: Budget) -> String {
        match after {
            Budget::Episodes(n) => format!("policy-after-{n}-episodes.safetensors"),
            Budget::EnvSteps(n) => format!("policy-after-{n}-env-steps.safetensors"),
        }
    }

    /// The folder's path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn config_path(&self) -> PathBuf {
        self.path.join(Self::CONFIG_FILE)
    }
}

/// Whether `entry` is a file that runs read or write.
fn is_run_file(entry: &fs::DirEntry) -> bool {
    let (path, name) = (entry.path(), entry.file_name());
    path.extension().is_some_and(|found| EXTENSIONS.iter().any(|extension| found == *extension))
        || [CHECKPOINT_FOLDER, "lock"].iter().any(|file| name == *file)
        || name.to_string_lossy().starts_with("events.")
}

/// Creates `runs/<scenario>-<preset>-<seed>`, with a number appended if that exists. The folder reserves the
/// name for this run.
fn create_default_folder(config: &RunConfig) -> Result<PathBuf, RunError> {
    let name = config.run_name();
    let runs = Path::new("runs");
    let mut path = runs.join(&name);
    let mut number = 2;
    loop {
        match fs::create_dir_all(runs).and_then(|()| fs::create_dir(&path)) {
            Ok(()) => return Ok(path),
            Err(error) if error.kind() == io::ErrorKind::AlreadyExists && path.is_dir() => {
                path = runs.join(format!("{name}-{number}"));
                number += 1;
            }
            Err(error) => return Err(folder_not_writable(&path, &error)),
        }
    }
}

/// The error for an output folder that cannot be written.
pub(super) fn folder_not_writable(folder: &Path, error: &io::Error) -> RunError {
    RunError::invalid_input(folder, format!("can't be written ({error}); help: give --out another folder"))
}
