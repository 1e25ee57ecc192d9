//! A run's folder: what is written where, and each file whole or not at all.
//!
//! | file | what |
//! |---|---|
//! | `config.ron` | all that was resolved: scenario, preset, seed, version |
//! | `episodes.csv`, `evaluations.csv` | a row each ([`metric_rows`](super::metric_rows)) |
//! | `events.out.tfevents.*` | the same for TensorBoard |
//! | `policy.safetensors`, `policy-last.safetensors` | the best policy by evaluation, the last |
//! | `policy-init.safetensors` | the policy that training started from, if it did from one |
//! | `policy-after-N-episodes.safetensors` | as it stood then, where the configuration asks for it |
//! | `checkpoint/` | everything needed to go on, the last three times it was written ([`checkpoint`](super::checkpoint)); a lock |
//! | `summary.json`, `learning-curve.svg` | the run in short, and as a picture |

use std::fs::{self, File, OpenOptions};
use std::io::{self, Write};
use std::path::{Path, PathBuf};
#[cfg(not(target_arch = "wasm32"))]
use std::sync::Arc;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::RunError;
#[cfg(not(target_arch = "wasm32"))]
use super::lock::Lock;
use super::preset::Preset;
use super::shipped;
use crate::scenario::{FileError, Scenario, read_ron_with_limit, read_text_with_limit, to_ron};
use crate::simulation::Extensions;
use crate::task::{ObservationLayout, ObservationSlice};

/// The most bytes that `config.ron` may have. (A scenario of a mebibyte takes more when it is written in full.)
const MAX_CONFIG_BYTES: u64 = 1 << 24;
/// How the names end of what is read and written in a run's folder.
const OURS: [&str; 5] = ["ron", "csv", "json", "safetensors", "bin"];

/// All that was resolved before a run began: `config.ron`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RunConfig {
    /// The version of wayfield that made the run.
    pub version: String,
    /// The seed of every random draw.
    pub seed: u64,
    /// What the scenario was asked for as.
    pub scenario_from: String,
    /// What the preset was asked for as.
    pub preset_from: String,
    /// The policy that training started from, if any.
    #[serde(default)]
    pub transfer: Option<Transfer>,
    /// After how many ended episodes the policy is kept as it stands then, in a file of its own
    /// ([`RunFolder::policy_after_file`]), beside the best and the last.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub save_policy_after_episodes: Vec<u64>,
    /// The sensors of plugins in the observation.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub sensors: Vec<ObservationSlice>,
    /// The reward terms of plugins.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub reward_terms: Vec<String>,
    /// The plugins themselves; a file cannot hold them.
    #[serde(skip)]
    pub extensions: Extensions,
    /// The scenario.
    pub scenario: Scenario,
    /// How to learn, command-line changes included.
    pub preset: Preset,
}

impl RunConfig {
    /// A run from nothing: scenario and preset by shipped name or file, and the seed.
    ///
    /// # Errors
    /// A file that cannot be used, with line, column and mend.
    pub fn resolve(scenario_from: &str, preset_from: &str, seed: u64) -> Result<Self, FileError> {
        Ok(Self {
            version: env!("CARGO_PKG_VERSION").into(),
            seed,
            scenario_from: scenario_from.into(),
            preset_from: preset_from.into(),
            transfer: None,
            save_policy_after_episodes: Vec::new(),
            sensors: Vec::new(),
            reward_terms: Vec::new(),
            extensions: Extensions::default(),
            scenario: shipped::scenario(scenario_from)?,
            preset: shipped::preset(preset_from)?,
        })
    }

    /// The same run with a user's plugins, whose sensors and reward terms are recorded.
    #[must_use]
    pub fn with_extensions(self, extensions: &Extensions) -> Self {
        let (sensors, reward_terms) = extensions.describe();
        Self { sensors, reward_terms, extensions: extensions.clone(), ..self }
    }

    /// The layout of the run's observations.
    #[must_use]
    pub fn observation_layout(&self) -> ObservationLayout {
        ObservationLayout::new(self.preset.observation, self.sensors.clone())
    }

