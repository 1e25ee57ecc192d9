//! The rapier colliders of shapes and of the enclosure.
//!
//! In: shapes of the scenario. Out: colliders with their poses.

use bevy::prelude::*;
use bevy_rapier2d::prelude::*;
use bevy_rapier2d::rapier::geometry::ConvexPolygon;
use bevy_rapier2d::rapier::prelude::SharedShape;

use crate::scenario::{Enclosure, Shape, polygon};

/// The thickness of the enclosure's walls, in m. Rapier lets few bodies through it; `contact.rs` stops the others.
const WALL_M: f32 = 0.5;

/// The colliders of the enclosure's walls and their poses.
///
/// A rectangle has thick walls. A polygon has segments, because thick walls would reach inside at a concave corner.
pub(super) fn enclosure_colliders(enclosure: &Enclosure) -> Vec<(Collider, Transform)> {
    match *enclosure {
        Enclosure::Rectangle { width_m, height_m } => {
            let (w, h, t) = (width_m / 2.0, height_m / 2.0, WALL_M / 2.0);
            let long = w + WALL_M;
            [(w + t, 0.0, t, h), (-w - t, 0.0, t, h), (0.0, h + t, long, t), (0.0, -h - t, long, t)]
                .map(|(x, y, half_width, half_height)| {
                    (Collider::cuboid(half_width, half_height), Transform::from_xyz(x, y, 0.0))
                })
                .into()
        }
        Enclosure::Polygon { .. } => {
            let side = |(from, to): (Vec2, Vec2)| (Collider::segment(from, to), Transform::IDENTITY);
            polygon::sides(&enclosure.corners_m()).map(side).collect()
        }
    }
}

/// The bevy_rapier collider of a shape, centred at the shape's origin.
pub(super) fn collider(shape: &Shape) -> Collider {
    match shape {
        Shape::Circle { radius_m } => Collider::ball(*radius_m),
        Shape::Rectangle { width_m, height_m } => Collider::cuboid(width_m / 2.0, height_m / 2.0),
        Shape::Capsule { length_m, radius_m } => Collider::capsule_x(length_m / 2.0, *radius_m),
        Shape::Polygon { corners_m } => {
            // Keeps every corner; parry's default would drop nearly collinear ones. It fails only for a polygon without
            // area, which the scenario's checks reject.
            let corners = polygon::counterclockwise(corners_m).into_iter().collect();
            ConvexPolygon::from_convex_polyline_unmodified(corners)
                .map_or_else(|| Collider::ball(0.001), |outline| SharedShape::new(outline).into())
        }
    }
}

/// The rapier shape of a shape, to replace that of an existing collider.
pub(super) fn shared_shape(shape: &Shape) -> SharedShape {
    collider(shape).raw
}
