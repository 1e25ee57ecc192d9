//! The view state: which parts of the app are shown, and how. It does not affect training.
//!
//! In: the controls on the screen. Out: what the screen draws. Most of it is stored between sessions (`preferences.rs`).

use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::commands::EditorReply;
use super::editor::Editor;
use super::interaction::Interaction;
use crate::scenario::Scenario;

/// The colour theme.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ThemeChoice {
    /// The system's theme.
    #[default]
    System,
    /// Dark on light.
    Light,
    /// Light on dark.
    Dark,
}

/// Overlays drawn over the arenas.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Overlays {
    /// LIDAR beams.
    pub beams: bool,
    /// The path since the last goal, and the planned path of a driver that plans one.
    pub path: bool,
    /// Earlier paths, coloured by outcome.
    pub trails: bool,
    /// The potential of the paper's eq. (4).
    pub potential: bool,
    /// The network's state value at each point of the plane.
    pub value: bool,
    /// The Q-values next to the robot.
    pub q_values: bool,
}

impl Default for Overlays {
    fn default() -> Self {
        Self { beams: true, path: true, trails: false, potential: false, value: false, q_values: true }
    }
}

/// The visible part of the plane.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewCamera {
    /// The point in the middle of the view, relative to the middle of the enclosure's bounding box, in m.
    pub centre_m: [f32; 2],
    /// Magnification: 1 shows the whole enclosure, 2 half of it.
    pub zoom: f32,
}

impl Default for ViewCamera {
    fn default() -> Self {
        Self { centre_m: [0.0, 0.0], zoom: 1.0 }
    }
}

/// The scenario to open in the editor.
#[derive(Clone, Debug, PartialEq)]
pub enum EditorSource {
    /// The current scenario of the training run.
    RunningScenario,
    /// A scenario that is not running: it may be invalid, or have unsaved changes.
    Draft {
        /// The scenario's file or shipped name.
        from: String,
        /// The scenario.
        scenario: Arc<Scenario>,
        /// The scenario in its file; `None` if unknown.
        in_file: Option<Arc<Scenario>>,
    },
}

/// The view state: the user's choices of what is shown.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ViewState {
    /// The colour theme.
    pub theme: ThemeChoice,
    /// Overlays drawn over the arenas.
    pub overlays: Overlays,
    /// Whether all arenas are shown as a grid, instead of one large arena.
    pub grid: bool,
    /// Index of the arena that is followed.
    #[serde(skip)]
    pub followed: usize,
    /// The visible part of the plane.
    #[serde(skip)]
    pub camera: ViewCamera,
    /// Whether the setup panel on the left is open.
    pub setup_open: bool,
    /// Whether the plots panel on the right is open.
    pub plots_open: bool,
    /// Width of the plots panel in points, if the user has changed it.
    pub plots_width: Option<f32>,
    /// Whether the help is open.
    #[serde(skip)]
    pub help_open: bool,
    /// The scenario editor, if it is open.
    #[serde(skip)]
    pub editor: Option<Box<Editor>>,
    /// A request to open the editor in the next frame.
    #[serde(skip)]
    pub open_editor: Option<EditorSource>,
    /// Unfinished actions of the user.
    #[serde(skip)]
    pub interaction: Interaction,
}

impl Default for ViewState {
    fn default() -> Self {
        Self {
            theme: ThemeChoice::default(),
            overlays: Overlays::default(),
            grid: false,
            followed: 0,
            camera: ViewCamera::default(),
            setup_open: true,
            plots_open: true,
            plots_width: None,
            help_open: false,
            editor: None,
            open_editor: None,
            interaction: Interaction::default(),
        }
    }
}

impl ViewState {
    /// Passes a reply of the session on to the editor, or to a pending request to open it. Ignored if there is neither.
    pub fn receive(&mut self, reply: &EditorReply) {
        match (reply, &mut self.editor, &mut self.open_editor) {
            (EditorReply::Saved { file, scenario }, Some(editor), _) => editor.mark_saved(file, scenario),
            (EditorReply::Opened { from, scenario }, Some(editor), _) => editor.open_other(from, scenario),
            (EditorReply::Opened { from, scenario }, None, Some(source)) => {
                let (scenario, in_file) = (scenario.clone(), Some(scenario.clone()));
                *source = EditorSource::Draft { from: from.clone(), scenario, in_file };
            }
            _ => {}
        }
    }
}