    /// What is run, in a line.
    #[must_use]
    pub fn description(&self) -> String {
        let name = self.preset_name();
        let from = self.transfer.as_ref().map_or(String::new(), |t| format!(", from {}", t.policy));
        let arenas = self.preset.arenas;
        format!(
            "{}, preset {name}, seed {}, {arenas} arena{}{from}",
            self.scenario.name,
            self.seed,
            if arenas == 1 { "" } else { "s" }
        )
    }

    /// The scenario's file name without folder and ending.
    #[must_use]
    pub fn scenario_name(&self) -> String {
        stem(&self.scenario_from)
    }

    /// The preset's file name without folder and ending.
    #[must_use]
    pub fn preset_name(&self) -> String {
        stem(&self.preset_from)
    }
}

fn stem(from: &str) -> String {
    Path::new(from).file_stem().unwrap_or_default().to_string_lossy().into_owned()
}

/// Knowledge transfer: training starts from a policy (section 3.2).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Transfer {
    /// The policy's file, as it was asked for.
    pub policy: String,
    /// Epsilon at the start, if not the preset's.
    pub epsilon: Option<f32>,
}

/// The file that keeps the policy which training started from.
pub const INITIAL_POLICY_FILE: &str = "policy-init.safetensors";

/// How temporary files are called: those of a process that was killed are swept away by the next.
const TEMPORARY: &str = ".writing-";

/// A run's folder on disk.
#[derive(Clone, Debug)]
pub struct RunFolder {
    path: PathBuf,
    /// Ours to write in, while this lives; not if it was only opened.
    #[cfg(not(target_arch = "wasm32"))]
    _lock: Option<Arc<Lock>>,
}

impl RunFolder {
    /// Makes the folder for a new run and writes `config.ron` into it. Without a path: `runs/<scenario>-<preset>-<seed>`,
    /// with a number behind it if that is taken.
    ///
    /// # Errors
    /// The folder holds a run already, or cannot be written.
    pub fn create(path: Option<PathBuf>, config: &RunConfig) -> Result<Self, RunError> {
        let folder = match path {
            Some(path) => Self::new(path),
            None => Self::new(default_path(config)?),
        };
        folder.check_vacant()?;
        fs::create_dir_all(folder.path.join("checkpoint")).map_err(|error| {
            RunError::invalid_input(
                &folder.path,
                format!("can't be written ({error}): give --out another folder"),
            )
        })?;
        let folder = folder.locked()?;
        // Somebody may have been quicker.
        folder.check_vacant()?;
        folder.write_config(config).map_err(|error| match error {
            RunError::Failed(text) | RunError::InvalidInput(text) => RunError::InvalidInput(text),
        })?;
        Ok(folder)
    }

    fn new(path: PathBuf) -> Self {
        Self {
            path,
            #[cfg(not(target_arch = "wasm32"))]
            _lock: None,
        }
    }

    /// Whether a new run can be made here: a folder that is not there, or empty, or where one was killed before it began.
    fn check_vacant(&self) -> Result<(), RunError> {
        if self.config().exists() {
            let why = "holds a run already: go on with it by --resume, or give --out another folder";
            return Err(RunError::invalid_input(&self.path, why));
        }
        let ours = |entry: io::Result<fs::DirEntry>| {
            entry.is_ok_and(|entry| entry.file_name() == "checkpoint" || is_temporary(&entry))
        };
        if fs::read_dir(&self.path).is_ok_and(|mut entries| !entries.all(ours)) {
            let why = "is not empty: give --out a new or an empty folder";
            return Err(RunError::invalid_input(&self.path, why));
        }
        Ok(())
    }

    /// This folder, to be written in: nobody else may, and what a killed process was writing is swept away.
    ///
    /// # Errors
    /// Another process has it, or it cannot be written.
    pub fn locked(self) -> Result<Self, RunError> {
        #[cfg(not(target_arch = "wasm32"))]
        {
            let lock = Arc::new(Lock::acquire(&self.path, &self.path.join("checkpoint/lock"))?);
            for folder in [self.path.clone(), self.path.join("checkpoint")] {
                for entry in fs::read_dir(folder).into_iter().flatten().flatten().filter(is_temporary) {
                    // What cannot be swept away does no harm.
                    let _ = fs::remove_file(entry.path());
                }
            }
            Ok(Self { _lock: Some(lock), ..self })
        }
        #[cfg(target_arch = "wasm32")]
        Ok(self)
    }

