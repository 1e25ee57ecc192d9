//! The rapier shapes of obstacles and of the enclosure.
//!
//! In: shapes of the scenario. Out: rapier's shapes; for the enclosure also their poses.

use bevy::prelude::*;
use bevy_rapier2d::rapier::geometry::ConvexPolygon;
use bevy_rapier2d::rapier::prelude::SharedShape;

use crate::scenario::{Enclosure, Shape, polygon};

/// The thickness of the enclosure's walls, in m. Rapier rarely lets a robot through a wall this thick; if it does, `contact.rs`
/// stops the robot.
const WALL_M: f32 = 0.5;

/// The shapes of the enclosure's walls and their poses, in m and rad.
///
/// A rectangle has thick walls. A polygon has segments, because thick walls would reach inside at a concave corner.
pub(super) fn enclosure_colliders(enclosure: &Enclosure) -> Vec<(SharedShape, (f32, f32, f32))> {
    match *enclosure {
        Enclosure::Rectangle { width_m, height_m } => {
            let (w, h, t) = (width_m / 2.0, height_m / 2.0, WALL_M / 2.0);
            let long = w + WALL_M;
            [(w + t, 0.0, t, h), (-w - t, 0.0, t, h), (0.0, h + t, long, t), (0.0, -h - t, long, t)]
                .map(|(x, y, half_width, half_height)| {
                    (SharedShape::cuboid(half_width, half_height), (x, y, 0.0))
                })
                .into()
        }
        Enclosure::Polygon { .. } => {
            let side = |(from, to): (Vec2, Vec2)| (SharedShape::segment(from, to), (0.0, 0.0, 0.0));
            polygon::sides(&enclosure.corners_m()).map(side).collect()
        }
    }
}

/// The rapier shape of a scenario's shape, centred at the shape's origin.
pub(super) fn shared_shape(shape: &Shape) -> SharedShape {
    match shape {
        Shape::Circle { radius_m } => SharedShape::ball(*radius_m),
        Shape::Rectangle { width_m, height_m } => SharedShape::cuboid(width_m / 2.0, height_m / 2.0),
        Shape::Capsule { length_m, radius_m } => SharedShape::capsule_x(length_m / 2.0, *radius_m),
        Shape::Polygon { corners_m } => {
            // Keeps every corner; parry's default would drop nearly collinear ones. This fails only with fewer than three
            // corners or a side of length 0, which the scenario's checks reject.
            let corners = polygon::counterclockwise(corners_m).into_iter().collect();
            ConvexPolygon::from_convex_polyline_unmodified(corners)
                .map_or_else(|| SharedShape::ball(0.001), SharedShape::new)
        }
    }
}
