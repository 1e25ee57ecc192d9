//! Dialogs: the system's own, for files to open and places to save to.
//!
//! In: the orders that ask for one. Out: the orders that name the file. A dialog runs beside the app; nothing waits for it.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use bevy::ecs::system::NonSendMarker;
use bevy::prelude::*;
use bevy::tasks::{IoTaskPool, Task, block_on, poll_once};
use rfd::AsyncFileDialog;

use super::orders::{Order, Saved};
use super::session::Session;
use super::status::Weight;

/// A dialog that was closed sooner than this was never there: nobody is so quick.
const SOONEST: Duration = Duration::from_millis(250);

/// The dialog that is open, if one is.
#[derive(Resource, Default)]
pub struct Dialogs {
    open: Option<Dialog>,
}

struct Dialog {
    asking: Task<Option<PathBuf>>,
    /// What is to be saved; None: something is to be opened.
    what: Option<Saved>,
    since: Instant,
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
    if let Some(dialog) = &mut dialogs.open
        && let Some(chosen) = block_on(poll_once(&mut dialog.asking))
    {
        match (chosen, dialog.what) {
            (Some(path), Some(what)) => {
                messages.write(Order::Save(what, path));
            }
            (Some(path), None) => {
                messages.write(Order::Open(path));
            }
            // No dialog here: what is to be saved goes where runs go.
            (None, Some(what)) if dialog.since.elapsed() < SOONEST => {
                messages.write(Order::Save(what, untaken(&session.proposed_name(what))));
            }
            (None, None) if dialog.since.elapsed() < SOONEST => session.tell(
                Weight::Failed,
                "This system shows no file dialog: drop a file on the window to open it, or start with --open FILE. \
                 (On Linux a desktop portal or zenity shows them.)",
            ),
            (None, _) => {}
        }
        dialogs.open = None;
    }
    let asked = seen.read(&messages).find_map(|order| match order {
        Order::OpenDialog => Some(None),
        Order::SaveDialog(what) => Some(Some(*what)),
        _ => None,
    });
    if let (None, Some(what)) = (&dialogs.open, asked) {
        let asking = match what {
            Some(what) => ask_where(what, &session.proposed_name(what)),
            None => ask_which(),
        };
        dialogs.open = Some(Dialog { asking, what, since: Instant::now() });
    }
}

/// Asks for a file to open.
fn ask_which() -> Task<Option<PathBuf>> {
    let asking = AsyncFileDialog::new()
        .set_title("Open a policy, a checkpoint, a scenario or a preset")
        .add_filter("Of wayfield", &["safetensors", "bin", "ron"])
        .pick_file();
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
