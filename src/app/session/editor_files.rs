//! Saves and opens scenario files for the editor.
//!
//! In: a scenario and a path. Out: a file, or a scenario to edit; the editor learns the result from an [`EditorReply`].

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use bevy::prelude::*;

use super::execute::notify_saved;
#[cfg(not(target_arch = "wasm32"))]
use super::file_watch::FileWatches;
use super::scenario_source::ScenarioSource;
use super::training_run::TrainingRun;
use crate::app::commands::EditorReply;
use crate::run::output_file::write_atomic;
use crate::run::{RunError, shipped};
use crate::scenario::{MAX_FILE_BYTES, Scenario, path_exists, read_text, to_text, utf8_path};

/// Saves an edited scenario to `path`. Keeps the comments of `based_on`, the file or shipped scenario that was edited; if
/// that cannot be read, those of the file at `path`.
///
/// # Errors
/// The file cannot be written, or another program has changed it and the user has not confirmed yet.
pub(super) fn save_scenario(
    world: &mut World,
    scenario: &Arc<Scenario>,
    based_on: &str,
    path: &Path,
) -> Result<(), RunError> {
    let file = utf8_path(path)?.to_owned();
    world.resource_scope(|world, mut source: Mut<ScenarioSource>| {
        source.check_overwrite(&world.resource::<TrainingRun>().config, scenario, path)
    })?;
    let older = source_text(based_on).or_else(|| read_text(path).ok());
    let text = to_text(scenario, older.as_deref());
    if text.len() as u64 > MAX_FILE_BYTES {
        let why = "the scenario is too large: its file would exceed 1 MiB and could not be read again; \
                   help: remove some of its obstacles or walls";
        return Err(RunError::failed(path, why));
    }
    write_atomic(path, |file| file.write_all(text.as_bytes()))
        .map_err(|error| RunError::failed(path, error.to_string()))?;
    // In a browser a saved scenario becomes one of the user's files, so that training can use it.
    #[cfg(target_arch = "wasm32")]
    crate::scenario::virtual_files::add_upload(file.clone(), text.into_bytes());
    if file == world.resource::<TrainingRun>().config.scenario_from {
        let mut source = world.resource_mut::<ScenarioSource>();
        source.loaded = Scenario::clone(scenario);
        // This also overwrites another program's change that was to be adopted at the end of an episode.
        source.pending = None;
        // The user decides in the editor whether to run the saved scenario, so the file watch must not adopt it.
        #[cfg(not(target_arch = "wasm32"))]
        world.resource_mut::<FileWatches>().watch_known(&file);
    }
    notify_saved(world, path);
    world.resource_mut::<ScenarioSource>().record_saved(file.clone(), scenario.clone());
    world.write_message(EditorReply::Saved { file, scenario: scenario.clone() });
    Ok(())
}

/// Opens the scenario at `path`, a file or a shipped scenario's name, in the editor. It need not be valid.
///
/// # Errors
/// The scenario cannot be read.
pub(super) fn open_in_editor(world: &mut World, path: &Path) -> Result<(), RunError> {
    let from = utf8_path(path)?.to_owned();
    let scenario = if path_exists(path) { Scenario::load_draft(path) } else { shipped::scenario(&from) }?;
    let scenario = Arc::new(scenario);
    world.resource_mut::<ScenarioSource>().record_opened(from.clone(), scenario.clone());
    world.write_message(EditorReply::Opened { from, scenario });
    Ok(())
}

/// The text of a shipped scenario or of a file.
fn source_text(from: &str) -> Option<String> {
    match shipped::scenario_text(from) {
        Some(text) if !path_exists(Path::new(from)) => Some(text.into()),
        _ => read_text(from).ok(),
    }
}
