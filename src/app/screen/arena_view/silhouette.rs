//! Outlines of the objects in an arena, drawn filled or as lines.
//!
//! In: a shape and its pose. Out: a drawing on a [`Canvas`].

use bevy::math;
use egui::epaint::{CircleShape, PathStroke};
use egui::{Color32, Pos2, Rect, Shape as Mark, Stroke, vec2};

use super::canvas::Canvas;
use super::polygon;
use crate::app::moves::ObstaclePose;
use crate::scenario::{Obstacle, Outline, Shape};

/// The outline of an object, in m.
#[derive(Clone, Debug, PartialEq)]
pub enum Silhouette {
    /// A disc.
    Disc {
        /// The centre, in m.
        at_m: [f32; 2],
        /// The radius, in m.
        radius_m: f32,
    },
    /// The shape of an obstacle or of the robot, at a pose.
    Obstacle {
        /// The shape.
        shape: Shape,
        /// The pose: x and y in m, rotation in rad, counterclockwise.
        pose: ObstaclePose,
    },
}

impl Silhouette {
    /// The outline of `obstacle` at step 0.
    #[must_use]
    pub fn from_obstacle(obstacle: &Obstacle) -> Self {
        let math::Vec2 { x, y } = obstacle.position_m;
        Self::Obstacle { shape: obstacle.shape.clone(), pose: (x, y, obstacle.rotation_rad) }
    }

    /// The distance from the centre to the farthest point, in m.
    #[must_use]
    pub fn reach_m(&self) -> f32 {
        match self {
            Self::Disc { radius_m, .. } => *radius_m,
            Self::Obstacle { shape, .. } => shape.bounding_radius_m(),
        }
    }

    /// The outline moved outwards by `by_m`.
    #[must_use]
    pub fn inflated(self, by_m: f32) -> Self {
        match self {
            Self::Disc { at_m, radius_m } => Self::Disc { at_m, radius_m: radius_m + by_m },
            Self::Obstacle { shape, pose } => Self::Obstacle { shape: shape.inflated(by_m), pose },
        }
    }

    /// A square on the screen that contains the object at any rotation.
    #[must_use]
    pub fn screen_rect(&self, canvas: &Canvas) -> Rect {
        let (x, y) = match self {
            Self::Disc { at_m, .. } => (at_m[0], at_m[1]),
            Self::Obstacle { pose, .. } => (pose.0, pose.1),
        };
        Rect::from_center_size(
            canvas.to_screen([x, y]),
            vec2(2.0, 2.0) * canvas.transform.to_screen_length(self.reach_m()),
        )
    }
}

/// Draws `silhouette` unless it is out of view or too small to see.
pub fn draw(canvas: &Canvas, silhouette: &Silhouette, fill: Color32, edge: Stroke) {
    let bounds = silhouette.screen_rect(canvas).expand(edge.width);
    if !(bounds.intersects(canvas.painter.clip_rect()) && bounds.size().max_elem() > 0.6) {
        return;
    }
    match silhouette {
        Silhouette::Disc { at_m, radius_m } => disc(canvas, *at_m, *radius_m, fill, edge),
        Silhouette::Obstacle { shape, pose } => draw_shape(canvas, shape, *pose, fill, edge),
    }
}

fn draw_shape(canvas: &Canvas, shape: &Shape, pose: ObstaclePose, fill: Color32, edge: Stroke) {
    let rounded_box = shape.rounded_box();
    let rounding = canvas.transform.to_screen_length(rounded_box.map_or(0.0, |rounded| rounded.radius_m));
    let corners = match shape.outline((rounding / 2.0).clamp(6.0, 32.0) as u32) {
        Outline::Circle(radius_m) => return disc(canvas, [pose.0, pose.1], radius_m as f32, fill, edge),
        Outline::Polygon(corners) => transformed(corners.iter().map(|corner| corner.as_vec2()), pose),
    };
    // A polygon may be concave while it is edited; a valid scenario has convex obstacles.
    if rounded_box.is_some() || polygon::is_convex(&corners) {
        canvas.painter.add(Mark::convex_polygon(on_screen(canvas, &corners), fill, edge));
    } else {
        polygon::fill(canvas, &corners, fill);
        canvas.painter.add(Mark::closed_line(on_screen(canvas, &corners), edge));
    }
}

/// Draws a closed line `width` points wide along the outside of a polygon with these corners, in m, counterclockwise.
pub fn draw_closed_line(canvas: &Canvas, corners_m: &[math::Vec2], width: f32, color: Color32) {
    let mut points = on_screen(canvas, corners_m);
    points.reverse();
    canvas.painter.add(Mark::closed_line(points, PathStroke::new(width, color).outside()));
}

fn on_screen(canvas: &Canvas, corners: &[math::Vec2]) -> Vec<Pos2> {
    corners.iter().map(|&math::Vec2 { x, y }| canvas.to_screen([x, y])).collect()
}

fn disc(canvas: &Canvas, at_m: [f32; 2], radius_m: f32, fill: Color32, edge: Stroke) {
    let (center, radius) = (canvas.to_screen(at_m), canvas.transform.to_screen_length(radius_m));
    canvas.painter.add(Mark::Circle(CircleShape { center, radius, fill, stroke: edge }));
}

/// Transforms corners from the frame of a shape to the arena.
fn transformed(corners: impl Iterator<Item = math::Vec2>, (x, y, rotation): ObstaclePose) -> Vec<math::Vec2> {
    let (sin, cos) = rotation.sin_cos();
    corners
        .map(|corner| math::vec2(x + corner.x * cos - corner.y * sin, y + corner.x * sin + corner.y * cos))
        .collect()
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn rotation_is_counterclockwise() {
        let corners = transformed([math::vec2(1.0, 0.5)].into_iter(), (1.0, 0.0, FRAC_PI_2));
        assert!((corners[0].x - 0.5).abs() < 1e-6 && (corners[0].y - 1.0).abs() < 1e-6, "{corners:?}");
    }
}
