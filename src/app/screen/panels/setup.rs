//! The setup panel on the left: training (`training.rs`), overlays, view and files.
//!
//! In: the session state and the view state. Out: commands. Choices wait in [`SetupForm`] until a button is
//! clicked.

use egui::{Button, Frame, Margin, ScrollArea, Ui, vec2};

use super::{overlays, training};
use crate::app::app_snapshot::AppSnapshot;
use crate::app::commands::{Command, SaveKind, SessionMode};
use crate::app::screen::input::ScreenInput;
use crate::app::screen::key_bindings::{Shortcut, with_key_hint};
use crate::app::screen::widgets::buttons::wide_button_ui;
use crate::app::screen::widgets::icons::{self, ButtonStyle, Icon};
use crate::app::screen::widgets::segments::{self, Segment};
use crate::app::screen::widgets::text::{key_cap_ui, section_title_ui, separator_ui, weak_text};
use crate::app::setup_form::SetupForm;
use crate::app::view_state::{ViewCamera, ViewState};

/// The height of the buttons for files, in points.
const FILE_BUTTON_HEIGHT: f32 = 26.0;

const OPEN_HELP: &str = "Open a policy to compare with, a saved run to resume, a scenario or a preset";

/// The tooltip without a disk, where no run can be opened.
const OPEN_HELP_WITHOUT_DISK: &str =
    "Open a policy to compare with, a scenario or a preset. The file stays on your machine";

/// Draws the panel.
pub fn setup_ui(
    ui: &mut Ui,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    // The scroll bar is in the margin.
    ScrollArea::vertical().auto_shrink([false, false]).show(ui, |ui| {
        Frame::new()
            .inner_margin(Margin::symmetric(14, 12))
            .show(ui, |ui| content_ui(ui, view, view_state, commands));
    });
}

fn content_ui(ui: &mut Ui, view: &ScreenInput<'_>, view_state: &mut ViewState, commands: &mut Vec<Command>) {
    if view.status.mode == SessionMode::Drive {
        driving_help_ui(ui);
        separator_ui(ui);
    }
    let mut setup_form = SetupForm::resume(view_state.interaction.setup_form.take(), view.status);
    training::training_ui(ui, view.status, &mut setup_form, commands);
    view_state.interaction.setup_form = Some(setup_form);
    separator_ui(ui);
    section_title_ui(ui, "Overlays");
    overlays::overlays_ui(ui, &mut view_state.overlays);
    separator_ui(ui);
    view_ui(ui, view, view_state);
    separator_ui(ui);
    files_ui(ui, view.status, commands);
}

fn view_ui(ui: &mut Ui, view: &ScreenInput<'_>, view_state: &mut ViewState) {
    section_title_ui(ui, "View");
    ui.horizontal(|ui| {
        let side = 28.0;
        if view.status.mode == SessionMode::Train {
            arena_choice_ui(ui, view, view_state, side);
        }
        let about = with_key_hint("Fit the arena to the view", Shortcut::Fit);
        if icons::icon_button_ui(ui, Icon::Fit, ButtonStyle::Framed, side, "Fit", &about).clicked() {
            view_state.camera = ViewCamera::default();
        }
    });
}

/// The choice of one arena or all; leaves `reserved` points on the right for a button.
fn arena_choice_ui(ui: &mut Ui, view: &ScreenInput<'_>, view_state: &mut ViewState, reserved: f32) {
    let all = format!("All {}", view.scene.arenas.len());
    let segments = [
        Segment::new("One arena", with_key_hint("Show one arena", Shortcut::Grid)),
        Segment {
            name: "All arenas".into(),
            ..Segment::new(&all, with_key_hint("Show all arenas", Shortcut::Grid))
        },
    ];
    let width = ui.available_width() - reserved - ui.spacing().item_spacing.x;
    if let Some(k) =
        segments::segments_ui(ui, "framing", &segments, Some(usize::from(view_state.grid)), Some(width))
    {
        view_state.grid = k == 1;
    }
}

fn files_ui(ui: &mut Ui, status: &AppSnapshot, commands: &mut Vec<Command>) {
    section_title_ui(ui, "Files");
    if let Some(expert) = &status.expert {
        let about = format!("Compare the current policy with a shipped one: {expert}");
        if wide_button_ui(ui, "Watch an expert", FILE_BUTTON_HEIGHT).on_hover_text(about).clicked() {
            commands.push(Command::OpenExpert);
        }
    }
    let width = (ui.available_width() - ui.spacing().item_spacing.x) / 2.0;
    for row in file_buttons(status.has_disk).chunks(2) {
        ui.horizontal(|ui| {
            // Less padding, so that the longest text fits.
            ui.spacing_mut().button_padding.x = 4.0;
            for (text, about, command) in row {
                let button = ui.add_sized(vec2(width, FILE_BUTTON_HEIGHT), Button::new(*text));
                if button.on_hover_text(about).clicked() {
                    commands.push(command.clone());
                }
            }
        });
    }
}

/// Text, tooltip and command of each button. Without a disk no run can be saved.
fn file_buttons(has_disk: bool) -> Vec<(&'static str, String, Command)> {
    let open = with_key_hint(if has_disk { OPEN_HELP } else { OPEN_HELP_WITHOUT_DISK }, Shortcut::Open);
    let policy = with_key_hint("Save the current network as .safetensors", Shortcut::Save);
    let run = "Save the whole run, so that it can be resumed".to_owned();
    let scenario = "Save the scenario, including objects you moved".to_owned();
    let mut buttons = vec![
        ("Open…", open, Command::OpenDialog),
        ("Save policy…", policy, Command::SaveDialog(SaveKind::Policy)),
        ("Save run…", run, Command::SaveDialog(SaveKind::Run)),
        ("Save scenario…", scenario, Command::SaveDialog(SaveKind::Scenario)),
    ];
    buttons.retain(|(.., command)| has_disk || *command != Command::SaveDialog(SaveKind::Run));
    buttons
}

fn driving_help_ui(ui: &mut Ui) {
    section_title_ui(ui, "Steering");
    for (keys, effect) in [
        (&["↑"][..], "straight ahead (also without a key)"),
        (&["↑", "←"], "or ↑ →: gentle turn"),
        (&["←"], "or →: sharp turn"),
    ] {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 3.0;
            keys.iter().for_each(|key| key_cap_ui(ui, key));
            ui.add_space(3.0);
            ui.label(weak_text(effect));
        });
    }
}
