//! File dialogs of the system: files to open, and paths to save to.
//!
//! In: commands that need a dialog. Out: commands with the chosen path. A dialog runs in the background; nothing waits for it.

use std::path::PathBuf;
use std::sync::Arc;
use std::time::{Duration, Instant};

use bevy::ecs::system::NonSendMarker;
use bevy::prelude::*;
use bevy::tasks::{IoTaskPool, Task, block_on, poll_once};
use rfd::{AsyncFileDialog, FileHandle};

use super::app_status::Severity;
use super::commands::{Command, FigureFormat, SaveKind};
use super::session::notices::NoticeTopic;
use super::session::{Notices, TrainingRun, unused_path};
use crate::scenario::Scenario;

/// A dialog that closes sooner than this has not appeared, because no user is that fast.
const MIN_DURATION: Duration = Duration::from_millis(250);

/// Notice if a file is to be opened and the system has no dialogs.
const NO_DIALOG: &str = "This system has no file dialogs\n\
     help: drop a file on the window, or start with --open FILE. On Linux, a desktop portal or zenity provides dialogs";

/// Notice if a file is to be saved and the system has no dialogs.
const NO_SAVE_DIALOG: &str = "This system has no file dialogs: the file goes to the folder runs";

/// The dialog that is open now, if any.
#[derive(Resource, Default)]
pub struct FileDialogs {
    open: Option<Dialog>,
}

struct Dialog {
    answer: Task<Answer>,
    purpose: Purpose,
}

/// The chosen path, if any, and how long the dialog was open. (An idle app polls the answer only once a second.)
type Answer = (Option<PathBuf>, Duration);

/// The purpose of a dialog.
enum Purpose {
    /// To open a file.
    Open,
    /// To save a part of the training run.
    Save(SaveKind),
    /// To open a scenario in the editor.
    Edit,
    /// To save an edited scenario that is based on `based_on`.
    SaveScenario { scenario: Arc<Scenario>, based_on: String },
}

impl Purpose {
    /// The purpose of `command`, if it needs a dialog.
    fn of(command: &Command) -> Option<Self> {
        match command {
            Command::OpenDialog => Some(Self::Open),
            Command::SaveDialog(what) => Some(Self::Save(*what)),
            Command::OpenInEditor(None) => Some(Self::Edit),
            Command::SaveScenario { scenario, based_on, path: None } => {
                Some(Self::SaveScenario { scenario: scenario.clone(), based_on: based_on.clone() })
            }
            _ => None,
        }
    }

    /// The command for the chosen path.
    fn command(self, path: PathBuf) -> Command {
        match self {
            Self::Open => Command::Open(path),
            Self::Save(what) => Command::Save(what, path),
            Self::Edit => Command::OpenInEditor(Some(path)),
            Self::SaveScenario { scenario, based_on } => {
                Command::SaveScenario { scenario, based_on, path: Some(path) }
            }
        }
    }

    /// The suggested name of the file to save; `None` if a file is opened.
    fn suggested_file_name(&self, run: &TrainingRun) -> Option<String> {
        match self {
            Self::Open | Self::Edit => None,
            Self::Save(what) => Some(run.suggested_file_name(*what)),
            Self::SaveScenario { .. } => Some(run.suggested_file_name(SaveKind::Scenario)),
        }
    }
}

/// Opens the dialogs that commands need, one at a time, and sends commands with the chosen paths. A command that needs a dialog
/// while another one is open is ignored. (Some systems allow dialogs only on the main thread, hence the marker.)
pub(super) fn run_file_dialogs(
    _main_thread: NonSendMarker,
    mut messages: ResMut<Messages<Command>>,
    mut seen: Local<bevy::ecs::message::MessageCursor<Command>>,
    run: Res<TrainingRun>,
    mut notices: ResMut<Notices>,
    mut dialogs: ResMut<FileDialogs>,
) {
    if let Some(mut dialog) = dialogs.open.take() {
        match block_on(poll_once(&mut dialog.answer)) {
            None => dialogs.open = Some(dialog),
            Some((Some(path), _)) => {
                messages.write(dialog.purpose.command(path));
            }
            Some((None, duration)) if duration < MIN_DURATION => {
                match dialog.purpose.suggested_file_name(&run) {
                    // This system has no dialogs: save to the folder of the runs.
                    Some(name) => {
                        notices.add(NoticeTopic::General, Severity::Info, NO_SAVE_DIALOG);
                        messages.write(dialog.purpose.command(unused_path(&name)));
                    }
                    None => notices.add(NoticeTopic::General, Severity::Error, NO_DIALOG),
                }
            }
            Some((None, _)) => {}
        }
    }
    let requested = seen.read(&messages).find_map(Purpose::of);
    if let (None, Some(purpose)) = (&dialogs.open, requested) {
        let answer = match (&purpose, purpose.suggested_file_name(&run)) {
            (Purpose::Save(saved), Some(name)) => save_dialog(*saved, &name),
            (Purpose::SaveScenario { .. }, Some(name)) => save_dialog(SaveKind::Scenario, &name),
            (Purpose::Edit, _) => open_dialog("Open a scenario in the editor", &["ron"]),
            _ => open_dialog(
                "Open a policy, a checkpoint, a scenario, a preset or a map",
                &["safetensors", "bin", "ron", "yaml", "yml", "sdf", "world"],
            ),
        };
        dialogs.open = Some(Dialog { answer, purpose });
    }
}

/// Shows a dialog to choose a file to open.
fn open_dialog(title: &str, extensions: &[&str]) -> Task<Answer> {
    let dialog = AsyncFileDialog::new().set_title(title).add_filter("wayfield files", extensions);
    in_background(dialog.pick_file())
}

/// Shows a dialog to choose a path to save `what` to, with `name` as the suggestion.
fn save_dialog(what: SaveKind, name: &str) -> Task<Answer> {
    let (title, kind, extensions): (_, _, &[&str]) = match what {
        SaveKind::BestPolicy => ("Save the best policy so far", "Policy", &["safetensors"]),
        SaveKind::Policy => ("Save the current policy", "Policy", &["safetensors"]),
        SaveKind::Run => ("Save the run as a folder", "Folder", &[]),
        SaveKind::Csv => ("Save the episodes", "CSV table", &["csv"]),
        SaveKind::Figure(FigureFormat::Png) => ("Save the curves", "PNG image", &["png"]),
        SaveKind::Figure(FigureFormat::Svg) => ("Save the curves", "SVG image", &["svg"]),
        SaveKind::Scenario => ("Save the scenario", "Scenario", &["ron"]),
    };
    let mut dialog = AsyncFileDialog::new().set_title(title).set_file_name(name);
    if !extensions.is_empty() {
        dialog = dialog.add_filter(kind, extensions);
    }
    in_background(dialog.save_file())
}

/// Runs a dialog in the background.
fn in_background(dialog: impl Future<Output = Option<FileHandle>> + Send + 'static) -> Task<Answer> {
    let since = Instant::now();
    IoTaskPool::get().spawn(async move {
        let path = dialog.await.map(|file| file.path().into());
        (path, since.elapsed())
    })
}
