//! The row "More", which shows or hides the plots below it.

use std::f32::consts::FRAC_PI_2;

use egui::collapsing_header::CollapsingState;
use egui::text::{LayoutJob, TextWrapping};
use egui::{Align2, FontId, Sense, Vec2, WidgetInfo, WidgetType, pos2, vec2};

use crate::app::screen::theme::{BODY, GAP, Palette, SMALL};

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
    // Truncates text at the end of the row.
    let text = |x, words: &str, size, color| {
        let mut job = LayoutJob::simple_singleline(words.into(), FontId::proportional(size), color);
        job.wrap = TextWrapping::truncate_at_width(rect.right() - x);
        let galley = ui.painter().layout_job(job);
        let rect_of_text = Align2::LEFT_CENTER.anchor_size(pos2(x, rect.center().y), galley.size());
        ui.painter().galley(rect_of_text.min, galley, color);
        rect_of_text
    };
    let more = text(rect.left() + 16.0, "More", BODY, palette.text);
    text(more.right() + 2.0 * GAP, "loss, Q-values, exploration, reward", SMALL, palette.weak_text);
    response.on_hover_text("Loss, Q-values, exploration and reward terms");
    state.show_body_unindented(ui, body);
}
