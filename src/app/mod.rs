//! The window: watch it learn, and take a hand in it.
//!
//! The same plugins as without a window run in the same ECS; this room decides when they step, shows what they do, and
//! carries out what the user asks for. Data goes one way round: the screen reads the [`scene`] and writes
//! [`commands`]; the session carries orders out between control steps; the scene is taken from the world anew.
//!
//! | file | duty |
//! |---|---|
//! | `session/` | what goes on: orders carried out, time passed, episodes noted, all of it to be replayed |
//! | `extract.rs` | the world -> the scene and the status, read only |
//! | `scalar_fields.rs` | the potential and the value over the plane, read only |
//! | `scene.rs`, `app_snapshot.rs` | what there is to see, as plain data |
//! | `history/` | the learning curves, in bounded memory |
//! | `screen/` | all that is drawn, by egui: the world, the plots, the panels |
//! | `editor/` | the world's editor: the document, what can be done with it, undone and redone |
//! | `commands.rs` | all that the user's hand can ask for |
//! | `interaction.rs`, `setup_form.rs` | the user's unfinished actions: a drag, choices on the setup panel |
//! | `view_state.rs` | what the user has chosen to look at; `preferences.rs` remembers it |
//! | `window.rs`, `blending.rs` | the window itself, its colours, and pictures of it |
//! | `file_dialogs.rs` | dialogs |
//! | `browser.rs` | the page around it, in place of dialogs, of a disk and of a command line |

pub mod app_snapshot;
mod blending;
#[cfg(target_arch = "wasm32")]
pub mod browser;
pub mod commands;
pub mod editor;
mod extract;
#[cfg(not(target_arch = "wasm32"))]
mod file_dialogs;
pub mod history;
pub mod interaction;
mod preferences;
mod scalar_fields;
pub mod scene;
pub mod screen;
pub mod session;
pub mod setup_form;
pub mod view_state;
pub mod window;

use bevy::prelude::*;

pub use extract::Snapshot;
pub use session::SessionPlugin;

use commands::Command;
use view_state::ViewState;

impl bevy::ecs::message::Message for Command {}

/// What the user has chosen to look at, as a resource.
#[derive(Resource, Default)]
pub struct CurrentViewState(pub ViewState);

/// Responsible for all of the room but the window itself: the session, and the scene taken of it. Runs without a
/// window, too.
pub struct AppCorePlugin {
    /// What to begin with.
    pub first: session::StartOptions,
}

impl Plugin for AppCorePlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<CurrentViewState>()
            .add_plugins(SessionPlugin { first: self.first.clone() })
            .add_systems(PostUpdate, (scalar_fields::compute_scalar_fields, extract::extract).chain());
        app.init_resource::<Snapshot>().init_resource::<scalar_fields::ScalarFields>();
    }
}
