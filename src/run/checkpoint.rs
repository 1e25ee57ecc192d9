//! Checkpoints of a run: everything that a resumed run needs to continue bit-identically.
//!
//! In: the learner, the arenas, the random streams, the lengths of the CSV files. Out: `checkpoint/latest.bin`, written
//! atomically, and the two checkpoints before it. If the newest cannot be read, the next older one is used.
//!
//! A file holds the magic bytes, the version, the length and CRC-32C of the head, the head ([`TrainerState`] as postcard),
//! and the learner's checkpoint, which has a separate checksum. Checksums detect accidental damage only, so every value is
//! also checked after it is read.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use bevy::prelude::World;
use serde::{Deserialize, Serialize};

use super::RunError;
use super::folder::{RunConfig, RunFolder};
use super::limits::{MAX_HEAD_BYTES, MAX_RECENT_RETURNS, MAX_TIME_S};
use super::metric_rows::Milestone;
use crate::agent::{ActiveLearner, Decisions, TrainingStats};
use crate::learning::framing::{HeaderError, HeaderFormat};
use crate::learning::{Learner, Policy};
use crate::random::{self, Stream};
use crate::sim;
use crate::task::ArenaState;

/// The files of the checkpoints, newest first. `next.bin` exists only until the others are renamed.
const NAMES: [&str; 4] =
    ["checkpoint/next.bin", "checkpoint/latest.bin", "checkpoint/previous.bin", "checkpoint/older.bin"];
/// The version of the format. It increases whenever an older reader would misread a newer file.
pub const VERSION: u32 = 4;
const FORMAT: HeaderFormat =
    HeaderFormat { magic: b"wayfrun\n", version: VERSION, max_bytes: MAX_HEAD_BYTES, checksum: true };

/// The state of a run, apart from its learner.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TrainerState {
    /// The arenas.
    pub arenas: Vec<ArenaState>,
    /// The random streams of exploration, one per arena.
    pub exploration: Vec<Stream>,
    /// Sums over the gradient steps since the last row of `episodes.csv`.
    pub stats: TrainingStats,
    /// Mean loss, TD error and Q-value in the last row.
    pub means: Option<(f64, f64, f64)>,
    /// Returns of the last episodes, at most [`MAX_RECENT_RETURNS`].
    pub recent_returns: VecDeque<f64>,
    /// Length of `episodes.csv` in bytes.
    pub episodes_bytes: u64,
    /// Length of `evaluations.csv` in bytes.
    pub evaluations_bytes: u64,
    /// Env steps at which the next evaluation is due.
    pub next_evaluation: u64,
    /// Env steps at the last evaluation; `None` before the first.
    pub evaluated_at: Option<u64>,
    /// Success rate of the last evaluation, 0 to 1.
    pub last_success_rate: Option<f64>,
    /// The best policy so far.
    pub best: Option<BestPolicy>,
    /// When a success rate of 96 % was first reached.
    pub first_96: Option<Milestone>,
    /// When a success rate of 99 % was first reached.
    pub first_99: Option<Milestone>,
    /// Wall time up to this checkpoint, in s, over all processes of the run.
    pub wall_s: f64,
    /// What plugins added to every arena; empty without plugins.
    pub arena_extensions: Vec<ArenaExtension>,
}

/// What plugins added to one arena: the sensors' readings and the sums of reward terms in the running episode.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct ArenaExtension {
    /// The sensors' readings.
    pub readings: Vec<f32>,
    /// The sums of the reward terms.
    pub extra_rewards: Vec<f32>,
}

impl ArenaExtension {
    fn from_state(state: &ArenaState) -> Self {
        Self { readings: state.readings.clone(), extra_rewards: state.episode.extra_rewards.clone() }
    }

    fn is_empty(&self) -> bool {
        self.readings.is_empty() && self.extra_rewards.is_empty()
    }
}

