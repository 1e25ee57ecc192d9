//! Everything that a run needs to go on to the bit: `checkpoint/latest.bin`, and the two before it.
//!
//! In: the learner, the arenas, the streams, and where the records stand. Out: one file, written whole or not at all:
//! magic, version, length and CRC-32C of the head, the head (postcard: [`TrainerState`]), then the learner's own
//! checkpoint, which has a checksum of its own. Where the newest cannot be read, the one before is. A checksum tells of
//! accidents, not of intent: so all that is read is checked, too.

use std::collections::VecDeque;
use std::fs::File;
use std::io::{self, BufReader, ErrorKind, Read, Write};
use std::path::{Path, PathBuf};

use bevy::prelude::World;
use serde::{Deserialize, Serialize};

use super::RunError;
use super::folder::{RunConfig, RunFolder};
use super::metric_rows::Milestone;
use crate::agent::{ActiveLearner, Decisions, TrainingStats};
use crate::learning::{Learner, Policy};
use crate::random::{self, Stream};
use crate::sim;
use crate::task::{ArenaState, observation};

/// The last checkpoints, from the newest on. The first is there only for a moment, while the others move up.
const NAMES: [&str; 4] =
    ["checkpoint/next.bin", "checkpoint/latest.bin", "checkpoint/previous.bin", "checkpoint/older.bin"];
const MAGIC: &[u8; 8] = b"wayfrun\n";
/// Raised whenever an older reader would misread a newer file.
const VERSION: u32 = 4;
/// The most bytes a head may have: as many numbers as may be seen in all arenas, and a policy.
const MAX_HEAD_BYTES: u64 = (1 << 30) + (1 << 27);
/// The longest time that a checkpoint may name, in s: some 30,000 years.
const MAX_TIME_S: f64 = 1e12;

/// Where a run stands, beside its learner.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct TrainerState {
    /// Every arena.
    pub arenas: Vec<ArenaState>,
    /// What plugins added to every arena; empty without plugins.
    pub arena_extensions: Vec<ArenaExtension>,
    /// The exploration streams.
    pub exploration: Vec<Stream>,
    /// Sums over the gradient steps since the last row.
    pub stats: TrainingStats,
    /// Loss, TD error and Q of the last row.
    pub means: Option<(f64, f64, f64)>,
    /// Returns of the last episodes, at most 100.
    pub recent_returns: VecDeque<f64>,
    /// Length of `episodes.csv`.
    pub episodes_bytes: u64,
    /// Length of `evaluations.csv`.
    pub evaluations_bytes: u64,
    /// Evaluate when so many env steps are reached.
    pub next_evaluation: u64,
    /// Env steps at the last evaluation.
    pub evaluated_at: Option<u64>,
    /// Success rate of the last evaluation.
    pub last_success_rate: Option<f64>,
    /// The best policy so far.
    pub best: Option<BestPolicy>,
    /// When 96 % was first reached.
    pub first_96: Option<Milestone>,
    /// When 99 % was first reached.
    pub first_99: Option<Milestone>,
    /// Wall time used by then, in s.
    pub wall_s: f64,
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

/// The best policy so far: the latest of those whose mean time in their evaluation, a failure counted as the time limit,
/// is within [`BestPolicy::COST_TOLERANCE`] of the least. (So small a difference over some hundred episodes is chance, and of
/// two policies that are equal but for chance the one that learnt longer is the better bet.)
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BestPolicy {
    /// Share of episodes that succeeded, 0 to 1.
    pub success_rate: f64,
    /// Mean time of those, in s.
    pub mean_time_s: Option<f64>,
    /// Mean time of all, in s, a failure counted as the time limit.
    pub mean_cost_s: f64,
    /// The least such mean of any policy so far, in s.
    pub min_cost_s: f64,
    /// Its file.
    pub bytes: Vec<u8>,
}

impl BestPolicy {
    /// A mean time of up to so many times the least is as good as the least.
    pub const COST_TOLERANCE: f64 = 1.01;
}

