//! Four shapes at once: the distance along a LIDAR beam to each of four circles or rectangles.
//!
//! In: a beam, and up to four shapes in the lanes of SIMD vectors. Out: four distances in m, bit-identical to those of
//! `ray_cast::cast_ray`. There are no branches, which the processor would often mispredict in a field of small shapes.

use bevy::math::Vec4;
use bevy::prelude::*;
use bevy_rapier2d::rapier::math::Pose as BodyPose;

/// A LIDAR beam. Heading and directions have length 1.
pub(super) struct Beam {
    pub(super) origin: Vec2,
    /// The robot's heading.
    pub(super) heading: Vec2,
    /// The beam's direction in the robot's frame.
    pub(super) in_robot: Vec2,
    /// The beam's direction in the scenario's frame.
    pub(super) direction: Vec2,
}

/// Up to four circles whose bodies are not rotated. (A cast to a rotated one is rounded differently.)
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FourCircles {
    centre: FourVectors,
    radius_squared: Vec4,
}

/// Up to four rectangles.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct FourRectangles {
    centre: FourVectors,
    /// Cosine and sine of the rotation.
    rotation: FourVectors,
    half_extents: FourVectors,
}

/// Four vectors, one in each lane.
#[derive(Clone, Copy, Debug, Default)]
struct FourVectors {
    x: Vec4,
    y: Vec4,
}

impl FourCircles {
    /// The circles (position, radius in m) of one to four shapes. Lanes without a shape repeat the first one.
    pub(super) fn new(circles: &[(&BodyPose, f32)]) -> Self {
        let mut four = Self::default();
        for lane in 0..4 {
            let (position, radius_m) = circles.get(lane).unwrap_or(&circles[0]);
            four.centre.set(lane, position.translation);
            four.radius_squared[lane] = radius_m * radius_m;
        }
        four
    }

    /// The distance along `beam` to each circle: 0 inside it, infinity without a hit.
    #[inline(always)]
    pub(super) fn cast(&self, beam: &Beam) -> Vec4 {
        let origin = FourVectors::splat(beam.origin).minus(self.centre);
        let direction = FourVectors::splat(beam.direction);
        let a = Vec4::splat(beam.direction.length_squared());
        let b = origin.dot(direction);
        let c = origin.dot(origin) - self.radius_squared;
        let discriminant = b * b - a * c;
        let root = Vec4::from_array(discriminant.to_array().map(f32::sqrt));
        let distance = (-b - root) / a;
        let misses = (c.cmpgt(Vec4::ZERO) & b.cmpgt(Vec4::ZERO)) | discriminant.cmplt(Vec4::ZERO);
        let is_inside = distance.cmple(Vec4::ZERO);
        Vec4::select(misses, Vec4::INFINITY, Vec4::select(is_inside, Vec4::ZERO, distance))
    }
}

impl FourRectangles {
    /// The rectangles (position, half extents in m) of one to four shapes. Lanes without a shape repeat the first one.
    pub(super) fn new(rectangles: &[(&BodyPose, Vec2)]) -> Self {
        let mut four = Self::default();
        for lane in 0..4 {
            let (position, half_extents) = rectangles.get(lane).unwrap_or(&rectangles[0]);
            four.centre.set(lane, position.translation);
            four.rotation.set(lane, Vec2::new(position.rotation.re, position.rotation.im));
            four.half_extents.set(lane, *half_extents);
        }
        four
    }

    /// The distance along `beam` to each rectangle: 0 inside it, infinity without a hit.
    #[inline(always)]
    pub(super) fn cast(&self, beam: &Beam) -> Vec4 {
        // In each rectangle's own frame. The direction is rounded as in casts against one shape.
        let origin = FourVectors::splat(beam.origin).minus(self.centre).rotated_back(self.rotation);
        let heading = FourVectors::splat(beam.heading).rotated_back(self.rotation);
        let direction = heading.rotated(FourVectors::splat(beam.in_robot));
        let (enter_x, exit_x) = between_sides(self.half_extents.x, origin.x, direction.x);
        let (enter_y, exit_y) = between_sides(self.half_extents.y, origin.y, direction.y);
        let enter = enter_x.max(enter_y).max(Vec4::ZERO);
        Vec4::select(enter.cmple(exit_x.min(exit_y)), enter, Vec4::INFINITY)
    }
}

/// Along one axis: the distances at which a beam enters and leaves the space between two opposite sides of a rectangle.
#[inline(always)]
fn between_sides(half_extent: Vec4, origin: Vec4, direction: Vec4) -> (Vec4, Vec4) {
    let per_direction = Vec4::ONE / direction;
    let a = (-half_extent - origin) * per_direction;
    let b = (half_extent - origin) * per_direction;
    // A beam parallel to the sides is between them (or along one of them) over its whole length, or nowhere.
    let is_parallel = direction.cmpeq(Vec4::ZERO);
    let is_between = origin.abs().cmple(half_extent);
    let enter_parallel = Vec4::select(is_between, Vec4::NEG_INFINITY, Vec4::INFINITY);
    (Vec4::select(is_parallel, enter_parallel, a.min(b)), Vec4::select(is_parallel, Vec4::INFINITY, a.max(b)))
}

impl FourVectors {
    #[inline(always)]
    fn splat(vector: Vec2) -> Self {
        Self { x: Vec4::splat(vector.x), y: Vec4::splat(vector.y) }
    }

    fn set(&mut self, lane: usize, vector: Vec2) {
        (self.x[lane], self.y[lane]) = vector.into();
    }

    #[inline(always)]
    fn minus(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y }
    }

    #[inline(always)]
    fn dot(self, other: Self) -> Vec4 {
        self.x * other.x + self.y * other.y
    }

    /// Rotated by the angle of `other`, a vector of length 1.
    #[inline(always)]
    fn rotated(self, other: Self) -> Self {
        Self { x: self.x * other.x - self.y * other.y, y: self.y * other.x + self.x * other.y }
    }

    /// Rotated by the angle of `other`, a vector of length 1, in the opposite direction.
    #[inline(always)]
    fn rotated_back(self, other: Self) -> Self {
        Self { x: self.x * other.x + self.y * other.y, y: self.y * other.x - self.x * other.y }
    }
}
