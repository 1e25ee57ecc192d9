//! The data that the screen draws in one frame.

use crate::app::app_snapshot::AppSnapshot;
use crate::app::history::History;
use crate::app::scene::Scene;

/// What there is to see this frame.
#[derive(Clone, Copy)]
pub struct ScreenInput<'a> {
    /// The world.
    pub scene: &'a Scene,
    /// How the session stands.
    pub status: &'a AppSnapshot,
    /// What has happened so far.
    pub history: &'a History,
}
