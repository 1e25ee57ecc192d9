//! The setup panel on the left: steering help in Drive mode, the tested policy (`tested_policy.rs`), training
//! (`training.rs`), overlays (`overlays.rs`), view and files (`files.rs`).
//!
//! In: the session state and the view state. Out: commands. [`SetupForm`] keeps the choices until a button is clicked.

use egui::{Frame, Margin, ScrollArea, Ui};

use super::{files, overlays, tested_policy, training};
use crate::app::commands::{Command, SessionMode};
use crate::app::screen::input::ScreenInput;
use crate::app::screen::key_bindings::{Shortcut, with_key_hint};
use crate::app::screen::widgets::icons::{self, ButtonStyle, Icon};
use crate::app::screen::widgets::segments::{self, Segment};
use crate::app::screen::widgets::text::{key_cap_ui, section_title_ui, separator_ui, weak_text};
use crate::app::setup_form::SetupForm;
use crate::app::view_state::{ViewCamera, ViewState};

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
    tested_policy::tested_policy_ui(ui, view.status, commands);
    let mut setup_form = SetupForm::keep_or_reset(view_state.interaction.setup_form.take(), view.status);
    training::training_ui(ui, view.status, &mut setup_form, commands);
    view_state.interaction.setup_form = Some(setup_form);
    separator_ui(ui);
    section_title_ui(ui, "Overlays");
    overlays::overlays_ui(ui, &mut view_state.overlays);
    separator_ui(ui);
    view_ui(ui, view, view_state);
    separator_ui(ui);
    files::files_ui(ui, view.status, commands);
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

/// Draws the choice of one arena or all; leaves `reserved` points on the right for a button.
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
