//! The switches of the overlays: one row each, with a sample of what the overlay draws, and its key.

use egui::{
    Align2, FontId, Mesh, Painter, Rect, Sense, Shape, Stroke, StrokeKind, Ui, WidgetInfo, WidgetType,
};
use egui::{pos2, vec2};

use crate::app::screen::key_bindings::{Shortcut, key_label};
use crate::app::screen::theme::{BODY, Palette, SMALL};
use crate::app::view_state::Overlays;

/// The height of a row, in points.
const ROW: f32 = 26.0;

/// Draws a row for each overlay.
pub fn overlays_ui(ui: &mut Ui, overlays: &mut Overlays) {
    let spacing = std::mem::take(&mut ui.spacing_mut().item_spacing.y);
    overlay_row_ui(
        ui,
        &mut overlays.beams,
        "LIDAR beams",
        Shortcut::Beams,
        "LIDAR beams, coloured by distance; the shortest is labelled",
    );
    overlay_row_ui(ui, &mut overlays.path, "Current path", Shortcut::Path, "Path since the last goal");
    overlay_row_ui(
        ui,
        &mut overlays.trails,
        "Past paths",
        Shortcut::Trails,
        "Recent paths, coloured by outcome",
    );
    overlay_row_ui(ui, &mut overlays.q_values, "Q-values", Shortcut::QValues, "Q-value of each motion");
    overlay_row_ui(
        ui,
        &mut overlays.potential,
        "Potential",
        Shortcut::Potential,
        "Potential field used by the reward (eq. 4): lower is better",
    );
    overlay_row_ui(
        ui,
        &mut overlays.value,
        "State value",
        Shortcut::Value,
        "State value of each position, at the robot's current heading",
    );
    ui.spacing_mut().item_spacing.y = spacing;
}

fn overlay_row_ui(ui: &mut Ui, on: &mut bool, name: &str, shortcut: Shortcut, about: &str) {
    let palette = Palette::from_ui(ui);
    let (rect, mut response) = ui.allocate_exact_size(vec2(ui.available_width(), ROW), Sense::click());
    if response.clicked() {
        *on = !*on;
        response.mark_changed();
    }
    response.widget_info(|| WidgetInfo::selected(WidgetType::Checkbox, ui.is_enabled(), *on, name));
    let painter = ui.painter();
    let middle = rect.center().y;
    if response.hovered() || response.has_focus() {
        painter.rect_filled(rect.expand2(vec2(6.0, 0.0)), 4.0, palette.control);
    }
    let tick = Rect::from_center_size(pos2(rect.left() + 8.0, middle), vec2(15.0, 15.0));
    if *on {
        painter.rect_filled(tick, 4.0, palette.accent);
        let corners = [(-3.5, 0.2), (-1.2, 2.8), (3.6, -2.8)].map(|(x, y)| tick.center() + vec2(x, y));
        painter.add(Shape::line(corners.into(), Stroke::new(1.7, palette.on_accent)));
    } else {
        painter.rect(tick, 4.0, palette.control, Stroke::new(1.0, palette.obstacle), StrokeKind::Inside);
    }
    sample(
        painter,
        shortcut,
        Rect::from_center_size(pos2(rect.left() + 40.0, middle), vec2(26.0, 14.0)),
        palette,
    );
    let text = |x, side, words, size, color| {
        painter.text(pos2(x, middle), side, words, FontId::proportional(size), color)
    };
    let color = if *on { palette.text } else { palette.weak_text };
    text(rect.left() + 62.0, Align2::LEFT_CENTER, name, BODY, color);
    text(rect.right(), Align2::RIGHT_CENTER, key_label(shortcut), SMALL, palette.weak_text);
    response.on_hover_text(about);
}

/// Draws a small sample of the overlay.
fn sample(painter: &Painter, shortcut: Shortcut, rect: Rect, palette: Palette) {
    let at = |x: f32, y: f32| rect.lerp_inside(vec2(x, y));
    let line = |from, to, color| {
        painter.line_segment([from, to], Stroke::new(1.5, color));
    };
    match shortcut {
        Shortcut::Beams => {
            for (x, y, color) in
                [(0.95, 0.0, palette.weak_text), (1.0, 0.5, palette.error), (0.95, 1.0, palette.weak_text)]
            {
                line(at(0.1, 0.5), at(x, y), color);
            }
            painter.circle_filled(at(0.1, 0.5), 2.5, palette.accent);
        }
        Shortcut::Path => {
            let points =
                (0..=16).map(|k| k as f32 / 16.0).map(|x| at(x, 0.5 - 0.4 * (x * 6.0).sin())).collect();
            painter.add(Shape::line(points, Stroke::new(1.5, palette.accent)));
        }
        Shortcut::Trails => {
            for (y, color) in [(0.1, palette.success), (0.5, palette.warning), (0.9, palette.error)] {
                line(at(0.0, y), at(1.0, y), color);
            }
        }
        Shortcut::QValues => {
            for (k, height) in [0.35, 0.6, 1.0, 0.7, 0.25].into_iter().enumerate() {
                let x = 0.1 + k as f32 * 0.19;
                let color = if k == 2 { palette.accent } else { palette.obstacle };
                painter.rect_filled(
                    Rect::from_min_max(at(x - 0.07, 1.0 - height), at(x + 0.07, 1.0)),
                    0.5,
                    color,
                );
            }
        }
        Shortcut::Potential => {
            gradient(painter, rect, palette);
            let (from, to) = (at(0.3, 0.5), at(0.7, 0.5));
            line(from, to, palette.text);
            for y in [0.25, 0.75] {
                line(at(0.56, y), to, palette.text);
            }
        }
        Shortcut::Value => gradient(painter, rect, palette),
        _ => {}
    }
}

/// Draws the colours of a field overlay, from the lowest value to the highest.
fn gradient(painter: &Painter, rect: Rect, palette: Palette) {
    let [from, to] = palette.field_colors;
    let mut mesh = Mesh::default();
    for (x, color) in [(rect.left(), from), (rect.right(), to)] {
        mesh.colored_vertex(pos2(x, rect.top()), color);
        mesh.colored_vertex(pos2(x, rect.bottom()), color);
    }
    mesh.add_triangle(0, 1, 2);
    mesh.add_triangle(1, 2, 3);
    painter.add(mesh);
    painter.rect_stroke(rect, 1.0, Stroke::new(1.0, palette.border), StrokeKind::Inside);
}
