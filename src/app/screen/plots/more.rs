//! The row "More", which shows or hides the plots below it.

use std::f32::consts::FRAC_PI_2;

use egui::collapsing_header::CollapsingState;
use egui::{Align2, Sense, Vec2, WidgetInfo, WidgetType, pos2, vec2};

use crate::app::screen::theme::{BODY, GAP, Palette, SMALL};
use crate::app::screen::widgets::text::paint_truncated;

/// Draws the row, and `body` below it while `open`.
pub(super) fn more_ui(ui: &mut egui::Ui, open: &mut bool, body: impl FnOnce(&mut egui::Ui)) {
    let id = ui.make_persistent_id("more");
    let mut state = CollapsingState::load_with_default_open(ui.ctx(), id, *open);
    let palette = Palette::from_ui(ui);
    let (rect, response) = ui.allocate_exact_size(vec2(ui.available_width(), 26.0), Sense::click());
    response.widget_info(|| WidgetInfo::labeled(WidgetType::CollapsingHeader, ui.is_enabled(), "More"));
    if response.clicked() {
        *open = !*open;
    }
    state.set_open(*open);
    let highlighted = response.hovered() || response.has_focus();
    if highlighted {
        ui.painter().rect_filled(rect.expand2(vec2(6.0, 0.0)), 4.0, palette.control);
    }
    // A triangle that points right while closed and down while open.
    let middle = rect.left_center() + vec2(4.0, 0.0);
    let along = Vec2::angled(state.openness(ui.ctx()) * FRAC_PI_2);
    let corners = [along * 5.0, along.rot90() * 5.0 - along * 3.5, -along.rot90() * 5.0 - along * 3.5];
    let color = if highlighted { palette.text } else { palette.weak_text };
    let corners = corners.map(|corner| middle + corner).to_vec();
    ui.painter().add(egui::Shape::convex_polygon(corners, color, egui::Stroke::NONE));
    let text = |x, words: &str, size, color| {
        let at = (pos2(x, rect.center().y), Align2::LEFT_CENTER);
        paint_truncated(ui.painter(), at, words, (size, color), rect.right() - x)
    };
    let more = text(rect.left() + 16.0, "More", BODY, palette.text);
    text(more.right() + 2.0 * GAP, "loss, Q-values, exploration, reward", SMALL, palette.weak_text);
    response.on_hover_text("Loss, Q-values, exploration and reward terms");
    state.show_body_unindented(ui, body);
}
