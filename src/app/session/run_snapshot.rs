//! A copy of the training run, from which its files are written. Training continues while they are written, because writing
//! takes much longer than copying.
//!
//! In: the world, between two control steps. Out: the files of a run folder.

use std::io::{self, Write};
#[cfg(not(target_arch = "wasm32"))]
use std::path::{Path, PathBuf};

use bevy::prelude::*;
use serde::Serialize;

use super::TrainingHistory;
use super::active_mode::ActiveMode;
use super::evaluations::Evaluations;
use super::journal::{JOURNAL, Journal};
use super::training_run::TrainingRun;
use crate::agent::ActiveLearner;
use crate::app::app_status::LastSession;
use crate::learning::Learner;
use crate::run::checkpoint::{self, TrainerState};
#[cfg(not(target_arch = "wasm32"))]
use crate::run::folder::RunFolder;
use crate::run::folder::{EPISODES_FILE, EVALUATIONS_FILE, POLICY_FILE, RunConfig, header};
use crate::run::metric_rows::SetColumns;
use crate::run::{RunError, metrics, shipped};
use crate::scenario::to_ron;

/// A function that writes the contents of a file.
pub(super) type WriteContents<'a> = &'a dyn Fn(&mut dyn Write) -> io::Result<()>;

/// A copy of the training run.
pub(super) struct RunSnapshot {
    pub(super) config: RunConfig,
    trainer_state: TrainerState,
    learner: Learner,
    journal: Journal,
    pub(super) initial_policy: Option<Vec<u8>>,
    last_policy: Vec<u8>,
    /// `episodes.csv`, without the `known_bytes` at its start that [`capture`](Self::capture) left out.
    episodes: Vec<u8>,
    evaluations: Vec<u8>,
}

impl RunSnapshot {
    /// A copy of the run in `world`, without the first `known_bytes` of `episodes.csv`. During a demo, a copy of the suspended
    /// training.
    ///
    /// # Errors
    /// The rows of the episodes could not be stored, or a policy cannot be saved.
    pub(super) fn capture(world: &mut World, known_bytes: u64) -> Result<Self, RunError> {
        world.resource_scope(|world, mut run: Mut<TrainingRun>| {
            let failed = |error: io::Error| RunError::Failed(error.to_string());
            let history = &mut world.resource_mut::<TrainingHistory>().0;
            let episodes = history.episodes_csv_from(known_bytes).map_err(failed)?;
            let evaluations = csv(&world.resource::<Evaluations>().rows, &run.config).map_err(failed)?;
            let wall_s = run.wall_s();
            let state = &mut run.trainer_state;
            state.episodes_bytes = known_bytes + episodes.len() as u64;
            state.evaluations_bytes = evaluations.len() as u64;
            state.wall_s = wall_s;
            world.resource_scope(|world, mode: Mut<ActiveMode>| mode.update_trainer_state(world, state));
            let initial_policy = run.initial_policy.as_ref().map(metrics::policy_bytes).transpose()?;
            Ok(Self {
                trainer_state: run.trainer_state.clone(),
                learner: world.resource::<ActiveLearner>().0.clone(),
                journal: world.resource::<Journal>().clone(),
                initial_policy,
                last_policy: metrics::policy_bytes(&metrics::policy(&run.config, world))?,
                config: run.config.clone(),
                episodes,
                evaluations,
            })
        })
    }

    /// The run as a session that has just been saved.
    pub(super) fn describe(&self) -> LastSession {
        LastSession {
            scenario: self.config.scenario_title().into(),
            preset: shipped::preset_title(&self.config.preset_from)
                .map_or_else(|| self.config.preset_name(), Into::into),
            seed: self.config.seed,
            env_steps: self.learner.env_steps(),
            age_s: 0,
        }
    }

    /// The length of the whole `episodes.csv`, in bytes.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn episodes_bytes(&self) -> u64 {
        self.trainer_state.episodes_bytes
    }

    /// Writes the run into the new folder `path`. The first bytes of `episodes.csv`, if this copy lacks them, are read from
    /// the `earlier` folder of the same run.
    ///
    /// # Errors
    /// The folder exists already, or a file cannot be written or read.
    #[cfg(not(target_arch = "wasm32"))]
    pub(super) fn write(&self, path: &Path, earlier: Option<PathBuf>) -> Result<(), RunError> {
        let folder = RunFolder::create(Some(path.into()), &self.config, self.initial_policy.as_deref())?;
        let known_bytes = self.trainer_state.episodes_bytes - self.episodes.len() as u64;
        let earlier = earlier.map(|folder| folder.join(EPISODES_FILE));
        self.each_file(|name, write| {
            folder.write(name, |file| {
                if let Some(earlier) = earlier.as_ref().filter(|_| name == EPISODES_FILE) {
                    copy_start(earlier, known_bytes, file)?;
                }
                write(file)
            })
        })
    }

    /// Calls `put` with the name and the contents of each file, except the two that [`RunFolder::create`] writes. The
    /// checkpoint comes last.
    pub(super) fn each_file(
        &self,
        mut put: impl FnMut(&str, WriteContents<'_>) -> Result<(), RunError>,
    ) -> Result<(), RunError> {
        let journal = to_ron(&self.journal).map_err(|error| RunError::Failed(error.to_string()))?;
        put(EPISODES_FILE, &|out| out.write_all(&self.episodes))?;
        put(EVALUATIONS_FILE, &|out| out.write_all(&self.evaluations))?;
        put("policy-last.safetensors", &|out| out.write_all(&self.last_policy))?;
        if let Some(best) = &self.trainer_state.best {
            put(POLICY_FILE, &|out| out.write_all(&best.bytes))?;
        }
        put(JOURNAL, &|out| out.write_all(journal.as_bytes()))?;
        put(checkpoint::LATEST, &|out| checkpoint::encode(out, &self.trainer_state, &self.learner))
    }
}

/// The rows of the run of `config` as CSV, with a header.
fn csv<Row: Serialize + Default + SetColumns>(rows: &[Row], config: &RunConfig) -> io::Result<Vec<u8>> {
    let scenarios: Vec<String> = config.member_names().map(String::from).collect();
    let mut bytes = header::<Row>(&Row::set_columns(&scenarios))?.into_bytes();
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(&mut bytes);
    let mut write = |row: &Row| writer.serialize((row, row.set_values(&scenarios)));
    rows.iter().try_for_each(&mut write).map_err(io::Error::other)?;
    writer.flush()?;
    drop(writer);
    Ok(bytes)
}

/// Copies the first `bytes` bytes of the file `from`.
#[cfg(not(target_arch = "wasm32"))]
fn copy_start(from: &Path, bytes: u64, to: &mut impl Write) -> io::Result<()> {
    let copied = io::copy(&mut io::Read::take(std::fs::File::open(from)?, bytes), to)?;
    if copied < bytes {
        return Err(io::Error::other(format!("{} has lost rows", from.display())));
    }
    Ok(())
}
