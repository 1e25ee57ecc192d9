//! Checkpoints of a run: the complete state from which a run resumes bit-identically.
//!
//! In: the learner, the arenas, the random streams, the lengths of the CSV files. Out:
//! `checkpoint/latest.bin`, written atomically, and the two checkpoints before it. If the newest cannot be
//! read, the next older one is used.
//!
//! A file holds the magic bytes, the version, the length and CRC-32C of the head, the head ([`TrainerState`]
//! as postcard), and the learner's checkpoint, which has a separate checksum. Checksums detect accidental
//! damage only, so every value is also checked after it is read.

mod state;

use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use bevy::prelude::World;

use super::RunError;
use super::folder::{RunConfig, RunFolder};
use super::training_setup::set_mirror;
use super::write_points::write_point;
use crate::agent::{ActiveLearner, Decisions, TrainingStats};
use crate::learning::Learner;
use crate::learning::framing::{HeaderError, HeaderFormat};
use crate::limits::MAX_HEAD_BYTES;
use crate::sim;
use crate::task::LevelProgress;

pub use state::{ArenaExtension, BestPolicy, TrainerState};

/// The files of the checkpoints, newest first. `next.bin` exists only until the others are renamed.
const NAMES: [&str; 4] =
    ["checkpoint/next.bin", "checkpoint/latest.bin", "checkpoint/previous.bin", "checkpoint/older.bin"];
/// The file of the newest checkpoint.
pub const LATEST: &str = NAMES[1];
/// The version of the format. It increases whenever an older reader would misread a newer file.
pub const VERSION: u32 = 12;
const FORMAT: HeaderFormat =
    HeaderFormat { magic: b"wayfrun\n", version: VERSION, max_bytes: MAX_HEAD_BYTES, checksum: true };

/// Updates `trainer_state` from `world` and writes a checkpoint.
///
/// # Errors
/// The checkpoint cannot be written; the previous one is kept.
pub fn save(folder: &RunFolder, world: &mut World, trainer_state: &mut TrainerState) -> Result<(), RunError> {
    trainer_state.update(world);
    folder.write(NAMES[0], |file| encode(file, trainer_state, &world.resource::<ActiveLearner>().0))?;
    // The oldest file is renamed first. If this is interrupted at any point, all files are complete and in order.
    for (from, to) in NAMES.iter().zip(&NAMES[1..]).rev() {
        let (from, to) = (folder.path().join(from), folder.path().join(to));
        match std::fs::rename(&from, &to) {
            Err(error) if error.kind() != ErrorKind::NotFound => return Err(RunError::failed(&to, error)),
            _ => write_point("checkpoint: renamed"),
        }
    }
    Ok(())
}

/// Updates `trainer_state` from `world` and writes the contents of a checkpoint to `file`.
///
/// # Errors
/// `file` cannot be written.
pub fn write_to(file: impl Write, world: &mut World, trainer_state: &mut TrainerState) -> io::Result<()> {
    trainer_state.update(world);
    encode(file, trainer_state, &world.resource::<ActiveLearner>().0)
}

/// Writes the contents of a checkpoint to `file`.
///
/// # Errors
/// `file` cannot be written.
pub fn encode(mut file: impl Write, trainer_state: &TrainerState, learner: &Learner) -> io::Result<()> {
    FORMAT.write(&mut file, trainer_state)?;
    write_point("checkpoint: state written");
    learner.save(file).map_err(io::Error::other)
}

/// A checkpoint that was read.
pub struct LoadedCheckpoint {
    /// The state of the run.
    pub trainer_state: TrainerState,
    /// The learner.
    pub learner: Learner,
    /// Newer checkpoints that could not be read, with the reasons.
    pub skipped: Vec<(PathBuf, RunError)>,
}

/// Whether the run in `folder` has a checkpoint.
pub fn exists(folder: &Path) -> bool {
    NAMES.iter().any(|name| folder.join(name).exists())
}

