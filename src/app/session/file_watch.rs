//! File watches: the scenario follows its file while the user edits it in another program.
//!
//! In: the file, checked five times a second of real time. Out: a scenario that the training adopts when the next
//! episode ends, or a notice about the errors in the file while the training continues in the last valid scenario. Adopted
//! scenarios are recorded in the journal.

use std::path::{Path, PathBuf};
use std::time::{Duration, SystemTime};

use bevy::prelude::*;

use super::notices::{NoticeTopic, Notices, notify};
use super::pacer::Pacer;
use super::scenario_changes::check_can_switch;
use super::scenario_source::ScenarioSource;
use super::training_run::TrainingRun;
use super::{open, start_training};
use crate::agent::ActiveLearner;
use crate::app::app_status::Severity;
use crate::drivers::DriverConfig;
use crate::run::RunError;
use crate::run::preset::Preset;
use crate::run::shipped;
use crate::scenario::{FileError, Scenario, read_text};

/// Time between two checks of a file.
const CHECK_INTERVAL: Duration = Duration::from_millis(200);

/// Modification time and length of a file.
type Stamp = (SystemTime, u64);

/// The watched files.
#[derive(Resource, Default)]
pub(super) struct FileWatches {
    /// The file of the scenario, if it has one.
    scenario: Option<FileWatch>,
    /// A broken file, and the action to take once it is fixed.
    waiting: Option<(FileWatch, RetryAction)>,
}

impl FileWatches {
    /// Watches the scenario file `from`, if it is a file. Its content is read at the first check, because it may have been
    /// written since the caller read it.
    pub fn new(from: &str) -> Self {
        Self { scenario: FileWatch::new(from), waiting: None }
    }

    /// Watches the scenario file `from`, if it is a file. Its current content is already known, so it is not read again.
    pub fn watch_known(&mut self, from: &str) {
        self.scenario = FileWatch::new(from).map(|watch| FileWatch { read: watch.stamp, ..watch });
    }
}

/// The action to take once a broken file is fixed.
pub(super) enum RetryAction {
    /// Start training in this file with the current preset and seed. The user named it on the command line; the default training
    /// runs meanwhile.
    StartTraining,
    /// Start training in this file with the preset and seed that the user requested.
    StartWith {
        /// The preset's file or shipped name.
        preset: String,
        /// The seed.
        seed: u64,
    },
    /// Open the file, as the user requested.
    Open,
}

/// A watched file.
struct FileWatch {
    path: PathBuf,
    /// Time of the last check; `None` before the first poll.
    checked: Option<Duration>,
    /// Stamp at the last check; `None` while the file does not exist.
    stamp: Option<Stamp>,
    /// Stamp when the file was last read.
    read: Option<Stamp>,
}

impl FileWatch {
    /// Watches the file `from`, which need not exist now. `None` for the name of a shipped scenario.
    fn new(from: &str) -> Option<Self> {
        let path = PathBuf::from(from);
        let stamp = stamp(&path);
        // A map or a Gazebo world is imported once.
        let is_map = crate::import::is_map_or_world(&path);
        let is_file = !is_map && (stamp.is_some() || !shipped::is_scenario(from));
        is_file.then_some(Self { path, checked: None, stamp, read: None })
    }

