//! Another world under the training: one that was edited, or whose file has changed.
//!
//! In: a world. Out: the training goes on in it, or begins anew there; worlds written to files, and opened to be edited.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use bevy::prelude::*;

use super::trails::Trails;
use super::{Session, hand};
use crate::app::orders::Mode;
use crate::app::status::Weight;
use crate::run::folder::write_whole;
use crate::run::{RunError, shipped};
use crate::scenario::{MOST_BYTES, Scenario, findings, is_there, read_text, to_text};

impl Session {
    /// The training goes on in an edited world, or begins anew there.
    ///
    /// # Errors
    /// The world can't be, or the network doesn't fit it; all stays as it was then.
    pub(super) fn take_edited(
        &mut self,
        world: &mut World,
        scenario: &Scenario,
        from: String,
        again: bool,
    ) -> Result<(), RunError> {
        if let Some(finding) = findings(scenario).first() {
            return Err(RunError::Unusable(format!("{}: {finding}", scenario.name)));
        }
        if again {
            return self.begin_in(world, scenario.clone(), from);
        }
        self.take_world(world, scenario)?;
        self.as_asked = as_it_stands(&from).unwrap_or_else(|| scenario.clone());
        self.config.scenario_from = from;
        #[cfg(not(target_arch = "wasm32"))]
        self.watch_file();
        self.offer_own();
        Ok(())
    }

    /// The training goes on in `scenario`, all arenas with a new episode.
    ///
    /// # Errors
    /// The network doesn't fit it.
    pub(super) fn take_world(&mut self, world: &mut World, scenario: &Scenario) -> Result<(), RunError> {
        self.may_take(scenario)?;
        let (mode, pace) = (self.mode, self.pacer.pace);
        self.set_mode(world, Mode::Train)?;
        let deed = hand::Deed::World(Box::new(scenario.clone()));
        hand::apply(world, &deed);
        self.journal.note(deed, false);
        self.world_is_another(world);
        let arenas = self.config.preset.arenas;
        world.resource_mut::<Trails>().restart(arenas);
        self.coming = None;
        self.set_mode(world, mode)?;
        self.pacer.pace = pace;
        Ok(())
    }

    /// Whether the training can go on in `scenario`.
    ///
    /// # Errors
    /// It cannot: what the network was made for differs, or it takes too much memory.
    pub(super) fn may_take(&self, scenario: &Scenario) -> Result<(), RunError> {
        let shape = |scenario: &Scenario| (scenario.lidar.beams, scenario.robot.motions.len());
        let ((beams, motions), here) = (shape(scenario), shape(&self.config.scenario));
        if (beams, motions) == here {
            let fits = self.config.preset.fits(scenario);
            return fits.map_err(|error| RunError::Unusable(format!("{}: {error}", scenario.name)));
        }
        Err(RunError::Unusable(format!(
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
    pub(super) fn save_world(
        &mut self,
        scenario: &Arc<Scenario>,
        like: &str,
        path: &Path,
    ) -> Result<(), RunError> {
        self.may_overwrite(scenario, path)?;
        let older = text_of(like).or_else(|| read_text(path).ok());
        let text = to_text(scenario, older.as_deref());
        if text.len() as u64 > MOST_BYTES {
            let why =
                "the world is too large: its file would have more than 1 MiB, and could not be read again";
            return Err(RunError::failed(path, why));
        }
        write_whole(path, |file| file.write_all(text.as_bytes()))
            .map_err(|error| RunError::failed(path, error.to_string()))?;
        let file = path.display().to_string();
        // What the page has saved is a file of the user's from now on, which can be asked for.
        #[cfg(target_arch = "wasm32")]
        crate::scenario::shelf::hand_in(file.clone(), text.into_bytes());
        if file == self.config.scenario_from {
            self.as_asked = Scenario::clone(scenario);
            // Whether it is driven in, the user says in the editor.
            #[cfg(not(target_arch = "wasm32"))]
            self.watch_file();
        }
        self.untell(&file);
        self.tell(Weight::Told, format!("Saved to {file}"));
        self.saved_world = Some((file, scenario.clone()));
        Ok(())
    }

    /// Whether the file at `path` may be written over: what is there is what was read or written last, or it is asked for
    /// the second time. (Of a file that was never read here whoever chose it was asked.)
    ///
    /// # Errors
    /// It is asked for the first time.
    fn may_overwrite(&mut self, scenario: &Scenario, path: &Path) -> Result<(), RunError> {
        let file = path.display().to_string();
        let asked = (file == self.config.scenario_from).then_some(&self.as_asked);
        let saved = self.saved_world.iter().filter(|saved| saved.0 == file).map(|saved| &*saved.1);
        let draft = self.draft.iter().filter(|draft| draft.1 == file).map(|draft| &*draft.2);
        let mut known = asked.into_iter().chain(saved).chain(draft).peekable();
        let there = Scenario::load_draft(path).ok();
        let as_known = known.peek().is_none()
            || there.as_ref() == Some(scenario)
            || known.any(|known| there.as_ref() == Some(known));
        let again = self.overwrites.take().as_deref() == Some(path);
        if !is_there(path) || as_known || again {
            return Ok(());
        }
        self.overwrites = Some(path.into());
        let why = "it was changed since by somebody else, which would be gone: save once more, or save it elsewhere";
        Err(RunError::failed(path, why))
    }

    /// Opens the scenario at `path`, a file or a shipped name, to be edited: also one whose parts don't fit together yet.
    ///
    /// # Errors
    /// It cannot be read.
    pub(super) fn open_to_edit(&mut self, path: &Path) -> Result<(), RunError> {
        let from = path.display().to_string();
        let scenario = if is_there(path) { Scenario::load_draft(path) } else { shipped::scenario(&from) }?;
        let number = self.draft.as_ref().map_or(0, |draft| draft.0) + 1;
        self.draft = Some((number, from, Arc::new(scenario)));
        Ok(())
    }

    /// After an episode's end: the world that was waiting for it is taken.
    pub(super) fn take_coming(&mut self, world: &mut World) {
        let Some(scenario) = self.coming.take() else { return };
        match self.take_world(world, &scenario) {
            Ok(()) => {
                self.tell(
                    Weight::Told,
                    format!("{}: the changed world is driven in now", self.config.scenario_from),
                );
                self.as_asked = scenario;
            }
            Err(error) => self.tell(Weight::Failed, error.to_string()),
        }
    }
}

/// The world that is asked for by `from`, a shipped name or a file, as it stands there.
pub(super) fn as_it_stands(from: &str) -> Option<Scenario> {
    shipped::scenario(from).ok()
}

/// The text of a shipped scenario or of a file.
fn text_of(from: &str) -> Option<String> {
    match shipped::scenario_text(from) {
        Some(text) if !is_there(Path::new(from)) => Some(text.into()),
        _ => read_text(from).ok(),
    }
}
