//! A training begun in the window: anew, from a policy's weights, or from a checkpoint.
//!
//! In: names or files. Out: a [`Session`] in place of the one before, and its arenas at their first observation. If
//! something cannot be used, all stays as it was.

use std::path::Path;
use std::sync::Arc;

use bevy::platform::cell::SyncCell;
use bevy::platform::time::Instant;
use bevy::prelude::*;

use super::advance::WARNING_PREFIX;
#[cfg(not(target_arch = "wasm32"))]
use super::file_watch;
use super::journal::{self, Journal};
use super::modes::{self, Rounds};
use super::pacer::Pacer;
use super::scenario_changes::load_source;
use super::trails::Trails;
use super::{Session, StartOptions, Throughput, TrainingHistory};
use crate::app::app_snapshot::Severity;
use crate::app::commands::SessionMode;
use crate::learning::{Learner, Policy};
use crate::run::background_evaluator::BackgroundEvaluator;
use crate::run::checkpoint::{self, LoadedCheckpoint, TrainerState};
use crate::run::folder::{RunConfig, RunFolder, Transfer};
use crate::run::metric_rows::{EpisodeRow, EvaluationRow};
use crate::run::{RunError, metrics, training_setup};
use crate::scenario::Scenario;

/// A training that could begin.
struct Beginning {
    config: RunConfig,
    init: Option<Policy>,
    learner: Learner,
    trainer_state: TrainerState,
}

/// The first session of the process. What was asked for was checked before; where it cannot be used all the same, the
/// default begins, with a notice.
pub(super) fn first_session(world: &mut World, first: &StartOptions) {
    let usual = StartOptions::default();
    let asked = from_nothing(&first.scenario, &first.preset, first.seed);
    let problem = asked.as_ref().err().map(ToString::to_string);
    let instead = |preset: &str| from_nothing(&usual.scenario, preset, first.seed);
    match asked.or_else(|_| instead(&first.preset)).or_else(|_| instead(&usual.preset)) {
        Ok(beginning) => {
            let mut session = session(world, beginning, Pacer::new(first.pace, first.paused));
            session.list_user_files();
            world.insert_resource(session);
        }
        // What is compiled in can be used: a test sees to it.
        Err(error) => error!("{error}"),
    }
    world.try_resource_scope(|world, mut session: Mut<Session>| {
        for problem in first.invalid_options.iter().cloned().chain(problem) {
            session.notify(Severity::Error, problem);
        }
        if first.edit && session.config.scenario_from != first.scenario {
            // It cannot be driven in, as was told, but perhaps be mended.
            let _ = session.open_in_editor(Path::new(&first.scenario));
        }
        #[cfg(not(target_arch = "wasm32"))]
        session.retry_when_fixed(&first.scenario, file_watch::RetryAction::StartTraining);
        if let Some(path) = &first.open {
            session.open_or_notify(world, path);
        }
    });
}

fn prepare(config: RunConfig, init: Option<Policy>) -> Result<Beginning, RunError> {
    let learner = training_setup::create_learner(&config, init.as_ref())?;
    let trainer_state =
        TrainerState { next_evaluation: config.preset.evaluation.every_env_steps, ..TrainerState::default() };
    Ok(Beginning { config, init, learner, trainer_state })
}

fn from_nothing(scenario: &str, preset: &str, seed: u64) -> Result<Beginning, RunError> {
    prepare(RunConfig::resolve(scenario, preset, seed)?, None)
}

/// The session of `beginning`, whose arenas it puts in place of whatever there is.
fn session(world: &mut World, beginning: Beginning, pacer: Pacer) -> Session {
    let Beginning { config, init, learner, trainer_state } = beginning;
    let scenario = Arc::new(config.scenario.clone());
    training_setup::start_training(world, &scenario, &config.preset, config.seed, learner);
    world.resource_mut::<Trails>().restart(config.preset.arenas);
    world.resource_mut::<TrainingHistory>().0.clear();
    Session {
        evaluator: SyncCell::new(evaluator(&config, &scenario)),
        journal: Journal::new(config.clone()),
        previous_wall_s: trainer_state.wall_s,
        loaded_scenario: load_source(&config.scenario_from).unwrap_or_else(|| config.scenario.clone()),
        saved_scenario: None,
        draft: None,
        pending_scenario: None,
        #[cfg(not(target_arch = "wasm32"))]
        file_watches: file_watch::FileWatches::new(&config.scenario_from),
        scenario,
        config,
        trainer_state,
        init,
        mode: SessionMode::Train,
        pacer,
        opened_policy: None,
        notices: Vec::new(),
        user_scenarios: Vec::new(),
        user_presets: Vec::new(),
        throughput: Throughput::default(),
        evaluations: Vec::new(),
        evaluating: false,
        evaluator_is_stale: false,
        suspended: None,
        rounds: Rounds::default(),
        broken: false,
        saved_at: None,
        open_requested_once: None,
        overwrite_requested: None,
        began: Instant::now(),
    }
}

