//! The floor of an arena, with grid lines at a round spacing.

use bevy::math::{Vec2, Vec2Swizzles};
use egui::{Rangef, Rect, Stroke};

use super::canvas::Canvas;
use super::polygon;
use super::transform::ArenaBounds;
use crate::scenario::Enclosure;

/// Draws the floor with faint grid lines at a round spacing.
pub fn draw_floor(canvas: &Canvas, enclosure: &Enclosure) {
    let (painter, transform, palette) = (&canvas.painter, &canvas.transform, &canvas.palette);
    let bounds = ArenaBounds::from_enclosure(enclosure);
    let bounds_rect = transform.to_screen_rect(bounds.min_m, bounds.max_m);
    let corners = enclosure.corners_m();
    match enclosure {
        Enclosure::Rectangle { .. } => {
            painter.rect_filled(bounds_rect, 0.0, palette.floor);
        }
        Enclosure::Polygon { .. } => polygon::fill(canvas, &corners, palette.floor),
    }
    let visible = bounds_rect.intersect(painter.clip_rect());
    if canvas.compact || !visible.is_positive() {
        return;
    }
    let faint = Stroke::new(1.0, palette.grid);
    draw_grid_lines(canvas, visible, &corners, grid_step_m(transform.scale), faint);
}

/// Draws lines `step_m` apart through the part of a polygon that is in the rectangle `visible`.
pub fn draw_grid_lines(canvas: &Canvas, visible: Rect, corners: &[Vec2], step_m: f32, stroke: Stroke) {
    let (painter, transform) = (&canvas.painter, &canvas.transform);
    let (low, high) = (transform.to_world(visible.left_bottom()), transform.to_world(visible.right_top()));
    let part =
        |from: f32, to: f32, visible: Rangef| Rangef::new(from.min(to), from.max(to)).intersection(visible);
    for x_m in lines_between(low[0], high[0], step_m) {
        for [from, to] in spans_at(corners, x_m, step_m) {
            let (from, to) = (canvas.to_screen([x_m, from]), canvas.to_screen([x_m, to]));
            painter.vline(from.x, part(from.y, to.y, visible.y_range()), stroke);
        }
    }
    let transposed: Vec<Vec2> = corners.iter().map(|corner| corner.yx()).collect();
    for y_m in lines_between(low[1], high[1], step_m) {
        for [from, to] in spans_at(&transposed, y_m, step_m) {
            let (from, to) = (canvas.to_screen([from, y_m]), canvas.to_screen([to, y_m]));
            painter.hline(part(from.x, to.x, visible.x_range()), from.y, stroke);
        }
    }
}

/// The parts of the line x = `at_m` inside a polygon; a side that lies on the line counts as inside.
fn spans_at(corners: &[Vec2], at_m: f32, step_m: f32) -> Vec<[f32; 2]> {
    let [left, right] = [-1e-3, 1e-3].map(|by| polygon::spans(corners, at_m + by * step_m));
    let length = |spans: &[[f32; 2]]| spans.iter().map(|[from, to]| to - from).sum::<f32>();
    if length(&left) >= length(&right) { left } else { right }
}

/// The spacing of the grid lines in m: the smallest of 1, 2 or 5 times a power of ten that is at least 56 points wide.
#[must_use]
pub fn grid_step_m(points_per_m: f32) -> f32 {
    let min_m = 56.0 / points_per_m.max(1e-6);
    let power = 10.0_f32.powf(min_m.log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|k| k * power).into_iter().find(|&step| step >= min_m).unwrap_or(min_m)
}

/// The multiples of `step` from `low` to `high`, at most 1,001.
fn lines_between(low: f32, high: f32, step: f32) -> impl Iterator<Item = f32> {
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    (first..=last.min(first.saturating_add(1000))).map(move |k| k as f32 * step)
}

#[cfg(test)]
mod tests {
    use bevy::math::vec2;

    use super::*;

    #[test]
    fn grid_lines_are_a_round_distance_apart() {
        for (scale, step) in [(56.0, 1.0), (150.0, 0.5), (40.0, 2.0), (6.0, 10.0), (1000.0, 0.1)] {
            assert!((grid_step_m(scale) / step - 1.0).abs() < 1e-4, "{scale}: {}", grid_step_m(scale));
        }
        let lines: Vec<f32> = lines_between(-1.1, 1.0, 0.5).collect();
        assert_eq!(lines, [-1.0, -0.5, 0.0, 0.5, 1.0]);
        // Enough for a screen of 9,000 points: the lines of the editor's grid are at least 9 points apart.
        assert_eq!(lines_between(0.0, 1e6, 1.0).count(), 1001);
    }

    #[test]
    fn a_line_along_a_side_counts_as_inside() {
        let square = [vec2(0.0, 0.0), vec2(2.0, 0.0), vec2(2.0, 3.0), vec2(0.0, 3.0)];
        for (at, spans) in [(0.0, vec![[0.0, 3.0]]), (2.0, vec![[0.0, 3.0]]), (2.1, vec![])] {
            assert_eq!(spans_at(&square, at, 0.5), spans, "{at}");
        }
    }
}
