//! Starts training runs in the app: from random weights or from a policy. `saved_run.rs` resumes saved ones.
//!
//! In: names or files. Out: a new [`TrainingRun`] in place of the previous one, with its arenas reset. After an error,
//! nothing has changed.

use std::sync::Arc;

use bevy::prelude::*;

use super::TrainingHistory;
use super::active_mode::ActiveMode;
use super::autosave;
use super::evaluations::Evaluations;
#[cfg(not(target_arch = "wasm32"))]
use super::file_watch::{self, FileWatches, RetryAction};
use super::journal::Journal;
use super::notices::{NoticeTopic, Notices, notify};
use super::open::{self, OpenedFiles};
use super::pacer::Pacer;
use super::run_notices;
use super::scenario_source::ScenarioSource;
use super::session_policy;
use super::trails::Trails;
use super::training_run::TrainingRun;
use crate::agent::ActiveLearner;
use crate::app::app_status::Severity;
use crate::app::commands::PolicySource;
use crate::app::history::History;
use crate::learning::Learner;
use crate::policy::Policy;
use crate::run::checkpoint::TrainerState;
use crate::run::folder::{RunConfig, Transfer};
use crate::run::provenance::{COMMIT, VERSION};
use crate::run::settings::Settings;
use crate::run::{RunError, policy_card, shipped, training_setup};
use crate::scenario::{Scenario, ScenarioSet};
use crate::simulation::Extensions;
use crate::task::ScenarioPool;

/// A training run that is ready to start.
pub(super) struct PreparedTraining {
    pub(super) config: RunConfig,
    pub(super) initial_policy: Option<Policy>,
    pub(super) learner: Learner,
    pub(super) trainer_state: TrainerState,
}

/// The topic of the notice that training could not start in `scenario`; `is_broken` if its file is invalid.
pub(super) fn scenario_topic(scenario: &str, is_broken: bool) -> NoticeTopic {
    if is_broken { NoticeTopic::File(scenario.into()) } else { NoticeTopic::General }
}

/// Prepares the training run of `config`, which may come from a saved run of another version of wayfield.
fn prepare(mut config: RunConfig, initial_policy: Option<Policy>) -> Result<PreparedTraining, RunError> {
    config.version = VERSION.into();
    config.commit = COMMIT.map(String::from);
    let learner = training_setup::create_learner(&config, initial_policy.as_ref())?;
    Ok(PreparedTraining { config, initial_policy, learner, trainer_state: TrainerState::default() })
}

/// Prepares a training run from random weights, with `settings` applied to the preset.
///
/// # Errors
/// The scenario, the preset or a setting is invalid.
pub(super) fn prepare_new(
    scenario: &str,
    preset: &str,
    settings: &Settings,
    seed: u64,
    extensions: &Extensions,
) -> Result<PreparedTraining, RunError> {
    let mut config = RunConfig::resolve(scenario, preset, seed)?.with_extensions(extensions);
    settings.apply_to_preset(&mut config.preset)?;
    prepare(config, None)
}

/// Inserts the resources of a prepared training run, and replaces the arenas.
pub(super) fn insert_run(world: &mut World, prepared: PreparedTraining) {
    let PreparedTraining { config, initial_policy, learner, trainer_state } = prepared;
    let scenario = Arc::new(config.scenario.clone());
    match &config.scenario_set {
        Some(set) => world.insert_resource(ScenarioPool::new(set)),
        None => drop(world.remove_resource::<ScenarioPool>()),
    }
    training_setup::start_training(world, &scenario, &config.preset, config.seed, learner);
    world.resource_mut::<Trails>().restart(config.preset.arenas);
    let scenarios: Vec<String> = config.member_names().map(String::from).collect();
    world.resource_mut::<TrainingHistory>().0 = History::of_set(&scenarios);
    world.insert_resource(Evaluations::new(&config, &scenario));
    world.insert_resource(Journal::new(config.clone()));
    world.insert_resource(ScenarioSource::new(&config));
    #[cfg(not(target_arch = "wasm32"))]
    world.insert_resource(match &config.scenario_set {
        // The scenarios of a set come from several files.
        Some(_) => FileWatches::default(),
        None => FileWatches::new(&config.scenario_from),
    });
    world.insert_resource(ActiveMode::Train);
    world.insert_resource(TrainingRun::new(config, initial_policy, trainer_state));
}

