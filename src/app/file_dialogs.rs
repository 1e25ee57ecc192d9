//! Dialogs: the system's own, for files to open and places to save to.
//!
//! In: the orders that ask for one. Out: the orders that name the file. A dialog runs beside the app; nothing waits for it.

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};

use bevy::ecs::system::NonSendMarker;
use bevy::prelude::*;
use bevy::tasks::{IoTaskPool, Task, block_on, poll_once};
use rfd::AsyncFileDialog;

use super::app_snapshot::Severity;
use super::commands::{Command, SaveKind};
use super::session::Session;
use crate::scenario::Scenario;

/// A dialog that was closed sooner than this was never there: nobody is so quick.
const SOONEST: Duration = Duration::from_millis(250);

/// The dialog that is open, if one is.
#[derive(Resource, Default)]
pub struct FileDialogs {
    open: Option<Dialog>,
}

struct Dialog {
    asking: Task<Option<PathBuf>>,
    what: Asked,
    since: Instant,
}

/// What a dialog is for.
enum Asked {
    /// Something is to be opened.
    Open,
    /// Something of the training is to be saved.
    Save(SaveKind),
    /// A scenario is to be edited.
    Edit,
    /// An edited world is to be saved, as one that was made from `like`.
    SaveScenario { scenario: Arc<Scenario>, like: String },
}

impl Asked {
    /// What `command` asks for, if that takes a dialog.
    fn by(command: &Command) -> Option<Self> {
        match command {
            Command::OpenDialog => Some(Self::Open),
            Command::SaveDialog(what) => Some(Self::Save(*what)),
            Command::OpenInEditor(None) => Some(Self::Edit),
            Command::SaveScenario { scenario, like, path: None } => {
                Some(Self::SaveScenario { scenario: scenario.clone(), like: like.clone() })
            }
            _ => None,
        }
    }

    /// The order that says so.
    fn answered(self, path: PathBuf) -> Command {
        match self {
            Self::Open => Command::Open(path),
            Self::Save(what) => Command::Save(what, path),
            Self::Edit => Command::OpenInEditor(Some(path)),
            Self::SaveScenario { scenario, like } => {
                Command::SaveScenario { scenario, like, path: Some(path) }
            }
        }
    }

    /// The name that is proposed for what is to be saved; none if something is to be opened.
    fn suggested_file_name(&self, session: &Session) -> Option<String> {
        match self {
            Self::Open | Self::Edit => None,
            Self::Save(what) => Some(session.suggested_file_name(*what)),
            Self::SaveScenario { .. } => Some(session.suggested_file_name(SaveKind::Scenario)),
        }
    }
}

/// Opens the dialogs that are asked for, and answers with what was chosen. (On some systems a dialog belongs to the main
/// thread: hence the marker.)
pub(super) fn run_file_dialogs(
    _main_thread: NonSendMarker,
    mut messages: ResMut<Messages<Command>>,
    mut seen: Local<bevy::ecs::message::MessageCursor<Command>>,
    mut session: ResMut<Session>,
    mut dialogs: ResMut<FileDialogs>,
) {
    if let Some(mut dialog) = dialogs.open.take() {
        match block_on(poll_once(&mut dialog.asking)) {
            None => dialogs.open = Some(dialog),
            Some(Some(path)) => {
                messages.write(dialog.what.answered(path));
            }
            Some(None) if dialog.since.elapsed() < SOONEST => match dialog.what.suggested_file_name(&session) {
                // No dialog here: what is to be saved goes where runs go.
                Some(name) => {
                    messages.write(dialog.what.answered(untaken(&name)));
                }
                None => session.notify(
                    Severity::Error,
                    "This system shows no file dialog: drop a file on the window to open it, or start with --open FILE. \
                     (On Linux a desktop portal or zenity shows them.)",
                ),
            },
            Some(None) => {}
        }
    }
    let asked = seen.read(&messages).find_map(Asked::by);
    if let (None, Some(what)) = (&dialogs.open, asked) {
        let asking = match (&what, what.suggested_file_name(&session)) {
            (Asked::Save(saved), Some(name)) => ask_where(*saved, &name),
            (Asked::SaveScenario { .. }, Some(name)) => ask_where(SaveKind::Scenario, &name),
            (Asked::Edit, _) => ask_which("Open a scenario to edit", &["ron"]),
            _ => ask_which(
                "Open a policy, a checkpoint, a scenario or a preset",
                &["safetensors", "bin", "ron"],
            ),
        };
        dialogs.open = Some(Dialog { asking, what, since: Instant::now() });
    }
}

/// Asks for a file to open.
fn ask_which(title: &str, endings: &[&str]) -> Task<Option<PathBuf>> {
    let asking = AsyncFileDialog::new().set_title(title).add_filter("Of wayfield", endings).pick_file();
    IoTaskPool::get().spawn(async move { asking.await.map(|file| file.path().into()) })
}

/// Asks for where to save `what`; `name` is proposed.
fn ask_where(what: SaveKind, name: &str) -> Task<Option<PathBuf>> {
    let (title, kind, endings): (_, _, &[&str]) = match what {
        SaveKind::Policy => ("Save the policy", "Policy", &["safetensors"]),
        SaveKind::Run => ("Save the run as a folder", "Folder", &[]),
        SaveKind::Csv => ("Save the episodes", "Table", &["csv"]),
        SaveKind::Png => ("Save the curves", "Picture", &["png"]),
        SaveKind::Scenario => ("Save the world", "Scenario", &["ron"]),
    };
    let mut dialog = AsyncFileDialog::new().set_title(title).set_file_name(name);
    if !endings.is_empty() {
        dialog = dialog.add_filter(kind, endings);
    }
    let asking = dialog.save_file();
    IoTaskPool::get().spawn(async move { asking.await.map(|file| file.path().into()) })
}

/// A path for `name` under `runs/` where there is nothing yet.
fn untaken(name: &str) -> PathBuf {
    let runs = Path::new("runs");
    // If it cannot be made, saving will say so.
    let _ = std::fs::create_dir_all(runs);
    let (stem, ending) = name.rsplit_once('.').map_or((name, String::new()), |(a, b)| (a, format!(".{b}")));
    let numbered = (2..).map(|number| runs.join(format!("{stem}-{number}{ending}")));
    std::iter::once(runs.join(name)).chain(numbered).find(|path| !path.exists()).unwrap_or_default()
}
