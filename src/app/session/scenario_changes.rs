//! Changes to the scenario of a training run, made in the editor or in the scenario's file.
//!
//! In: a scenario. Out: the training run, continued or restarted in that scenario.

use bevy::prelude::*;

use super::TrainingHistory;
use super::active_mode;
use super::evaluations::Evaluations;
#[cfg(not(target_arch = "wasm32"))]
use super::file_watch::FileWatches;
use super::interventions::{self, Intervention};
use super::journal::Journal;
use super::notices::{NoticeTopic, notify};
use super::open;
use super::run_notices;
use super::scenario_source::{ScenarioSource, load_source};
use super::start_training;
use super::trails::Trails;
use super::training_run::TrainingRun;
use crate::agent::ActiveLearner;
use crate::app::app_status::Severity;
use crate::app::commands::PolicySource;
use crate::run::RunError;
use crate::run::folder::RunConfig;
use crate::scenario::{Scenario, diagnostics};
use crate::task::CurrentScenario;

/// The label of the mark in the curves where the scenario changed.
pub(super) const SCENARIO_CHANGED: &str = "scenario changed";

/// Continues training in an edited scenario, or restarts it there. `from` is the scenario's file or shipped name.
///
/// # Errors
/// The scenario is invalid, or training cannot continue or start in it. The training run is then unchanged.
pub(super) fn apply_edited(
    world: &mut World,
    scenario: &Scenario,
    from: String,
    restart: bool,
) -> Result<(), RunError> {
    if let Some(found) = diagnostics(scenario).first() {
        return Err(RunError::InvalidInput(format!("{}: {found}", scenario.name)));
    }
    if restart {
        return start_training::start_in_scenario(world, (scenario.clone(), None), from);
    }
    switch_scenario(world, scenario, &from)?;
    world.resource_mut::<ScenarioSource>().loaded = load_source(&from).unwrap_or_else(|| scenario.clone());
    #[cfg(not(target_arch = "wasm32"))]
    world.resource_mut::<FileWatches>().watch_known(&from);
    open::list_user_files(world);
    Ok(())
}

/// Continues training in `scenario`, with a new episode in every arena. `from` is the scenario's file or shipped name.
///
/// # Errors
/// Training cannot continue in `scenario` ([`check_can_switch`]). The training run is then unchanged.
fn switch_scenario(world: &mut World, scenario: &Scenario, from: &str) -> Result<(), RunError> {
    check_can_switch(&world.resource::<TrainingRun>().config, scenario)?;
    active_mode::while_training(world, |world| {
        let intervention = Intervention::Scenario(Box::new(scenario.clone()));
        interventions::apply(world, &intervention);
        world.resource_mut::<Journal>().record(intervention, false);
        on_scenario_changed(world);
        from.clone_into(&mut world.resource_mut::<TrainingRun>().config.scenario_from);
        run_notices::show_notes(world);
        let arenas = world.resource::<TrainingRun>().config.preset.arenas;
        world.resource_mut::<Trails>().restart(arenas);
        world.resource_mut::<ScenarioSource>().pending = None;
        Ok(())
    })
}

/// Checks that the training run of `config` can continue in `scenario`.
///
/// # Errors
/// The run trains on a set of scenarios, the network does not fit the number of beams or motions, or the scenario needs too
/// much memory.
pub(super) fn check_can_switch(config: &RunConfig, scenario: &Scenario) -> Result<(), RunError> {
    if let Some(set) = &config.scenario_set {
        return Err(RunError::InvalidInput(format!(
            "{}: training on this set of scenarios cannot continue in another scenario\nhelp: start a new training run there",
            set.name
        )));
    }
    if let Some(why) = config.preset.network_misfit(&config.scenario, scenario) {
        let name = &scenario.name;
        return Err(RunError::InvalidInput(format!("{name}: {why}\nhelp: start a new training run there")));
    }
    let fits = config.preset.check_memory(scenario, &config.observation_layout());
    fits.map_err(|error| RunError::InvalidInput(format!("{}: {error}", scenario.name)))
}

/// Switches to the scenario that waits for the end of an episode, if there is one.
pub(super) fn apply_pending_scenario(world: &mut World) {
    let Some(scenario) = world.resource_mut::<ScenarioSource>().pending.take() else { return };
    let file = world.resource::<TrainingRun>().config.scenario_from.clone();
    let (severity, text) = match switch_scenario(world, &scenario, &file) {
        Ok(()) => {
            world.resource_mut::<ScenarioSource>().record_loaded(file.clone(), scenario);
            (Severity::Info, format!("{file}: now running the changed scenario"))
        }
        Err(error) => (Severity::Error, error.to_string()),
    };
    notify(world, NoticeTopic::File(file), severity, text);
}

/// Updates everything that depends on the scenario, after the scenario in `world` has changed.
pub(super) fn on_scenario_changed(world: &mut World) {
    let scenario = Scenario::clone(&world.resource::<CurrentScenario>().0);
    let mut run = world.resource_mut::<TrainingRun>();
    run.config.scenario = scenario;
    // The best policy of the previous scenario may fail in this one.
    run.trainer_state.best = None;
    run.tested = PolicySource::Current;
    world.resource_mut::<Evaluations>().mark_outdated();
    world.resource_mut::<ScenarioSource>().forget_saved();
    let env_steps = world.resource::<ActiveLearner>().0.env_steps();
    world.resource_mut::<TrainingHistory>().0.annotate(env_steps, SCENARIO_CHANGED.into());
}
