//! The geometry of obstacle shapes.
//!
//! A new shape needs: a variant of [`Shape`], the methods here and in `shape_fields.rs`, and a collider
//! (`src/sim/colliders.rs` of the crate `wayfield`).

use glam::{Vec2, vec2};

use super::geometry::{box_distance, length};
use super::polygon;
use super::schema::{Obstacle, Shape};

/// A rectangle with rounded corners; a circle and a capsule are special cases.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RoundedBox {
    /// Half the extent along the shape's own x axis without the rounding, in m.
    pub half_width_m: f32,
    /// Half the extent along the shape's own y axis without the rounding, in m.
    pub half_height_m: f32,
    /// Radius of the rounding, in m.
    pub radius_m: f32,
}

impl Shape {
    /// Signed distance, in m, from a point in the shape's own frame to its surface; negative inside.
    #[must_use]
    pub fn distance(&self, point: Vec2) -> f32 {
        match self {
            Self::Circle { radius_m } => length(point.x, point.y) - radius_m,
            Self::Rectangle { width_m, height_m } => {
                // Folded into the first quadrant, measured from the corner.
                box_distance(vec2(point.x.abs() - width_m / 2.0, point.y.abs() - height_m / 2.0))
            }
            Self::Polygon { corners_m } => -polygon::signed_distance(corners_m, point),
            Self::Capsule { length_m, radius_m } => {
                length((point.x.abs() - length_m / 2.0).max(0.0), point.y) - radius_m
            }
        }
    }

    /// Distance from the shape's origin to its farthest point, in m.
    #[must_use]
    pub fn bounding_radius_m(&self) -> f32 {
        match self {
            Self::Circle { radius_m } => *radius_m,
            Self::Rectangle { width_m, height_m } => length(width_m / 2.0, height_m / 2.0),
            Self::Polygon { corners_m } => corners_m.iter().map(|c| length(c.x, c.y)).fold(0.0, f32::max),
            Self::Capsule { length_m, radius_m } => length_m / 2.0 + radius_m,
        }
    }

    /// Distance from a reference point to the farthest point of the shape, in m. `origin` is the shape's origin relative to
    /// that reference point, along the shape's own axes.
    #[must_use]
    pub fn max_distance(&self, origin: Vec2) -> f32 {
        match self {
            Self::Circle { radius_m } => length(origin.x, origin.y) + radius_m,
            Self::Rectangle { width_m, height_m } => {
                length(origin.x.abs() + width_m / 2.0, origin.y.abs() + height_m / 2.0)
            }
            Self::Polygon { corners_m } => {
                corners_m.iter().map(|c| length(origin.x + c.x, origin.y + c.y)).fold(0.0, f32::max)
            }
            Self::Capsule { length_m, radius_m } => {
                length(origin.x.abs() + length_m / 2.0, origin.y) + radius_m
            }
        }
    }

    /// The shape as points and a radius: it covers everything within the radius of the convex hull of the points. The points
    /// are rotated by `rotation_rad`, and in counterclockwise order unless a polygon's corners are not.
    #[must_use]
    pub fn support_points(&self, rotation_rad: f32) -> (Vec<Vec2>, f32) {
        let (points, radius) = match self {
            Self::Circle { radius_m } => (vec![Vec2::ZERO], *radius_m),
            Self::Rectangle { width_m, height_m } => {
                let (w, h) = (width_m / 2.0, height_m / 2.0);
                (vec![vec2(w, h), vec2(-w, h), vec2(-w, -h), vec2(w, -h)], 0.0)
            }
            Self::Polygon { corners_m } => (corners_m.clone(), 0.0),
            Self::Capsule { length_m, radius_m } => {
                (vec![vec2(length_m / 2.0, 0.0), vec2(-length_m / 2.0, 0.0)], *radius_m)
            }
        };
        let (sin, cos) = libm::sincosf(rotation_rad);
        let rotated = |p: Vec2| vec2(p.x * cos - p.y * sin, p.x * sin + p.y * cos);
        (points.into_iter().map(rotated).collect(), radius)
    }

    /// The shape as a rounded box, or `None` for a polygon.
    #[must_use]
    pub fn rounded_box(&self) -> Option<RoundedBox> {
        let (half_width_m, half_height_m, radius_m) = match *self {
            Self::Circle { radius_m } => (0.0, 0.0, radius_m),
            Self::Rectangle { width_m, height_m } => (width_m / 2.0, height_m / 2.0, 0.0),
            Self::Capsule { length_m, radius_m } => (length_m / 2.0, 0.0, radius_m),
            Self::Polygon { .. } => return None,
        };
        Some(RoundedBox { half_width_m, half_height_m, radius_m })
    }

    /// Number of sides that a distance query tests, approximately.
    pub(super) fn side_count(&self) -> usize {
        match self {
            Self::Circle { .. } => 1,
            Self::Rectangle { .. } | Self::Capsule { .. } => 2,
            Self::Polygon { corners_m } => corners_m.len(),
        }
    }

    /// Whether rotating the shape changes it.
    #[must_use]
    pub fn has_orientation(&self) -> bool {
        !matches!(self, Self::Circle { .. })
    }
}

impl Obstacle {
    /// Distance from `centre_m` to the farthest point of the obstacle at step 0, in m.
    pub(super) fn max_distance_from(&self, centre_m: Vec2) -> f32 {
        let offset = self.position_m - centre_m;
        self.shape.max_distance(to_local(offset, self.rotation_rad))
    }
}

/// `offset` expressed in a frame rotated by `rotation_rad`.
pub(super) fn to_local(offset: Vec2, rotation_rad: f32) -> Vec2 {
    let (sin, cos) = libm::sincosf(rotation_rad);
    vec2(offset.x * cos + offset.y * sin, offset.y * cos - offset.x * sin)
}
