//! Changes of the scenario under a training: edited in the app, or rewritten in its file.
//!
//! In: a scenario. Out: the training continues in it, or restarts there. Also: scenarios saved to files and opened in the
//! editor, which learns the result from an [`EditorReply`].

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use bevy::prelude::*;

use super::active_mode;
use super::execute::{notify_saved, on_scenario_changed};
#[cfg(not(target_arch = "wasm32"))]
use super::file_watch::FileWatches;
use super::interventions::{self, Intervention};
use super::journal::Journal;
use super::notices::{NoticeTopic, notify};
use super::open;
use super::start_training;
use super::trails::Trails;
use super::training_run::TrainingRun;
use crate::app::app_snapshot::{ScenarioFile, Severity};
use crate::app::commands::EditorReply;
use crate::run::folder::{RunConfig, write_atomic};
use crate::run::{RunError, shipped};
use crate::scenario::{MAX_FILE_BYTES, Scenario, diagnostics, path_exists, read_text, to_text};

/// Where the scenario of the training comes from, and what its file is known to hold.
#[derive(Resource)]
pub struct ScenarioSource {
    /// The scenario in its file, or as it is shipped.
    pub(super) loaded: Scenario,
    /// A scenario to adopt when the next episode ends.
    pub(super) pending: Option<Scenario>,
    /// The scenario that was saved last. `None` once the scenario of the training has changed after it.
    saved: Option<ScenarioFile>,
    /// The scenario that was opened last in the editor.
    opened_in_editor: Option<ScenarioFile>,
    /// A file that somebody else has changed, and that the user wanted to overwrite once.
    overwrite_requested: Option<PathBuf>,
}

impl ScenarioSource {
    /// The source of the scenario in `config`.
    pub(super) fn new(config: &RunConfig) -> Self {
        Self {
            loaded: load_source(&config.scenario_from).unwrap_or_else(|| config.scenario.clone()),
            pending: None,
            saved: None,
            opened_in_editor: None,
            overwrite_requested: None,
        }
    }

    /// Keeps what `old` knows about files when a new training replaces one.
    pub(super) fn keep_known_files(&mut self, old: Self) {
        self.saved = old.saved;
        self.opened_in_editor = old.opened_in_editor;
    }

    /// Whether the scenario of the training differs from its file: an object was moved, or an edit was not saved.
    #[must_use]
    pub fn is_modified(&self, config: &RunConfig) -> bool {
        self.loaded != config.scenario
    }

    /// The scenario that was saved last, and its file.
    #[must_use]
    pub fn saved(&self) -> Option<&ScenarioFile> {
        self.saved.as_ref()
    }

    /// Forgets the saved scenario: the scenario of the training is newer.
    pub(super) fn forget_saved(&mut self) {
        self.saved = None;
    }

    /// Checks that writing `scenario` to `path` destroys nobody's work. That holds if the file has the same content as when
    /// it was read or written here last, if it was never read here (the file dialog has asked then), or if the user asks for
    /// the second time.
    ///
    /// # Errors
    /// Somebody else has changed the file, and the user asks for the first time.
    fn check_overwrite(
        &mut self,
        config: &RunConfig,
        scenario: &Scenario,
        path: &Path,
    ) -> Result<(), RunError> {
        let file = path.display().to_string();
        let loaded = (file == config.scenario_from).then_some(&self.loaded);
        let files = self.saved.iter().chain(&self.opened_in_editor);
        let known = files.filter(|known| known.0 == file).map(|known| &*known.1);
        let mut known = loaded.into_iter().chain(known).peekable();
        let present = Scenario::load_draft(path).ok();
        let is_unchanged = known.peek().is_none()
            || present.as_ref() == Some(scenario)
            || known.any(|known| present.as_ref() == Some(known));
        let is_repeated = self.overwrite_requested.take().as_deref() == Some(path);
        if !path_exists(path) || is_unchanged || is_repeated {
            return Ok(());
        }
        self.overwrite_requested = Some(path.into());
        let why = "another program has changed this file, and its changes would be lost\n\
                   help: save again to overwrite it, or choose another name";
        Err(RunError::failed(path, why))
    }
}

/// Continues the training in an edited scenario, or restarts it there.
///
/// # Errors
/// The scenario is invalid, or the network does not fit it. Nothing has changed then.
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
        return start_training::start_in_scenario(world, scenario.clone(), from);
    }
    switch_scenario(world, scenario)?;
    world.resource_mut::<ScenarioSource>().loaded = load_source(&from).unwrap_or_else(|| scenario.clone());
    world.resource_mut::<TrainingRun>().config.scenario_from.clone_from(&from);
    #[cfg(not(target_arch = "wasm32"))]
    world.resource_mut::<FileWatches>().watch_known(&from);
    open::list_user_files(world);
    Ok(())
}

