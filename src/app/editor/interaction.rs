//! The user's unfinished actions in the editor, which are never saved.

use bevy::math::Vec2;

use super::handle::HandleKind;
use super::selection::Selection;
use crate::app::commands::Command;

/// The target of the pointer: what is under it, or what it drags.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PointerHit {
    /// The floor.
    Nothing,
    /// A handle of the selected item.
    Handle(HandleKind),
    /// An item.
    Body(Selection),
}

/// A pressed pointer button.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Press {
    /// The pressed target.
    pub hit: PointerHit,
    /// The position of the press, in m.
    pub position_m: Vec2,
}

/// A request to leave the editor that waits for the user's confirmation.
#[derive(Clone, Debug, PartialEq)]
pub struct ExitRequest {
    /// The command to send after leaving, if any.
    pub then: Option<Command>,
    /// Whether to leave as soon as the scenario is saved.
    pub once_saved: bool,
}

/// The user's unfinished actions in the editor.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EditorInteraction {
    /// The pressed pointer button.
    pub press: Option<Press>,
    /// The question whether to leave with unsaved changes, if it is open.
    pub exit_request: Option<ExitRequest>,
    /// Whether the user is being asked to confirm that the current training run is discarded.
    pub confirm_restart: bool,
    /// Whether the simulation was running when the editor was opened; it resumes when the editor is closed.
    pub resume_on_exit: bool,
    /// The group to open in the scenario's panel in the next frame, by the name of its field in the scenario.
    pub group_to_open: Option<String>,
}
