//! The user's unfinished actions (a drag, choices that have not been applied), the last steering command, and which plots are
//! open.
//!
//! Written by the widgets of the screen and read by them in the next frame. Never saved.

use super::editor::EditorInteraction;
use super::moves::{Movable, MoveRejection};
use super::setup_form::SetupForm;

/// The drag in progress.
#[derive(Clone, Debug, PartialEq)]
pub struct ActiveDrag {
    /// Index of the arena.
    pub arena: usize,
    /// The object.
    pub object: Movable,
    /// Requested position of the object's centre, in m.
    pub to_m: [f32; 2],
    /// The reason why the object cannot be moved there; `None` if it can.
    pub rejection: Option<MoveRejection>,
    /// Offset from the pointer to the object's centre, in m.
    pub offset_m: [f32; 2],
}

/// The user's unfinished actions, the last steering command, and which plots are open.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Interaction {
    /// The object being dragged.
    pub drag: Option<ActiveDrag>,
    /// Scenario name and motion (an index into the robot's motions) of the last steering command from the arrow keys.
    pub steered: Option<(String, usize)>,
    /// Choices on the setup panel that have not been applied yet; `None` before the panel is first shown.
    pub setup_form: Option<SetupForm>,
    /// Whether the plots under "More" are shown.
    pub more_plots_open: bool,
    /// Whether the user is being asked whether to edit a copy of a scenario of the set.
    pub set_question: bool,
    /// Unfinished actions in the editor.
    pub editor: EditorInteraction,
}
