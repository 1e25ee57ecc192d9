//! The time that a driver takes to choose an action: policies (observation and network), with and without a map, and DWA.
//!
//! `cargo bench --bench act`; items are decisions of one robot. The robot drives on a circle in an arena of 6 m x 6 m in which
//! six discs move.

#[path = "support/allocator.rs"]
mod allocator;

use std::f32::consts::TAU;

use bevy::math::{Vec2, vec2};
use divan::Bencher;
use divan::counter::ItemsCount;
use wayfield::drivers::{Driver, DriverConfig, Odometry, Percept, Robot};
use wayfield::run::{policy_card, shipped};
use wayfield::scenario::{Lidar, Motion, Scenario};

fn main() {
    divan::main();
}

const BEAMS: [usize; 2] = [24, 360];
const STEPS: usize = 210;
/// The motion on the circle: its 210 steps of 0.2 s take 42 s.
const MOTION: Motion = Motion { v_m_s: 0.15, w_rad_s: 0.15 };

#[divan::bench]
fn scenario_1(bencher: Bencher) {
    policy(bencher, "scenario-1", false, 24);
}

#[divan::bench(args = BEAMS)]
fn general(bencher: Bencher, beams: usize) {
    policy(bencher, "general", false, beams);
}

#[divan::bench(args = BEAMS)]
fn general_with_map(bencher: Bencher, beams: usize) {
    policy(bencher, "general", true, beams);
}

#[divan::bench(args = BEAMS)]
fn dwa_cv(bencher: Bencher, beams: usize) {
    let driver = DriverConfig::shipped("dwa-cv").expect("a shipped driver");
    act(bencher, beams, |scenario| driver.driver(&Robot::of(scenario)));
}

/// Times the shipped policy `name`.
fn policy(bencher: Bencher, name: &str, has_map: bool, beams: usize) {
    let shipped = shipped::policies().iter().find(|shipped| shipped.scenario_from == name);
    let policy = shipped.expect("a shipped policy").policy.clone();
    let driver = policy_card::driving(policy, has_map).expect("a policy of this version");
    act(bencher, beams, |scenario| driver.driver(scenario));
}

/// Times a decision, over the percepts of a whole circle.
fn act(bencher: Bencher, beams: usize, driver: impl Fn(&Scenario) -> Box<dyn Driver>) {
    let scenario = Scenario { lidar: Lidar { beams, ..Lidar::default() }, ..Scenario::default() };
    let scans: Vec<Vec<f32>> = (0..STEPS).map(|step| scan(&scenario.lidar, step)).collect();
    let mut driver = driver(&scenario);
    let mut decide = |step: usize| {
        let (from, to) = (pose(step.saturating_sub(1)), pose(step));
        let goal_m = vec2(2.5, 2.5) - vec2(to.0, to.1);
        driver.act(&Percept {
            ranges_m: &scans[step % STEPS],
            goal_distance_m: goal_m.length(),
            goal_bearing_rad: Vec2::from_angle(-to.2).rotate(goal_m).to_angle(),
            twist: MOTION,
            odometry: Odometry::between(from, to),
            truth: None,
        })
    };
    let mut step = 0;
    bencher.counter(ItemsCount::new(STEPS)).bench_local(|| {
        for _ in 0..STEPS {
            decide(step);
            step += 1;
        }
    });
}

/// The robot's pose after `step` control steps (x in m, y in m, heading in rad): on a circle with a radius of 1 m around the
/// origin.
fn pose(step: usize) -> (f32, f32, f32) {
    let angle = TAU * (step % STEPS) as f32 / STEPS as f32;
    (angle.sin(), -angle.cos(), angle)
}

/// The scan after `step` control steps: of the arena's walls, and of discs with a radius of 0.2 m that move the other way on a
/// circle with a radius of 2 m.
fn scan(lidar: &Lidar, step: usize) -> Vec<f32> {
    let (x, y, heading) = pose(step);
    let at = vec2(x, y);
    let range = |beam: Vec2| {
        let beam = Vec2::from_angle(heading).rotate(beam);
        let to_wall = |at: f32, along: f32| {
            if along == 0.0 { f32::INFINITY } else { (3.0 * along.signum() - at) / along }
        };
        let to_disc = |disc: usize| {
            let angle = TAU * (disc as f32 / 6.0 - step as f32 / STEPS as f32);
            let to_centre = 2.0 * Vec2::from_angle(angle) - at;
            let (along, across) = (beam.dot(to_centre), beam.perp_dot(to_centre));
            let half_chord_squared = 0.04 - across * across;
            if along > 0.0 && half_chord_squared > 0.0 {
                along - half_chord_squared.sqrt()
            } else {
                f32::INFINITY
            }
        };
        let discs = (0..6).map(to_disc).fold(f32::INFINITY, f32::min);
        to_wall(x, beam.x).min(to_wall(y, beam.y)).min(discs).min(lidar.max_range_m)
    };
    lidar.beam_directions().into_iter().map(range).collect()
}