/// Continues the training in `scenario`, with a new episode in every arena.
///
/// # Errors
/// The network does not fit it. Nothing has changed then.
fn switch_scenario(world: &mut World, scenario: &Scenario) -> Result<(), RunError> {
    check_can_switch(&world.resource::<TrainingRun>().config, scenario)?;
    active_mode::while_training(world, |world| {
        let intervention = Intervention::Scenario(Box::new(scenario.clone()));
        interventions::apply(world, &intervention);
        world.resource_mut::<Journal>().record(intervention, false);
        on_scenario_changed(world);
        let arenas = world.resource::<TrainingRun>().config.preset.arenas;
        world.resource_mut::<Trails>().restart(arenas);
        world.resource_mut::<ScenarioSource>().pending = None;
        Ok(())
    })
}

/// Checks that the training of `config` can continue in `scenario`.
///
/// # Errors
/// The network was made for other numbers of beams or motions, or the scenario needs too much memory.
pub(super) fn check_can_switch(config: &RunConfig, scenario: &Scenario) -> Result<(), RunError> {
    let shape = |scenario: &Scenario| (scenario.lidar.beams, scenario.robot.motions.len());
    let ((beams, motions), here) = (shape(scenario), shape(&config.scenario));
    if (beams, motions) == here {
        let fits = config.preset.check_memory(scenario);
        return fits.map_err(|error| RunError::InvalidInput(format!("{}: {error}", scenario.name)));
    }
    Err(RunError::InvalidInput(format!(
        "{}: it has {beams} beams and {motions} motions, but the network was built for {} and {}\n\
         help: start a new training there",
        scenario.name, here.0, here.1
    )))
}

/// Adopts the scenario that waits for the end of an episode, if there is one.
pub(super) fn apply_pending_scenario(world: &mut World) {
    let Some(scenario) = world.resource_mut::<ScenarioSource>().pending.take() else { return };
    let file = world.resource::<TrainingRun>().config.scenario_from.clone();
    let (severity, text) = match switch_scenario(world, &scenario) {
        Ok(()) => {
            world.resource_mut::<ScenarioSource>().loaded = scenario;
            (Severity::Info, format!("{file}: now running the changed scenario"))
        }
        Err(error) => (Severity::Error, error.to_string()),
    };
    notify(world, NoticeTopic::File(file), severity, text);
}

/// Saves an edited scenario to `path`. The comments are those of `based_on`, the file or shipped scenario that it was made
/// from, or else those of the file at `path`.
///
/// # Errors
/// The file cannot be written, or another program has changed it and the user has not confirmed yet.
pub(super) fn save_scenario(
    world: &mut World,
    scenario: &Arc<Scenario>,
    based_on: &str,
    path: &Path,
) -> Result<(), RunError> {
    world.resource_scope(|world, mut source: Mut<ScenarioSource>| {
        source.check_overwrite(&world.resource::<TrainingRun>().config, scenario, path)
    })?;
    let older = source_text(based_on).or_else(|| read_text(path).ok());
    let text = to_text(scenario, older.as_deref());
    if text.len() as u64 > MAX_FILE_BYTES {
        let why = "the scenario is too large: its file would exceed 1 MiB and could not be read again";
        return Err(RunError::failed(path, why));
    }
    write_atomic(path, |file| file.write_all(text.as_bytes()))
        .map_err(|error| RunError::failed(path, error.to_string()))?;
    let file = path.display().to_string();
    // In a browser a saved scenario becomes one of the user's files, so that a training can use it.
    #[cfg(target_arch = "wasm32")]
    crate::scenario::virtual_files::add_upload(file.clone(), text.into_bytes());
    if file == world.resource::<TrainingRun>().config.scenario_from {
        world.resource_mut::<ScenarioSource>().loaded = Scenario::clone(scenario);
        // The user decides in the editor whether to run it; the file watch must not.
        #[cfg(not(target_arch = "wasm32"))]
        world.resource_mut::<FileWatches>().watch_known(&file);
    }
    notify_saved(world, path);
    world.resource_mut::<ScenarioSource>().saved = Some((file.clone(), scenario.clone()));
    world.write_message(EditorReply::Saved { file, scenario: scenario.clone() });
    Ok(())
}

/// Opens the scenario at `path`, a file or a shipped scenario's name, in the editor. It need not be valid.
///
/// # Errors
/// It cannot be read.
pub(super) fn open_in_editor(world: &mut World, path: &Path) -> Result<(), RunError> {
    let from = path.display().to_string();
    let scenario = if path_exists(path) { Scenario::load_draft(path) } else { shipped::scenario(&from) }?;
    let scenario = Arc::new(scenario);
    world.resource_mut::<ScenarioSource>().opened_in_editor = Some((from.clone(), scenario.clone()));
    world.write_message(EditorReply::Opened { from, scenario });
    Ok(())
}

/// The present content of `from`, a shipped scenario's name or a file.
fn load_source(from: &str) -> Option<Scenario> {
    shipped::scenario(from).ok()
}

/// The text of a shipped scenario or of a file.
fn source_text(from: &str) -> Option<String> {
    match shipped::scenario_text(from) {
        Some(text) if !path_exists(Path::new(from)) => Some(text.into()),
        _ => read_text(from).ok(),
    }
}