    /// The folder of a run that was begun, and its configuration; to be read only, unless it is [`locked`](Self::locked).
    ///
    /// # Errors
    /// It is not there, or its `config.ron` cannot be used.
    pub fn open(path: &Path) -> Result<(Self, RunConfig), RunError> {
        let folder = Self::new(path.into());
        if !folder.config().exists() {
            let why = "is no run's folder (it has no config.ron): give --resume the folder of a run";
            return Err(RunError::invalid_input(path, why));
        }
        folder.holds_files_of_its_own()?;
        let config: RunConfig = read_ron_with_limit(folder.config(), MAX_CONFIG_BYTES)?;
        let diagnostics: Vec<_> = config
            .preset
            .diagnostics()
            .into_iter()
            .chain(crate::scenario::diagnostics(&config.scenario))
            .collect();
        if !diagnostics.is_empty() {
            let text = read_text_with_limit(folder.config(), MAX_CONFIG_BYTES)?;
            return Err(FileError::from_diagnostics(&folder.config(), &text, &diagnostics).into());
        }
        config
            .preset
            .check_memory(&config.scenario)
            .map_err(|error| RunError::invalid_input(&folder.config(), error))?;
        Ok((folder, config))
    }

    /// Whether all that a run reads and writes here are files of this folder: a link would let a folder from elsewhere
    /// write over any file of its user, and a pipe would never end.
    ///
    /// # Errors
    /// Which is none, and what it is.
    fn holds_files_of_its_own(&self) -> Result<(), RunError> {
        for folder in [self.path.clone(), self.path.join("checkpoint")] {
            for entry in fs::read_dir(&folder).into_iter().flatten().flatten() {
                let (path, name) = (entry.path(), entry.file_name());
                let ours = path.extension().is_some_and(|ending| OURS.iter().any(|ours| ending == *ours))
                    || ["checkpoint", "lock"].iter().any(|ours| name == *ours)
                    || name.to_string_lossy().starts_with("events.");
                // (Of the entry itself, not of what it leads to.)
                let own = entry.file_type().is_ok_and(|kind| kind.is_file() || kind.is_dir());
                if ours && !own {
                    let why = "is a link or a pipe: a run's folder must hold the file itself";
                    return Err(RunError::invalid_input(&path, why));
                }
            }
        }
        Ok(())
    }

    /// Writes `config.ron` anew.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write_config(&self, config: &RunConfig) -> Result<(), RunError> {
        let text = to_ron(config).map_err(|error| RunError::failed(&self.config(), error))?;
        self.write("config.ron", |file| file.write_all(text.as_bytes()))
    }

    /// Writes the file `name` by `write`: whole or not at all, an older one is replaced at the end.
    ///
    /// # Errors
    /// It cannot be written.
    pub fn write(&self, name: &str, write: impl FnOnce(&mut Sink) -> io::Result<()>) -> Result<(), RunError> {
        let path = self.path.join(name);
        write_atomic(&path, write)
            .map_err(|error| RunError::failed(&path, format!("can't be written: {error}")))
    }

    /// The rows of the CSV file `name`.
    ///
    /// # Errors
    /// It cannot be read, or holds other rows.
    pub fn rows<Row: DeserializeOwned>(&self, name: &str) -> Result<Vec<Row>, RunError> {
        let path = self.path.join(name);
        let rows = csv::Reader::from_path(&path).map(|mut reader| reader.deserialize().collect());
        rows.flatten().map_err(|error| RunError::failed(&path, error))
    }

    /// A CSV file of rows like `Row`, opened to add some behind its first `bytes` bytes; whatever stood behind them is
    /// gone. A new file gets its header at once.
    ///
    /// # Errors
    /// It cannot be opened, or is shorter than that.
    pub fn csv<Row: Serialize + Default>(
        &self,
        name: &str,
        bytes: u64,
        extra_columns: &[String],
    ) -> Result<csv::Writer<File>, RunError> {
        let path = self.path.join(name);
        let open = || -> io::Result<File> {
            let mut file = OpenOptions::new().create(true).truncate(false).write(true).open(&path)?;
            if file.metadata()?.len() < bytes {
                return Err(io::Error::other("it is shorter than the checkpoint says; rows were lost"));
            }
            file.set_len(bytes)?;
            io::Seek::seek(&mut file, io::SeekFrom::End(0))?;
            if bytes == 0 {
                let header = header::<Row>()?;
                let extra: String = extra_columns.iter().map(|column| format!(",{column}")).collect();
                file.write_all(format!("{}{extra}\n", header.trim_end()).as_bytes())?;
            }
            Ok(file)
        };
        let file = open().map_err(|error| RunError::invalid_input(&path, error))?;
        Ok(csv::WriterBuilder::new().has_headers(false).from_writer(file))
    }

    /// The name of the file that keeps the policy as it stood after `episodes`.
    #[must_use]
    pub fn policy_after_file(episodes: u64) -> String {
        format!("policy-after-{episodes}-episodes.safetensors")
    }

    /// The folder's path.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    fn config(&self) -> PathBuf {
        self.path.join("config.ron")
    }
}

