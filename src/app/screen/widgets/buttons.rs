//! Text buttons: the primary button in the accent colour, and the full-width button.

use egui::{Button, Response, RichText, Stroke, Ui, Vec2, vec2};

use crate::app::screen::theme::Palette;

/// Draws a button of `size` in the accent colour, with text of `font_size` points: the suggested next action.
pub fn primary_button_ui(ui: &mut Ui, text: &str, font_size: f32, size: Vec2) -> Response {
    let palette = Palette::from_ui(ui);
    let shown = ui.scope(|ui| {
        let widgets = &mut ui.visuals_mut().widgets;
        let hovered = palette.accent.lerp_to_gamma(palette.text, 0.15);
        for (visuals, fill) in [
            (&mut widgets.inactive, palette.accent),
            (&mut widgets.hovered, hovered),
            (&mut widgets.active, hovered),
        ] {
            visuals.weak_bg_fill = fill;
            visuals.bg_stroke = Stroke::NONE;
        }
        ui.add_sized(
            size,
            Button::new(RichText::new(text).size(font_size).color(palette.on_accent)).truncate(),
        )
    });
    let response = shown.inner;
    if response.has_focus() {
        let ring = Stroke::new(2.0, palette.text);
        ui.painter().rect_stroke(response.rect.expand(2.0), 6.0, ring, egui::StrokeKind::Inside);
    }
    response
}

/// Draws a button of the full width and `height` points.
pub fn wide_button_ui(ui: &mut Ui, text: &str, height: f32) -> Response {
    ui.add_sized(vec2(ui.available_width(), height), Button::new(text).truncate())
}
