//! The scenario's file, watched: whoever saves it in an editor sees the world change in the window.
//!
//! In: the file, as often as a few times a second. Out: a world that is taken when the next episode ends, or what is wrong
//! with the file, while the last good world goes on. What is taken stands in the journal, as what the hand does.

use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use bevy::platform::time::Instant;
use bevy::prelude::World;

use super::Session;
use crate::agent::ActiveLearner;
use crate::app::app_snapshot::Severity;
use crate::run::preset::Preset;
use crate::run::shipped;
use crate::scenario::{FileError, Scenario};

/// So long between two looks at the file.
const EVERY: Duration = Duration::from_millis(200);

/// When it was written, and its length.
type Stamp = (SystemTime, u64);

/// The files that are watched.
#[derive(Default)]
pub(super) struct FileWatches {
    /// The scenario's, if it is one.
    pub file: Option<FileWatch>,
    /// One that could not be used, and what is done as soon as it can.
    waited_for: Option<(FileWatch, RetryAction)>,
}

impl FileWatches {
    /// Watches the file that `from` names, if it is one.
    pub fn new(from: &str) -> Self {
        Self { file: FileWatch::new(from), waited_for: None }
    }
}

/// What is done when a file can be used at last.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum RetryAction {
    /// A training begins in it: the one that goes on is nobody's choice.
    StartTraining,
    /// It is opened, as if it had been asked for again.
    Open,
}

/// A file that is watched.
pub(super) struct FileWatch {
    path: PathBuf,
    looked: Instant,
    /// As it was at the last look; none while there is no such file.
    stamp: Option<Stamp>,
    /// As it was when it was read last.
    read: Option<Stamp>,
}

impl FileWatch {
    /// Watches the file that `from` names, whether it is there at this moment or not; a shipped world's name is none. It
    /// is read once at first: it may have been written since whoever asks has read it.
    pub fn new(from: &str) -> Option<Self> {
        let path = PathBuf::from(from);
        let stamp = stamp(&path);
        let is_file = stamp.is_some() || !shipped::is_scenario(from);
        is_file.then(|| Self { path, looked: Instant::now(), stamp, read: None })
    }

    /// The file, if it is to be read: it has changed, and has been the same for two looks, so that nobody is in the middle
    /// of writing it.
    fn changed(&mut self) -> Option<PathBuf> {
        if self.looked.elapsed() < EVERY {
            return None;
        }
        self.looked = Instant::now();
        let before = std::mem::replace(&mut self.stamp, stamp(&self.path));
        let is_idle = self.stamp.is_some() && self.stamp == before;
        if !is_idle || self.stamp == self.read {
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
    pub(super) fn poll_watched_files(&mut self, world: &mut World) {
        if let Some(path) = self.file_watches.file.as_mut().and_then(FileWatch::changed) {
            self.scenario_changed(&path);
        }
        let waited_for = self.file_watches.waited_for.as_mut();
        if let Some(path) = waited_for.and_then(|(watch, _)| watch.changed()) {
            self.try_again(world, &path);
        }
    }

    /// The scenario's file was written: its world is coming, or what is wrong with it is told.
    fn scenario_changed(&mut self, path: &Path) {
        let name = path.display().to_string();
        let found = Scenario::load(path);
        let loaded_scenario = found.as_ref() == Ok(&self.loaded_scenario);
        if loaded_scenario && self.pending_scenario.is_none() {
            // What was told of its mistakes is over.
            return self.notices.retain(|(notice, _)| {
                notice.severity != Severity::Error || notice.text.split(':').next() != Some(&name)
            });
        }
        self.retract_notice(&name);
        self.pending_scenario = None;
        match found {
            Err(error) => self.notify(Severity::Error, error.to_string()),
            Ok(_) if loaded_scenario => {}
            Ok(found) if found == self.config.scenario => self.loaded_scenario = found,
            Ok(found) => match self.check_can_switch(&found) {
                Err(error) => self.notify(Severity::Error, format!("{name}: {error}")),
                Ok(()) => {
                    self.notify(
                        Severity::Info,
                        format!("{name}: its new world is taken when the next episode ends"),
                    );
                    self.pending_scenario = Some(found);
                }
            },
        }
    }

    /// A file that could not be used was written. If it can be now, it is, unless a training of some worth would be gone.
    fn try_again(&mut self, world: &mut World, path: &Path) {
        let name = path.display().to_string();
        self.retract_notice(&name);
        if let Err(error) = usable(path) {
            return self.notify(Severity::Error, error.to_string());
        }
        let Some((_, then)) = self.file_watches.waited_for.take() else { return };
        if self.would_lose_training(world.resource::<ActiveLearner>().0.env_steps()) {
            return self.notify(Severity::Info, format!("{name}: it can be used now; open it, if you like"));
        }
        let paused = self.pacer.paused;
        match then {
            RetryAction::Open => self.open_or_notify(world, path),
            RetryAction::StartTraining => {
                let (preset, seed) = (self.config.preset_from.clone(), self.config.seed);
                match self.start_training(world, &name, &preset, seed) {
                    Ok(()) => self.notify(Severity::Info, format!("{name}: training begins there")),
                    Err(error) => self.notify(Severity::Error, error.to_string()),
                }
            }
        }
        self.pacer.paused = paused;
    }

    /// Where the file `from` is there and cannot be used, it is waited for.
    pub(super) fn retry_when_fixed(&mut self, from: &str, then: RetryAction) {
        if Path::new(from).is_file() && usable(Path::new(from)).is_err() {
            self.file_watches.waited_for = FileWatch::new(from).map(|watch| (watch, then));
        }
    }

    /// From now on the scenario's file is watched, if it is one; what it holds now is known.
    pub(super) fn watch_scenario_file(&mut self) {
        self.file_watches.file =
            FileWatch::new(&self.config.scenario_from).map(|watch| FileWatch { read: watch.stamp, ..watch });
    }
}

/// Whether there is a scenario in the file at `path`, or else a preset.
fn usable(path: &Path) -> Result<(), FileError> {
    match Scenario::load(path) {
        Err(_) if Preset::load(path).is_ok() => Ok(()),
        found => found.map(drop),
    }
}