/// Replaces the current training run. Keeps what the user has opened or saved, and the notices that are not about the run.
pub(super) fn replace(world: &mut World, prepared: PreparedTraining) {
    if let Some(pace) = world.resource::<ActiveMode>().suspended_pace() {
        world.resource_mut::<Pacer>().pace = pace;
    }
    let env_steps = world.resource::<ActiveLearner>().0.env_steps();
    let keep = world.resource::<TrainingRun>().would_lose_training(env_steps);
    autosave::end_training(world, keep);
    let old = world.remove_resource::<ScenarioSource>();
    insert_run(world, prepared);
    if let Some(old) = old {
        world.resource_mut::<ScenarioSource>().keep_known_files(old);
    }
    world.resource_mut::<OpenedFiles>().requested_once = None;
    world.resource_mut::<Notices>().remove_training();
    run_notices::show_notes(world);
    open::list_user_files(world);
}

/// Starts a training run from random weights, or reports why it cannot start.
pub(super) fn start_or_notify(world: &mut World, scenario: &str, preset: &str, seed: u64) {
    let Err(error) = start_training(world, scenario, preset, seed) else { return };
    #[cfg(not(target_arch = "wasm32"))]
    let is_broken =
        file_watch::retry_when_fixed(world, scenario, RetryAction::StartWith { preset: preset.into(), seed });
    #[cfg(target_arch = "wasm32")]
    let is_broken = false;
    notify(world, scenario_topic(scenario, is_broken), Severity::Error, error.to_string());
}

/// Starts a training run from random weights.
///
/// # Errors
/// The scenario or the preset is invalid.
pub(super) fn start_training(
    world: &mut World,
    scenario: &str,
    preset: &str,
    seed: u64,
) -> Result<(), RunError> {
    let extensions = world.resource::<TrainingRun>().config.extensions.clone();
    let prepared = prepare_new(scenario, preset, &Settings::default(), seed, &extensions)?;
    world.resource_mut::<Pacer>().set_paused(false);
    replace(world, prepared);
    Ok(())
}

/// Starts a training run from random weights, with the current preset and seed: in a scenario, or on a set, given with its
/// first scenario. `from` is the scenario's or the set's file or shipped name.
///
/// # Errors
/// The preset does not fit the scenario.
pub(super) fn start_in_scenario(
    world: &mut World,
    scenario: (Scenario, Option<ScenarioSet>),
    from: String,
) -> Result<(), RunError> {
    let mut config = world.resource::<TrainingRun>().config.clone();
    (config.scenario, config.scenario_set) = scenario;
    config.scenario_from = from;
    config.transfer = None;
    let prepared = prepare(config, None)?;
    world.resource_mut::<Pacer>().set_paused(false);
    replace(world, prepared);
    Ok(())
}

/// The configuration of the current training run with this scenario, preset and seed. If the scenario or the preset has
/// the same name as now, it is kept with the user's changes.
///
/// # Errors
/// The scenario or the preset is invalid.
pub(super) fn transfer_config(
    world: &World,
    scenario: &str,
    preset: &str,
    seed: u64,
) -> Result<RunConfig, RunError> {
    let mut config = world.resource::<TrainingRun>().config.clone();
    if scenario != config.scenario_from {
        (config.scenario, config.scenario_set) = shipped::scenario_or_set(scenario)?;
        config.scenario_from = scenario.into();
    }
    if preset != config.preset_from {
        config.preset = shipped::preset(preset)?;
        config.preset_from = preset.into();
    }
    config.seed = seed;
    Ok(config)
}

/// Starts the training run of `config` from a policy, and resumes time if it was paused. Exploration starts at `epsilon`,
/// limited to 0..=1. If the policy is the current or the best one, the curves of the run that it comes from stay in the
/// background.
///
/// # Errors
/// There is no such policy, or it does not fit the scenario or the preset.
pub(super) fn start_from_policy(
    world: &mut World,
    mut config: RunConfig,
    source: PolicySource,
    epsilon: f32,
) -> Result<(), RunError> {
    let (name, policy) = session_policy::policy(world, source)?;
    let warning = policy_card::warning(&policy, &config.scenario)?.map(|text| format!("{name}: {text}"));
    config.transfer = Some(Transfer { policy: name, epsilon: Some(epsilon.clamp(0.0, 1.0)) });
    let prepared = prepare(config, Some(policy))?;
    let earlier = world.resource::<TrainingHistory>().0.to_earlier();
    world.resource_mut::<Pacer>().set_paused(false);
    replace(world, prepared);
    if source != PolicySource::Opened {
        world.resource_mut::<TrainingHistory>().0.set_earlier(earlier);
    }
    if let Some(text) = warning {
        notify(world, NoticeTopic::TrainingWarning, Severity::Warning, text);
    }
    Ok(())
}