/// Takes what the world holds into `trainer_state`, and writes the checkpoint.
///
/// # Errors
/// It cannot be written; the one before is still there.
pub fn save(folder: &RunFolder, world: &mut World, trainer_state: &mut TrainerState) -> Result<(), RunError> {
    folder.write(NAMES[0], |file| write_to(file, world, trainer_state))?;
    // Whenever this is cut short, all that are there are whole, and in order.
    for (from, to) in NAMES.iter().zip(&NAMES[1..]).rev() {
        let (from, to) = (folder.path().join(from), folder.path().join(to));
        match std::fs::rename(&from, &to) {
            Err(error) if error.kind() != ErrorKind::NotFound => return Err(RunError::failed(&to, error)),
            _ => {}
        }
    }
    Ok(())
}

/// Takes what the world holds into `trainer_state`, and writes both as the bytes of a checkpoint's file.
///
/// # Errors
/// The writer's.
pub fn write_to(mut file: impl Write, world: &mut World, trainer_state: &mut TrainerState) -> io::Result<()> {
    trainer_state.arenas = sim::snapshot(world);
    trainer_state.arena_extensions = trainer_state.arenas.iter().map(ArenaExtension::from_state).collect();
    if trainer_state.arena_extensions.iter().all(ArenaExtension::is_empty) {
        trainer_state.arena_extensions.clear();
    }
    trainer_state.exploration = world.resource::<Decisions>().streams.clone();
    trainer_state.stats = *world.resource::<TrainingStats>();
    let head = postcard::to_allocvec(trainer_state).map_err(io::Error::other)?;
    file.write_all(MAGIC)?;
    file.write_all(&VERSION.to_le_bytes())?;
    file.write_all(&(head.len() as u64).to_le_bytes())?;
    file.write_all(&crc32c::crc32c(&head).to_le_bytes())?;
    file.write_all(&head)?;
    world.resource::<ActiveLearner>().0.save(file).map_err(io::Error::other)
}

/// What was read of a run's checkpoints.
pub struct LoadedCheckpoint {
    /// Where the run stands.
    pub trainer_state: TrainerState,
    /// Its learner.
    pub learner: Learner,
    /// Newer checkpoints that could not be read, and why.
    pub skipped: Vec<(PathBuf, RunError)>,
}

/// Whether there is any checkpoint of the run in `folder`.
pub fn exists(folder: &Path) -> bool {
    NAMES.iter().any(|name| folder.join(name).exists())
}

/// Reads the newest of what [`save`] wrote that can be read.
///
/// # Errors
/// There is none; or all are damaged, or of another configuration: what is wrong with the newest.
pub fn load(folder: &RunFolder, config: &RunConfig) -> Result<LoadedCheckpoint, RunError> {
    let mut skipped = Vec::new();
    for path in NAMES.iter().map(|name| folder.path().join(name)).filter(|path| path.exists()) {
        match read(&path, config) {
            Ok((trainer_state, learner)) => return Ok(LoadedCheckpoint { trainer_state, learner, skipped }),
            Err(error) => skipped.push((path, error)),
        }
    }
    let newest = skipped.into_iter().next().map_or_else(
        || RunError::invalid_input(&folder.path().join(NAMES[1]), "no checkpoint to go on from"),
        |(_, error)| error,
    );
    Err(RunError::InvalidInput(format!("{newest} (restore the file if you have a copy, or train anew)")))
}

/// Puts aside what could not be read, so that it does not take the place of what can: under the same name, with `.damaged`
/// behind it.
///
/// # Errors
/// It cannot be renamed.
pub fn mark_damaged(skipped: &[(PathBuf, RunError)]) -> Result<(), RunError> {
    for (path, _) in skipped {
        let mut aside = path.clone().into_os_string();
        aside.push(".damaged");
        std::fs::rename(path, &aside).map_err(|error| RunError::failed(path, error))?;
    }
    Ok(())
}

fn read(path: &Path, config: &RunConfig) -> Result<(TrainerState, Learner), RunError> {
    let file =
        File::open(path).map_err(|error| RunError::invalid_input(path, format!("can't be read: {error}")))?;
    read_from(BufReader::new(file), config).map_err(|why| RunError::invalid_input(path, why))
}

