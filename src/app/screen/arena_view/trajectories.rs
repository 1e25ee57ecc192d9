//! Trajectories: the path since the last start or goal, and past paths coloured by outcome.

use egui::{Color32, Painter, Pos2, Rect, Stroke, StrokeKind, vec2};

use super::canvas::Canvas;
use crate::app::scene::{ArenaScene, Trail, TrailEnd};
use crate::app::screen::theme::Palette;
use crate::app::view_state::Overlays;

/// Draws the past paths, coloured by outcome, and the current path, which fades towards its start; each only if its overlay
/// is on.
pub fn draw(canvas: &Canvas, arena: &ArenaScene, overlays: &Overlays) {
    if overlays.trails {
        let count = arena.trails.len().min(if canvas.compact { 3 } else { usize::MAX });
        for (age, trail) in arena.trails.iter().rev().take(count).enumerate().rev() {
            let recency = 1.0 - age as f32 / count as f32;
            draw_trail(canvas, trail, 0.22 + 0.38 * recency);
        }
    }
    if overlays.path && !arena.path_m.is_empty() {
        let path = arena.path_m.iter().copied().chain([[arena.pose.x_m, arena.pose.y_m]]);
        let color = canvas.palette.accent;
        let width = if canvas.compact { 1.25 } else { 2.5 };
        canvas.gradient_line(path, width, |fraction| color.gamma_multiply(0.06 + 0.84 * fraction * fraction));
    }
}

/// The colour of an outcome.
#[must_use]
pub fn outcome_color(palette: &Palette, end: TrailEnd) -> Color32 {
    match end {
        TrailEnd::Reached => palette.success,
        TrailEnd::Collided => palette.error,
        TrailEnd::TimedOut => palette.warning,
    }
}

/// Draws a past path with the opacity `strength`.
fn draw_trail(canvas: &Canvas, trail: &Trail, strength: f32) {
    let color = outcome_color(&canvas.palette, trail.end);
    let width = if canvas.compact { 1.0 } else { 1.5 };
    canvas.gradient_line(trail.points_m.iter().copied(), width, |fraction| {
        color.gamma_multiply(strength * (0.35 + 0.65 * fraction))
    });
    if let (Some(&end), false) = (trail.points_m.last(), canvas.compact) {
        outcome_mark(
            &canvas.painter,
            canvas.to_screen(end),
            trail.end,
            color.gamma_multiply(strength + 0.25),
        );
    }
}

/// Draws the mark at the end of a past path: a dot for a reached goal, a cross for a collision, a square for
/// a timeout.
pub fn outcome_mark(painter: &Painter, at: Pos2, end: TrailEnd, color: Color32) {
    let stroke = Stroke::new(1.75, color);
    match end {
        TrailEnd::Reached => {
            painter.circle_filled(at, 2.75, color);
        }
        TrailEnd::Collided => {
            painter.line_segment([at - vec2(3.0, 3.0), at + vec2(3.0, 3.0)], stroke);
            painter.line_segment([at + vec2(-3.0, 3.0), at + vec2(3.0, -3.0)], stroke);
        }
        TrailEnd::TimedOut => {
            let square = Rect::from_center_size(at, vec2(5.0, 5.0));
            painter.rect_stroke(square, 0.0, Stroke::new(1.25, color), StrokeKind::Middle);
        }
    }
}
