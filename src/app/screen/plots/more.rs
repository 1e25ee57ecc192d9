//! The row "More", which shows or hides the plots below it.

use std::f32::consts::FRAC_PI_2;

use egui::collapsing_header::CollapsingState;
use egui::text::{LayoutJob, TextWrapping};
use egui::{Align2, FontId, Sense, Vec2, WidgetInfo, WidgetType, pos2, vec2};

use crate::app::screen::theme::{BODY, GAP, Palette, SMALL};

/// A row that opens and closes what is under it.
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
    let lit = response.hovered() || response.has_focus();
    if lit {
        ui.painter().rect_filled(rect.expand2(vec2(6.0, 0.0)), 4.0, palette.control);
    }
    // A triangle that turns from the right to below.
    let middle = rect.left_center() + vec2(4.0, 0.0);
    let along = Vec2::angled(state.openness(ui.ctx()) * FRAC_PI_2);
    let corners = [along * 5.0, along.rot90() * 5.0 - along * 3.5, -along.rot90() * 5.0 - along * 3.5];
    let ink = if lit { palette.text } else { palette.weak_text };
    let corners = corners.map(|corner| middle + corner).to_vec();
    ui.painter().add(egui::Shape::convex_polygon(corners, ink, egui::Stroke::NONE));
    // As much of it as has room.
    let word = |x, text: &str, size, ink| {
        let mut job = LayoutJob::simple_singleline(text.into(), FontId::proportional(size), ink);
        job.wrap = TextWrapping::truncate_at_width(rect.right() - x);
        let galley = ui.painter().layout_job(job);
        let place = Align2::LEFT_CENTER.anchor_size(pos2(x, rect.center().y), galley.size());
        ui.painter().galley(place.min, galley, ink);
        place
    };
    let more = word(rect.left() + 16.0, "More", BODY, palette.text);
    word(more.right() + 2.0 * GAP, "loss, Q-values, exploration, reward", SMALL, palette.weak_text);
    response.on_hover_text("Loss, Q-values, exploration, and what the reward is made of.");
    state.show_body_unindented(ui, body);
}
