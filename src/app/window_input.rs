//! Input and size of the app window: corrections of bevy_egui's input, dropped files, a size that fits the monitors, and a
//! lower frame rate when idle.

use std::time::Duration;

use bevy::prelude::*;
use bevy::window::{FileDragAndDrop, Monitor, PrimaryWindow, WindowTheme};
use bevy::winit::{UpdateMode, WinitSettings};
use bevy_egui::EguiInput;

use super::CurrentViewState;
use super::commands::Command;
use super::session::{Evaluations, Pacer};

/// Works around two gaps in bevy_egui 0.42. First, it does not pass on the system's theme. Second, it reports the modifier
/// keys in every frame. As egui requests a frame after every event, the app would never be idle; so repeated reports are
/// removed.
pub(super) fn fix_input(
    mut inputs: Query<&mut EguiInput>,
    windows: Query<&Window, With<PrimaryWindow>>,
    mut held: Local<egui::Modifiers>,
) {
    let theme = windows.single().ok().and_then(|window| window.window_theme).map(|theme| match theme {
        WindowTheme::Light => egui::Theme::Light,
        WindowTheme::Dark => egui::Theme::Dark,
    });
    for mut input in &mut inputs {
        input.system_theme = theme;
        input.events.retain(|event| match event {
            egui::Event::ModifiersChanged(now) => std::mem::replace(&mut *held, *now) != *now,
            _ => true,
        });
    }
}

/// While simulated time is paused and no evaluation runs, draws only on input and once a second.
pub(super) fn draw_less_when_idle(
    pacer: Option<Res<Pacer>>,
    evaluations: Option<Res<Evaluations>>,
    mut settings: ResMut<WinitSettings>,
) {
    let is_paused = pacer.is_some_and(|pacer| pacer.is_paused());
    let is_idle = is_paused && evaluations.is_some_and(|evaluations| !evaluations.is_running());
    let mode = if is_idle { UpdateMode::reactive(Duration::from_secs(1)) } else { UpdateMode::Continuous };
    if settings.focused_mode != mode {
        settings.focused_mode = mode;
        settings.unfocused_mode = mode;
    }
}

/// Once the monitors are known, shrinks a window whose stored size is wider or taller than every monitor, and also reduces its
/// minimum size if necessary.
pub(super) fn fit_to_monitor(
    mut windows: Query<&mut Window, With<PrimaryWindow>>,
    monitors: Query<&Monitor>,
    mut is_done: Local<bool>,
) {
    if *is_done || monitors.is_empty() {
        return;
    }
    *is_done = true;
    let (width, height) = monitors.iter().fold((0, 0), |(width, height), monitor| {
        (width.max(monitor.physical_width), height.max(monitor.physical_height))
    });
    if width == 0 || height == 0 {
        return;
    }
    for mut window in &mut windows {
        let points = |pixels: u32| pixels as f32 / window.scale_factor();
        let (max_width, max_height) = (points(width), points(height));
        let limits = &mut window.resize_constraints;
        limits.min_width = limits.min_width.min(max_width);
        limits.min_height = limits.min_height.min(max_height);
        let now = window.physical_size();
        let fitting = UVec2::new(now.x.min(width), now.y.min(height));
        if fitting != now {
            window.resolution.set_physical_resolution(fitting.x, fitting.y);
        }
    }
}

/// Opens files that are dropped on the window. RON files open in the editor if the editor is shown.
pub(super) fn take_dropped_files(
    view_state: Res<CurrentViewState>,
    mut dropped: MessageReader<FileDragAndDrop>,
    mut commands: MessageWriter<Command>,
) {
    for event in dropped.read() {
        if let FileDragAndDrop::DroppedFile { path_buf: path, .. } = event {
            let is_ron = path.extension().is_some_and(|extension| extension == "ron");
            commands.write(if is_ron && view_state.0.editor.is_some() {
                Command::OpenInEditor(Some(path.clone()))
            } else {
                Command::Open(path.clone())
            });
        }
    }
}
