//! Another world under the training: one that was edited, or whose file has changed.
//!
//! In: a world. Out: the training goes on in it, or begins anew there; worlds written to files, and opened to be edited.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use bevy::prelude::*;

use super::trails::Trails;
use super::{Session, interventions};
use crate::app::app_snapshot::Severity;
use crate::app::commands::SessionMode;
use crate::run::folder::write_atomic;
use crate::run::{RunError, shipped};
use crate::scenario::{MAX_FILE_BYTES, Scenario, diagnostics, path_exists, read_text, to_text};

impl Session {
    /// The training goes on in an edited world, or begins anew there.
    ///
    /// # Errors
    /// The world can't be, or the network doesn't fit it; all stays as it was then.
    pub(super) fn apply_edited(
        &mut self,
        world: &mut World,
        scenario: &Scenario,
        from: String,
        again: bool,
    ) -> Result<(), RunError> {
        if let Some(finding) = diagnostics(scenario).first() {
            return Err(RunError::InvalidInput(format!("{}: {finding}", scenario.name)));
        }
        if again {
            return self.start_in_scenario(world, scenario.clone(), from);
        }
        self.switch_scenario(world, scenario)?;
        self.loaded_scenario = load_source(&from).unwrap_or_else(|| scenario.clone());
        self.config.scenario_from = from;
        #[cfg(not(target_arch = "wasm32"))]
        self.watch_scenario_file();
        self.list_user_files();
        Ok(())
    }

    /// The training goes on in `scenario`, all arenas with a new episode.
    ///
    /// # Errors
    /// The network doesn't fit it.
    pub(super) fn switch_scenario(&mut self, world: &mut World, scenario: &Scenario) -> Result<(), RunError> {
        self.check_can_switch(scenario)?;
        let (mode, pace) = (self.mode, self.pacer.pace);
        self.set_mode(world, SessionMode::Train)?;
        let intervention = interventions::Intervention::World(Box::new(scenario.clone()));
        interventions::apply(world, &intervention);
        self.journal.record(intervention, false);
        self.on_scenario_changed(world);
        let arenas = self.config.preset.arenas;
        world.resource_mut::<Trails>().restart(arenas);
        self.pending_scenario = None;
        self.set_mode(world, mode)?;
        self.pacer.pace = pace;
        Ok(())
    }

    /// Whether the training can go on in `scenario`.
    ///
    /// # Errors
    /// It cannot: what the network was made for differs, or it takes too much memory.
    pub(super) fn check_can_switch(&self, scenario: &Scenario) -> Result<(), RunError> {
        let shape = |scenario: &Scenario| (scenario.lidar.beams, scenario.robot.motions.len());
        let ((beams, motions), here) = (shape(scenario), shape(&self.config.scenario));
        if (beams, motions) == here {
            let fits = self.config.preset.check_memory(scenario);
            return fits.map_err(|error| RunError::InvalidInput(format!("{}: {error}", scenario.name)));
        }
        Err(RunError::InvalidInput(format!(
            "{}: it has {beams} beams and {motions} motions, and the network was made for {} and {}: begin a new \
             training there",
            scenario.name, here.0, here.1
        )))
    }

    /// Writes an edited world to `path`, with the comments of `like`, that it was made from, or else of the file that is
    /// there.
    ///
    /// # Errors
    /// It cannot be written; or somebody else has changed the file, and it was not asked for twice.
    pub(super) fn save_scenario(
        &mut self,
        scenario: &Arc<Scenario>,
        like: &str,
        path: &Path,
    ) -> Result<(), RunError> {
        self.may_overwrite(scenario, path)?;
        let older = text_of(like).or_else(|| read_text(path).ok());
        let text = to_text(scenario, older.as_deref());
        if text.len() as u64 > MAX_FILE_BYTES {
            let why =
                "the world is too large: its file would have more than 1 MiB, and could not be read again";
            return Err(RunError::failed(path, why));
        }
        write_atomic(path, |file| file.write_all(text.as_bytes()))
            .map_err(|error| RunError::failed(path, error.to_string()))?;
        let file = path.display().to_string();
        // What the page has saved is a file of the user's from now on, which can be asked for.
        #[cfg(target_arch = "wasm32")]
        crate::scenario::virtual_files::add_upload(file.clone(), text.into_bytes());
        if file == self.config.scenario_from {
            self.loaded_scenario = Scenario::clone(scenario);
            // Whether it is driven in, the user says in the editor.
            #[cfg(not(target_arch = "wasm32"))]
            self.watch_scenario_file();
        }
        self.retract_notice(&file);
        self.notify(Severity::Info, format!("Saved to {file}"));
        self.saved_scenario = Some((file, scenario.clone()));
        Ok(())
    }

    /// Whether the file at `path` may be written over: what is there is what was read or written last, or it is asked for
    /// the second time. (Of a file that was never read here whoever chose it was asked.)
    ///
    /// # Errors
    /// It is asked for the first time.
    fn may_overwrite(&mut self, scenario: &Scenario, path: &Path) -> Result<(), RunError> {
        let file = path.display().to_string();
        let asked = (file == self.config.scenario_from).then_some(&self.loaded_scenario);
        let saved = self.saved_scenario.iter().filter(|saved| saved.0 == file).map(|saved| &*saved.1);
        let draft = self.draft.iter().filter(|draft| draft.1 == file).map(|draft| &*draft.2);
        let mut known = asked.into_iter().chain(saved).chain(draft).peekable();
        let there = Scenario::load_draft(path).ok();
        let as_known = known.peek().is_none()
            || there.as_ref() == Some(scenario)
            || known.any(|known| there.as_ref() == Some(known));
        let again = self.overwrite_requested.take().as_deref() == Some(path);
        if !path_exists(path) || as_known || again {
            return Ok(());
        }
        self.overwrite_requested = Some(path.into());
        let why = "it was changed since by somebody else, which would be gone: save once more, or save it elsewhere";
        Err(RunError::failed(path, why))
    }

    /// Opens the scenario at `path`, a file or a shipped name, to be edited: also one whose parts don't fit together yet.
    ///
    /// # Errors
    /// It cannot be read.
    pub(super) fn open_in_editor(&mut self, path: &Path) -> Result<(), RunError> {
        let from = path.display().to_string();
        let scenario = if path_exists(path) { Scenario::load_draft(path) } else { shipped::scenario(&from) }?;
        let number = self.draft.as_ref().map_or(0, |draft| draft.0) + 1;
        self.draft = Some((number, from, Arc::new(scenario)));
        Ok(())
    }

    /// After an episode's end: the world that was waiting for it is taken.
    pub(super) fn apply_pending_scenario(&mut self, world: &mut World) {
        let Some(scenario) = self.pending_scenario.take() else { return };
        match self.switch_scenario(world, &scenario) {
            Ok(()) => {
                self.notify(
                    Severity::Info,
                    format!("{}: the changed world is driven in now", self.config.scenario_from),
                );
                self.loaded_scenario = scenario;
            }
            Err(error) => self.notify(Severity::Error, error.to_string()),
        }
    }
}

/// The world that is asked for by `from`, a shipped name or a file, as it stands there.
pub(super) fn load_source(from: &str) -> Option<Scenario> {
    shipped::scenario(from).ok()
}

/// The text of a shipped scenario or of a file.
fn text_of(from: &str) -> Option<String> {
    match shipped::scenario_text(from) {
        Some(text) if !path_exists(Path::new(from)) => Some(text.into()),
        _ => read_text(from).ok(),
    }
}
