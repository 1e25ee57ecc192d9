//! LIDAR beams: short ones in a strong, warm colour, long ones faint, the shortest with its length.
//!
//! In: the last scan of an [`ArenaScene`]. Out: shapes on a [`Canvas`].

use egui::{Align2, Color32, Pos2, Rect, Shape, Stroke, Vec2};

use super::canvas::Canvas;
use super::transform::screen_direction;
use crate::app::scene::ArenaScene;
use crate::app::screen::theme::Palette;
use crate::scenario::Scenario;

/// The maximum number of beams drawn. If a scan has more, only every n-th beam is drawn: more could not be distinguished.
const MAX_BEAMS: usize = 720;

/// The colour of a beam; `near` is 1 for length 0 and 0 from half the sensor's range on.
#[must_use]
pub fn beam_color(palette: &Palette, near: f32) -> Color32 {
    palette.weak_text.lerp_to_gamma(palette.error, near.clamp(0.0, 1.0)).gamma_multiply(0.27 + 0.55 * near)
}

/// 1 for a beam of length 0, falling to 0 at half the sensor's range.
fn nearness(range_m: f32, max_range_m: f32) -> f32 {
    (1.0 - 2.0 * range_m / max_range_m.max(1e-6)).clamp(0.0, 1.0)
}

/// Index and length in m of the shortest beam, if any beam hit something.
fn shortest(ranges_m: &[f32], max_range_m: f32) -> Option<(usize, f32)> {
    let hits = ranges_m.iter().copied().enumerate().filter(|(_, range)| *range < max_range_m);
    hits.min_by(|a, b| a.1.total_cmp(&b.1))
}

/// Draws the last scan and returns the rectangle of the shortest beam's label.
pub fn draw(canvas: &Canvas, scenario: &Scenario, arena: &ArenaScene) -> Option<Rect> {
    let (painter, palette) = (&canvas.painter, &canvas.palette);
    let (ranges, max_m) = (&arena.ranges_m, scenario.lidar.max_range_m);
    let from = canvas.to_screen([arena.scan_pose.x_m, arena.scan_pose.y_m]);
    let body = canvas.transform.to_screen_length(scenario.robot.inner_radius_m());
    let towards = |beam: usize| -> Vec2 {
        screen_direction(arena.scan_pose.heading_rad + scenario.lidar.beam_angle_rad(beam) as f32)
    };
    if !scenario.lidar.is_all_around() {
        draw_field_of_view(canvas, scenario, arena, from);
    }
    let shortest = shortest(ranges, max_m);
    // The more beams, the fainter each, so that the whole scan is equally visible.
    let strength = (48.0 / ranges.len() as f32).sqrt().min(1.0);
    for beam in (0..ranges.len()).step_by(ranges.len().div_ceil(MAX_BEAMS).max(1)) {
        let range_m = ranges[beam];
        let (along, reach) = (towards(beam), canvas.transform.to_screen_length(range_m));
        if !range_m.is_finite() || reach <= body || shortest.is_some_and(|(index, _)| index == beam) {
            continue;
        }
        let color = beam_color(palette, nearness(range_m, max_m)).gamma_multiply(strength);
        painter.line_segment([from + along * body, from + along * reach], Stroke::new(1.0, color));
        if range_m < max_m && ranges.len() <= 128 && !canvas.compact {
            painter.circle_filled(from + along * reach, 1.75, color.gamma_multiply(1.6));
        }
    }
    let (beam, range_m) = shortest?;
    let (along, reach) = (towards(beam), canvas.transform.to_screen_length(range_m));
    let (hit, color) = (from + along * reach, palette.error);
    let width = if canvas.compact { 1.25 } else { 2.0 };
    painter.line_segment([from + along * body.min(reach), hit], Stroke::new(width, color));
    if canvas.compact {
        painter.circle_filled(hit, 2.0, color);
        return None;
    }
    painter.circle_filled(hit, 4.5, palette.floor);
    painter.circle_filled(hit, 3.25, color);
    let label = format!("{range_m:.2} m");
    Some(canvas.label(hit + along * 9.0 + label_shift(along), Align2::CENTER_CENTER, &label, palette.text))
}

/// Draws the field of view of a sensor that does not cover the full circle: a wedge between its outermost
/// beams.
fn draw_field_of_view(canvas: &Canvas, scenario: &Scenario, arena: &ArenaScene, from: Pos2) {
    let half = scenario.lidar.field_of_view_rad / 2.0;
    let body = canvas.transform.to_screen_length(scenario.robot.inner_radius_m());
    let (heading, max_reach) =
        (arena.scan_pose.heading_rad, canvas.transform.to_screen_length(scenario.lidar.max_range_m));
    let ends =
        if arena.ranges_m.len() > 1 { [arena.ranges_m.first(), arena.ranges_m.last()] } else { [None; 2] };
    let stroke = Stroke::new(1.0, canvas.palette.weak_text.gamma_multiply(0.6));
    for (turn, end) in [-half, half].into_iter().zip(ends) {
        let length = end.map_or(max_reach, |&range_m| canvas.transform.to_screen_length(range_m));
        let along = screen_direction(heading + turn);
        canvas.painter.line_segment([from + along * body, from + along * length.max(body)], stroke);
    }
    let radius = (2.2 * body).max(16.0);
    let parts = 24;
    let arc = (0..=parts)
        .map(|k| from + screen_direction(heading - half + 2.0 * half * k as f32 / parts as f32) * radius);
    canvas.painter.add(Shape::line(arc.collect(), stroke));
}

/// The offset from the end of a beam in direction `along` to the centre of its label, so that the label is
/// beyond the end.
fn label_shift(along: Vec2) -> Vec2 {
    Vec2::new(along.x * 23.0, along.y * 9.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_shortest_beam_is_one_that_hit_something() {
        assert_eq!(shortest(&[3.5, 1.0, 0.4, 0.9], 3.5), Some((2, 0.4)));
        assert_eq!(shortest(&[3.5, 3.5], 3.5), None);
        assert_eq!(shortest(&[], 3.5), None);
    }

    #[test]
    fn short_beams_are_more_opaque_than_long_ones() {
        let palette = Palette::new(true);
        assert!(beam_color(&palette, nearness(0.2, 3.5)).a() > beam_color(&palette, nearness(3.0, 3.5)).a());
        assert_eq!((nearness(0.0, 3.5), nearness(1.75, 3.5)), (1.0, 0.0));
    }
}
