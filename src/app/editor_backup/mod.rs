//! The backup of the scenario editor: a copy of unsaved changes, a few seconds old, in case the app crashes or is killed.
//!
//! In: the editor. Out: a file (in a browser, an entry in its storage), which is deleted as soon as the changes are saved or
//! discarded; and the newest backup of an earlier session, which the app offers to restore.
//!
//! | file | purpose |
//! |---|---|
//! | `store.rs` | the files of the backups, locked by the processes that write them |
//! | `browser_store.rs` | the same in a browser, where the page stores them |

#[cfg_attr(target_arch = "wasm32", path = "browser_store.rs")]
mod store;
#[cfg(all(test, not(target_arch = "wasm32")))]
mod tests;

use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use bevy::platform::time::Instant;
use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::CurrentViewState;
use super::app_status::{Severity, UnsavedEdits};
use super::editor::Editor;
use super::session::notices::{NoticeTopic, notify};
use super::session::{AutosaveOptions, ScenarioSource};
use super::view_state::EditorSource;
use crate::run::{RunError, without_help};
use crate::scenario::{MAX_FILE_BYTES, Scenario, parse_ron_with_limit, to_ron};
use store::{FoundBackup, Store};

/// The longest interval between backups of changes; shorter if autosaves are more frequent.
const INTERVAL: Duration = Duration::from_secs(10);

/// A backup contains the scenario twice: as edited, and as saved in its file. The rest is for deeper indentation.
const MAX_BACKUP_BYTES: u64 = 3 * MAX_FILE_BYTES;

/// The contents of a backup.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
struct Backup {
    /// The scenario's name or file.
    from: String,
    /// The edited scenario, which may be invalid.
    edited: Scenario,
    /// The scenario as shipped or as saved in its file; `None` if unknown.
    in_file: Option<Scenario>,
}

impl Backup {
    fn of(editor: &Editor) -> Self {
        Self {
            from: editor.from().into(),
            edited: Scenario::clone(editor.scenario()),
            in_file: editor.scenario_in_file().map(|scenario| Scenario::clone(scenario)),
        }
    }

    fn parse(text: &str, path: &Path) -> Option<Self> {
        parse_ron_with_limit(text, path, MAX_BACKUP_BYTES).ok()
    }
}

/// The state of the backups.
#[derive(Resource, Default)]
pub struct EditorBackup {
    /// `None` if backups are disabled.
    store: Option<Store>,
    interval: Duration,
    /// The scenario that this session last wrote to its backup; `None` if it has written none.
    written: Option<Arc<Scenario>>,
    /// When writing a backup was last attempted; `None` without unsaved changes.
    last_attempt: Option<Instant>,
    /// Whether a failure has been reported and no backup has been written since.
    has_failed: bool,
    /// The backup to offer.
    found: Option<FoundBackup>,
}

impl EditorBackup {
    /// Opens the backup folder inside the autosave folder; disabled without `options`. Deletes old backups and offers the
    /// newest.
    pub(super) fn new(options: Option<&AutosaveOptions>) -> Self {
        let Some(options) = options else { return Self::default() };
        let folder = options.folder.join("editor");
        Self {
            found: store::find(&folder),
            store: Some(Store::new(&folder)),
            interval: options.every.min(INTERVAL),
            ..Self::default()
        }
    }

    /// The unsaved changes to offer, if there are any.
    pub(super) fn offer(&self) -> Option<UnsavedEdits> {
        let found = self.found.as_ref()?;
        Some(UnsavedEdits { scenario: found.backup.edited.name.clone(), age_s: found.age_s() })
    }

    /// Hides the offer; the backup file stays until newer ones displace it.
    pub(super) fn dismiss(&mut self) {
        self.found = None;
    }

    fn write(&mut self, editor: &Editor) -> Result<(), RunError> {
        let Some(store) = &mut self.store else { return Ok(()) };
        self.last_attempt = Some(Instant::now());
        let text = to_ron(&Backup::of(editor)).map_err(|error| RunError::Failed(error.to_string()))?;
        store.write(&text)?;
        self.written = Some(editor.scenario().clone());
        self.has_failed = false;
        Ok(())
    }

    fn delete(&mut self) {
        self.written = None;
        if self.last_attempt.take().is_some()
            && let Some(store) = &mut self.store
        {
            store.delete();
        }
    }
}

/// Backs up unsaved changes in the editor if a backup is due; deletes the backup once nothing is unsaved.
pub(super) fn back_up_if_due(world: &mut World) {
    let interval = world.resource::<EditorBackup>().interval;
    if let Err(error) = back_up(world, interval)
        && !std::mem::replace(&mut world.resource_mut::<EditorBackup>().has_failed, true)
    {
        let error = error.to_string();
        let cause = without_help(&error);
        let text = format!("Unsaved changes cannot be backed up: {cause}\nhelp: save the scenario often");
        notify(world, NoticeTopic::General, Severity::Error, text);
    }
}

/// Backs up unsaved changes in the editor if the last attempt is at least `interval` ago.
fn back_up(world: &mut World, interval: Duration) -> Result<(), RunError> {
    world.resource_scope(|world, mut backup: Mut<EditorBackup>| {
        let view_state = &world.resource::<CurrentViewState>().0;
        let editor = view_state.editor.as_deref();
        let Some(editor) = editor.filter(|editor| editor.has_unsaved_changes()) else {
            // Restored changes are unsaved, even if the screen has not opened them yet.
            if !matches!(view_state.open_editor, Some(EditorSource::Draft { .. })) {
                backup.delete();
            }
            return Ok(());
        };
        let is_written =
            backup.written.as_ref().is_some_and(|written| Arc::ptr_eq(written, editor.scenario()));
        if is_written || backup.last_attempt.is_some_and(|last| last.elapsed() < interval) {
            return Ok(());
        }
        backup.write(editor)
    })
}

/// Backs up unsaved changes in the editor, regardless of when the last backup was written. Returns the file of the backup,
/// if anything is unsaved.
///
/// # Errors
/// The file cannot be written.
#[cfg(not(target_arch = "wasm32"))]
pub(super) fn save_now(world: &mut World) -> Result<Option<std::path::PathBuf>, RunError> {
    back_up(world, Duration::ZERO)?;
    Ok(world.resource::<EditorBackup>().store.as_ref().and_then(Store::path))
}

/// Opens the editor with the backup that was offered, which becomes this session's backup.
///
/// # Errors
/// Another process has restored it.
pub(super) fn restore(world: &mut World) -> Result<(), RunError> {
    let mut state = world.resource_mut::<EditorBackup>();
    let Some(found) = state.found.take() else { return Ok(()) };
    let Backup { from, edited, in_file } = found.backup.clone();
    let (edited, in_file) = (Arc::new(edited), in_file.map(Arc::new));
    // The screen offers this only while nothing is unsaved, so this session has no backup yet. If a program sends the command
    // nevertheless, the backup of what is replaced stays, and the next start offers it.
    state.store = Some(Store::of(found)?);
    // Another process may have deleted the file since it was found. After the interval it is written again.
    (state.written, state.last_attempt) = (None, Some(Instant::now()));
    if let Some(in_file) = &in_file {
        world.resource_mut::<ScenarioSource>().record_opened(from.clone(), in_file.clone());
    }
    world.resource_mut::<CurrentViewState>().0.open_editor =
        Some(EditorSource::Draft { from, scenario: edited, in_file });
    Ok(())
}