/// The best policy so far: the latest one whose mean cost is within [`BestPolicy::COST_TOLERANCE`] of the minimum.
///
/// The cost of an episode is its simulated time; a failure costs the whole time limit. A smaller difference over some
/// hundred episodes is noise, and of two equally good policies the one trained longer is the better bet.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BestPolicy {
    /// Share of episodes that succeeded, 0 to 1.
    pub success_rate: f64,
    /// Mean simulated time of those, in s.
    pub mean_time_s: Option<f64>,
    /// Mean cost of all episodes, in s.
    pub mean_cost_s: f64,
    /// Minimum mean cost of all policies so far, in s.
    pub min_cost_s: f64,
    /// The contents of the policy file.
    pub bytes: Vec<u8>,
}

impl BestPolicy {
    /// Policies count as equally good up to this multiple of the minimum mean cost.
    pub const COST_TOLERANCE: f64 = 1.01;
}

/// Updates `trainer_state` from `world` and writes a checkpoint.
///
/// # Errors
/// The checkpoint cannot be written; the previous one is kept.
pub fn save(folder: &RunFolder, world: &mut World, trainer_state: &mut TrainerState) -> Result<(), RunError> {
    folder.write(NAMES[0], |file| write_to(file, world, trainer_state))?;
    // From the oldest to the newest: whenever this is interrupted, all files are complete and in order.
    for (from, to) in NAMES.iter().zip(&NAMES[1..]).rev() {
        let (from, to) = (folder.path().join(from), folder.path().join(to));
        match std::fs::rename(&from, &to) {
            Err(error) if error.kind() != ErrorKind::NotFound => return Err(RunError::failed(&to, error)),
            _ => {}
        }
    }
    Ok(())
}

