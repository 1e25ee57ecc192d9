//! Autosaves: a copy of the training on disk (in a browser, in its storage), at most half a minute old, in case the app ends
//! unexpectedly.
//!
//! In: the training, between two control steps. Out: a run folder that `--resume` continues, replaced by a newer one at every
//! interval; and the last session, which the app offers to continue at its next start. The training is copied in a few
//! milliseconds and written in the background. Nothing is saved while an evaluation runs, because its result belongs to the run.
//!
//! | file | purpose |
//! |---|---|
//! | `background.rs` | an autosave that is being written |
//! | `slot.rs` | the folder of one training run's autosave |
//! | `sessions.rs` | autosaves of earlier sessions: which to offer, which to delete |
//! | `retention.rs` | how many autosaves and editor backups of earlier sessions are kept |
//! | `latest.rs` | the current autosave, in words, for a process that ends unexpectedly |
//! | `browser_*.rs` | the same in a browser, where the page stores the files |

#[cfg_attr(target_arch = "wasm32", path = "browser_background.rs")]
mod background;
pub mod latest;
#[cfg(not(target_arch = "wasm32"))]
pub mod retention;
#[cfg_attr(target_arch = "wasm32", path = "browser_sessions.rs")]
mod sessions;
#[cfg_attr(target_arch = "wasm32", path = "browser_slot.rs")]
mod slot;

use std::path::PathBuf;
use std::time::Duration;

use bevy::platform::time::Instant;
use bevy::prelude::*;

use super::active_mode::ActiveMode;
use super::evaluations::Evaluations;
use super::journal::Journal;
use super::notices::{NoticeTopic, Notices, notify};
use super::run_snapshot::RunSnapshot;
#[cfg(not(target_arch = "wasm32"))]
use super::save;
use super::saved_run::SavedRun;
use super::training_run::TrainingRun;
use crate::agent::ActiveLearner;
use crate::app::app_status::{LastSession, Severity};
use crate::run::{RunError, without_help};
use background::Writing;
use sessions::FoundSession;
use slot::Slot;

/// The default interval between autosaves. With the time that writing takes, less than half a minute is lost.
pub const AUTOSAVE_INTERVAL: Duration = Duration::from_secs(25);

/// If an evaluation has delayed an autosave for this long, no more control steps are taken until the evaluation ends.
const MAX_DELAY: Duration = Duration::from_secs(3);

/// The interval between autosaves while the user seems to be leaving the page.
const SOON: Duration = Duration::from_secs(3);

/// What the user can do if autosaves fail.
const FAILURE_HELP: &str = if cfg!(target_arch = "wasm32") {
    "save the policy before you close the page"
} else {
    "make room there, or save the run elsewhere"
};

/// Where and when to save.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct AutosaveOptions {
    /// The folder that holds the autosaves of all sessions.
    pub folder: PathBuf,
    /// The interval between autosaves.
    pub every: Duration,
}

#[cfg(not(target_arch = "wasm32"))]
impl AutosaveOptions {
    /// Autosaves in the user's data folder; without one, under `runs/` in the working directory.
    #[must_use]
    pub fn in_data_folder(every: Duration) -> Self {
        let folders = directories::ProjectDirs::from("", "", "wayfield");
        let folder = folders.map_or_else(|| "runs".into(), |folders| folders.data_local_dir().to_path_buf());
        let folder = folder.join("autosave");
        Self { folder: std::path::absolute(&folder).unwrap_or(folder), every }
    }
}

/// Numbers of control steps and interventions so far. If either differs from the last autosave, the training has changed.
type Progress = (u64, usize);

/// The state of the autosaves.
#[derive(Resource)]
pub struct Autosave {
    /// `None` if autosaves are off.
    options: Option<AutosaveOptions>,
    /// The autosave of this training run; `None` while it is being written, or if autosaves are off.
    slot: Option<Slot>,
    writing: Option<Writing>,
    /// The training at the last autosave; `None` before the first, after a failure and after an intervention.
    saved: Option<Progress>,
    /// Time of the last autosave, successful or not, or the start of the training.
    since: Instant,
    /// Whether to save soon, at the interval [`SOON`].
    soon: bool,
    /// The last failure that was reported.
    reported: Option<String>,
    /// The session to offer.
    last_session: Option<FoundSession>,
}

