//! Quitting the app. If unsaved training would be lost, the user is asked first and can save it.
//!
//! In: the user's request to close the window, and the answer. Out: a saved run, and the end of the app.

use bevy::prelude::*;

use super::QuitQuestion;
use super::autosave;
use super::notices::{NoticeTopic, notify};
use super::save;
use super::training_run::TrainingRun;
use crate::agent::ActiveLearner;
use crate::app::app_status::Severity;
use crate::app::commands::SaveKind;
use crate::run::progress::print_stderr;

/// Quits, or opens the question if unsaved training would be lost.
pub(super) fn request(world: &mut World) {
    let env_steps = world.resource::<ActiveLearner>().0.env_steps();
    let run = world.resource::<TrainingRun>();
    if run.would_lose_training(env_steps) {
        world.resource_mut::<QuitQuestion>().0 = true;
    } else if run.is_worth_keeping(env_steps) {
        // The user has saved it; the autosave lets the next session continue.
        exit_with_autosave(world);
    } else {
        autosave::discard(world);
        exit(world);
    }
}

/// Quits after the question. With `save`, saves the run under `runs/` first; if that fails, the app does not quit.
pub(super) fn answer(world: &mut World, save: bool) {
    world.resource_mut::<QuitQuestion>().0 = false;
    if !save {
        autosave::discard(world);
        return exit(world);
    }
    let path = save::unused_path(&world.resource::<TrainingRun>().suggested_file_name(SaveKind::Run));
    match save::save(world, SaveKind::Run, &path) {
        Ok(()) => {
            print_stderr(&format!("saved the run to {}", path.display()));
            exit_with_autosave(world);
        }
        Err(error) => notify(world, NoticeTopic::General, Severity::Error, error.to_string()),
    }
}

/// Quits, and leaves an autosave for the next session. If it cannot be written, the app quits nevertheless.
fn exit_with_autosave(world: &mut World) {
    if let Err(error) = autosave::save_now(world) {
        print_stderr(&format!("warning: autosave failed: {error}"));
    }
    exit(world);
}

fn exit(world: &mut World) {
    world.write_message(AppExit::Success);
}
