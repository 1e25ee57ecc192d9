//! Dialogs: the system's own, for files to open and places to save to.
//!
//! In: the orders that ask for one. Out: the orders that name the file. A dialog runs beside the app; nothing waits for it.

use std::path::PathBuf;
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
            (None, _) if dialog.since.elapsed() < SOONEST => session.tell(
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
        let name = format!("{}-{}", session.config.scenario_name(), session.config.preset_name());
        dialogs.open = Some(Dialog { asking: ask(what, &name), what, since: Instant::now() });
    }
}

/// Asks for a file to open, or for where to save `what`; `name` is proposed.
fn ask(what: Option<Saved>, name: &str) -> Task<Option<PathBuf>> {
    let dialog = AsyncFileDialog::new();
    let (title, file, kind, endings): (_, _, _, &[&str]) = match what {
        None => {
            let asking = dialog
                .set_title("Open a policy, a checkpoint, a scenario or a preset")
                .add_filter("Of wayfield", &["safetensors", "bin", "ron"])
                .pick_file();
            return IoTaskPool::get().spawn(async move { asking.await.map(|file| file.path().into()) });
        }
        Some(Saved::Policy) => ("Save the policy", format!("{name}.safetensors"), "Policy", &["safetensors"]),
        Some(Saved::Run) => ("Save the run as a folder", name.to_string(), "Folder", &[]),
        Some(Saved::Csv) => ("Save the episodes", format!("{name}-episodes.csv"), "Table", &["csv"]),
        Some(Saved::Png) => ("Save the curves", format!("{name}-curves.png"), "Picture", &["png"]),
        Some(Saved::Scenario) => ("Save the world", "my-world.ron".into(), "Scenario", &["ron"]),
    };
    let mut dialog = dialog.set_title(title).set_file_name(file);
    if !endings.is_empty() {
        dialog = dialog.add_filter(kind, endings);
    }
    let asking = dialog.save_file();
    IoTaskPool::get().spawn(async move { asking.await.map(|file| file.path().into()) })
}
