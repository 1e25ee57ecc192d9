//! The paths of moving obstacles as dashed lines: the circle of an orbit, the legs of a patrol, the reach of
//! a random walk.

use bevy::math;
use egui::{Color32, Pos2, Stroke, Vec2, vec2};

use super::canvas::Canvas;
use crate::scenario::{MotionKind, MotionSpeed, Obstacle, Track};

/// Lengths of a dash and of the gap after it, in points.
const DASH: (f32, f32) = (6.0, 4.0);
/// A path with more corners than this (from a recording, for example) is drawn without dots and arrows.
const MAX_MARKED_CORNERS: usize = 300;

/// Draws the path of `obstacle`; nothing for a static one.
pub fn draw(canvas: &Canvas, obstacle: &Obstacle, color: Color32) {
    let stroke = Stroke::new(1.5, color);
    let at = canvas.to_screen(obstacle.position_m.into());
    match obstacle.track() {
        Track::Point => {}
        Track::Circle { centre_m } => orbit(canvas, canvas.to_screen(centre_m.into()), obstacle, stroke),
        Track::Lines { corners_m, closed } => legs(canvas, corners_m, traversal(obstacle, closed), stroke),
        Track::Disc { radius_m } => {
            let reach = canvas.transform.to_screen_length(radius_m);
            canvas.painter.circle_filled(at, reach, color.gamma_multiply(0.08));
            ring(canvas, at, reach, stroke);
        }
    }
}

/// Draws a dashed circle with its centre, and an arrow a little ahead of the obstacle.
fn orbit(canvas: &Canvas, centre: Pos2, obstacle: &Obstacle, stroke: Stroke) {
    let arm = canvas.to_screen(obstacle.position_m.into()) - centre;
    ring(canvas, centre, arm.length(), stroke);
    for side in [vec2(4.0, 0.0), vec2(0.0, 4.0)] {
        canvas.painter.line_segment([centre - side, centre + side], stroke);
    }
    if let MotionSpeed::Revolution { speed_rad_s, .. } = obstacle.motion.speed()
        && speed_rad_s != 0.0
        && arm.length() > 12.0
    {
        // With y down, counterclockwise means smaller angles.
        let direction = -speed_rad_s.signum();
        let spoke = Vec2::angled(arm.angle() + direction * 0.6);
        canvas.arrow_head(centre + spoke * arm.length(), spoke.rot90() * -direction, 8.0, stroke.color);
    }
}

/// How an obstacle moves along its path.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Traversal {
    /// From corner to corner, and from the last to the first.
    Loop,
    /// From corner to corner, and back.
    BackAndForth,
    /// From the first corner to the last.
    OneWay,
}

fn traversal(obstacle: &Obstacle, closed: bool) -> Traversal {
    match obstacle.motion.kind() {
        _ if closed => Traversal::Loop,
        MotionKind::KeyFrames | MotionKind::Pedestrian => Traversal::OneWay,
        _ => Traversal::BackAndForth,
    }
}

/// Draws a dashed line through the corners. Each long leg has an arrow for each direction of travel.
fn legs(canvas: &Canvas, corners: Vec<math::Vec2>, traversal: Traversal, stroke: Stroke) {
    let mut points: Vec<Pos2> = corners.into_iter().map(|corner| canvas.to_screen(corner.into())).collect();
    if traversal == Traversal::Loop {
        points.extend(points.first().copied());
    }
    if points.len() > MAX_MARKED_CORNERS {
        canvas.dashed_line(&points, stroke, DASH);
        return;
    }
    for &corner in points.iter().skip(1) {
        canvas.painter.circle_filled(corner, 2.5, stroke.color);
    }
    for leg in points.windows(2) {
        let (from, to) = (leg[0], leg[1]);
        let along = (to - from).normalized();
        canvas.dashed_line(&[from, to], stroke, DASH);
        if from.distance(to) < 40.0 {
            continue;
        }
        // Not in the middle, where the editor has its handle for a new corner.
        let position = from.lerp(to, 0.7);
        canvas.arrow_head(position + along * 4.0, along, 8.0, stroke.color);
        if traversal == Traversal::BackAndForth {
            canvas.arrow_head(from.lerp(to, 0.3) - along * 4.0, -along, 8.0, stroke.color);
        }
    }
}

/// Draws a dashed circle.
fn ring(canvas: &Canvas, centre: Pos2, radius: f32, stroke: Stroke) {
    if !(radius > 1.0 && radius < 1e5) {
        return;
    }
    let parts = (radius * 0.7).clamp(24.0, 360.0) as usize;
    let point = |k: usize| centre + Vec2::angled(k as f32 / parts as f32 * std::f32::consts::TAU) * radius;
    let points: Vec<Pos2> = (0..=parts).map(point).collect();
    canvas.dashed_line(&points, stroke, DASH);
}
