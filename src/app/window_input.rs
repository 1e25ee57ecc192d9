//! Input of the app window: corrections of bevy_egui's input, dropped files, and a lower frame rate when idle.

use std::time::Duration;

use bevy::prelude::*;
use bevy::window::{FileDragAndDrop, PrimaryWindow, WindowTheme};
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

/// Draws only on input and once a second while simulated time is paused and no evaluation runs.
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

/// Opens files that are dropped on the window. Scenarios open in the editor if the editor is shown.
pub(super) fn take_dropped_files(
    view_state: Res<CurrentViewState>,
    mut dropped: MessageReader<FileDragAndDrop>,
    mut commands: MessageWriter<Command>,
) {
    for event in dropped.read() {
        if let FileDragAndDrop::DroppedFile { path_buf: path, .. } = event {
            let is_scenario = path.extension().is_some_and(|extension| extension == "ron");
            commands.write(if is_scenario && view_state.0.editor.is_some() {
                Command::OpenInEditor(Some(path.clone()))
            } else {
                Command::Open(path.clone())
            });
        }
    }
}
