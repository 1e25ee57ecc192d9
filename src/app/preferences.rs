//! Preferences: the view state and the size of the window, stored between sessions.
//!
//! In: the view state. Out: `preferences.ron` in the user's configuration folder, or the browser's local storage. A file that
//! cannot be read is ignored, and so is a failure to write it.

#[cfg(not(target_arch = "wasm32"))]
use std::io::Write;
#[cfg(not(target_arch = "wasm32"))]
use std::path::PathBuf;

use bevy::prelude::*;
use bevy::time::Real;
use bevy::window::PrimaryWindow;
use serde::{Deserialize, Serialize};

use super::CurrentViewState;
use super::interaction::Interaction;
use super::view_state::ViewState;
#[cfg(not(target_arch = "wasm32"))]
use crate::run::output_file::write_atomic;
#[cfg(target_arch = "wasm32")]
use crate::scenario::parse_ron;
#[cfg(not(target_arch = "wasm32"))]
use crate::scenario::read_ron;
use crate::scenario::to_ron;

/// Minimum time between two checks for changes to write, in s.
const CHECK_INTERVAL_S: f64 = 2.0;

/// The stored preferences.
#[derive(Resource, Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// The view state.
    pub view_state: ViewState,
    /// Size of the window in points.
    pub size: (f32, f32),
}

impl Default for Preferences {
    fn default() -> Self {
        Self { view_state: ViewState::default(), size: (1280.0, 800.0) }
    }
}

/// Path of the preferences file, if the system has a configuration folder.
#[cfg(not(target_arch = "wasm32"))]
fn file() -> Option<PathBuf> {
    let folders = directories::ProjectDirs::from("", "", "wayfield")?;
    Some(folders.config_dir().join("preferences.ron"))
}

/// Reads the stored preferences; `None` if they cannot be read.
#[cfg(not(target_arch = "wasm32"))]
fn read() -> Option<Preferences> {
    file().and_then(|file| read_ron(file).ok())
}

#[cfg(target_arch = "wasm32")]
fn read() -> Option<Preferences> {
    super::page::load_preferences().and_then(|text| parse_ron(&text, "preferences.ron").ok())
}

#[cfg(not(target_arch = "wasm32"))]
fn write(text: &str) {
    let Some(file) = file() else { return };
    let written = file.parent().map(std::fs::create_dir_all).transpose().is_ok()
        && write_atomic(&file, |file| file.write_all(text.as_bytes())).is_ok();
    if !written {
        debug!("{}: cannot be written", file.display());
    }
}

#[cfg(target_arch = "wasm32")]
use super::page::save_preferences as write;

/// Loads the stored preferences, or the default. A window size out of range is replaced by the default.
#[must_use]
pub fn load() -> Preferences {
    let mut stored = read().unwrap_or_default();
    let (width, height) = stored.size;
    if !((400.0..=16_000.0).contains(&width) && (300.0..=16_000.0).contains(&height)) {
        stored.size = Preferences::default().size;
    }
    stored
}

/// Stores the preferences when they have changed.
pub(super) fn store(
    view_state: Res<CurrentViewState>,
    windows: Query<&Window, With<PrimaryWindow>>,
    time: Res<Time<Real>>,
    mut stored: ResMut<Preferences>,
    mut checked_s: Local<f64>,
    mut exits: MessageReader<AppExit>,
) {
    let closing = exits.read().next().is_some();
    let now_s = time.elapsed_secs_f64();
    if !closing && now_s - *checked_s < CHECK_INTERVAL_S {
        return;
    }
    *checked_s = now_s;
    let size = windows.single().map_or(stored.size, |window| (window.width(), window.height()));
    let mut now = Preferences { view_state: view_state.0.clone(), size };
    // These belong to the session, not to the user's preferences.
    now.view_state.followed = stored.view_state.followed;
    now.view_state.camera = stored.view_state.camera;
    now.view_state.help_open = stored.view_state.help_open;
    now.view_state.editor = None;
    now.view_state.interaction = Interaction::default();
    if now == *stored {
        return;
    }
    *stored = now;
    if let Ok(text) = to_ron(&*stored) {
        write(&text);
    }
}