/// Who examines the policies of a training in `scenario`.
pub(super) fn evaluator(config: &RunConfig, scenario: &Arc<Scenario>) -> BackgroundEvaluator {
    let seed = metrics::evaluation_seed(config.seed);
    BackgroundEvaluator::new(scenario, config.preset.evaluation.episodes, seed, &config.extensions)
}

impl Session {
    /// Puts `beginning` in place of this training; what the user has opened and told stays.
    fn replace(&mut self, world: &mut World, beginning: Beginning) {
        let mut pacer = self.pacer.clone();
        pacer.pace = self.suspended.as_ref().map_or(pacer.pace, modes::SuspendedTraining::pace);
        let new = session(world, beginning, pacer);
        let old = std::mem::replace(self, new);
        self.opened_policy = old.opened_policy;
        self.notices = old.notices;
        self.retract_notice(WARNING_PREFIX);
        self.user_scenarios = old.user_scenarios;
        self.user_presets = old.user_presets;
        self.throughput = old.throughput;
        self.saved_scenario = old.saved_scenario;
        self.draft = old.draft;
        self.list_user_files();
    }

    /// A new training from nothing.
    ///
    /// # Errors
    /// The scenario or the preset cannot be used.
    pub(super) fn start_training(
        &mut self,
        world: &mut World,
        scenario: &str,
        preset: &str,
        seed: u64,
    ) -> Result<(), RunError> {
        let beginning = from_nothing(scenario, preset, seed)?;
        self.pacer.paused = false;
        self.replace(world, beginning);
        Ok(())
    }

    /// A new training of the same preset and seed from nothing, in `scenario`, which is asked for by `from`.
    ///
    /// # Errors
    /// The preset does not fit.
    pub(super) fn start_in_scenario(
        &mut self,
        world: &mut World,
        scenario: Scenario,
        from: String,
    ) -> Result<(), RunError> {
        let mut config = self.config.clone();
        config.scenario = scenario;
        config.scenario_from = from;
        config.transfer = None;
        let beginning = prepare(config, None)?;
        self.pacer.paused = false;
        self.replace(world, beginning);
        Ok(())
    }

    /// A new training of the same preset and seed from `policy`, which is called `name`; in another scenario, if there is
    /// one.
    ///
    /// # Errors
    /// The policy does not fit.
    pub(super) fn start_from_policy(
        &mut self,
        world: &mut World,
        scenario: Option<(&str, Scenario)>,
        (name, policy): (String, Policy),
        epsilon: f32,
    ) -> Result<(), RunError> {
        let mut config = self.config.clone();
        if let Some((from, scenario)) = scenario {
            config.scenario_from = from.into();
            config.scenario = scenario;
        }
        config.transfer = Some(Transfer { policy: name, epsilon: Some(epsilon.clamp(0.0, 1.0)) });
        let beginning = prepare(config, Some(policy))?;
        self.replace(world, beginning);
        Ok(())
    }

    /// The training in the run's folder at `path` goes on.
    ///
    /// # Errors
    /// It holds no run, or one that cannot be used.
    pub(super) fn resume(&mut self, world: &mut World, path: &Path) -> Result<(), RunError> {
        let (folder, config) = RunFolder::open(path)?;
        let LoadedCheckpoint { trainer_state, learner, skipped } = checkpoint::load(&folder, &config)?;
        let rows: Vec<EpisodeRow> = folder.rows("episodes.csv")?;
        let mut evaluations: Vec<EvaluationRow> = folder.rows("evaluations.csv")?;
        let (known, env_steps) = (learner.episodes(), learner.env_steps());
        let journal = Journal::load(&folder, &config, &learner)?;
        // It goes on without knowing what it started from; only a replay would not.
        let init = journal::initial_policy(&folder, &journal.begun).ok().flatten();
        self.replace(world, Beginning { config, init, learner, trainer_state });
        self.journal = journal;
        self.saved_at = Some(env_steps);
        checkpoint::restore(world, &self.trainer_state);
        let curves = &mut world.resource_mut::<TrainingHistory>().0;
        rows.iter().filter(|row| row.episode <= known).for_each(|row| curves.push_episode(row));
        evaluations.retain(|row| row.env_steps <= env_steps);
        evaluations.iter().for_each(|row| curves.push_evaluation(row));
        self.evaluations = evaluations;
        for (_, error) in skipped {
            self.notify(Severity::Error, format!("{error}; the checkpoint before it is taken instead"));
        }
        Ok(())
    }
}
