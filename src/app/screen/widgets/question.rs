//! A question in the middle of the window, with its buttons.

use egui::{Align2, Area, Frame, Id, Margin, Order, Rect, Stroke, Ui};

use crate::app::screen::theme::Palette;

/// Draws a frame in the middle of `canvas`, with `contents` in it, `width` points wide.
pub fn question_ui(ui: &Ui, canvas: Rect, id: &str, width: f32, contents: impl FnOnce(&mut Ui)) {
    let palette = Palette::from_ui(ui);
    let area = Area::new(Id::new(id)).order(Order::Foreground).pivot(Align2::CENTER_CENTER);
    area.fixed_pos(canvas.center()).constrain_to(canvas).show(ui.ctx(), |ui| {
        let frame = Frame::new()
            .fill(palette.panel)
            .stroke(Stroke::new(1.0, palette.warning))
            .corner_radius(8.0)
            .shadow(ui.visuals().popup_shadow)
            .inner_margin(Margin::same(14));
        frame.show(ui, |ui| {
            ui.set_width(width);
            contents(ui);
        });
    });
}
