//! The floor of an arena, with grid lines at round distances.

use bevy::math::{Vec2, Vec2Swizzles, vec2};
use egui::{Rangef, Rect, Stroke};

use super::canvas::Canvas;
use super::polygon;
use super::transform::ArenaBounds;
use crate::scenario::Enclosure;

/// The floor within the walls, with faint lines every so often.
pub fn draw_floor(canvas: &Canvas, enclosure: &Enclosure) {
    let (painter, transform, palette) = (&canvas.painter, &canvas.transform, &canvas.palette);
    let bounds = ArenaBounds::from_enclosure(enclosure);
    let whole = transform.to_screen_rect(bounds.min_m, bounds.max_m);
    let corners = enclosure.corners_m();
    match enclosure {
        Enclosure::Rectangle { .. } => {
            painter.rect_filled(whole, 0.0, palette.floor);
        }
        Enclosure::Polygon { .. } => polygon::fill(canvas, &corners, palette.floor),
    }
    let seen = whole.intersect(painter.clip_rect());
    if canvas.compact || !seen.is_positive() {
        return;
    }
    let faint = Stroke::new(1.0, palette.grid);
    draw_grid_lines(canvas, seen, &corners, grid_step_m(transform.scale), faint);
}

/// Lines `step_m` apart through what is `seen` of the inside of a polygon.
pub fn draw_grid_lines(canvas: &Canvas, seen: Rect, corners: &[Vec2], step_m: f32, stroke: Stroke) {
    let (painter, transform) = (&canvas.painter, &canvas.transform);
    let (low, high) = (transform.to_world(seen.left_bottom()), transform.to_world(seen.right_top()));
    let part = |from: f32, to: f32, seen: Rangef| Rangef::new(from.min(to), from.max(to)).intersection(seen);
    for k in lines_between(low[0], high[0], step_m) {
        for [from, to] in beside(corners, k, step_m) {
            let (from, to) = (canvas.to_screen([k, from]), canvas.to_screen([k, to]));
            painter.vline(from.x, part(from.y, to.y, seen.y_range()), stroke);
        }
    }
    let lying: Vec<Vec2> = corners.iter().map(|corner| corner.yx()).collect();
    for k in lines_between(low[1], high[1], step_m) {
        for [from, to] in beside(&lying, k, step_m) {
            let (from, to) = (canvas.to_screen([from, k]), canvas.to_screen([to, k]));
            painter.hline(part(from.x, to.x, seen.x_range()), from.y, stroke);
        }
    }
}

/// The parts of the line x = `at_m` within a polygon. Where a side lies on the line, it counts as within.
fn beside(corners: &[Vec2], at_m: f32, step_m: f32) -> Vec<[f32; 2]> {
    let [left, right] = [-1e-3, 1e-3].map(|by| polygon::spans(corners, at_m + by * step_m));
    let long = |spans: &[[f32; 2]]| spans.iter().map(|[from, to]| to - from).sum::<f32>();
    if long(&left) >= long(&right) { left } else { right }
}

/// The distance of the floor's lines: 1, 2 or 5 times a power of ten, in m, that is 56 points or more.
#[must_use]
pub fn grid_step_m(points_per_m: f32) -> f32 {
    let least = 56.0 / points_per_m.max(1e-6);
    let power = 10.0_f32.powf(least.log10().floor());
    [1.0, 2.0, 5.0, 10.0].map(|k| k * power).into_iter().find(|&step| step >= least).unwrap_or(least)
}

fn lines_between(low: f32, high: f32, step: f32) -> impl Iterator<Item = f32> {
    let (first, last) = ((low / step).ceil() as i64, (high / step).floor() as i64);
    (first..=last.min(first + 200)).map(move |k| k as f32 * step)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_floors_lines_are_round_numbers_apart() {
        for (scale, step) in [(56.0, 1.0), (150.0, 0.5), (40.0, 2.0), (6.0, 10.0), (1000.0, 0.1)] {
            assert!((grid_step_m(scale) / step - 1.0).abs() < 1e-4, "{scale}: {}", grid_step_m(scale));
        }
        let lines: Vec<f32> = lines_between(-1.1, 1.0, 0.5).collect();
        assert_eq!(lines, [-1.0, -0.5, 0.0, 0.5, 1.0]);
    }

    #[test]
    fn a_line_along_a_side_is_within() {
        let square = [vec2(0.0, 0.0), vec2(2.0, 0.0), vec2(2.0, 3.0), vec2(0.0, 3.0)];
        for (at, spans) in [(0.0, vec![[0.0, 3.0]]), (2.0, vec![[0.0, 3.0]]), (2.1, vec![])] {
            assert_eq!(beside(&square, at, 0.5), spans, "{at}");
        }
    }
}
