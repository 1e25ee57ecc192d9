//! The execution of each [`Command`], between two control steps.
//!
//! In: a command. Out: the effect, or a notice with the reason for the failure.

use std::path::Path;

use bevy::prelude::*;

use super::QuitQuestion;
use super::active_mode::{self, ActiveMode};
use super::autosave::{self, Autosave};
use super::comparison;
use super::demo;
use super::editor_files;
use super::interventions::{self, Intervention};
use super::journal::Journal;
use super::notices::{NoticeTopic, Notices, notify};
use super::open::{self, OpenedFiles};
use super::pacer::Pacer;
#[cfg(not(target_arch = "wasm32"))]
use super::quit;
use super::save;
use super::scenario_changes;
use super::scenario_source::ScenarioSource;
use super::start_training;
use super::trails::Trails;
use super::training_run::TrainingRun;
use crate::agent::{ActionSource, ActionSources, ActiveLearner};
use crate::app::CurrentViewState;
use crate::app::app_status::Severity;
use crate::app::commands::{Command, SaveKind};
use crate::app::editor_backup::{self, EditorBackup};
use crate::app::moves::{Movable, MoveRequest};
use crate::app::view_state::EditorSource;
use crate::run::RunError;

/// Executes `command`. A failure becomes a notice.
pub(super) fn execute(world: &mut World, command: Command) {
    let (topic, edited) = (topic(&command), edited_scenario(world, &command));
    if let Err(error) = try_execute(world, command) {
        notify(world, topic, Severity::Error, error.to_string());
        if edited.is_some() {
            // The editor has closed, perhaps with unsaved changes.
            world.resource_mut::<CurrentViewState>().0.open_editor = edited;
        }
    }
}

/// The scenario to open in the editor again if `command` cannot apply it.
fn edited_scenario(world: &World, command: &Command) -> Option<EditorSource> {
    match command {
        Command::ApplyScenario { scenario, from, .. } => {
            let in_file = world.resource::<ScenarioSource>().known(from).cloned();
            Some(EditorSource::Draft { from: from.clone(), scenario: scenario.clone(), in_file })
        }
        Command::SaveFirst(then) => edited_scenario(world, then),
        _ => None,
    }
}

/// The topic of a notice about `command`.
fn topic(command: &Command) -> NoticeTopic {
    match command {
        Command::Save(_, path)
        | Command::SaveScenario { path: Some(path), .. }
        | Command::OpenInEditor(Some(path)) => NoticeTopic::File(path.display().to_string()),
        _ => NoticeTopic::General,
    }
}

/// Calls `open`, and shows the confirmation that it returns.
fn confirm(
    world: &mut World,
    open: impl FnOnce(&mut World) -> Result<String, RunError>,
) -> Result<(), RunError> {
    let text = open(world)?;
    notify(world, NoticeTopic::General, Severity::Info, text);
    Ok(())
}

fn try_execute(world: &mut World, command: Command) -> Result<(), RunError> {
    match command {
        Command::Pause(paused) => world.resource_mut::<Pacer>().set_paused(paused),
        Command::Step => world.resource_mut::<Pacer>().step_once(),
        Command::SetPace(pace) => world.resource_mut::<Pacer>().pace = pace,
        Command::SetMode(mode) => active_mode::set_mode(world, mode)?,
        Command::SetTested(source) => active_mode::set_tested(world, source)?,
        Command::StartTraining { scenario, preset, seed } => {
            start_training::start_or_notify(world, &scenario, &preset, seed);
        }
        Command::Transfer { policy, scenario, preset, seed, epsilon } => {
            let config = start_training::transfer_config(world, &scenario, &preset, seed)?;
            start_training::start_from_policy(world, config, policy, epsilon)?;
        }
        Command::Move(request) => move_object(world, &request),
        Command::SetGoal(request) => set_goal(world, &request),
        Command::Steer(motion) => steer(world, motion),
        Command::OpenExpert => confirm(world, comparison::open_expert)?,
        Command::OpenBest => comparison::open_best(world)?,
        Command::OpenDriver(name) => confirm(world, |world| comparison::open_driver(world, name))?,
        Command::OpenWithMap => confirm(world, comparison::open_with_map)?,
        Command::OpenExpertWithMap => confirm(world, comparison::open_expert_with_map)?,
        Command::Open(path) => open::open_or_notify(world, &path),
        Command::Save(what, path) => save_to(world, what, &path)?,
        Command::ApplyScenario { scenario, from, restart } => {
            scenario_changes::apply_edited(world, &scenario, from, restart)?;
        }
        Command::SaveScenario { scenario, based_on, path: Some(path) } => {
            editor_files::save_scenario(world, &scenario, &based_on, &path)?;
        }
        Command::OpenInEditor(Some(path)) => editor_files::open_in_editor(world, &path)?,
        Command::SaveFirst(then) => {
            save_before_discarding(world)?;
            try_execute(world, *then)?;
        }
        Command::ContinueLastSession => autosave::continue_last_session(world)?,
        Command::DismissLastSession => world.resource_mut::<Autosave>().dismiss_last_session(),
        Command::RestoreEdits => editor_backup::restore(world)?,
        Command::DismissEdits => world.resource_mut::<EditorBackup>().dismiss(),
        #[cfg(not(target_arch = "wasm32"))]
        Command::Close => quit::request(world),
        #[cfg(not(target_arch = "wasm32"))]
        Command::Quit { save } => quit::answer(world, save),
        #[cfg(target_arch = "wasm32")]
        Command::Close | Command::Quit { .. } => {}
        Command::KeepOpen => world.resource_mut::<QuitQuestion>().0 = false,
        Command::DismissNotice(notice) => world.resource_mut::<Notices>().dismiss(&notice),
        // The file dialogs answer these with a command that has a path.
        Command::OpenDialog
        | Command::SaveDialog(_)
        | Command::SaveScenario { path: None, .. }
        | Command::OpenInEditor(None) => {}
    }
    Ok(())
}