impl Default for Autosave {
    fn default() -> Self {
        Self {
            options: None,
            slot: None,
            writing: None,
            saved: None,
            since: Instant::now(),
            soon: false,
            reported: None,
            last_session: None,
        }
    }
}

impl Autosave {
    /// Autosaves with these options; `None` saves nothing. Deletes old autosaves of earlier sessions, and with `offer`
    /// offers the newest.
    pub(super) fn new(options: Option<AutosaveOptions>, offer: bool) -> Self {
        let found = options.as_ref().map(|options| sessions::find(&options.folder)).unwrap_or_default();
        Self {
            slot: options.as_ref().map(|options| Slot::new(&options.folder)),
            last_session: found.into_iter().next().filter(|_| offer),
            options,
            ..Self::default()
        }
    }

    /// The session to offer, if there is one.
    #[must_use]
    pub fn last_session(&self) -> Option<LastSession> {
        self.last_session.as_ref().map(FoundSession::describe)
    }

    /// Withdraws the offer.
    pub(super) fn dismiss_last_session(&mut self) {
        self.last_session = None;
    }

    /// Marks the training as changed by an intervention. [`Progress`] may not show the change, because an intervention can
    /// replace the last one in the journal.
    pub(super) fn mark_changed(&mut self) {
        self.saved = None;
    }

    /// Begins to save another training run.
    fn begin(&mut self, slot: Option<Slot>, saved: Option<Progress>) {
        latest::set(slot.as_ref().and_then(Slot::path));
        (self.slot, self.saved, self.since) = (slot, saved, Instant::now());
    }
}

/// Saves when it is time.
pub(super) fn run(world: &mut World) {
    #[cfg(target_arch = "wasm32")]
    take_reports(world);
    finish_writing(world, false);
    if delay(world).is_some() && !world.resource::<Evaluations>().is_running() {
        start(world);
    }
}

/// Whether control steps have to wait for an evaluation, because the training must be saved after it.
pub(super) fn holds_steps(world: &World) -> bool {
    world.resource::<Evaluations>().is_running() && delay(world).is_some_and(|delay| delay >= MAX_DELAY)
}

/// The time since an autosave became due; `None` if none is due.
fn delay(world: &World) -> Option<Duration> {
    let autosave = world.resource::<Autosave>();
    let every = autosave.options.as_ref()?.every;
    let every = if autosave.soon { every.min(SOON) } else { every };
    let is_possible = autosave.slot.is_some() && !world.resource::<ActiveMode>().has_pending_changes();
    autosave.since.elapsed().checked_sub(every).filter(|_| is_possible && has_changed(world))
}

/// Whether the training has changed since the last autosave, and can be continued.
fn has_changed(world: &World) -> bool {
    let saved = world.resource::<Autosave>().saved;
    let has_begun = world.resource::<ActiveLearner>().0.env_steps() > 0;
    has_begun && saved != Some(progress(world)) && !world.resource::<TrainingRun>().has_failed
}

fn progress(world: &World) -> Progress {
    let journal = world.resource::<Journal>();
    (journal.steps, journal.entries.len())
}

/// Copies the training, and writes the copy in the background.
fn start(world: &mut World) {
    let progress = progress(world);
    let Some(slot) = world.resource_mut::<Autosave>().slot.take() else { return };
    let snapshot = RunSnapshot::capture(world, slot.known_bytes());
    let mut autosave = world.resource_mut::<Autosave>();
    (autosave.saved, autosave.since, autosave.soon) = (Some(progress), Instant::now(), false);
    match snapshot {
        Ok(snapshot) => autosave.writing = Some(Writing::start(slot, snapshot)),
        Err(error) => finish(world, slot, Err(error)),
    }
}

/// Takes note of an autosave that has been written; with `wait`, waits for it.
fn finish_writing(world: &mut World, wait: bool) {
    let mut autosave = world.resource_mut::<Autosave>();
    let Some(writing) = autosave.writing.take() else { return };
    match writing.poll(wait) {
        Ok((slot, written)) => finish(world, slot, written),
        Err(writing) => autosave.writing = Some(writing),
    }
}

