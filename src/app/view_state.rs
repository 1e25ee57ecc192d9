//! The desk: what the user has chosen to look at, and how. None of it touches the world.
//!
//! In: the screen's own buttons. Out: what the screen draws; most of it is remembered from one time to the next.

use serde::{Deserialize, Serialize};

use super::editor::Editor;
use super::interaction::Interaction;

/// Light, dark, or as the system has it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum ThemeChoice {
    /// As the system has it.
    #[default]
    System,
    /// Dark on light.
    Light,
    /// Light on dark.
    Dark,
}

/// What is drawn over the world.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(default)]
pub struct Overlays {
    /// The LIDAR's beams.
    pub beams: bool,
    /// The way driven in this navigation.
    pub path: bool,
    /// The ways of the last navigations, by outcome.
    pub trails: bool,
    /// The potential field of eq. (4).
    pub potential: bool,
    /// The network's value over the plane.
    pub value: bool,
    /// The Q-values beside the robot.
    pub q_values: bool,
}

impl Default for Overlays {
    fn default() -> Self {
        Self { beams: true, path: true, trails: false, potential: false, value: false, q_values: true }
    }
}

/// Which part of the plane the world view shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ViewCamera {
    /// The point in the view's middle, from the middle of the box around the enclosure, in m.
    pub centre_m: [f32; 2],
    /// 1 shows the whole enclosure; 2 half of it.
    pub zoom: f32,
}

impl Default for ViewCamera {
    fn default() -> Self {
        Self { centre_m: [0.0, 0.0], zoom: 1.0 }
    }
}

/// What the user has chosen to look at.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct ViewState {
    /// Light or dark.
    pub theme: ThemeChoice,
    /// What is drawn over the world.
    pub overlays: Overlays,
    /// All arenas as a grid, or the followed one large.
    pub grid: bool,
    /// Which arena is followed.
    #[serde(skip)]
    pub followed: usize,
    /// Where the world view looks.
    #[serde(skip)]
    pub camera: ViewCamera,
    /// The panel on the left is open.
    pub setup_open: bool,
    /// The panel on the right is open.
    pub plots_open: bool,
    /// That panel's width in points, if the user has chosen one.
    pub plots_width: Option<f32>,
    /// The list of keys is open.
    #[serde(skip)]
    pub help_open: bool,
    /// The world that is being edited, in place of the one that runs.
    #[serde(skip)]
    pub editor: Option<Box<Editor>>,
    /// It is to be opened on the world that runs.
    #[serde(skip)]
    pub open_editor: bool,
    /// The user's unfinished actions.
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
            open_editor: false,
            interaction: Interaction::default(),
        }
    }
}
