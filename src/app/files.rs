//! Dialogs: the system's own, for files to open and places to save to.
//!
//! In: the orders that ask for one. Out: the orders that name the file. A dialog runs beside the app; nothing waits for it.

use std::path::PathBuf;

use bevy::ecs::system::NonSendMarker;
use bevy::prelude::*;
use bevy::tasks::{IoTaskPool, Task, block_on, poll_once};
use rfd::AsyncFileDialog;

use super::orders::{Order, Saved};
use super::session::Session;

/// The dialog that is open, if one is.
#[derive(Resource, Default)]
pub struct Dialogs {
    open: Option<(Task<Option<PathBuf>>, Option<Saved>)>,
}

/// Opens the dialogs that are asked for, and answers with what was chosen. (On some systems a dialog belongs to the main
/// thread: hence the marker.)
pub(super) fn answer(
    _main_thread: NonSendMarker,
    mut messages: ResMut<Messages<Order>>,
    mut seen: Local<bevy::ecs::message::MessageCursor<Order>>,
    session: Option<Res<Session>>,
    mut dialogs: ResMut<Dialogs>,
) {
    if let Some((task, what)) = &mut dialogs.open
        && let Some(chosen) = block_on(poll_once(task))
    {
        let what = *what;
        dialogs.open = None;
        if let Some(path) = chosen {
            messages.write(match what {
                Some(what) => Order::Save(what, path),
                None => Order::Open(path),
            });
        }
    }
    let asked = seen.read(&messages).find_map(|order| match order {
        Order::OpenDialog => Some(None),
        Order::SaveDialog(what) => Some(Some(*what)),
        _ => None,
    });
    if let (None, Some(what)) = (&dialogs.open, asked) {
        let name = session.map_or_else(String::new, |session| {
            format!("{}-{}", session.config.scenario_name(), session.config.preset_name())
        });
        dialogs.open = Some((ask(what, &name), what));
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