/// Puts back the slot after an autosave, and reports a failure unless it has been reported before.
fn finish(world: &mut World, slot: Slot, written: Result<(), RunError>) {
    let mut autosave = world.resource_mut::<Autosave>();
    autosave.slot = Some(slot);
    let failure = written.err().map(|error| error.to_string());
    if failure.is_some() {
        autosave.saved = None;
    }
    if failure == autosave.reported {
        return;
    }
    autosave.reported.clone_from(&failure);
    match failure {
        None => world.resource_mut::<Notices>().remove(&NoticeTopic::Autosave),
        Some(error) => {
            let cause = without_help(&error);
            let text = format!("Autosave failed: {cause}\nhelp: {FAILURE_HELP}. Training continues");
            notify(world, NoticeTopic::Autosave, Severity::Error, text);
        }
    }
}

/// Saves what has changed since the last autosave, and waits until it is written.
///
/// # Errors
/// The training cannot be copied, or the files cannot be written. The earlier autosave is kept.
#[cfg(not(target_arch = "wasm32"))]
pub fn save_now(world: &mut World) -> Result<(), RunError> {
    finish_writing(world, true);
    if !has_changed(world) {
        return Ok(());
    }
    let Some(mut slot) = world.resource_mut::<Autosave>().slot.take() else { return Ok(()) };
    let progress = progress(world);
    let written = save::complete_snapshot(world).and_then(|snapshot| slot.replace(&snapshot));
    world.resource_mut::<Autosave>().saved = Some(progress);
    finish(world, slot, written.clone());
    written
}

/// Ends the autosaves of the current training run, before another one replaces it. Deletes them unless they are to be kept for an
/// offer at the next start.
pub(super) fn end_training(world: &mut World, keep: bool) {
    finish_writing(world, true);
    let mut autosave = world.resource_mut::<Autosave>();
    if let Some(slot) = autosave.slot.as_mut().filter(|_| !keep) {
        slot.delete();
    }
    let slot = autosave.options.as_ref().map(|options| Slot::new(&options.folder));
    autosave.begin(slot, None);
}

/// Ends the autosaves when the app quits, and deletes those of the current training run.
#[cfg(not(target_arch = "wasm32"))]
pub(super) fn discard(world: &mut World) {
    end_training(world, false);
    world.resource_mut::<Autosave>().begin(None, None);
}

/// Continues the session that was offered.
///
/// # Errors
/// Another process has already continued it, its files are invalid, or the current training run cannot be saved first.
#[cfg(not(target_arch = "wasm32"))]
pub(super) fn continue_last_session(world: &mut World) -> Result<(), RunError> {
    let Some(found) = world.resource_mut::<Autosave>().last_session.take() else { return Ok(()) };
    let slot = Slot::of_existing(&found.path)?;
    let run = world.resource::<TrainingRun>();
    let saved = SavedRun::from_folder(&found.path, &run.config.extensions)?;
    let would_lose = run.would_lose_training(world.resource::<ActiveLearner>().0.env_steps());
    if would_lose && let Err(error) = save_now(world) {
        // The user can make room and try again.
        world.resource_mut::<Autosave>().last_session = Some(found);
        return Err(error);
    }
    start_saved(world, saved, || slot);
    Ok(())
}

/// Requests the files of the session that was offered. They arrive in a later frame.
///
/// # Errors
/// None.
#[cfg(target_arch = "wasm32")]
pub(super) fn continue_last_session(world: &mut World) -> Result<(), RunError> {
    if world.resource_mut::<Autosave>().last_session.take().is_some() {
        crate::app::page::load_session();
    }
    Ok(())
}

/// Continues the run `saved` from its autosave. Calls `slot` afterwards, because the start ends the autosaves of the current
/// training run.
fn start_saved(world: &mut World, saved: SavedRun, slot: impl FnOnce() -> Slot) {
    saved.start(world);
    let progress = progress(world);
    world.resource_mut::<Autosave>().begin(Some(slot()), Some(progress));
    notify(world, NoticeTopic::General, Severity::Info, "The last session continues");
}

/// Takes note of what the page has reported since the last frame.
#[cfg(target_arch = "wasm32")]
fn take_reports(world: &mut World) {
    world.resource_mut::<Autosave>().soon |= sessions::take_save_soon();
    let Some(received) = sessions::take_session() else { return };
    let extensions = world.resource::<TrainingRun>().config.extensions.clone();
    match received.and_then(|files| SavedRun::from_files(&files, &extensions)) {
        Ok(saved) => {
            finish_writing(world, true);
            start_saved(world, saved, Slot::of_last_session);
        }
        Err(error) => notify(world, NoticeTopic::General, Severity::Error, error.to_string()),
    }
}
