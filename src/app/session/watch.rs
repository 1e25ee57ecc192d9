//! The scenario's file, watched: whoever saves it in an editor sees the world change in the window.
//!
//! In: the file, as often as a few times a second. Out: a world that is taken when the next episode ends, or what is wrong
//! with the file, while the last good world goes on. What is taken stands in the journal, as what the hand does.

use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use bevy::platform::time::Instant;
use bevy::prelude::World;

use super::Session;
use crate::app::status::Weight;
use crate::run::shipped;
use crate::scenario::Scenario;

/// So long between two looks at the file.
const EVERY: Duration = Duration::from_millis(200);

/// When it was written, and its length.
type Stamp = (SystemTime, u64);

/// The files that are watched.
#[derive(Default)]
pub(super) struct Watches {
    /// The scenario's, if it is one.
    pub file: Option<Watch>,
    /// One that could not be used, and what is done as soon as it can.
    waited_for: Option<(Watch, Then)>,
}

impl Watches {
    /// Watches the file that `from` names, if it is one.
    pub fn of(from: &str) -> Self {
        Self { file: Watch::of(from), waited_for: None }
    }
}

/// What is done when a file can be used at last.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Then {
    /// A training begins in it: the one that goes on is nobody's choice.
    Begin,
    /// It is opened, as if it had been asked for again.
    Open,
}

/// A file that is watched.
pub(super) struct Watch {
    path: PathBuf,
    looked: Instant,
    /// As it was at the last look; none while there is no such file.
    stamp: Option<Stamp>,
    /// As it was when it was read last.
    read: Option<Stamp>,
}

impl Watch {
    /// Watches the file that `from` names, if it is one; what it holds now is known already.
    pub fn of(from: &str) -> Option<Self> {
        let path = PathBuf::from(from);
        let stamp = stamp(&path)?;
        Some(Self { path, looked: Instant::now(), stamp: Some(stamp), read: Some(stamp) })
    }

    /// The file, if it is to be read: it has changed, and has been the same for two looks, so that nobody is in the middle
    /// of writing it.
    fn changed(&mut self) -> Option<PathBuf> {
        if self.looked.elapsed() < EVERY {
            return None;
        }
        self.looked = Instant::now();
        let before = std::mem::replace(&mut self.stamp, stamp(&self.path));
        let rests = self.stamp.is_some() && self.stamp == before;
        if !rests || self.stamp == self.read {
            return None;
        }
        self.read = self.stamp;
        Some(self.path.clone())
    }
}

fn stamp(path: &Path) -> Option<Stamp> {
    let file = std::fs::metadata(path).ok().filter(std::fs::Metadata::is_file)?;
    Some((file.modified().ok()?, file.len()))
}

impl Session {
    /// A look at the files that are watched.
    pub(super) fn look_at_files(&mut self, world: &mut World) {
        if let Some(path) = self.watches.file.as_mut().and_then(Watch::changed) {
            self.scenario_changed(&path);
        }
        if let Some((watch, then)) = &mut self.watches.waited_for
            && let Some(path) = watch.changed()
        {
            let then = *then;
            self.try_again(world, &path, then);
        }
    }

    /// The scenario's file was written: its world is coming, or what is wrong with it is told.
    fn scenario_changed(&mut self, path: &Path) {
        let name = path.display().to_string();
        self.untell(&name);
        self.coming = None;
        match Scenario::load(path) {
            Err(error) => self.tell(Weight::Failed, error.to_string()),
            Ok(found) if found == self.config.scenario => self.as_asked = found,
            Ok(found) => match self.may_take(&found) {
                Err(error) => self.tell(Weight::Failed, format!("{name}: {error}")),
                Ok(()) => {
                    self.tell(
                        Weight::Told,
                        format!("{name}: its new world is taken when the next episode ends"),
                    );
                    self.coming = Some(found);
                }
            },
        }
    }

    /// A file that could not be used was written.
    fn try_again(&mut self, world: &mut World, path: &Path, then: Then) {
        let name = path.display().to_string();
        self.untell(&name);
        if let Err(error) = Scenario::load(path) {
            return self.tell(Weight::Failed, error.to_string());
        }
        match then {
            Then::Open => self.open_or_tell(world, path),
            Then::Begin => {
                let (preset, seed) = (self.config.preset_from.clone(), self.config.seed);
                match self.begin(world, &name, &preset, seed) {
                    Ok(()) => self.tell(Weight::Told, format!("{name}: training begins there")),
                    Err(error) => self.tell(Weight::Failed, error.to_string()),
                }
            }
        }
    }

    /// Where the scenario's file `from` is there and cannot be used, it is waited for.
    pub(super) fn wait_for(&mut self, from: &str, then: Then) {
        if from != self.config.scenario_from && shipped::scenario(from).is_err() {
            self.watches.waited_for = Watch::of(from).map(|watch| (watch, then));
        }
    }
}
