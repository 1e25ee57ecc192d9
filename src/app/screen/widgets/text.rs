//! Text elements: section titles, secondary text, separators and key caps.

use egui::text::{LayoutJob, TextWrapping};
use egui::{
    Align2, Color32, FontId, Label, Painter, Pos2, Rect, Response, RichText, Sense, Stroke, StrokeKind, Ui,
    WidgetInfo, WidgetType, vec2,
};

use crate::app::screen::theme::{BODY, GAP, Palette, SMALL};

/// The radius of the dot of a note, in points.
const NOTE_DOT: f32 = 3.5;

/// The title of a section of a panel.
pub fn section_title_ui(ui: &mut Ui, text: &str) -> Response {
    ui.label(RichText::new(text).size(BODY).strong())
}

/// Small text in the weak colour: captions, explanations.
pub fn weak_text(text: &str) -> RichText {
    RichText::new(text).size(SMALL).weak()
}

/// Paints one line of text of `size` points, anchored `at` a point and cut off at `max_width`. Returns the rectangle of the text.
pub fn paint_truncated(
    painter: &Painter,
    (at, anchor): (Pos2, Align2),
    text: &str,
    (size, color): (f32, Color32),
    max_width: f32,
) -> Rect {
    let mut job = LayoutJob::simple_singleline(text.into(), FontId::proportional(size), color);
    job.wrap = TextWrapping::truncate_at_width(max_width.max(0.0));
    let galley = painter.layout_job(job);
    let rect = anchor.anchor_size(at, galley.size());
    painter.galley(rect.min, galley, color);
    rect
}

/// A short note that needs attention: small text after a dot in the warning colour.
pub fn note_ui(ui: &mut Ui, text: &str) {
    ui.horizontal_top(|ui| {
        ui.spacing_mut().item_spacing.x = GAP;
        let (dot, _) = ui.allocate_exact_size(vec2(2.0 * NOTE_DOT, SMALL + 3.0), Sense::hover());
        ui.painter().circle_filled(dot.center(), NOTE_DOT, Palette::from_ui(ui).warning);
        ui.add(Label::new(RichText::new(text).size(SMALL)).wrap());
    });
}

/// A horizontal line between two sections.
pub fn separator_ui(ui: &mut Ui) {
    ui.add_space(GAP);
    ui.separator();
    ui.add_space(GAP * 0.5);
}

/// A key, drawn as a key cap.
pub fn key_cap_ui(ui: &mut Ui, key: &str) {
    let palette = Palette::from_ui(ui);
    let text = ui.painter().layout_no_wrap(key.into(), FontId::proportional(SMALL), palette.text);
    let size = vec2((text.size().x + 12.0).max(20.0), 20.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(WidgetType::Label, true, key));
    let stroke = Stroke::new(1.0, palette.border);
    ui.painter().rect(rect, 4.0, palette.control, stroke, StrokeKind::Inside);
    ui.painter().galley(rect.center() - text.size() / 2.0, text, palette.text);
}
