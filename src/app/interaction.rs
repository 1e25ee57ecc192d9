//! The user's unfinished actions: a drag, a motion key held down, a choice not yet started, an open question.
//!
//! In: the widgets. Out: the same widgets, in the next frame. Never saved.

use super::editor::EditorInteraction;
use super::setup_form::SetupForm;

/// What can be taken hold of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum DragTarget {
    /// The goal.
    Goal,
    /// The robot.
    Robot,
    /// An obstacle, by its number in the scenario.
    Obstacle(usize),
}

/// A drag in progress.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActiveDrag {
    /// In which arena.
    pub arena: usize,
    /// What.
    pub drag_target: DragTarget,
    /// Where its middle is to go, in m.
    pub to_m: [f32; 2],
    /// Why it cannot go there.
    pub rejection: Option<&'static str>,
    /// From the pointer to its middle, in m.
    pub offset_m: [f32; 2],
}

/// The user's unfinished actions.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Interaction {
    /// The object being dragged.
    pub drag: Option<ActiveDrag>,
    /// The last motion that the arrow keys asked for, an index into the robot's motions, and the scenario it is for.
    pub steered: Option<(String, usize)>,
    /// The choices made on the setup panel and not started yet; none before the panel is shown first.
    pub setup_form: Option<SetupForm>,
    /// Whether the plots under "More" are shown.
    pub more_plots_open: bool,
    /// Unfinished actions in the editor.
    pub editor: EditorInteraction,
}
