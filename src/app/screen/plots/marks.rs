//! The texts at the vertical marks of a plot.

use egui::{Align2, FontId, Rect, pos2, vec2};
use egui_plot::PlotTransform;

use crate::app::history::Annotation;
use crate::app::screen::theme::{Palette, SMALL};

/// Writes what the marks are at the top of the plot, each beside its line where there is room.
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
        // To the right of its line or to the left, in the lowest row or the one above.
        let places = [0.0, 1.0].into_iter().flat_map(|row| {
            let y = frame.bottom() - 4.0 - row * (size.y + 1.0);
            let right = Align2::LEFT_BOTTOM.anchor_size(pos2(x + 4.0, y), size);
            [right, right.translate(vec2(-size.x - 8.0, 0.0))]
        });
        let free = |place: &Rect| {
            frame.contains_rect(*place)
                && !taken.iter().any(|other| other.intersects(place.expand2(vec2(3.0, 0.0))))
        };
        if let Some(place) = places.into_iter().find(free) {
            painter.rect_filled(place.expand2(vec2(2.0, 0.0)), 2.0, palette.panel.gamma_multiply(0.85));
            painter.galley(place.min, galley, palette.weak_text);
            taken.push(place);
        }
    }
}