/// Writes the file `path` by `write`: whole or not at all, an older one is replaced at the end.
///
/// # Errors
/// It cannot be written.
#[cfg(not(target_arch = "wasm32"))]
pub fn write_atomic(path: &Path, write: impl FnOnce(&mut Sink) -> io::Result<()>) -> io::Result<()> {
    let in_folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut temporary = tempfile::Builder::new().prefix(TEMPORARY).tempfile_in(in_folder)?;
    let mut writer = io::BufWriter::new(temporary.as_file_mut());
    write(&mut writer)?;
    writer.flush()?;
    drop(writer);
    make_readable(temporary.path())?;
    temporary.as_file().sync_all()?;
    temporary.persist(path).map_err(|error| error.error)?;
    // The new name, too, is to outlive a power cut, where that can be had.
    if let Ok(folder) = File::open(in_folder) {
        let _ = folder.sync_all();
    }
    Ok(())
}

fn is_temporary(entry: &fs::DirEntry) -> bool {
    entry.file_name().to_string_lossy().starts_with(TEMPORARY)
}

/// Writes the file `path` by `write`, onto the shelf from which the page saves it.
///
/// # Errors
/// Those of `write`.
#[cfg(target_arch = "wasm32")]
pub fn write_atomic(path: &Path, write: impl FnOnce(&mut Sink) -> io::Result<()>) -> io::Result<()> {
    let mut bytes = Vec::new();
    write(&mut bytes)?;
    crate::scenario::virtual_files::add_download(path, bytes);
    Ok(())
}

/// What a file is written into.
#[cfg(not(target_arch = "wasm32"))]
pub type Sink<'a> = io::BufWriter<&'a mut File>;
/// What a file is written into.
#[cfg(target_arch = "wasm32")]
pub type Sink = Vec<u8>;

/// The line of column names of a CSV file of rows like `Row`.
///
/// # Errors
/// Never known to happen.
pub fn header<Row: Serialize + Default>() -> io::Result<String> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.serialize(Row::default()).map_err(io::Error::other)?;
    let bytes = writer.into_inner().map_err(|error| io::Error::other(error.to_string()))?;
    let line = bytes.split_inclusive(|&byte| byte == b'\n').next().unwrap_or_default();
    Ok(String::from_utf8_lossy(line).into_owned())
}

/// Temporary files are made private; what a run leaves behind is as readable as any file.
#[cfg(unix)]
fn make_readable(path: &Path) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(path, fs::Permissions::from_mode(0o644))
}

#[cfg(not(any(unix, target_arch = "wasm32")))]
fn make_readable(_: &Path) -> io::Result<()> {
    Ok(())
}

/// `runs/<scenario>-<preset>-<seed>`, with a number behind it if that is taken; the folder is made, so that nobody else
/// gets it.
fn default_path(config: &RunConfig) -> Result<PathBuf, RunError> {
    let name = format!("{}-{}-{}", config.scenario_name(), config.preset_name(), config.seed);
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
            Err(error) => {
                let why = format!("can't be written ({error}): give --out another folder");
                return Err(RunError::invalid_input(&path, why));
            }
        }
    }
}
