//! The ways of moving obstacles: where one goes, as a broken line, before it goes there.
//!
//! In: an obstacle with its motion. Out: an orbit's circle, a patrol's legs with its corners, a random walk's reach.

use bevy::math;
use egui::{Color32, Pos2, Shape as Mark, Stroke, Vec2, vec2};

use super::canvas::Canvas;
use crate::scenario::{Obstacle, ObstacleMotion};

/// A dash and the gap after it, in points.
const DASH: (f32, f32) = (6.0, 4.0);

/// Draws where `obstacle` goes; nothing of one that stands still.
pub fn draw(canvas: &Canvas, obstacle: &Obstacle, ink: Color32) {
    let stroke = Stroke::new(1.5, ink);
    let at = canvas.to_screen(obstacle.position_m.into());
    match &obstacle.motion {
        ObstacleMotion::Static => {}
        ObstacleMotion::Orbit { centre_m, speed_rad_s } => {
            let centre = canvas.to_screen((*centre_m).into());
            ring(canvas, centre, centre.distance(at), stroke);
            for side in [vec2(4.0, 0.0), vec2(0.0, 4.0)] {
                canvas.painter.line_segment([centre - side, centre + side], stroke);
            }
            // A little ahead of the obstacle. y is down here: counterclockwise is towards smaller angles.
            if *speed_rad_s != 0.0 && centre.distance(at) > 12.0 {
                let way = -speed_rad_s.signum();
                let spoke = Vec2::angled((at - centre).angle() + way * 0.6);
                canvas.arrow_head(centre + spoke * centre.distance(at), spoke.rot90() * -way, 8.0, ink);
            }
        }
        ObstacleMotion::Patrol { .. } | ObstacleMotion::BackAndForth { .. } => {
            if let Some((corners, closed)) = obstacle.path_m() {
                legs(canvas, corners, closed, stroke);
            }
        }
        ObstacleMotion::RandomWalk { radius_m, .. } => {
            let reach = canvas.transform.to_screen_length(*radius_m);
            canvas.painter.circle_filled(at, reach, ink.gamma_multiply(0.08));
            ring(canvas, at, reach, stroke);
        }
    }
}

/// A broken line through the corners, with an arrow on each leg that is long enough, and both ways if it comes back.
fn legs(canvas: &Canvas, corners: Vec<math::Vec2>, closed: bool, stroke: Stroke) {
    let mut points: Vec<Pos2> = corners.into_iter().map(|corner| canvas.to_screen(corner.into())).collect();
    for &corner in points.iter().skip(1) {
        canvas.painter.circle_filled(corner, 2.5, stroke.color);
    }
    if closed {
        points.extend(points.first().copied());
    }
    for leg in points.windows(2) {
        let (from, to) = (leg[0], leg[1]);
        let along = (to - from).normalized();
        canvas.painter.extend(Mark::dashed_line(&[from, to], stroke, DASH.0, DASH.1));
        if from.distance(to) < 40.0 {
            continue;
        }
        // Not in the middle, where a new corner can be dragged out of it.
        let late = from.lerp(to, 0.7);
        canvas.arrow_head(late + along * 4.0, along, 8.0, stroke.color);
        if !closed {
            canvas.arrow_head(from.lerp(to, 0.3) - along * 4.0, -along, 8.0, stroke.color);
        }
    }
}

/// A broken circle.
fn ring(canvas: &Canvas, centre: Pos2, radius: f32, stroke: Stroke) {
    if !(radius > 1.0 && radius < 1e5) {
        return;
    }
    let parts = (radius * 0.7).clamp(24.0, 360.0) as usize;
    let point = |k: usize| centre + Vec2::angled(k as f32 / parts as f32 * std::f32::consts::TAU) * radius;
    let points: Vec<Pos2> = (0..=parts).map(point).collect();
    canvas.painter.extend(Mark::dashed_line(&points, stroke, DASH.0, DASH.1));
}
