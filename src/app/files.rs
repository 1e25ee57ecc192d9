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

use super::orders::{Order, Saved};
use super::session::Session;
use super::status::Weight;
use crate::scenario::Scenario;

/// A dialog that was closed sooner than this was never there: nobody is so quick.
const SOONEST: Duration = Duration::from_millis(250);

/// The dialog that is open, if one is.
#[derive(Resource, Default)]
pub struct Dialogs {
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
    Save(Saved),
    /// A scenario is to be edited.
    Edit,
    /// An edited world is to be saved, as one that was made from `like`.
    SaveWorld { scenario: Arc<Scenario>, like: String },
}

impl Asked {
    /// What `order` asks for, if that takes a dialog.
    fn by(order: &Order) -> Option<Self> {
        match order {
            Order::OpenDialog => Some(Self::Open),
            Order::SaveDialog(what) => Some(Self::Save(*what)),
            Order::EditOpen(None) => Some(Self::Edit),
            Order::SaveWorld { scenario, like, path: None } => {
                Some(Self::SaveWorld { scenario: scenario.clone(), like: like.clone() })
            }
            _ => None,
        }
    }

    /// The order that says so.
    fn answered(self, path: PathBuf) -> Order {
        match self {
            Self::Open => Order::Open(path),
            Self::Save(what) => Order::Save(what, path),
            Self::Edit => Order::EditOpen(Some(path)),
            Self::SaveWorld { scenario, like } => Order::SaveWorld { scenario, like, path: Some(path) },
        }
    }

    /// The name that is proposed for what is to be saved; none if something is to be opened.
    fn proposed_name(&self, session: &Session) -> Option<String> {
        match self {
            Self::Open | Self::Edit => None,
            Self::Save(what) => Some(session.proposed_name(*what)),
            Self::SaveWorld { .. } => Some(session.proposed_name(Saved::Scenario)),
        }
    }
}

/// Opens the dialogs that are asked for, and answers with what was chosen. (On some systems a dialog belongs to the main
/// thread: hence the marker.)
pub(super) fn answer(
    _main_thread: NonSendMarker,
    mut messages: ResMut<Messages<Order>>,
    mut seen: Local<bevy::ecs::message::MessageCursor<Order>>,
    mut session: ResMut<Session>,
    mut dialogs: ResMut<Dialogs>,
) {
    if let Some(mut dialog) = dialogs.open.take() {
        match block_on(poll_once(&mut dialog.asking)) {
            None => dialogs.open = Some(dialog),
            Some(Some(path)) => {
                messages.write(dialog.what.answered(path));
            }
            Some(None) if dialog.since.elapsed() < SOONEST => match dialog.what.proposed_name(&session) {
                // No dialog here: what is to be saved goes where runs go.
                Some(name) => {
                    messages.write(dialog.what.answered(untaken(&name)));
                }
                None => session.tell(
                    Weight::Failed,
                    "This system shows no file dialog: drop a file on the window to open it, or start with --open FILE. \
                     (On Linux a desktop portal or zenity shows them.)",
                ),
            },
            Some(None) => {}
        }
    }
    let asked = seen.read(&messages).find_map(Asked::by);
    if let (None, Some(what)) = (&dialogs.open, asked) {
        let asking = match (&what, what.proposed_name(&session)) {
            (Asked::Save(saved), Some(name)) => ask_where(*saved, &name),
            (Asked::SaveWorld { .. }, Some(name)) => ask_where(Saved::Scenario, &name),
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
fn ask_where(what: Saved, name: &str) -> Task<Option<PathBuf>> {
    let (title, kind, endings): (_, _, &[&str]) = match what {
        Saved::Policy => ("Save the policy", "Policy", &["safetensors"]),
        Saved::Run => ("Save the run as a folder", "Folder", &[]),
        Saved::Csv => ("Save the episodes", "Table", &["csv"]),
        Saved::Png => ("Save the curves", "Picture", &["png"]),
        Saved::Scenario => ("Save the world", "Scenario", &["ron"]),
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