/// Reads the newest readable checkpoint.
///
/// # Errors
/// There is no checkpoint, none is valid for `config`, or one was written by a newer version of the program. The message describes
/// the newest.
pub fn load(folder: &RunFolder, config: &RunConfig) -> Result<LoadedCheckpoint, RunError> {
    let mut skipped = Vec::new();
    for path in NAMES.iter().map(|name| folder.path().join(name)).filter(|path| path.exists()) {
        match read(&path, config) {
            Ok((trainer_state, learner)) => return Ok(LoadedCheckpoint { trainer_state, learner, skipped }),
            // It is not damaged, and an older one must not take its place.
            Err(error) if is_newer(&path) => return Err(error),
            Err(error) => skipped.push((path, error)),
        }
    }
    let newest = skipped.into_iter().next().map_or_else(
        || RunError::invalid_input(&folder.path().join(NAMES[1]), "there is no checkpoint to resume from"),
        |(_, error)| error,
    );
    let newest = newest.to_string();
    let has_help = newest.contains("; help: ");
    let help = if has_help { "" } else { "; help: restore the file from a copy, or start a new run" };
    Err(RunError::InvalidInput(newest + help))
}

/// Renames unreadable checkpoints to `*.damaged`, so that they do not replace readable ones.
///
/// # Errors
/// A file cannot be renamed.
pub fn mark_damaged(skipped: &[(PathBuf, RunError)]) -> Result<(), RunError> {
    for (path, _) in skipped {
        let mut renamed = path.clone().into_os_string();
        renamed.push(".damaged");
        std::fs::rename(path, &renamed).map_err(|error| RunError::failed(path, error))?;
    }
    Ok(())
}

fn read(path: &Path, config: &RunConfig) -> Result<(TrainerState, Learner), RunError> {
    let file =
        File::open(path).map_err(|error| RunError::invalid_input(path, format!("can't be read: {error}")))?;
    read_from(BufReader::new(file), config).map_err(|why| RunError::invalid_input(path, why))
}

/// Whether the file at `path` is a checkpoint of a newer version of the format.
fn is_newer(path: &Path) -> bool {
    let header = File::open(path).map(|file| FORMAT.read::<TrainerState>(BufReader::new(file)));
    matches!(header, Ok(Err(HeaderError::Version { found })) if found > VERSION)
}

/// Reads what [`write_to`] wrote in a run with `config`. The contents are untrusted, even with valid checksums:
/// every value is checked.
///
/// # Errors
/// The file is invalid. The message describes the problem.
pub fn read_from(mut file: impl Read, config: &RunConfig) -> Result<(TrainerState, Learner), String> {
    let mut trainer_state: TrainerState = FORMAT.read(&mut file).map_err(header_error)?;
    trainer_state.distribute_extensions()?;
    trainer_state.check(config)?;
    let inputs = config.observation_layout().width(config.scenario.lidar.beams);
    let actions = config.preset.actions.len(config.scenario.robot.motions.len());
    let mut learner = Learner::restore(&config.preset.learning, inputs, actions, config.preset.arenas, file)
        .map_err(|error| error.to_string())?;
    set_mirror(&mut learner, config).map_err(|error| error.to_string())?;
    Ok((trainer_state, learner))
}

/// The message for an invalid header, which continues a sentence that starts with the file's path.
fn header_error(error: HeaderError) -> String {
    match error {
        HeaderError::Io(error) if error.kind() == ErrorKind::UnexpectedEof => {
            "is too short to be a checkpoint".into()
        }
        HeaderError::Io(error) => error.to_string(),
        HeaderError::WrongMagic => "is not a checkpoint of a run".into(),
        HeaderError::Version { found } if found > VERSION => {
            format!(
                "was written by a newer wayfield: it has checkpoint version {found}, but this wayfield reads version {VERSION}; \
                 help: resume with the newer wayfield, or start a new run"
            )
        }
        HeaderError::Version { found } => {
            format!(
                "has checkpoint version {found}, but this wayfield reads version {VERSION}; help: resume with the wayfield that \
                 wrote it, or start a new run"
            )
        }
        HeaderError::Corrupt(what) => format!("is damaged: {what}"),
    }
}

/// Restores `world`, which must already have its arenas, to `trainer_state`.
pub fn restore(world: &mut World, trainer_state: &TrainerState) {
    sim::restore(world, &trainer_state.arenas);
    world.resource_mut::<Decisions>().streams.clone_from(&trainer_state.exploration);
    *world.resource_mut::<TrainingStats>() = trainer_state.stats;
    if let Some(mut progress) = world.get_resource_mut::<LevelProgress>() {
        progress.restore(&trainer_state.level_results);
    }
}
