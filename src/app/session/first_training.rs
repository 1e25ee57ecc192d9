//! The first training run of the app.
//!
//! In: [`StartOptions`]. Out: the resources of the session, with a notice for each invalid option.

use std::path::Path;

use bevy::prelude::*;

use super::StartOptions;
use super::autosave::Autosave;
use super::demo::FirstRound;
use super::editor_files;
#[cfg(not(target_arch = "wasm32"))]
use super::file_watch::{self, RetryAction};
use super::notices::{NoticeTopic, notify};
use super::open;
use super::pacer::Pacer;
use super::run_notices;
use super::start_training::{insert_run, prepare_new, scenario_topic};
use super::training_run::TrainingRun;
use crate::app::app_status::Severity;
use crate::run::settings::Settings;

/// Starts the first training run. The options were checked before; if the scenario, the preset or a setting is nevertheless
/// invalid, training starts with defaults and a notice.
pub(super) fn start_first(world: &mut World, start: &StartOptions) {
    let default = StartOptions::default();
    let prepare = |scenario: &str, preset: &str, settings: &Settings| {
        prepare_new(scenario, preset, settings, start.seed, &start.extensions)
    };
    let requested = prepare(&start.scenario, &start.preset, &start.settings);
    let problem = requested.as_ref().err().map(ToString::to_string);
    let in_default_scenario = |_| prepare(&default.scenario, &start.preset, &start.settings);
    let with_default_preset = |_| prepare(&start.scenario, &default.preset, &default.settings);
    let by_default = |_| prepare(&default.scenario, &default.preset, &default.settings);
    match requested.or_else(in_default_scenario).or_else(with_default_preset).or_else(by_default) {
        Ok(prepared) => {
            world.insert_resource(Pacer::new(start.pace, start.paused));
            world.insert_resource(Autosave::new(start.autosave.clone(), start.open.is_none()));
            world.insert_resource(FirstRound(start.episode));
            insert_run(world, prepared);
            run_notices::show_notes(world);
            open::list_user_files(world);
        }
        // Unreachable as long as the shipped files are valid, which a test checks.
        Err(error) => return error!("{error}"),
    }
    for option in &start.invalid_options {
        notify(world, NoticeTopic::General, Severity::Error, option.clone());
    }
    #[cfg(not(target_arch = "wasm32"))]
    let is_broken = file_watch::retry_when_fixed(world, &start.scenario, RetryAction::StartTraining);
    #[cfg(target_arch = "wasm32")]
    let is_broken = false;
    if let Some(problem) = problem {
        notify(world, scenario_topic(&start.scenario, is_broken), Severity::Error, problem);
    }
    if start.edit && world.resource::<TrainingRun>().config.scenario_from != start.scenario {
        // The scenario could not be used, and has a notice. The user may fix it in the editor.
        let _ = editor_files::open_in_editor(world, Path::new(&start.scenario));
    }
    if let Some(path) = &start.open {
        open::open_or_notify(world, path);
    }
}
