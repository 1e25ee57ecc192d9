//! Ray casts: the distance along each LIDAR beam to the nearest collider.
//!
//! In: rapier's colliders, the robot's pose and the beam directions. Out: one range per beam, in m. Beams are cast against
//! the colliders of one arena, in each shape's own frame. Most casts are skipped, because the beam cannot hit the shape
//! ([`BeamFilter`]), or because the shape is in none of the cells that the beam crosses (`static_shapes.rs`).

use bevy::prelude::*;
use bevy_rapier2d::rapier::geometry::{
    Ball, Collider, ColliderHandle, ColliderSet, ConvexPolygon, Cuboid, Ray, Shape, TypedShape,
};
use bevy_rapier2d::rapier::parry::query::RayCast;

use super::physics::Bodies;
use crate::scenario::polygon::sides;
use crate::task::Pose;

/// Casts `beams` from `pose` against `solids`.
///
/// `beams` are unit vectors in the robot's frame. `ranges_m` receives one distance per beam, in m: `max_range_m` if the
/// beam hits nothing, 0 if it starts inside a shape. Skipping casts changes no bit of the result.
pub fn cast(
    colliders: &ColliderSet,
    solids: &[ColliderHandle],
    pose: &Pose,
    beams: &[Vec2],
    max_range_m: f32,
    ranges_m: &mut Vec<f32>,
) {
    let (origin, heading) = start(pose, beams, max_range_m, ranges_m);
    let solids = solids.iter().filter_map(|&handle| colliders.get(handle));
    shorten(solids, origin, heading, beams, ranges_m);
}

/// Like [`cast`], against everything in an arena.
pub fn cast_in_arena(
    colliders: &ColliderSet,
    bodies: &Bodies,
    pose: &Pose,
    beams: &[Vec2],
    max_range_m: f32,
    ranges_m: &mut Vec<f32>,
) {
    let (origin, heading) = start(pose, beams, max_range_m, ranges_m);
    if let Some(shapes) = &bodies.static_shapes {
        shapes.cast(origin, heading, beams, ranges_m);
    }
    let solids = bodies.not_in_grid().filter_map(|(_, handle)| colliders.get(handle));
    shorten(solids, origin, heading, beams, ranges_m);
}

/// Fills `ranges_m` with the range of a beam that hits nothing. Returns the position of `pose`, and its heading as a unit vector.
fn start(pose: &Pose, beams: &[Vec2], max_range_m: f32, ranges_m: &mut Vec<f32>) -> (Vec2, Vec2) {
    ranges_m.clear();
    ranges_m.resize(beams.len(), max_range_m);
    let (sin, cos) = libm::sincosf(pose.heading_rad);
    (Vec2::new(pose.x_m, pose.y_m), Vec2::new(cos, sin))
}

/// Shortens `ranges_m`, one per beam, to the nearest of `solids`.
fn shorten<'a>(
    solids: impl Iterator<Item = &'a Collider>,
    origin: Vec2,
    heading: Vec2,
    beams: &[Vec2],
    ranges_m: &mut [f32],
) {
    for collider in solids {
        let shape = collider.shape();
        let position = collider.position();
        let local_origin = position.inverse_transform_point(origin);
        let local_heading = position.inverse_transform_vector(heading);
        let filter = BeamFilter::new(shape, local_origin, local_heading);
        let shape = shape.as_typed_shape();
        for (beam, range) in beams.iter().zip(ranges_m.iter_mut()) {
            if filter.may_hit(*beam, *range) {
                let ray = Ray::new(local_origin, local_heading.rotate(*beam));
                if let Some(distance) = cast_ray(&shape, &ray, *range) {
                    *range = distance;
                }
            }
        }
    }
}

/// The distance along `ray` to `shape`, if it is at most `max_m`.
///
/// Parry approximates casts to capsules and polygons iteratively, to about 0.1 mm. Casts to their parts, as here, are as
/// exact as casts to circles.
#[inline(always)]
pub(super) fn cast_ray(shape: &TypedShape, ray: &Ray, max_m: f32) -> Option<f32> {
    let nearest = |a: Option<f32>, b: Option<f32>| a.into_iter().chain(b).reduce(f32::min);
    match *shape {
        TypedShape::Ball(ball) => ball.cast_local_ray(ray, max_m, true),
        TypedShape::Cuboid(cuboid) => cast_to_cuboid(cuboid, ray, max_m),
        TypedShape::Segment(segment) => cast_to_segment(segment.a, segment.b, ray, max_m),
        TypedShape::ConvexPolygon(polygon) => {
            if polygon_contains(polygon, ray.origin) {
                return Some(0.0);
            }
            sides(polygon.points())
                .fold(None, |found, (from, to)| nearest(found, cast_to_segment(from, to, ray, max_m)))
        }
        TypedShape::Capsule(capsule) => {
            // A capsule lies along its own x axis, centred at 0 (`colliders.rs`).
            let middle = Cuboid::new(Vec2::new(capsule.segment.b.x.abs(), capsule.radius));
            let ends = [capsule.segment.a, capsule.segment.b].map(|end| {
                let end_ray = Ray::new(ray.origin - end, ray.dir);
                Ball::new(capsule.radius).cast_local_ray(&end_ray, max_m, true)
            });
            nearest(cast_to_cuboid(&middle, ray, max_m), nearest(ends[0], ends[1]))
        }
        // `colliders.rs` makes no other shapes.
        _ => None,
    }
}

