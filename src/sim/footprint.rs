//! The footprint of a robot that is not a disc: when it first touches something in a step.
//!
//! In: the robot's shape, and a shape next to its path. Out: the fraction of the step before the contact. The robot's origin
//! moves along the chord of its arc while its heading changes at constant speed. No point of the body moves farther than the
//! chord plus the arc of the point farthest from the origin. Conservative advancement uses this bound as in `contact.rs`.
//! Rapier moves the body but never stops it, because its collider is a sensor.

use bevy::prelude::*;
use bevy_rapier2d::rapier::prelude::{Shape, TypedShape};

use super::contact::{MIN_ADVANCE_M, ObstacleTrajectory, PlacedShape};
use crate::scenario::{Robot, convex_distance};

/// The body of a robot in its own frame: all points within a radius of a convex polygon or a segment.
#[derive(Clone, Debug)]
pub(super) struct Footprint {
    points_m: Vec<Vec2>,
    radius_m: f32,
    /// Distance from the origin to the farthest point, in m.
    pub(super) reach_m: f32,
}

/// The motion of a robot in a step: its origin from `from` to `to`, in m, and its heading from `heading_rad` by `turn_rad`.
#[derive(Clone, Copy)]
pub(super) struct Sweep {
    pub(super) from: Vec2,
    pub(super) to: Vec2,
    pub(super) heading_rad: f32,
    pub(super) turn_rad: f32,
}

impl Footprint {
    /// The footprint of `robot`; `None` for a disc.
    pub(super) fn of(robot: &Robot) -> Option<Self> {
        let shape = robot.shape.as_ref()?;
        let (points_m, radius_m) = shape.support_points(0.0);
        Some(Self { points_m, radius_m, reach_m: shape.bounding_radius_m() })
    }

    /// The fraction of the step after which a shape first comes within `margin_m` of the robot. The robot's origin and the
    /// obstacle together cover at most `max_travel_m`.
    pub(super) fn approach(
        &self,
        sweep: Sweep,
        (position, shape): PlacedShape,
        trajectory: &ObstacleTrajectory,
        margin_m: f32,
        max_travel_m: f32,
    ) -> Option<f32> {
        let max_travel_m = max_travel_m + sweep.turn_rad.abs() * self.reach_m;
        let (points, radius_m) = support_points(shape);
        let mut fraction = 0.0;
        let mut body = Vec::with_capacity(self.points_m.len());
        loop {
            let at = sweep.from.lerp(sweep.to, fraction);
            let (sin, cos) = libm::sincosf(sweep.heading_rad + sweep.turn_rad * fraction);
            body.clear();
            body.extend(self.points_m.iter().map(|&point| {
                let point = at + Vec2::new(cos, sin).rotate(point);
                position.inverse_transform_point(trajectory.in_obstacle_frame(point, 1.0 - fraction))
            }));
            let gap_m = convex_distance(&body, &points) - self.radius_m - radius_m - margin_m;
            if gap_m <= 0.0 {
                return Some(fraction);
            }
            if fraction >= 1.0 {
                return None;
            }
            fraction = (fraction + (gap_m.max(MIN_ADVANCE_M) / max_travel_m).max(f32::EPSILON)).min(1.0);
        }
    }
}

/// A shape in its own frame: all points within a radius of a convex polygon, a segment or a point.
fn support_points(shape: &dyn Shape) -> (Vec<Vec2>, f32) {
    match shape.as_typed_shape() {
        TypedShape::Ball(ball) => (vec![Vec2::ZERO], ball.radius),
        TypedShape::Cuboid(cuboid) => {
            let Vec2 { x, y } = cuboid.half_extents;
            (vec![Vec2::new(x, y), Vec2::new(-x, y), Vec2::new(-x, -y), Vec2::new(x, -y)], 0.0)
        }
        TypedShape::Capsule(capsule) => (vec![capsule.segment.a, capsule.segment.b], capsule.radius),
        TypedShape::Segment(segment) => (vec![segment.a, segment.b], 0.0),
        TypedShape::ConvexPolygon(polygon) => (polygon.points().to_vec(), 0.0),
        // `colliders.rs` makes no other shapes.
        _ => (Vec::new(), 0.0),
    }
}
