//! The labels of the vertical marks in a plot.

use egui::{Align2, FontId, Rect, pos2, vec2};
use egui_plot::PlotTransform;

use crate::app::history::Annotation;
use crate::app::screen::theme::{Palette, SMALL};

/// Labels the marks at the bottom of the plot, each next to its line. Labels that do not fit are left out.
pub(super) fn label_marks(ui: &egui::Ui, transform: &PlotTransform, marks: &[Annotation], palette: Palette) {
    let frame = *transform.frame();
    let painter = ui.painter().with_clip_rect(frame.intersect(ui.clip_rect()));
    let font = FontId::proportional(SMALL);
    let mut taken: Vec<Rect> = Vec::new();
    for mark in marks.iter().rev() {
        let x = transform.position_from_point_x(mark.env_steps as f64);
        if !frame.x_range().contains(x) {
            continue;
        }
        let galley = painter.layout_no_wrap(mark.text.clone(), font.clone(), palette.weak_text);
        let size = galley.size();
        // Right or left of the line, in the bottom row or the one above.
        let candidates = [0.0, 1.0].into_iter().flat_map(|row| {
            let y = frame.bottom() - 4.0 - row * (size.y + 1.0);
            let right = Align2::LEFT_BOTTOM.anchor_size(pos2(x + 4.0, y), size);
            [right, right.translate(vec2(-size.x - 8.0, 0.0))]
        });
        let is_free = |rect: &Rect| {
            frame.contains_rect(*rect)
                && !taken.iter().any(|other| other.intersects(rect.expand2(vec2(3.0, 0.0))))
        };
        if let Some(rect) = candidates.into_iter().find(is_free) {
            painter.rect_filled(rect.expand2(vec2(2.0, 0.0)), 2.0, palette.panel.gamma_multiply(0.85));
            painter.galley(rect.min, galley, palette.weak_text);
            taken.push(rect);
        }
    }
}