/// The distance along `ray` to `cuboid`, if it is at most `max_m`: the same result as parry's cast, without its branches,
/// which are often mispredicted.
#[inline(always)]
fn cast_to_cuboid(cuboid: &Cuboid, ray: &Ray, max_m: f32) -> Option<f32> {
    if ray.dir.x == 0.0 || ray.dir.y == 0.0 {
        return cuboid.cast_local_ray(ray, max_m, true);
    }
    // Unlike `f32::min` and `f32::max`, without regard to NaN.
    let lesser = |a: f32, b: f32| if a < b { a } else { b };
    let greater = |a: f32, b: f32| if a > b { a } else { b };
    let per_direction = ray.dir.recip();
    let a = (-cuboid.half_extents - ray.origin) * per_direction;
    let b = (cuboid.half_extents - ray.origin) * per_direction;
    let enter_m = greater(greater(lesser(a.x, b.x), lesser(a.y, b.y)), 0.0);
    let exit_m = lesser(lesser(greater(a.x, b.x), greater(a.y, b.y)), max_m);
    (enter_m <= exit_m).then_some(enter_m)
}

/// Whether `point` lies inside `polygon`, in the polygon's frame.
pub(super) fn polygon_contains(polygon: &ConvexPolygon, point: Vec2) -> bool {
    let inside = |(corner, normal): (&Vec2, &Vec2)| normal.dot(point - *corner) <= 0.0;
    polygon.points().iter().zip(polygon.normals()).all(inside)
}

/// The distance along `ray` to the segment between two corners, if it is at most `max_m`.
///
/// Computed from cross products. Parry's own cast squares lengths, which costs millimetres for grazing beams and small
/// polygons. Segments extend slightly past their corners, so that no beam slips through a corner.
fn cast_to_segment(from: Vec2, to: Vec2, ray: &Ray, max_m: f32) -> Option<f32> {
    /// The extension at each end, as a fraction of the segment.
    const EXTENSION: f32 = 1e-5;
    let (side, gap) = (to - from, from - ray.origin);
    let cross = ray.dir.perp_dot(side);
    let (distance, fraction) = (gap.perp_dot(side) / cross, gap.perp_dot(ray.dir) / cross);
    // A ray parallel to the segment hits only the neighbouring segments: 1 / 0 and 0 / 0 are in no range.
    let hit = (0.0..=max_m).contains(&distance) && (-EXTENSION..=1.0 + EXTENSION).contains(&fraction);
    // Adding 0 removes the sign of a zero, which would depend on the order of the casts.
    hit.then_some(distance + 0.0)
}

/// The margin of the tests that skip casts, relative to the sum of the shape's distance and size. A grazing cast may be off by
/// the square root of f32's rounding error, 0.0003 of these lengths.
pub(super) const MARGIN: f32 = 0.003;

/// The beams that may hit a convex shape, in the robot's frame: a cheap test that makes most casts unnecessary.
///
/// A beam that hits the shape passes through the shape's bounding circle. It also crosses the line through the shape's
/// nearest point, perpendicular to the direction towards that point, since the whole shape lies beyond this line. Both
/// tests have a margin far above the rounding errors of the cast, so a rejected beam would have hit nothing.
struct BeamFilter {
    /// The vector from the robot to the centre of the bounding circle, in m.
    centre: Vec2,
    /// The square of the circle's radius plus the square of the margin, in m^2.
    radius_squared: f32,
    /// The vector from the robot to the shape's nearest point, in m; zero inside the shape.
    gap: Vec2,
    gap_squared: f32,
    margin_m: f32,
}

impl BeamFilter {
    fn new(shape: &dyn Shape, local_origin: Vec2, local_heading: Vec2) -> Self {
        let to_robot_frame = Vec2::new(local_heading.x, -local_heading.y);
        let circle = shape.compute_local_bounding_sphere();
        let gap = shape.project_local_point(local_origin, true).point - local_origin;
        let centre = circle.center - local_origin;
        let margin_m = MARGIN * (centre.length() + circle.radius);
        Self {
            centre: to_robot_frame.rotate(centre),
            radius_squared: circle.radius * circle.radius + margin_m * margin_m,
            gap: to_robot_frame.rotate(gap),
            gap_squared: gap.length_squared(),
            margin_m,
        }
    }

    /// Whether `beam`, a unit vector, may hit the shape within `range_m`.
    fn may_hit(&self, beam: Vec2, range_m: f32) -> bool {
        let lateral = beam.perp_dot(self.centre);
        lateral * lateral <= self.radius_squared
            && range_m * (beam.dot(self.gap) + self.margin_m) >= self.gap_squared
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Any number, or one on a lattice of 0.25, so that some rays start on sides or run along them.
    fn number() -> impl Strategy<Value = f32> {
        prop_oneof![-3.0_f32..3.0, (-12_i8..=12).prop_map(|k| 0.25 * f32::from(k))]
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(10_000))]

        #[test]
        fn a_cast_to_a_cuboid_equals_that_of_parry(
            half in (0.001_f32..2.0, prop_oneof![Just(0.5_f32), 0.001_f32..2.0]),
            origin in (number(), number()),
            direction in (number(), number()),
            max_m in prop_oneof![Just(3.5_f32), 0.0_f32..4.0],
        ) {
            let (cuboid, ray) = (Cuboid::new(half.into()), Ray::new(origin.into(), direction.into()));
            prop_assert_eq!(cast_to_cuboid(&cuboid, &ray, max_m), cuboid.cast_local_ray(&ray, max_m, true));
        }
    }
}
