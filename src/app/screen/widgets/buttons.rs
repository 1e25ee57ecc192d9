//! The primary button: in the accent, for what to press next.
//!
//! In: the text and the size. Out: egui's own button in other colours.

use egui::{Button, Response, RichText, Stroke, Ui, Vec2};

use crate::app::screen::theme::Palette;

/// Draws it.
pub fn primary_button_ui(ui: &mut Ui, text: &str, height: f32, size: Vec2) -> Response {
    let palette = Palette::from_ui(ui);
    let shown = ui.scope(|ui| {
        let widgets = &mut ui.visuals_mut().widgets;
        let lit = palette.accent.lerp_to_gamma(palette.text, 0.15);
        for (look, fill) in
            [(&mut widgets.inactive, palette.accent), (&mut widgets.hovered, lit), (&mut widgets.active, lit)]
        {
            look.weak_bg_fill = fill;
            look.bg_stroke = Stroke::NONE;
        }
        ui.add_sized(size, Button::new(RichText::new(text).size(height).color(palette.on_accent)))
    });
    let response = shown.inner;
    if response.has_focus() {
        let ring = Stroke::new(2.0, palette.text);
        ui.painter().rect_stroke(response.rect.expand(2.0), 6.0, ring, egui::StrokeKind::Inside);
    }
    response
}
