//! Outlines of the objects in an arena, drawn filled or as lines.
//!
//! In: a shape and its pose. Out: a drawing on a [`Canvas`].

use bevy::math;
use egui::epaint::{CircleShape, PathStroke};
use egui::{Color32, Pos2, Rect, Shape as Mark, Stroke, vec2};

use super::canvas::Canvas;
use super::polygon;
use crate::app::moves::ObstaclePose;
use crate::scenario::{Obstacle, Shape};

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
    /// An obstacle's shape at a pose.
    Obstacle {
        /// The shape.
        shape: Shape,
        /// The pose.
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
        let (shape, pose) = match self {
            Self::Disc { at_m, radius_m } => return Self::Disc { at_m, radius_m: radius_m + by_m },
            Self::Obstacle { shape, pose } => (shape, pose),
        };
        let shape = match shape {
            Shape::Circle { radius_m } => Shape::Circle { radius_m: radius_m + by_m },
            Shape::Rectangle { width_m, height_m } => {
                Shape::Rectangle { width_m: width_m + 2.0 * by_m, height_m: height_m + 2.0 * by_m }
            }
            Shape::Polygon { corners_m } => Shape::Polygon { corners_m: polygon::inflated(&corners_m, by_m) },
            Shape::Capsule { length_m, radius_m } => Shape::Capsule { length_m, radius_m: radius_m + by_m },
        };
        Self::Obstacle { shape, pose }
    }

    /// The bounding box on the screen.
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

/// Draws `outline` unless it is out of view or too small to see.
pub fn draw(canvas: &Canvas, outline: &Silhouette, fill: Color32, edge: Stroke) {
    let bounds = outline.screen_rect(canvas).expand(edge.width);
    if !(bounds.intersects(canvas.painter.clip_rect()) && bounds.size().max_elem() > 0.6) {
        return;
    }
    match outline {
        Silhouette::Disc { at_m, radius_m } => disc(canvas, *at_m, *radius_m, fill, edge),
        Silhouette::Obstacle { shape: Shape::Circle { radius_m }, pose } => {
            disc(canvas, [pose.0, pose.1], *radius_m, fill, edge);
        }
        Silhouette::Obstacle { shape: Shape::Rectangle { width_m, height_m }, pose } => {
            let (w, h) = (width_m / 2.0, height_m / 2.0);
            convex(
                canvas,
                &transformed(
                    &[math::vec2(w, h), math::vec2(-w, h), math::vec2(-w, -h), math::vec2(w, -h)],
                    *pose,
                ),
                fill,
                edge,
            );
        }
        Silhouette::Obstacle { shape: Shape::Polygon { corners_m }, pose } => {
            let corners = transformed(corners_m, *pose);
            if polygon::is_convex(&corners) {
                convex(canvas, &corners, fill, edge);
            } else {
                // Only while it is edited: a valid scenario has convex obstacles.
                polygon::fill(canvas, &corners, fill);
                canvas.painter.add(Mark::closed_line(on_screen(canvas, &corners), edge));
            }
        }
        Silhouette::Obstacle { shape: Shape::Capsule { length_m, radius_m }, pose } => {
            let parts = (canvas.transform.to_screen_length(*radius_m) / 2.0).clamp(6.0, 32.0) as usize;
            convex(canvas, &transformed(&capsule(*length_m, *radius_m, parts), *pose), fill, edge);
        }
    }
}

/// Draws a closed line `width` points wide along the outside of a polygon.
pub fn draw_closed_line(canvas: &Canvas, counterclockwise: &[math::Vec2], width: f32, color: Color32) {
    let mut points = on_screen(canvas, counterclockwise);
    points.reverse();
    canvas.painter.add(Mark::closed_line(points, PathStroke::new(width, color).outside()));
}

fn on_screen(canvas: &Canvas, corners: &[math::Vec2]) -> Vec<Pos2> {
    corners.iter().map(|&math::Vec2 { x, y }| canvas.to_screen([x, y])).collect()
}

fn convex(canvas: &Canvas, corners: &[math::Vec2], fill: Color32, edge: Stroke) {
    canvas.painter.add(Mark::convex_polygon(on_screen(canvas, corners), fill, edge));
}

fn disc(canvas: &Canvas, at_m: [f32; 2], radius_m: f32, fill: Color32, edge: Stroke) {
    let (center, radius) = (canvas.to_screen(at_m), canvas.transform.to_screen_length(radius_m));
    canvas.painter.add(Mark::Circle(CircleShape { center, radius, fill, stroke: edge }));
}

/// Transforms corners from the frame of a shape to the arena.
#[must_use]
pub fn transformed(corners: &[math::Vec2], (x, y, rotation): ObstaclePose) -> Vec<math::Vec2> {
    let (sin, cos) = rotation.sin_cos();
    corners
        .iter()
        .map(|&math::Vec2 { x: a, y: b }| math::vec2(x + a * cos - b * sin, y + a * sin + b * cos))
        .collect()
}

/// The corners of a capsule, counterclockwise, with ends of `parts` segments.
fn capsule(length_m: f32, radius_m: f32, parts: usize) -> Vec<math::Vec2> {
    use std::f32::consts::{FRAC_PI_2, PI};
    let end = |side: f32, from: f32| {
        (0..=parts).map(move |k| {
            let (sin, cos) = (from + PI * k as f32 / parts as f32).sin_cos();
            math::vec2(side * length_m / 2.0 + radius_m * cos, radius_m * sin)
        })
    };
    end(1.0, -FRAC_PI_2).chain(end(-1.0, FRAC_PI_2)).collect()
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn rotation_is_counterclockwise() {
        let corners = transformed(&[math::vec2(1.0, 0.5)], (1.0, 0.0, FRAC_PI_2));
        assert!((corners[0].x - 0.5).abs() < 1e-6 && (corners[0].y - 1.0).abs() < 1e-6, "{corners:?}");
    }

    #[test]
    fn the_outline_of_a_capsule_is_at_its_radius_from_its_axis() {
        let corners = capsule(2.0, 0.5, 4);
        assert_eq!(corners.len(), 10);
        for math::Vec2 { x, y } in corners {
            let beyond = (x.abs() - 1.0).max(0.0);
            assert!((beyond.hypot(y) - 0.5).abs() < 1e-6, "{x} {y}");
        }
    }

    #[test]
    fn every_shape_grows_by_the_same_amount() {
        let corners_m =
            vec![math::vec2(1.0, 1.0), math::vec2(-1.0, 1.0), math::vec2(-1.0, -1.0), math::vec2(1.0, -1.0)];
        for (shape, reach, inflated) in [
            (Shape::Circle { radius_m: 1.0 }, 1.0, 1.5),
            (Shape::Rectangle { width_m: 6.0, height_m: 8.0 }, 5.0, 3.5_f32.hypot(4.5)),
            (Shape::Polygon { corners_m }, 2.0_f32.sqrt(), 1.5 * 2.0_f32.sqrt()),
            (Shape::Capsule { length_m: 2.0, radius_m: 0.3 }, 1.3, 1.8),
        ] {
            let outline = Silhouette::Obstacle { shape, pose: (0.0, 0.0, 0.0) };
            assert!((outline.reach_m() - reach).abs() < 1e-6, "{outline:?}");
            assert!((outline.clone().inflated(0.5).reach_m() - inflated).abs() < 1e-5, "{outline:?}");
        }
    }
}
