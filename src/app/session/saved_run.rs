//! A saved run, read and checked completely before it replaces the current training run.
//!
//! In: a run folder, or in a browser the files of an autosave. Both may come from anywhere, so every value is checked. Out: the
//! training run, continued where it was saved.

#[cfg(target_arch = "wasm32")]
use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use bevy::prelude::*;
#[cfg(target_arch = "wasm32")]
use serde::de::DeserializeOwned;

use super::TrainingHistory;
use super::evaluations::Evaluations;
#[cfg(target_arch = "wasm32")]
use super::journal::JOURNAL;
use super::journal::{self, Journal};
use super::notices::{NoticeTopic, notify};
use super::scenario_changes::SCENARIO_CHANGED;
use super::start_training::{PreparedTraining, replace};
use super::training_run::TrainingRun;
use crate::app::app_status::Severity;
use crate::learning::Learner;
#[cfg(target_arch = "wasm32")]
use crate::limits::MAX_CONFIG_BYTES;
use crate::policy::Policy;
use crate::run::checkpoint::{self, LoadedCheckpoint, TrainerState};
#[cfg(target_arch = "wasm32")]
use crate::run::folder::INITIAL_POLICY_FILE;
use crate::run::folder::{EPISODES_FILE, EVALUATIONS_FILE, RunConfig, RunFolder};
use crate::run::metric_rows::{EpisodeRow, EvaluationRow};
#[cfg(target_arch = "wasm32")]
use crate::run::metric_rows::{SetColumns, parse_rows};
use crate::run::{RunError, without_help};
#[cfg(target_arch = "wasm32")]
use crate::scenario::parse_ron_with_limit;
use crate::simulation::Extensions;

/// A saved run.
pub(super) struct SavedRun {
    config: RunConfig,
    trainer_state: TrainerState,
    learner: Learner,
    initial_policy: Option<Policy>,
    journal: Journal,
    episodes: Vec<EpisodeRow>,
    evaluations: Vec<EvaluationRow>,
    /// Newer checkpoints that could not be read, with the errors.
    skipped: Vec<(PathBuf, RunError)>,
}

impl SavedRun {
    /// The run in the folder at `path`. Its plugins must be `extensions`.
    ///
    /// # Errors
    /// The folder has no run, or an invalid one.
    pub(super) fn from_folder(path: &Path, extensions: &Extensions) -> Result<Self, RunError> {
        let (folder, config) = RunFolder::open(path)?;
        let config = config.resume_with_extensions(extensions, path)?;
        let scenarios: Vec<String> = config.member_names().map(String::from).collect();
        let LoadedCheckpoint { trainer_state, learner, skipped } = checkpoint::load(&folder, &config)?;
        let journal = Journal::load(&folder, &config, &learner)?;
        Ok(Self {
            // A missing initial policy prevents a replay, but not resuming.
            initial_policy: journal::initial_policy(&folder, &journal.config).ok().flatten(),
            episodes: folder.rows_of_set(EPISODES_FILE, trainer_state.episodes_bytes, &scenarios)?,
            // Without the evaluation that a finished run makes after its last checkpoint: a continued run makes none there.
            evaluations: folder.rows_of_set(EVALUATIONS_FILE, trainer_state.evaluations_bytes, &scenarios)?,
            config,
            trainer_state,
            learner,
            journal,
            skipped,
        })
    }

    /// The run in `files`, given by name. Its plugins must be `extensions`.
    ///
    /// # Errors
    /// A file is missing or invalid.
    #[cfg(target_arch = "wasm32")]
    pub(super) fn from_files(
        files: &BTreeMap<String, Vec<u8>>,
        extensions: &Extensions,
    ) -> Result<Self, RunError> {
        let bytes = |name: &str| {
            let missing = || RunError::invalid_input(Path::new(name), "is missing from the autosave");
            files.get(name).ok_or_else(missing)
        };
        let text = |name: &str| {
            str::from_utf8(bytes(name)?).map_err(|error| RunError::invalid_input(Path::new(name), error))
        };
        let config: RunConfig =
            parse_ron_with_limit(text(RunFolder::CONFIG_FILE)?, RunFolder::CONFIG_FILE, MAX_CONFIG_BYTES)?;
        let problem = config.diagnostics().first().map(ToString::to_string);
        let problem = problem.map_or_else(|| config.check_memory(), Err);
        problem.map_err(|why| RunError::invalid_input(Path::new(RunFolder::CONFIG_FILE), why))?;
        let config = config.resume_with_extensions(extensions, Path::new(RunFolder::CONFIG_FILE))?;
        let scenarios: Vec<String> = config.member_names().map(String::from).collect();
        let (trainer_state, learner) = checkpoint::read_from(&bytes(checkpoint::LATEST)?[..], &config)
            .map_err(|why| RunError::invalid_input(Path::new(checkpoint::LATEST), why))?;
        let journal = Journal::parse(Some(text(JOURNAL)?), Path::new(JOURNAL), &config, &learner)?;
        let initial_policy = files.get(INITIAL_POLICY_FILE).and_then(|bytes| Policy::from_bytes(bytes).ok());
        Ok(Self {
            episodes: rows(EPISODES_FILE, bytes(EPISODES_FILE)?, &scenarios)?,
            evaluations: rows(EVALUATIONS_FILE, bytes(EVALUATIONS_FILE)?, &scenarios)?,
            initial_policy: initial_policy.filter(|_| journal.config.transfer.is_some()),
            config,
            trainer_state,
            learner,
            journal,
            skipped: Vec::new(),
        })
    }

    /// Continues the run in place of the current training run.
    pub(super) fn start(self, world: &mut World) {
        let Self {
            config,
            trainer_state,
            learner,
            initial_policy,
            journal,
            episodes,
            mut evaluations,
            skipped,
        } = self;
        let (last_episode, env_steps) = (learner.episodes(), learner.env_steps());
        replace(world, PreparedTraining { config, initial_policy, learner, trainer_state });
        world.insert_resource(journal);
        world.resource_scope(|world, mut run: Mut<TrainingRun>| {
            run.mark_saved(env_steps);
            checkpoint::restore(world, &run.trainer_state);
        });
        let curves = &mut world.resource_mut::<TrainingHistory>().0;
        episodes.iter().filter(|row| row.episode <= last_episode).for_each(|row| curves.push_episode(row));
        evaluations.retain(|row| row.env_steps <= env_steps);
        evaluations.iter().for_each(|row| curves.push_evaluation(row));
        world.resource_mut::<Evaluations>().rows = evaluations;
        world.resource_scope(|world, journal: Mut<Journal>| {
            let curves = &mut world.resource_mut::<TrainingHistory>().0;
            journal
                .scenario_changes()
                .for_each(|env_steps| curves.annotate(env_steps, SCENARIO_CHANGED.into()));
        });
        for (_, error) in skipped {
            let error = error.to_string();
            // Its help is about a run without a readable checkpoint.
            let why = without_help(&error);
            let text = format!("{why}\nAn older checkpoint was used instead");
            notify(world, NoticeTopic::General, Severity::Error, text);
        }
    }
}

/// The rows of the CSV file `name`, with the columns of a set whose scenarios have the names `scenarios`.
#[cfg(target_arch = "wasm32")]
fn rows<Row: DeserializeOwned + SetColumns>(
    name: &str,
    bytes: &[u8],
    scenarios: &[String],
) -> Result<Vec<Row>, RunError> {
    parse_rows(bytes, scenarios).map_err(|error| RunError::invalid_input(Path::new(name), error))
}
