//! The cost of a scan of one arena with 24 beams, averaged over random poses: wayfield's casts against the arena's colliders,
//! with and without the grid over static shapes, and the same beams in rapier's query pipeline.
//!
//! `cargo bench --bench lidar`; each time is for 500 scans; throughput is in beams.

#[path = "support/allocator.rs"]
mod allocator;
#[path = "../tests/common/mod.rs"]
mod common;

use bevy::math::Vec2;
use bevy_rapier2d::prelude::{RapierContextColliders, RapierContextSimulation, RapierRigidBodySet};
use bevy_rapier2d::rapier::parry::query::DefaultQueryDispatcher;
use bevy_rapier2d::rapier::prelude::{ColliderSet, QueryFilter, Ray};
use common::Lab;
use divan::counter::ItemsCount;
use divan::{Bencher, black_box};
use wayfield::scenario::{Lidar, Scenario};
use wayfield::sim::{Bodies, lidar};
use wayfield::task::Pose;

fn main() {
    divan::main();
}

const SCENARIOS: [&str; 4] = ["static", "moving", "barn", "office"];
const BEAMS: usize = 24;
const MAX_RANGE_M: f32 = 3.5;
/// The number of poses. With only a few, the branch predictor would learn every cast.
const POSES: usize = 500;

#[divan::bench(args = SCENARIOS)]
fn wayfield_scan(bencher: Bencher, name: &str) {
    scan(bencher, name, |colliders, bodies, pose, beams, ranges_m| {
        lidar::cast_in_arena(colliders, bodies, pose, beams, MAX_RANGE_M, ranges_m);
    });
}

/// The same scan without the grid over static shapes.
#[divan::bench(args = SCENARIOS)]
fn without_grid(bencher: Bencher, name: &str) {
    scan(bencher, name, |colliders, bodies, pose, beams, ranges_m| {
        lidar::cast(colliders, &bodies.solids, pose, beams, MAX_RANGE_M, ranges_m);
    });
}

/// Measures a scan by `cast` from each of the poses.
fn scan(bencher: Bencher, name: &str, cast: impl Fn(&ColliderSet, &Bodies, &Pose, &[Vec2], &mut Vec<f32>)) {
    let mut lab = lab_after_a_step(name);
    let beams = Lidar { beams: BEAMS, ..Lidar::default() }.beam_directions();
    let poses = poses(name);
    lab.with_physics(0, |bodies, _, colliders| {
        let mut ranges_m = Vec::new();
        bencher.counter(ItemsCount::new(BEAMS * POSES)).bench_local(|| {
            for pose in &poses {
                cast(&colliders.colliders, bodies, black_box(pose), &beams, &mut ranges_m);
            }
            ranges_m[0]
        });
    });
}

#[divan::bench(args = SCENARIOS)]
fn rapier_query_pipeline(bencher: Bencher, name: &str) {
    let mut lab = lab_after_a_step(name);
    let beams = Lidar { beams: BEAMS, ..Lidar::default() }.beam_directions();
    let world = lab.simulation.world_mut();
    let mut arenas =
        world.query::<(&Bodies, &RapierContextSimulation, &RapierRigidBodySet, &RapierContextColliders)>();
    let (bodies, context, set, colliders) = arenas.single(world).expect("one arena");
    let filter = QueryFilter::new().exclude_rigid_body(bodies.robot);
    let pipeline = context.broad_phase.as_query_pipeline(
        &DefaultQueryDispatcher,
        &set.bodies,
        &colliders.colliders,
        filter,
    );
    let poses = poses(name);
    let mut ranges_m = vec![0.0; BEAMS];
    bencher.counter(ItemsCount::new(BEAMS * POSES)).bench_local(|| {
        for pose in black_box(&poses) {
            let heading = Vec2::from_angle(pose.heading_rad);
            for (beam, range) in beams.iter().zip(&mut ranges_m) {
                let ray = Ray::new(Vec2::new(pose.x_m, pose.y_m), heading.rotate(*beam));
                let hit = pipeline.cast_ray(&ray, MAX_RANGE_M, true);
                *range = hit.map_or(MAX_RANGE_M, |(_, distance)| distance);
            }
        }
        ranges_m[0]
    });
}

/// Random start poses of a robot.
fn poses(name: &str) -> Vec<Pose> {
    let mut lab = Lab::new(&scenario(name), POSES, 1);
    lab.states().iter().map(|state| state.pose).collect()
}

/// One arena after a step, so that rapier's query pipeline is up to date.
fn lab_after_a_step(name: &str) -> Lab {
    let mut lab = Lab::new(&scenario(name), 1, 1);
    lab.step(&[2]);
    lab
}

fn scenario(name: &str) -> Scenario {
    match name {
        "static" => common::four_cylinders(),
        "moving" => common::moving_obstacles(),
        "barn" => common::large_worlds::barn(),
        _ => common::large_worlds::office(),
    }
}
