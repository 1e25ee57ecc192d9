//! The LIDAR: a fan of beams from the robot's centre, cast against the very colliders that collisions use.
//!
//! In: rapier's colliders and the robot's pose. Out: [`Scan`], in m. Beams are cast arena by arena against the few
//! shapes there, each through parry's own ray cast, in the shape's own frame. A scan is taken after every physics
//! step and after every reset, from where the robot is then, so it is never stale.

use bevy::prelude::*;
use bevy_rapier2d::prelude::*;
use bevy_rapier2d::rapier::geometry::{
    Ball, ColliderHandle, ColliderSet, ConvexPolygon, Cuboid, Ray, Shape, TypedShape,
};
use bevy_rapier2d::rapier::parry::query::RayCast;

use super::physics::Bodies;
use crate::random::{self, Stream};
use crate::scenario::Lidar;
use crate::scenario::polygon::sides;
use crate::task::{CurrentScenario, Episode, Pose, Scan, Streams};

/// The beams' directions in the robot's own frame: unit vectors, in the sensor's order.
#[derive(Resource, Clone, Debug, Default)]
pub struct BeamDirections(pub Vec<Vec2>);

impl BeamDirections {
    /// The beams of `lidar`.
    #[must_use]
    pub fn from_lidar(lidar: &Lidar) -> Self {
        let way = |beam| {
            let (sin, cos) = libm::sincos(lidar.beam_angle_rad(beam));
            Vec2::new(cos as f32, sin as f32)
        };
        Self((0..lidar.beams).map(way).collect())
    }
}

/// Casts `beams` from `pose` against `solids`; `ranges_m` receives one distance a beam, `max_range_m` where nothing
/// is met, 0 where the beam starts inside a shape.
///
/// Which beams are worth a cast is settled by `BeamRange`, which changes no bit of the result.
pub fn cast(
    colliders: &ColliderSet,
    solids: &[ColliderHandle],
    pose: &Pose,
    beams: &[Vec2],
    max_range_m: f32,
    ranges_m: &mut Vec<f32>,
) {
    ranges_m.clear();
    ranges_m.resize(beams.len(), max_range_m);
    let origin = Vec2::new(pose.x_m, pose.y_m);
    let (sin, cos) = libm::sincosf(pose.heading_rad);
    let heading = Vec2::new(cos, sin);
    for collider in solids.iter().filter_map(|&handle| colliders.get(handle)) {
        let shape = collider.shape();
        let placed = collider.position();
        let local_origin = placed.inverse_transform_point(origin);
        let local_heading = placed.inverse_transform_vector(heading);
        let window = BeamRange::onto(shape, local_origin, local_heading);
        let shape = shape.as_typed_shape();
        for (beam, range) in beams.iter().zip(ranges_m.iter_mut()) {
            if window.may_show(*beam, *range) {
                let ray = Ray::new(local_origin, local_heading.rotate(*beam));
                if let Some(distance) = meets(&shape, &ray, *range) {
                    *range = distance;
                }
            }
        }
    }
}

/// How far `ray` goes to `shape`, if it meets it within `most_m`. To a rod and to a polygon parry comes nearer step by
/// step, to a tenth of a millimetre or so; by their parts it is as exact as to a circle.
fn meets(shape: &TypedShape, ray: &Ray, most_m: f32) -> Option<f32> {
    let nearest = |a: Option<f32>, b: Option<f32>| a.into_iter().chain(b).reduce(f32::min);
    match *shape {
        TypedShape::Ball(ball) => ball.cast_local_ray(ray, most_m, true),
        TypedShape::Cuboid(cuboid) => cuboid.cast_local_ray(ray, most_m, true),
        TypedShape::Segment(side) => to_side(side.a, side.b, ray, most_m),
        TypedShape::ConvexPolygon(polygon) => {
            if polygon_contains(polygon, ray.origin) {
                return Some(0.0);
            }
            sides(polygon.points())
                .fold(None, |found, (from, to)| nearest(found, to_side(from, to, ray, most_m)))
        }
        TypedShape::Capsule(rod) => {
            // It lies along its own x axis, its middle at 0 (`physics.rs`).
            let middle = Cuboid::new(Vec2::new(rod.segment.b.x.abs(), rod.radius));
            let ends = [rod.segment.a, rod.segment.b].map(|end| {
                Ball::new(rod.radius).cast_local_ray(&Ray::new(ray.origin - end, ray.dir), most_m, true)
            });
            nearest(middle.cast_local_ray(ray, most_m, true), nearest(ends[0], ends[1]))
        }
        // No other kind is made (`physics.rs`).
        _ => None,
    }
}

/// Whether a point lies in a polygon, in its own frame.
pub(super) fn polygon_contains(polygon: &ConvexPolygon, point: Vec2) -> bool {
    let inside = |(corner, normal): (&Vec2, &Vec2)| normal.dot(point - *corner) <= 0.0;
    polygon.points().iter().zip(polygon.normals()).all(inside)
}

/// How far `ray` goes to the side between two corners, if it meets it within `most_m`. By cross products: parry's own cast
/// squares the lengths, and where a beam grazes, or a polygon is small, that is millimetres off. Sides reach a hair past
/// their corners, so that no beam slips through one.
fn to_side(from: Vec2, to: Vec2, ray: &Ray, most_m: f32) -> Option<f32> {
    const HAIR: f32 = 1e-5;
    let (side, gap) = (to - from, from - ray.origin);
    let across = ray.dir.perp_dot(side);
    let (distance, part) = (gap.perp_dot(side) / across, gap.perp_dot(ray.dir) / across);
    // (Along the side nothing is met but its neighbours: 1 / 0 and 0 / 0 are in no range.)
    let met = (0.0..=most_m).contains(&distance) && (-HAIR..=1.0 + HAIR).contains(&part);
    met.then_some(distance)
}