/// What [`write_to`] wrote in a run of `config`. What a resumed run could not go on from is refused: nothing in the bytes
/// is believed, however good their checksums are.
///
/// # Errors
/// What is wrong with the file.
pub fn read_from(mut file: impl Read, config: &RunConfig) -> Result<(TrainerState, Learner), String> {
    let mut array = [0_u8; 24];
    file.read_exact(&mut array).map_err(|_| "is too short to be a checkpoint")?;
    let (magic, rest) = array.split_at(8);
    if magic != MAGIC {
        return Err("is no checkpoint of a run".into());
    }
    let version = u32::from_le_bytes([rest[0], rest[1], rest[2], rest[3]]);
    if version != VERSION {
        return Err(format!("is of checkpoint version {version}, but this wayfield reads version {VERSION}"));
    }
    let mut length = [0_u8; 8];
    length.copy_from_slice(&rest[4..12]);
    let length = u64::from_le_bytes(length);
    let crc = u32::from_le_bytes([rest[12], rest[13], rest[14], rest[15]]);
    if length > MAX_HEAD_BYTES {
        return Err("is damaged: its head is too long".into());
    }
    let mut head = Vec::new();
    (&mut file).take(length).read_to_end(&mut head).map_err(|error| error.to_string())?;
    if head.len() as u64 != length || crc32c::crc32c(&head) != crc {
        return Err("is damaged: the checksum of its head does not agree".into());
    }
    let trainer_state: TrainerState = postcard::from_bytes(&head).map_err(|_| "is damaged: its head")?;
    trainer_state.check(config)?;
    let inputs = observation::width(config.scenario.lidar.beams);
    let actions = config.scenario.robot.motions.len();
    let learner = Learner::restore(&config.preset.learning, inputs, actions, config.preset.arenas, file)
        .map_err(|error| error.to_string())?;
    Ok((trainer_state, learner))
}

impl TrainerState {
    /// Whether a run of `config` can go on from here.
    fn check(&self, config: &RunConfig) -> Result<(), String> {
        let arenas = config.preset.arenas;
        if self.arenas.len() != arenas || self.exploration.len() != arenas {
            return Err("is of another number of arenas than config.ron says".into());
        }
        for (number, arena) in self.arenas.iter().enumerate() {
            arena
                .check(&config.scenario, &config.observation_layout())
                .map_err(|what| format!("is damaged: {what} in arena {number} cannot be"))?;
        }
        let are = |values: &[f64]| values.iter().all(|value| value.is_finite());
        let TrainingStats { loss, td_error, q, .. } = self.stats;
        let share = |rate: f64| (0.0..=1.0).contains(&rate);
        let milestones = [self.first_96, self.first_99];
        for (what, sane) in [
            ("a stream by which it explores", self.exploration.iter().all(random::is_valid)),
            ("its sums over gradient steps", are(&[loss, td_error, q])),
            ("its last row", self.means.is_none_or(|(a, b, c)| are(&[a, b, c]))),
            (
                "its last returns",
                self.recent_returns.len() <= 100 && self.recent_returns.iter().all(|value| value.is_finite()),
            ),
            ("its next evaluation", self.next_evaluation <= 1 << 62),
            ("its last success rate", self.last_success_rate.is_none_or(share)),
            ("its best policy", self.best.as_ref().is_none_or(BestPolicy::is_valid)),
            ("its milestones", milestones.iter().flatten().all(|milestone| milestone.wall_s.is_finite())),
            ("its wall time", (0.0..=MAX_TIME_S).contains(&self.wall_s)),
        ] {
            if !sane {
                return Err(format!("is damaged: {what} cannot be"));
            }
        }
        Ok(())
    }
}

impl BestPolicy {
    /// Whether it is a policy, and its numbers are such as evaluations give.
    fn is_valid(&self) -> bool {
        let times = [self.mean_cost_s, self.min_cost_s].into_iter().chain(self.mean_time_s);
        (0.0..=1.0).contains(&self.success_rate)
            && times.into_iter().all(|time| (0.0..=MAX_TIME_S).contains(&time))
            && Policy::from_bytes(&self.bytes).is_ok()
    }
}

/// Puts a populated world back to where `trainer_state` was taken.
pub fn restore(world: &mut World, trainer_state: &TrainerState) {
    sim::restore(world, &trainer_state.arenas);
    world.resource_mut::<Decisions>().streams.clone_from(&trainer_state.exploration);
    *world.resource_mut::<TrainingStats>() = trainer_state.stats;
}