/// Updates `trainer_state` from `world` and writes the contents of a checkpoint to `file`.
///
/// # Errors
/// `file` cannot be written.
pub fn write_to(mut file: impl Write, world: &mut World, trainer_state: &mut TrainerState) -> io::Result<()> {
    trainer_state.arenas = sim::snapshot(world);
    trainer_state.collect_extensions();
    trainer_state.exploration = world.resource::<Decisions>().streams.clone();
    trainer_state.stats = *world.resource::<TrainingStats>();
    FORMAT.write(&mut file, trainer_state)?;
    world.resource::<ActiveLearner>().0.save(file).map_err(io::Error::other)
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
/// There is no checkpoint, or none is valid for `config`. The message describes the newest.
pub fn load(folder: &RunFolder, config: &RunConfig) -> Result<LoadedCheckpoint, RunError> {
    let mut skipped = Vec::new();
    for path in NAMES.iter().map(|name| folder.path().join(name)).filter(|path| path.exists()) {
        match read(&path, config) {
            Ok((trainer_state, learner)) => return Ok(LoadedCheckpoint { trainer_state, learner, skipped }),
            Err(error) => skipped.push((path, error)),
        }
    }
    let newest = skipped.into_iter().next().map_or_else(
        || RunError::invalid_input(&folder.path().join(NAMES[1]), "there is no checkpoint to resume from"),
        |(_, error)| error,
    );
    Err(RunError::InvalidInput(format!("{newest}; help: restore the file from a copy, or start a new run")))
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

/// Reads what [`write_to`] wrote in a run of `config`. The contents are untrusted, even with valid checksums: every value
/// is checked.
///
/// # Errors
/// What is wrong with the file.
pub fn read_from(mut file: impl Read, config: &RunConfig) -> Result<(TrainerState, Learner), String> {
    let mut trainer_state: TrainerState = FORMAT.read(&mut file).map_err(header_error)?;
    trainer_state.distribute_extensions()?;
    trainer_state.check(config)?;
    let inputs = config.observation_layout().width(config.scenario.lidar.beams);
    let actions = config.scenario.robot.motions.len();
    let learner = Learner::restore(&config.preset.learning, inputs, actions, config.preset.arenas, file)
        .map_err(|error| error.to_string())?;
    Ok((trainer_state, learner))
}

/// What is wrong with the header of a checkpoint, as the end of a sentence that starts with the file's path.
fn header_error(error: HeaderError) -> String {
    match error {
        HeaderError::Io(error) if error.kind() == ErrorKind::UnexpectedEof => {
            "is too short to be a checkpoint".into()
        }
        HeaderError::Io(error) => error.to_string(),
        HeaderError::WrongMagic => "is not a checkpoint of a run".into(),
        HeaderError::Version { found } => {
            format!("has checkpoint version {found}, but this wayfield reads version {VERSION}")
        }
        HeaderError::Corrupt(what) => format!("is damaged: {what}"),
    }
}

impl TrainerState {
    /// Collects what plugins added to the arenas, which the arenas' own bytes leave out.
    fn collect_extensions(&mut self) {
        self.arena_extensions = self.arenas.iter().map(ArenaExtension::from_state).collect();
        if self.arena_extensions.iter().all(ArenaExtension::is_empty) {
            self.arena_extensions.clear();
        }
    }

    /// Gives the arenas back what plugins added to them.
    fn distribute_extensions(&mut self) -> Result<(), String> {
        if !self.arena_extensions.is_empty() && self.arena_extensions.len() != self.arenas.len() {
            return Err("is damaged: it holds plugin data of another number of arenas".into());
        }
        for (arena, extension) in self.arenas.iter_mut().zip(&self.arena_extensions) {
            arena.readings.clone_from(&extension.readings);
            arena.episode.extra_rewards.clone_from(&extension.extra_rewards);
        }
        self.collect_extensions();
        Ok(())
    }

    /// Checks that a run of `config` can continue from this state.
    fn check(&self, config: &RunConfig) -> Result<(), String> {
        let arenas = config.preset.arenas;
        if self.arenas.len() != arenas || self.exploration.len() != arenas {
            return Err("has a different number of arenas than config.ron".into());
        }
        for (number, arena) in self.arenas.iter().enumerate() {
            arena
                .check(&config.scenario, &config.observation_layout())
                .map_err(|what| format!("is damaged: arena {number} has an invalid value for {what}"))?;
        }
        let finite = |values: &[f64]| values.iter().all(|value| value.is_finite());
        let TrainingStats { loss, td_error, q, .. } = self.stats;
        let is_share = |rate: f64| (0.0..=1.0).contains(&rate);
        let milestones = [self.first_96, self.first_99];
        for (what, is_valid) in [
            ("a random stream of exploration", self.exploration.iter().all(random::is_valid)),
            ("the sums over gradient steps", finite(&[loss, td_error, q])),
            ("the means of the last row", self.means.is_none_or(|(a, b, c)| finite(&[a, b, c]))),
            (
                "the recent returns",
                self.recent_returns.len() <= MAX_RECENT_RETURNS
                    && self.recent_returns.iter().all(|value| value.is_finite()),
            ),
            ("the next evaluation", self.next_evaluation <= 1 << 62),
            ("the last success rate", self.last_success_rate.is_none_or(is_share)),
            ("the best policy", self.best.as_ref().is_none_or(BestPolicy::is_valid)),
            ("the milestones", milestones.iter().flatten().all(|milestone| milestone.wall_s.is_finite())),
            ("the wall time", (0.0..=MAX_TIME_S).contains(&self.wall_s)),
        ] {
            if !is_valid {
                return Err(format!("is damaged: invalid value for {what}"));
            }
        }
        Ok(())
    }
}

impl BestPolicy {
    /// Whether the policy can be read and the numbers are possible results of an evaluation.
    fn is_valid(&self) -> bool {
        let times = [self.mean_cost_s, self.min_cost_s].into_iter().chain(self.mean_time_s);
        (0.0..=1.0).contains(&self.success_rate)
            && times.into_iter().all(|time| (0.0..=MAX_TIME_S).contains(&time))
            && Policy::from_bytes(&self.bytes).is_ok()
    }
}

/// Restores `world`, which must already have its arenas, to `trainer_state`.
pub fn restore(world: &mut World, trainer_state: &TrainerState) {
    sim::restore(world, &trainer_state.arenas);
    world.resource_mut::<Decisions>().streams.clone_from(&trainer_state.exploration);
    *world.resource_mut::<TrainingStats>() = trainer_state.stats;
}
