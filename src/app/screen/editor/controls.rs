//! Choices and buttons of the editor's panel.

use egui::{Align, Button, ComboBox, Layout, Response, RichText, Ui, vec2};

use crate::app::screen::theme::BODY;
use crate::app::screen::widgets::text::weak_text;

/// Width of a choice, in points; the spacing between two fields is added to it.
const CHOICE_WIDTH: f32 = 132.0;

/// Gives a control a name for screen readers.
pub fn set_accessible_name(response: &Response, name: &str) {
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(name));
}

/// Shows a row with a list to choose from; each choice has a value, a text and a tooltip. Returns the chosen value if
/// it is not `current`.
pub fn choice_ui<T: Copy + PartialEq>(
    ui: &mut Ui,
    name: &str,
    current: T,
    choices: &[(T, &str, &str)],
) -> Option<T> {
    let mut chosen = None;
    ui.horizontal(|ui| {
        let label = ui.label(weak_text(name));
        let width = (CHOICE_WIDTH + ui.spacing().item_spacing.x).min(ui.available_width());
        let text = choices.iter().find(|(value, ..)| *value == current).map_or("", |(_, text, _)| *text);
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
            let combo = ComboBox::from_id_salt(name).width(width).selected_text(text).truncate();
            let shown = combo.show_ui(ui, |ui| {
                for &(value, text, tip) in choices {
                    if ui.selectable_label(value == current, text).on_hover_text(tip).clicked() {
                        chosen = Some(value);
                    }
                }
            });
            shown.response.labelled_by(label.id);
        });
    });
    chosen.filter(|&value| value != current)
}

/// Shows a row of buttons across the width of the panel; each has a text, a tooltip and whether it is enabled. Returns the
/// index of the clicked button.
pub fn button_row_ui(ui: &mut Ui, buttons: &[(&str, &str, bool)]) -> Option<usize> {
    let mut clicked = None;
    let gaps = ui.spacing().item_spacing.x * buttons.len().saturating_sub(1) as f32;
    let width = (ui.available_width() - gaps) / buttons.len().max(1) as f32;
    ui.horizontal(|ui| {
        for (k, (text, tip, enabled)) in buttons.iter().enumerate() {
            ui.add_enabled_ui(*enabled, |ui| {
                let button = Button::new(RichText::new(*text).size(BODY));
                let response = ui.add_sized(vec2(width, 26.0), button);
                if response.on_hover_text(*tip).on_disabled_hover_text(*tip).clicked() {
                    clicked = Some(k);
                }
            });
        }
    });
    clicked
}
