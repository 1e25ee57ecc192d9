//! What is remembered from one time to the next: the desk, and the window's size.
//!
//! In: the desk as it is. Out: `preferences.ron` in the user's configuration folder, or the browser's own memory. A file
//! that cannot be read is taken for none, and one that cannot be written is not missed.

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
use crate::run::folder::write_atomic;
#[cfg(target_arch = "wasm32")]
use crate::scenario::parse_ron;
#[cfg(not(target_arch = "wasm32"))]
use crate::scenario::read_ron;
use crate::scenario::to_ron;

/// It is written at most every so many seconds.
const EVERY_S: f64 = 2.0;

/// What is remembered.
#[derive(Resource, Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Preferences {
    /// What the user has chosen to look at.
    pub view_state: ViewState,
    /// The window's size, in points.
    pub size: (f32, f32),
}

impl Default for Preferences {
    fn default() -> Self {
        Self { view_state: ViewState::default(), size: (1280.0, 800.0) }
    }
}

/// Where it stands.
#[cfg(not(target_arch = "wasm32"))]
fn file() -> Option<PathBuf> {
    let folders = directories::ProjectDirs::from("", "", "wayfield")?;
    Some(folders.config_dir().join("preferences.ron"))
}

/// What was written by [`write`], if it can be read.
#[cfg(not(target_arch = "wasm32"))]
fn read() -> Option<Preferences> {
    file().and_then(|file| read_ron(file).ok())
}

#[cfg(target_arch = "wasm32")]
fn read() -> Option<Preferences> {
    super::browser::load_preferences().and_then(|text| parse_ron(&text, "preferences.ron").ok())
}

#[cfg(not(target_arch = "wasm32"))]
fn write(text: &str) {
    let Some(file) = file() else { return };
    let written = file.parent().map(std::fs::create_dir_all).transpose().is_ok()
        && write_atomic(&file, |file| file.write_all(text.as_bytes())).is_ok();
    if !written {
        debug!("{} could not be written", file.display());
    }
}

#[cfg(target_arch = "wasm32")]
use super::browser::save_preferences as write;

/// What was remembered, or the default.
#[must_use]
pub fn load() -> Preferences {
    let mut remembered = read().unwrap_or_default();
    let (width, height) = remembered.size;
    if !((400.0..=16_000.0).contains(&width) && (300.0..=16_000.0).contains(&height)) {
        remembered.size = Preferences::default().size;
    }
    remembered
}

/// Remembers what has changed.
pub(super) fn keep(
    view_state: Res<CurrentViewState>,
    windows: Query<&Window, With<PrimaryWindow>>,
    time: Res<Time<Real>>,
    mut remembered: ResMut<Preferences>,
    mut kept_s: Local<f64>,
    mut exits: MessageReader<AppExit>,
) {
    let closing = exits.read().next().is_some();
    let now_s = time.elapsed_secs_f64();
    if !closing && now_s - *kept_s < EVERY_S {
        return;
    }
    *kept_s = now_s;
    let size = windows.single().map_or(remembered.size, |window| (window.width(), window.height()));
    let mut now = Preferences { view_state: view_state.0.clone(), size };
    // Where one looked is not what one likes.
    now.view_state.followed = remembered.view_state.followed;
    now.view_state.camera = remembered.view_state.camera;
    now.view_state.help_open = remembered.view_state.help_open;
    now.view_state.editor = None;
    now.view_state.interaction = Interaction::default();
    if now == *remembered {
        return;
    }
    *remembered = now;
    if let Ok(text) = to_ron(&*remembered) {
        write(&text);
    }
}