    /// The file's path, if the file should be read at time `now`: it has changed since it was last read, but not between the
    /// last two checks, so probably no program is still writing it.
    fn changed(&mut self, now: Duration) -> Option<PathBuf> {
        if now - *self.checked.get_or_insert(now) < CHECK_INTERVAL {
            return None;
        }
        self.checked = Some(now);
        let before = std::mem::replace(&mut self.stamp, stamp(&self.path));
        let is_settled = self.stamp.is_some() && self.stamp == before;
        if !is_settled || self.stamp == self.read {
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

/// Checks the watched files.
pub(super) fn poll(world: &mut World) {
    let now = world.resource::<Time<Real>>().elapsed();
    let scenario = &mut world.resource_mut::<FileWatches>().scenario;
    let changed = scenario.as_mut().and_then(|watch| watch.changed(now));
    if let Some(path) = changed {
        read_scenario(world, &path);
    }
    let mut watches = world.resource_mut::<FileWatches>();
    let changed = watches.waiting.as_mut().and_then(|(watch, _)| watch.changed(now));
    if let Some(path) = changed {
        retry(world, &path);
    }
}

/// Reads the file of the scenario, which has changed, and schedules the scenario, or reports the errors in it.
fn read_scenario(world: &mut World, path: &Path) {
    let name = path.display().to_string();
    let topic = NoticeTopic::File(name.clone());
    let found = Scenario::load(path);
    let mut source = world.resource_mut::<ScenarioSource>();
    let is_loaded = found.as_ref() == Ok(&source.loaded);
    if is_loaded && source.pending.is_none() {
        return world.resource_mut::<Notices>().remove_error(&topic);
    }
    source.pending = None;
    world.resource_mut::<Notices>().remove(&topic);
    let config = &world.resource::<TrainingRun>().config;
    match found {
        Err(error) => notify(world, topic, Severity::Error, error.to_string()),
        Ok(_) if is_loaded => {}
        Ok(found) if found == config.scenario => {
            world.resource_mut::<ScenarioSource>().record_loaded(name, found);
        }
        Ok(found) => match check_can_switch(config, &found) {
            Err(error) => notify(world, topic, Severity::Error, format!("{name}: {error}")),
            Ok(()) => {
                let text = format!("{name}: the changed scenario runs when the next episode ends");
                notify(world, topic, Severity::Info, text);
                world.resource_mut::<ScenarioSource>().pending = Some(found);
            }
        },
    }
}

/// Retries a broken file after it has changed. If using it would discard a training run worth keeping, only reports
/// that the file is fixed.
fn retry(world: &mut World, path: &Path) {
    let name = path.display().to_string();
    let topic = NoticeTopic::File(name.clone());
    world.resource_mut::<Notices>().remove(&topic);
    if let Err(error) = check_usable(path) {
        return notify(world, topic, Severity::Error, error.to_string());
    }
    let Some((watch, action)) = world.resource_mut::<FileWatches>().waiting.take() else { return };
    let env_steps = world.resource::<ActiveLearner>().0.env_steps();
    if world.resource::<TrainingRun>().would_lose_training(env_steps) {
        let text = format!("{name}: the file is valid now\nhelp: open it to use it");
        return notify(world, topic, Severity::Info, text);
    }
    let paused = world.resource::<Pacer>().is_paused();
    let started = || format!("{name}: training started");
    let done = match &action {
        RetryAction::Open => open::open(world, path),
        RetryAction::StartTraining => start_in_file(world, &name).map(|()| started()),
        RetryAction::StartWith { preset, seed } => {
            start_training::start_training(world, &name, preset, *seed).map(|()| started())
        }
    };
    world.resource_mut::<Pacer>().set_paused(paused);
    match done {
        Ok(text) => notify(world, topic, Severity::Info, text),
        Err(error) => {
            // Something else is wrong, such as the preset: the next change of the file is another chance.
            world.resource_mut::<FileWatches>().waiting = Some((watch, action));
            notify(world, topic, Severity::Error, error.to_string());
        }
    }
}

/// Starts training in the scenario file `name`, with the current preset and seed.
///
/// # Errors
/// The scenario is invalid, or the preset does not fit it.
fn start_in_file(world: &mut World, name: &str) -> Result<(), RunError> {
    start_training::start_in_scenario(world, shipped::scenario_or_set(name)?, name.into())
}

/// Starts to watch the file `from` if it exists and is broken, unless it is a map or a world. Returns whether it is watched.
pub(super) fn retry_when_fixed(world: &mut World, from: &str, action: RetryAction) -> bool {
    let is_broken = Path::new(from).is_file() && check_usable(Path::new(from)).is_err();
    let Some(watch) = FileWatch::new(from).filter(|_| is_broken) else { return false };
    world.resource_mut::<FileWatches>().waiting = Some((watch, action));
    true
}

/// Checks that the file at `path` is valid: a scenario, a level generator, a set of scenarios, a preset or a classical driver.
fn check_usable(path: &Path) -> Result<(), FileError> {
    let text = read_text(path)?;
    if DriverConfig::looks_like(&text) {
        return DriverConfig::parse(&text, path).map(drop);
    }
    if open::is_set(&text) {
        return shipped::scenario_or_set(&path.display().to_string()).map(drop);
    }
    match Scenario::parse(&text, path) {
        Err(_) if open::is_preset(&text) => Preset::parse(&text, path).map(drop),
        found => found.map(drop),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_is_read_once_it_has_not_changed_between_two_checks() {
        let folder = tempfile::tempdir().expect("temporary folder");
        let file = folder.path().join("mine.ron");
        let write = |text: &str| std::fs::write(&file, text).expect("the file can be written");
        write("1");
        let mut watch = FileWatch::new(&file.display().to_string()).expect("a file");
        let mut changed = |at_ms: u64| watch.changed(Duration::from_millis(at_ms)).is_some();
        // The first poll starts the clock. The contents are read at the first check.
        assert_eq!([1000, 1199, 1200, 1201, 1400].map(&mut changed), [false, false, true, false, false]);
        // A program that is still writing.
        write("12");
        assert!(!changed(1600));
        write("123");
        assert!(!changed(1800));
        assert!(!changed(1999), "the next check is not due");
        assert!(changed(2000));
        // A file that is deleted and written again.
        std::fs::remove_file(&file).expect("the file exists");
        assert_eq!([2200, 2400].map(&mut changed), [false, false]);
        write("1234");
        assert_eq!([2600, 2800, 3000].map(&mut changed), [false, true, false]);
    }
}
