//! The window: watch it learn, and take a hand in it.
//!
//! The same plugins as without a window run in the same ECS; this room decides when they step, shows what they do, and
//! carries out what the user asks for. Data goes one way round: the screen reads the [`scene`] and writes
//! [`orders`]; the session carries orders out between control steps; the scene is taken from the world anew.
//!
//! | file | duty |
//! |---|---|
//! | `session/` | what goes on: orders carried out, time passed, episodes noted, all of it to be replayed |
//! | `look.rs` | the world -> the scene and the status, read only |
//! | `fields.rs` | the potential and the value over the plane, read only |
//! | `scene.rs`, `status.rs` | what there is to see, as plain data |
//! | `history/` | the learning curves, in bounded memory |
//! | `screen/` | all that is drawn, by egui: the world, the plots, the panels |
//! | `editor/` | the world's editor: the document, what can be done with it, undone and redone |
//! | `orders.rs` | all that the user's hand can ask for |
//! | `desk.rs` | what the user has chosen to look at; `preferences.rs` remembers it |
//! | `window.rs`, `blending.rs` | the window itself, its colours, and pictures of it |
//! | `files.rs` | dialogs |
//! | `browser.rs` | the page around it, in place of dialogs, of a disk and of a command line |

mod blending;
#[cfg(target_arch = "wasm32")]
pub mod browser;
pub mod desk;
pub mod editor;
mod fields;
#[cfg(not(target_arch = "wasm32"))]
mod files;
pub mod history;
mod look;
pub mod orders;
mod preferences;
pub mod scene;
pub mod screen;
pub mod session;
pub mod status;
pub mod window;

use bevy::prelude::*;

pub use look::Shown;
pub use session::SessionPlugin;

use desk::Desk;
use orders::Order;

impl bevy::ecs::message::Message for Order {}

/// What the user has chosen to look at, as a resource.
#[derive(Resource, Default)]
pub struct OnDesk(pub Desk);

/// Responsible for all of the room but the window itself: the session, and the scene taken of it. Runs without a
/// window, too.
pub struct StudioPlugin {
    /// What to begin with.
    pub first: session::First,
}

impl Plugin for StudioPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<OnDesk>()
            .add_plugins(SessionPlugin { first: self.first.clone() })
            .add_systems(PostUpdate, (fields::survey, look::look).chain());
        app.init_resource::<Shown>().init_resource::<fields::Fields>();
    }
}