/// Sets the motion of the robot that the user drives, if there is one.
fn steer(world: &mut World, motion: usize) {
    if let Some(ActionSource::Manual(held)) = world.resource_mut::<ActionSources>().arenas.first_mut() {
        *held = motion;
    }
}

fn save_to(world: &mut World, what: SaveKind, path: &Path) -> Result<(), RunError> {
    save::save(world, what, path)?;
    if matches!(what, SaveKind::Policy | SaveKind::BestPolicy | SaveKind::Run) {
        let env_steps = world.resource::<ActiveLearner>().0.env_steps();
        world.resource_mut::<TrainingRun>().mark_saved(env_steps);
        world.resource_mut::<OpenedFiles>().requested_once = None;
    }
    notify_saved(world, path);
    Ok(())
}

/// Saves the run under `runs/`; in a browser, which has no folders, the policy.
fn save_before_discarding(world: &mut World) -> Result<(), RunError> {
    let what = if cfg!(target_arch = "wasm32") { SaveKind::Policy } else { SaveKind::Run };
    let path = save::unused_path(&world.resource::<TrainingRun>().suggested_file_name(what));
    save_to(world, what, &path)
}

/// Confirms that `path` was written.
pub(super) fn notify_saved(world: &mut World, path: &Path) {
    // Absolute, so that the user finds it. In a browser there are no folders.
    let shown = std::path::absolute(path).unwrap_or_else(|_| path.into());
    let text = format!("Saved as {}", shown.display());
    notify(world, NoticeTopic::File(path.display().to_string()), Severity::Info, text);
}

/// Moves an object that the user drags, if the requested position is allowed.
fn move_object(world: &mut World, request: &MoveRequest) {
    let intervention = match interventions::resolve(world, request) {
        Ok(intervention) => intervention,
        Err(rejection) => {
            return notify(world, NoticeTopic::Move, Severity::Info, rejection.to_string());
        }
    };
    world.resource_mut::<Notices>().remove(&NoticeTopic::Move);
    interventions::apply(world, &intervention);
    if request.object == Movable::Robot {
        world.resource_mut::<Trails>().restart_path(request.arena);
    }
    record(world, &intervention);
}

/// Sets the goal of all robots in a demo, if it may be at the requested position.
fn set_goal(world: &mut World, request: &MoveRequest) {
    if world.resource::<ActiveMode>().is_training() {
        return;
    }
    match interventions::resolve(world, &MoveRequest { object: Movable::Goal, ..*request }) {
        Ok(_) => {
            world.resource_mut::<Notices>().remove(&NoticeTopic::Move);
            demo::set_goal(world, request.to_m);
        }
        Err(rejection) => notify(world, NoticeTopic::Move, Severity::Info, rejection.to_string()),
    }
}

/// Records an intervention in the journal if it affects the training. Outside training, only a change of the scenario does.
fn record(world: &mut World, intervention: &Intervention) {
    let changes_scenario = intervention.changes_scenario();
    if changes_scenario || world.resource::<ActiveMode>().is_training() {
        let config = &world.resource::<TrainingRun>().config;
        // With an inexact LIDAR, each scan draws from the sensor's random stream.
        let only_last_counts = config.has_exact_lidars() && intervention.overrides_earlier(&config.scenario);
        world.resource_mut::<ActiveMode>().record_for_training(intervention, only_last_counts);
        world.resource_mut::<Journal>().record(intervention.clone(), only_last_counts);
        world.resource_mut::<Autosave>().mark_changed();
    }
    if changes_scenario {
        scenario_changes::on_scenario_changed(world);
    }
}
