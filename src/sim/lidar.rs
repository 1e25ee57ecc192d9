//! The LIDAR: scans with noise, dropout and latency.
//!
//! In: rapier's colliders and the robot's pose. Out: [`Scan`], in m. The beams start at the robot's centre and are cast
//! against the same colliders that collisions use (`ray_cast.rs`). A scan is taken after every physics step and after
//! every reset that may move the robot, from its pose at that moment. So only a latency in the scenario delays it.

use bevy::prelude::*;
use bevy_rapier2d::prelude::*;

pub use super::ray_cast::{cast, cast_in_arena};

use super::physics::Bodies;
use crate::random::{self, Stream};
use crate::scenario::Lidar;
use crate::task::{ArenaLayout, Episode, Pose, Scan, Streams};

/// The components of an arena that a scan reads and writes.
type Scanned = (
    &'static ArenaLayout,
    &'static Bodies,
    &'static RapierContextColliders,
    &'static Pose,
    &'static Episode,
    &'static mut Streams,
    &'static mut Scan,
);

/// `Sense`: takes the scan of every arena after the physics step.
pub(super) fn scan(mut arenas: Query<Scanned>) {
    for (layout, bodies, colliders, pose, episode, mut streams, mut scan) in &mut arenas {
        if !episode.inactive {
            take_scan(layout, bodies, colliders, pose, &mut streams, &mut scan);
        }
    }
}

/// `Reset`: takes the scan of every robot that may have been moved.
pub(super) fn scan_after_reset(mut arenas: Query<Scanned>) {
    for (layout, bodies, colliders, pose, episode, mut streams, mut scan) in &mut arenas {
        if episode.pending_reset.moves_robot() {
            scan.touching = false;
            scan.delayed.clear();
            take_scan(layout, bodies, colliders, pose, &mut streams, &mut scan);
        }
    }
}

fn take_scan(
    layout: &ArenaLayout,
    bodies: &Bodies,
    colliders: &RapierContextColliders,
    pose: &Pose,
    streams: &mut Streams,
    scan: &mut Scan,
) {
    let lidar = &layout.scenario.lidar;
    cast_in_arena(&colliders.colliders, bodies, pose, &layout.beams, lidar.max_range_m, &mut scan.ranges_m);
    scan.nearest_m = scan.ranges_m.iter().copied().fold(lidar.max_range_m, f32::min);
    add_noise(lidar, &mut streams.sensor, &mut scan.ranges_m);
    scan.sensor_pose = *pose;
    let latency_steps = lidar.latency_steps.value();
    if latency_steps > 0 {
        delay(latency_steps as usize, scan);
    }
}

/// Adds the sensor's noise to exact ranges, in m.
///
/// A beam is lost with probability `dropout` and then reads the maximum range. Otherwise a normally distributed error with
/// standard deviation `noise_std_m` is added, and the sum is clamped to [0, maximum range].
fn add_noise(lidar: &Lidar, stream: &mut Stream, ranges_m: &mut [f32]) {
    if lidar.is_exact() {
        return;
    }
    let (noise_std_m, dropout) = (lidar.noise_std_m.value(), lidar.dropout.value());
    for range in ranges_m {
        let lost = random::uniform_01(stream) < dropout;
        let error = noise_std_m * random::normal(stream);
        *range = if lost { lidar.max_range_m } else { (*range + error).clamp(0.0, lidar.max_range_m) };
    }
}

/// Queues the new scan and reports the one taken `steps` steps ago or, until there is one, the first scan after the reset.
fn delay(steps: usize, scan: &mut Scan) {
    let new = (scan.sensor_pose, scan.ranges_m.clone());
    scan.delayed.push_back(new);
    while scan.delayed.len() > steps + 1 {
        scan.delayed.pop_front();
    }
    if let Some((pose, ranges_m)) = scan.delayed.front() {
        scan.sensor_pose = *pose;
        scan.ranges_m.clone_from(ranges_m);
    }
}
