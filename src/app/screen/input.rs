//! The input of the screen: references to the scene, the session state and the history.

use crate::app::app_status::AppStatus;
use crate::app::history::History;
use crate::app::scene::Scene;

/// The data that the screen draws in one frame.
#[derive(Clone, Copy)]
pub struct ScreenInput<'a> {
    /// The arenas.
    pub scene: &'a Scene,
    /// The state of the session.
    pub status: &'a AppStatus,
    /// The learning curves so far.
    pub history: &'a History,
}
