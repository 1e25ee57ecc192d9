//! The panel on the left: what is learnt where (`training.rs`), what is drawn, what is kept.
//!
//! In: the status and the desk. Out: orders. What is chosen here waits in [`SetupForm`] until a button is pressed.

use egui::{Button, Frame, Margin, ScrollArea, Ui, vec2};

use super::{overlays, training};
use crate::app::app_snapshot::AppSnapshot;
use crate::app::commands::{Command, SaveKind, SessionMode};
use crate::app::screen::input::ScreenInput;
use crate::app::screen::key_bindings::{Shortcut, with_key_hint};
use crate::app::screen::widgets::icons::{self, ButtonStyle, Icon};
use crate::app::screen::widgets::segments::{self, Segment};
use crate::app::screen::widgets::text::{key_cap_ui, section_title_ui, separator_ui, weak_text};
use crate::app::setup_form::SetupForm;
use crate::app::view_state::{ViewCamera, ViewState};

/// What can be opened.
const OPENS: &str = "Opens a policy to set against the present one, a saved run to go on with, or a world or preset of \
                     your own.";

/// The same where there is no disk.
const OPENS_WITHOUT_DISK: &str = "Opens a policy to set against the present one, or a world or preset of your own. It \
                                  stays on your machine.";

/// Draws it.
pub fn setup_ui(
    ui: &mut Ui,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    // The scroll bar has its place in the margin.
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
    framing_ui(ui, view, view_state);
    separator_ui(ui);
    files_ui(ui, view.status, commands);
}

fn framing_ui(ui: &mut Ui, view: &ScreenInput<'_>, view_state: &mut ViewState) {
    section_title_ui(ui, "View");
    ui.horizontal(|ui| {
        let side = 28.0;
        if view.status.mode == SessionMode::Train {
            arena_choice_ui(ui, view, view_state, side);
        }
        let about = with_key_hint("Show the whole enclosure", Shortcut::Fit);
        if icons::icon_button_ui(ui, Icon::Fit, ButtonStyle::Framed, side, "Fit", &about).clicked() {
            view_state.camera = ViewCamera::default();
        }
    });
}

/// The followed arena or all of them; leaves room for a button `beside` points wide.
fn arena_choice_ui(ui: &mut Ui, view: &ScreenInput<'_>, view_state: &mut ViewState, beside: f32) {
    let all = format!("All {}", view.scene.arenas.len());
    let segments = [
        Segment::new("One arena", with_key_hint("The arena that is followed, large", Shortcut::Grid)),
        Segment {
            name: "All arenas".into(),
            ..Segment::new(&all, with_key_hint("All arenas side by side", Shortcut::Grid))
        },
    ];
    let width = ui.available_width() - beside - ui.spacing().item_spacing.x;
    if let Some(k) =
        segments::segments_ui(ui, "framing", &segments, Some(usize::from(view_state.grid)), Some(width))
    {
        view_state.grid = k == 1;
    }
}

fn files_ui(ui: &mut Ui, status: &AppSnapshot, commands: &mut Vec<Command>) {
    section_title_ui(ui, "Files");
    if let Some(expert) = &status.expert {
        let about = format!("A policy that comes with the program drives beside the present one: {expert}");
        let button = ui.add_sized(vec2(ui.available_width(), 26.0), Button::new("Watch an expert"));
        if button.on_hover_text(about).clicked() {
            commands.push(Command::OpenExpert);
        }
    }
    let opens = if status.has_disk { OPENS } else { OPENS_WITHOUT_DISK };
    let mut all = vec![
        ("Open…", with_key_hint(opens, Shortcut::Open), Command::OpenDialog),
        (
            "Save policy",
            with_key_hint("What it has learnt", Shortcut::Save),
            Command::SaveDialog(SaveKind::Policy),
        ),
    ];
    if status.has_disk {
        all.push((
            "Save run",
            "All of the training, to go on from".into(),
            Command::SaveDialog(SaveKind::Run),
        ));
    }
    let world = "The world as it stands, with what you moved";
    all.push(("Save world", world.into(), Command::SaveDialog(SaveKind::Scenario)));
    let width = (ui.available_width() - ui.spacing().item_spacing.x) / 2.0;
    for row in all.chunks(2) {
        ui.horizontal(|ui| {
            for (text, about, command) in row {
                if ui.add_sized(vec2(width, 26.0), Button::new(*text)).on_hover_text(about).clicked() {
                    commands.push(command.clone());
                }
            }
        });
    }
}

fn driving_help_ui(ui: &mut Ui) {
    section_title_ui(ui, "You drive");
    for (keys, what) in [
        (&["↑"][..], "straight on, as without a key"),
        (&["↑", "←"], "or → with it: a gentle turn"),
        (&["←"], "or → alone: a sharp turn"),
    ] {
        ui.horizontal(|ui| {
            ui.spacing_mut().item_spacing.x = 3.0;
            keys.iter().for_each(|key| key_cap_ui(ui, key));
            ui.add_space(3.0);
            ui.label(weak_text(what));
        });
    }
}
