//! The LIDAR: a fan of beams from the robot's centre, cast against the very colliders that collisions use.
//!
//! In: rapier's colliders and the robot's pose. Out: [`Scan`], in m. Beams are cast arena by arena against the few
//! shapes there, each through parry's own ray cast, in the shape's own frame. A scan is taken after every physics
//! step and after every restart, from where the robot is then, so it is never stale.

use bevy::prelude::*;
use bevy_rapier2d::prelude::*;
use bevy_rapier2d::rapier::geometry::{ColliderHandle, ColliderSet, Ray};

use super::physics::{Bodies, robot_touches};
use crate::random::{self, Stream};
use crate::scenario::Lidar;
use crate::task::{CurrentScenario, Episode, Pose, Restart, Scan, Streams};

/// The beams' directions in the robot's own frame: unit vectors, evenly around, the first straight ahead.
#[derive(Resource, Clone, Debug, Default)]
pub struct Beams(pub Vec<Vec2>);

impl Beams {
    /// `count` beams, counterclockwise.
    #[must_use]
    pub fn around(count: usize) -> Self {
        let step = core::f64::consts::TAU / count as f64;
        Self(
            (0..count)
                .map(|i| {
                    let (sin, cos) = libm::sincos(i as f64 * step);
                    Vec2::new(cos as f32, sin as f32)
                })
                .collect(),
        )
    }
}

/// Casts `beams` from `pose` against `solids`; `ranges_m` receives one distance a beam, `max_range_m` where nothing
/// is met, 0 where the beam starts inside a shape.
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
        for (beam, range) in beams.iter().zip(ranges_m.iter_mut()) {
            let ray = Ray::new(local_origin, local_heading.rotate(*beam));
            if let Some(distance) = shape.cast_local_ray(&ray, *range, true) {
                *range = distance;
            }
        }
    }
}

/// Makes a clean scan what the sensor reports: each beam is lost with the probability `dropout` (it then reads the
/// maximum range), else off by a normal error with the standard deviation `noise_std_m`, within [0, maximum].
pub fn disturb(lidar: &Lidar, stream: &mut Stream, ranges_m: &mut [f32]) {
    if lidar.noise_std_m <= 0.0 && lidar.dropout <= 0.0 {
        return;
    }
    for range in ranges_m {
        let lost = random::unit(stream) < lidar.dropout;
        let error = lidar.noise_std_m * random::normal(stream);
        *range = if lost { lidar.max_range_m } else { (*range + error).clamp(0.0, lidar.max_range_m) };
    }
}

/// `Sense`: every arena's scan after the physics step.
pub(super) fn scan(
    scenario: Res<CurrentScenario>,
    beams: Res<Beams>,
    mut arenas: Query<(&Bodies, &RapierContextColliders, &Pose, &Episode, &mut Streams, &mut Scan)>,
) {
    for (bodies, colliders, pose, episode, mut streams, mut scan) in &mut arenas {
        if !episode.parked {
            scan.touching = robot_touches(&colliders.colliders, bodies);
            take(&scenario.0.lidar, &beams, bodies, colliders, pose, &mut streams, &mut scan);
        }
    }
}

/// `Begin`: the scan of robots that have just been placed.
pub(super) fn scan_restarted(
    scenario: Res<CurrentScenario>,
    beams: Res<Beams>,
    mut arenas: Query<(&Bodies, &RapierContextColliders, &Pose, &Episode, &mut Streams, &mut Scan)>,
) {
    for (bodies, colliders, pose, episode, mut streams, mut scan) in &mut arenas {
        if matches!(episode.restart, Restart::Episode | Restart::Everything) {
            scan.touching = false;
            take(&scenario.0.lidar, &beams, bodies, colliders, pose, &mut streams, &mut scan);
        }
    }
}

fn take(
    lidar: &Lidar,
    beams: &Beams,
    bodies: &Bodies,
    colliders: &RapierContextColliders,
    pose: &Pose,
    streams: &mut Streams,
    scan: &mut Scan,
) {
    cast(&colliders.colliders, &bodies.solids, pose, &beams.0, lidar.max_range_m, &mut scan.ranges_m);
    scan.nearest_m = scan.ranges_m.iter().copied().fold(lidar.max_range_m, f32::min);
    disturb(lidar, &mut streams.sensor, &mut scan.ranges_m);
}
