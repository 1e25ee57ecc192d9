//! Random worlds in which all is as fast as may be, and what happens in them between two steps.

use std::f64::consts::PI;

use bevy::math::{Vec2, vec2};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use wayfield::random::{Stream, uniform, uniform_01};
use wayfield::scenario::{Motion, Obstacle, ObstacleMotion, Scenario, diagnostics, pose_at};
use wayfield::task::Pose;

use crate::common::closed_form;
use crate::scenario_strategies::valid_scenario;

/// A place (x, y in m).
pub type Point = (f64, f64);

/// `count` worlds over the whole schema with nothing wrong: the same for each `seed`.
pub fn worlds(seed: u8, count: usize) -> impl Iterator<Item = Scenario> {
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[seed; 32]);
    let mut runner = TestRunner::new_with_rng(Config::default(), rng);
    (0..count).map(move |_| valid_scenario().new_tree(&mut runner).expect("a world").current())
}

/// The same world with robot and obstacles as fast as the checks let them be, if that leaves nothing wrong.
pub fn at_max_speed(mut scenario: Scenario) -> Option<Scenario> {
    let period = scenario.task.control_period_s;
    for obstacle in &mut scenario.obstacles {
        let at = obstacle.position_m;
        match &mut obstacle.motion {
            ObstacleMotion::Static => {}
            ObstacleMotion::Orbit { centre_m, speed_rad_s } => {
                let arm = (at.x - centre_m.x).hypot(at.y - centre_m.y);
                let most = (0.5 / period).min(5.0) / arm;
                *speed_rad_s = most.min(20.0).min(PI as f32 / period).copysign(*speed_rad_s);
            }
            ObstacleMotion::Patrol { speed_m_s, .. }
            | ObstacleMotion::BackAndForth { speed_m_s, .. }
            | ObstacleMotion::RandomWalk { speed_m_s, .. } => *speed_m_s = (0.5 / period).min(5.0),
        }
    }
    let v = (2.0 * scenario.task.goal_radius_m / period).min(5.0);
    let w = (PI as f32 / period).min(20.0);
    scenario.robot.motions = [(v, 0.0), (v, w), (-v, -w / 3.0), (0.3 * v, 0.1 * w), (0.0, w), (0.0, 0.0)]
        .map(|(v_m_s, w_rad_s)| Motion { v_m_s, w_rad_s })
        .into();
    diagnostics(&scenario).is_empty().then_some(scenario)
}

/// The world a part (0 to 1) of a step after `step`, all standing. What revolves goes along its arc, everything else
/// straight from where the one step has it to where the next has it.
pub fn between_steps(room: &Scenario, step: u64, part: f64) -> Scenario {
    let period = room.task.control_period_s;
    let still = |obstacle: &Obstacle| {
        let (from, to) = (pose_at(obstacle, step, period), pose_at(obstacle, step + 1, period));
        let (at, turn) =
            if let ObstacleMotion::Orbit { centre_m: Vec2 { x: cx, y: cy }, speed_rad_s } = obstacle.motion {
                let angle = part * f64::from(speed_rad_s) * f64::from(period);
                let (sin, cos) = angle.sin_cos();
                let (x, y) = (f64::from(from.0 - cx), f64::from(from.1 - cy));
                let at = (f64::from(cx) + x * cos - y * sin, f64::from(cy) + x * sin + y * cos);
                (at, f64::from(from.2) + angle)
            } else {
                (straight(wide(vec2(from.0, from.1)), wide(vec2(to.0, to.1)), part), f64::from(from.2))
            };
        Obstacle {
            position_m: vec2(at.0 as f32, at.1 as f32),
            rotation_rad: turn as f32,
            motion: ObstacleMotion::Static,
            ..obstacle.clone()
        }
    };
    Scenario { obstacles: room.obstacles.iter().map(still).collect(), ..room.clone() }
}

/// The first part of the step after `step` at which something is nearer than `reach_m` to the robot's middle, which goes
/// straight from `from` to `to`; to 0.1 mm of what comes near.
pub fn first_within(room: &Scenario, step: u64, from: Point, to: Point, reach_m: f64) -> Option<f64> {
    let period = room.task.control_period_s;
    let hurry = |obstacle: &Obstacle| match obstacle.motion {
        ObstacleMotion::Static => 0.0,
        ObstacleMotion::Orbit { centre_m, speed_rad_s } => {
            let (x, y) = (obstacle.position_m.x - centre_m.x, obstacle.position_m.y - centre_m.y);
            f64::from(speed_rad_s.abs() * period * (x.hypot(y) + obstacle.shape.bounding_radius_m()))
        }
        _ => {
            let (a, b) = (pose_at(obstacle, step, period), pose_at(obstacle, step + 1, period));
            f64::from((b.0 - a.0).hypot(b.1 - a.1))
        }
    };
    let most = 1e-9 + apart(from, to) + room.obstacles.iter().map(hurry).fold(0.0, f64::max);
    let mut part = 0.0;
    loop {
        let clear = closed_form::clearance(&between_steps(room, step, part), 0, straight(from, to, part));
        if clear < reach_m {
            return Some(part);
        }
        if part >= 1.0 {
            return None;
        }
        part = (part + (clear - reach_m).max(2e-4) / most).min(1.0);
    }
}

/// Anywhere in the enclosure where everything is farther than `clear_m` from the middle.
pub fn free_pose(room: &Scenario, step: u64, clear_m: f64, stream: &mut Stream) -> Option<Pose> {
    let (low, high) = room.enclosure.bounds_m();
    for _ in 0..1000 {
        let (x_m, y_m) = (uniform(stream, low.x, high.x), uniform(stream, low.y, high.y));
        if closed_form::clearance(room, step, wide(vec2(x_m, y_m))) > clear_m {
            let heading_rad = (2.0 * uniform_01(stream) - 1.0) * std::f32::consts::PI;
            return Some(Pose { x_m, y_m, heading_rad });
        }
    }
    None
}

pub fn straight(from: Point, to: Point, part: f64) -> Point {
    (from.0 + (to.0 - from.0) * part, from.1 + (to.1 - from.1) * part)
}

pub fn apart(a: Point, b: Point) -> f64 {
    (a.0 - b.0).hypot(a.1 - b.1)
}

pub fn wide(Vec2 { x, y }: Vec2) -> Point {
    (f64::from(x), f64::from(y))
}

/// Where a robot's middle is.
pub fn middle(pose: &Pose) -> Point {
    wide(vec2(pose.x_m, pose.y_m))
}

/// Where constant `v` in m/s and `w` in rad/s take a robot in `seconds`, and how it looks then: in f64.
pub fn arc((at, heading): (Point, f64), (v, w): (f64, f64), seconds: f64) -> (Point, f64) {
    let half = 0.5 * w * seconds;
    let chord = v * seconds * if half.abs() < 1e-9 { 1.0 } else { half.sin() / half };
    let (sin, cos) = (heading + half).sin_cos();
    ((at.0 + chord * cos, at.1 + chord * sin), heading + 2.0 * half)
}
