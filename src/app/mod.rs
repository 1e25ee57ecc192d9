//! The app: watch a robot learn, and intervene.
//!
//! The app runs the plugins of a headless run. This module decides when they step, displays their state, and executes the
//! user's commands. Data flows in one direction: the screen reads the [`scene`] and writes [`commands`]; the
//! session executes the commands between control steps; the scene is extracted from the world once per frame.
//!
//! | file | purpose |
//! |---|---|
//! | `session/` | the training session: commands, time, the journal of interventions, saving |
//! | `commands.rs` | the commands that the user can give |
//! | `interaction.rs`, `setup_form.rs` | unfinished actions of the user: a drag, choices on the setup panel |
//! | `moves.rs` | which objects can be moved by hand, and where to |
//! | `extract.rs` | the world -> the scene and the app's status, read-only |
//! | `scalar_fields.rs` | the potential and the value over the plane, read-only |
//! | `scene.rs`, `app_status.rs` | the displayed state, as plain data |
//! | `history/` | the learning curves, in bounded memory |
//! | `screen/` | everything that is drawn, with egui: the arenas, the plots, the panels |
//! | `editor/` | the scenario editor: the document, its operations, undo and redo |
//! | `editor_backup/` | a copy of unsaved changes, for the next start |
//! | `view_state.rs` | what the user has chosen to see; `preferences.rs` stores it |
//! | `window.rs`, `window_input.rs`, `blending.rs` | the window, its input and its colours |
//! | `shutdown.rs` | exits other than by closing the window: signals, a lost display or GPU, a panic |
//! | `fallback_fonts.rs` | fonts for characters that the app's typeface lacks |
//! | `window_failure.rs` | error messages for a missing display, driver or library |
//! | `screenshot.rs` | screenshots |
//! | `file_dialogs.rs` | file dialogs |
//! | `browser.rs`, `page.rs` | the web page, in place of dialogs, a disk and a command line |
//! | `text_input.rs` | input methods in the page |
//! | `controls.rs` | the positions of named controls, for tests of the window and the page |

pub mod app_status;
mod blending;
#[cfg(target_arch = "wasm32")]
pub mod browser;
pub mod commands;
mod controls;
pub mod editor;
mod editor_backup;
mod extract;
mod fallback_fonts;
#[cfg(not(target_arch = "wasm32"))]
mod file_dialogs;
pub mod history;
pub mod interaction;
pub mod moves;
#[cfg(target_arch = "wasm32")]
mod page;
mod preferences;
mod scalar_fields;
pub mod scene;
pub mod screen;
#[cfg(not(target_arch = "wasm32"))]
pub mod screenshot;
pub mod session;
pub mod setup_form;
#[cfg(not(target_arch = "wasm32"))]
pub mod shutdown;
#[cfg(target_arch = "wasm32")]
mod text_input;
pub mod view_state;
pub mod window;
#[cfg(not(target_arch = "wasm32"))]
mod window_failure;
mod window_input;

use bevy::prelude::*;

pub use extract::Snapshot;
pub use session::SessionPlugin;

use commands::{Command, EditorReply};
use editor_backup::EditorBackup;
use session::TrainingRun;
use view_state::ViewState;

impl bevy::ecs::message::Message for Command {}

impl bevy::ecs::message::Message for EditorReply {}

/// The [`ViewState`] as a resource.
#[derive(Resource, Default)]
pub struct CurrentViewState(pub ViewState);

/// The plugin of the app without its window: the session, and the scene extracted from it. It also works headless.
pub struct AppCorePlugin {
    /// Options of the first training run.
    pub start: session::StartOptions,
}

impl Plugin for AppCorePlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<CurrentViewState>()
            .init_resource::<Snapshot>()
            .init_resource::<scalar_fields::ScalarFields>()
            .insert_resource(EditorBackup::new(self.start.autosave.as_ref()))
            .add_plugins(SessionPlugin { start: self.start.clone() })
            .add_systems(
                PostUpdate,
                (deliver_replies, scalar_fields::compute_scalar_fields, extract::extract)
                    .chain()
                    .run_if(resource_exists::<TrainingRun>),
            )
            .add_systems(Last, editor_backup::back_up_if_due);
    }
}

/// Passes the session's replies on to the editor.
fn deliver_replies(mut replies: MessageReader<EditorReply>, mut view_state: ResMut<CurrentViewState>) {
    for reply in replies.read() {
        view_state.0.receive(reply);
    }
}