/// Through which beams a convex shape can be seen, in the robot's own frame: a cheap question that spares most casts.
///
/// A beam that meets the shape passes through its bounding circle, and gets across the line that stands square on the
/// shortest way to the shape at its end (all of the shape lies beyond it). Both are asked with a margin far above
/// the rounding errors of parry's cast, so a beam that is turned away would have met nothing.
struct BeamRange {
    /// From the robot to the bounding circle's centre, in m.
    centre: Vec2,
    /// The circle's radius, with the margin, in m, squared.
    radius_squared: f32,
    /// From the robot to the shape's nearest point, in m; zero from within.
    gap: Vec2,
    gap_squared: f32,
    margin_m: f32,
}

impl BeamRange {
    /// A grazing cast may be off by the root of f32's rounding error, 0.0003 of the lengths in it.
    const MARGIN: f32 = 0.003;

    fn onto(shape: &dyn Shape, local_origin: Vec2, local_heading: Vec2) -> Self {
        let to_robot = Vec2::new(local_heading.x, -local_heading.y);
        let circle = shape.compute_local_bounding_sphere();
        let gap = shape.project_local_point(local_origin, true).point - local_origin;
        let centre = circle.center - local_origin;
        let margin_m = Self::MARGIN * (centre.length() + circle.radius);
        Self {
            centre: to_robot.rotate(centre),
            radius_squared: circle.radius * circle.radius + margin_m * margin_m,
            gap: to_robot.rotate(gap),
            gap_squared: gap.length_squared(),
            margin_m,
        }
    }

    /// Whether `beam`, a unit vector, may meet the shape within `range_m`.
    fn may_show(&self, beam: Vec2, range_m: f32) -> bool {
        let aside = beam.perp_dot(self.centre);
        aside * aside <= self.radius_squared
            && range_m * (beam.dot(self.gap) + self.margin_m) >= self.gap_squared
    }
}

/// Makes a clean scan what the sensor reports: each beam is lost with the probability `dropout` (it then reads the
/// maximum range), else off by a normal error with the standard deviation `noise_std_m`, within [0, maximum].
pub fn add_noise(lidar: &Lidar, stream: &mut Stream, ranges_m: &mut [f32]) {
    if lidar.is_exact() {
        return;
    }
    for range in ranges_m {
        let lost = random::uniform_01(stream) < lidar.dropout;
        let error = lidar.noise_std_m * random::normal(stream);
        *range = if lost { lidar.max_range_m } else { (*range + error).clamp(0.0, lidar.max_range_m) };
    }
}

/// `Sense`: every arena's scan after the physics step.
pub(super) fn scan(
    scenario: Res<CurrentScenario>,
    beams: Res<BeamDirections>,
    mut arenas: Query<(&Bodies, &RapierContextColliders, &Pose, &Episode, &mut Streams, &mut Scan)>,
) {
    for (bodies, colliders, pose, episode, mut streams, mut scan) in &mut arenas {
        if !episode.inactive {
            take(&scenario.0.lidar, &beams, bodies, colliders, pose, &mut streams, &mut scan);
        }
    }
}

/// `Reset`: the scan of robots that have just been placed.
pub(super) fn scan_after_reset(
    scenario: Res<CurrentScenario>,
    beams: Res<BeamDirections>,
    mut arenas: Query<(&Bodies, &RapierContextColliders, &Pose, &Episode, &mut Streams, &mut Scan)>,
) {
    for (bodies, colliders, pose, episode, mut streams, mut scan) in &mut arenas {
        if episode.pending_reset.moves_robot() {
            scan.touching = false;
            scan.delayed.clear();
            take(&scenario.0.lidar, &beams, bodies, colliders, pose, &mut streams, &mut scan);
        }
    }
}

fn take(
    lidar: &Lidar,
    beams: &BeamDirections,
    bodies: &Bodies,
    colliders: &RapierContextColliders,
    pose: &Pose,
    streams: &mut Streams,
    scan: &mut Scan,
) {
    cast(&colliders.colliders, &bodies.solids, pose, &beams.0, lidar.max_range_m, &mut scan.ranges_m);
    scan.nearest_m = scan.ranges_m.iter().copied().fold(lidar.max_range_m, f32::min);
    add_noise(lidar, &mut streams.sensor, &mut scan.ranges_m);
    scan.sensor_pose = *pose;
    if lidar.latency_steps > 0 {
        delay(lidar.latency_steps as usize, scan);
    }
}

/// Keeps the fresh scan back, and reports the one of `steps` steps ago, or the first of the episode until there is one.
fn delay(steps: usize, scan: &mut Scan) {
    let fresh = (scan.sensor_pose, scan.ranges_m.clone());
    scan.delayed.push_back(fresh);
    while scan.delayed.len() > steps + 1 {
        scan.delayed.pop_front();
    }
    if let Some((from, ranges_m)) = scan.delayed.front() {
        scan.sensor_pose = *from;
        scan.ranges_m.clone_from(ranges_m);
    }
}
