//! Random scenarios, optionally with everything at maximum speed; and the positions of the robot and the obstacles between two
//! control steps, computed in f64 as a reference.

use std::f64::consts::PI;

use bevy::math::{Vec2, vec2};
use proptest::strategy::{Strategy, ValueTree};
use proptest::test_runner::{Config, RngAlgorithm, TestRng, TestRunner};
use wayfield::random::{Stream, uniform, uniform_01};
use wayfield::scenario::{KeyFrameEnd, Motion, Obstacle, ObstacleMotion, Scenario, diagnostics, pose_at};
use wayfield::task::Pose;

use crate::common::closed_form;
use crate::scenario_strategies::valid_scenario;

/// A point (x, y) in m.
pub type Point = (f64, f64);

/// `count` valid random scenarios over most of the schema. The same `seed` gives the same scenarios.
pub fn scenarios(seed: u8, count: usize) -> impl Iterator<Item = Scenario> {
    let rng = TestRng::from_seed(RngAlgorithm::ChaCha, &[seed; 32]);
    let mut runner = TestRunner::new_with_rng(Config::default(), rng);
    (0..count).map(move |_| valid_scenario().new_tree(&mut runner).expect("a scenario").current())
}

/// The scenario with robot and obstacles at the highest speeds that the checks allow, or None if it is then invalid.
pub fn at_max_speed(mut scenario: Scenario) -> Option<Scenario> {
    let period = scenario.task.control_period_s;
    for obstacle in &mut scenario.obstacles {
        let at = obstacle.position_m;
        match &mut obstacle.motion {
            ObstacleMotion::Static => {}
            ObstacleMotion::Orbit { centre_m, speed_rad_s } => {
                let radius_m = (at.x - centre_m.x).hypot(at.y - centre_m.y);
                let max_rad_s = (0.5 / period).min(5.0) / radius_m;
                let sign = speed_rad_s.value();
                *speed_rad_s = max_rad_s.min(20.0).min(PI as f32 / period).copysign(sign).into();
            }
            ObstacleMotion::Patrol { speed_m_s, .. }
            | ObstacleMotion::BackAndForth { speed_m_s, .. }
            | ObstacleMotion::RandomWalk { speed_m_s, .. }
            | ObstacleMotion::Pedestrian { speed_m_s, .. } => {
                *speed_m_s = (0.5 / period).min(5.0).into();
            }
            ObstacleMotion::KeyFrames { frames, end } => {
                let path_m: Vec<_> = frames.iter().map(|frame| frame.position_m).collect();
                let is_loop = *end != KeyFrameEnd::Stop;
                obstacle.motion =
                    ObstacleMotion::key_frames_along(at, &path_m, (0.5 / period).min(5.0), is_loop);
            }
        }
    }
    let v = (2.0 * scenario.task.goal_radius_m / period).min(5.0);
    let w = (PI as f32 / period).min(20.0);
    scenario.robot.motions = [(v, 0.0), (v, w), (-v, -w / 3.0), (0.3 * v, 0.1 * w), (0.0, w), (0.0, 0.0)]
        .map(|(v_m_s, w_rad_s)| Motion { v_m_s, w_rad_s })
        .into();
    diagnostics(&scenario).is_empty().then_some(scenario)
}

/// The layout at a fraction (0 to 1) of the control period after `step`, with static obstacles. Orbiting obstacles move along
/// their arcs, all others on straight lines between their poses at the two steps.
pub fn between_steps(layout: &Scenario, step: u64, fraction: f64) -> Scenario {
    let period = layout.task.control_period_s;
    let static_at = |obstacle: &Obstacle| {
        let (from, to) = (pose_at(obstacle, step, period), pose_at(obstacle, step + 1, period));
        let (at, turn) =
            if let ObstacleMotion::Orbit { centre_m: Vec2 { x: cx, y: cy }, speed_rad_s } = obstacle.motion {
                let angle = fraction * f64::from(speed_rad_s.value()) * f64::from(period);
                let (sin, cos) = angle.sin_cos();
                let (x, y) = (f64::from(from.0 - cx), f64::from(from.1 - cy));
                let at = (f64::from(cx) + x * cos - y * sin, f64::from(cy) + x * sin + y * cos);
                (at, f64::from(from.2) + angle)
            } else {
                let (from_m, to_m) = (to_f64(vec2(from.0, from.1)), to_f64(vec2(to.0, to.1)));
                (interpolate(from_m, to_m, fraction), f64::from(from.2))
            };
        Obstacle {
            position_m: vec2(at.0 as f32, at.1 as f32),
            rotation_rad: turn as f32,
            motion: ObstacleMotion::Static,
            ..obstacle.clone()
        }
    };
    Scenario { obstacles: layout.obstacles.iter().map(static_at).collect(), ..layout.clone() }
}

/// The fraction of the control period after `step` at which something first comes within `reach_m` of the robot's centre,
/// which moves on a straight line from `from` to `to`. The resolution is 0.2 mm of relative motion.
pub fn first_within(layout: &Scenario, step: u64, from: Point, to: Point, reach_m: f64) -> Option<f64> {
    let period = layout.task.control_period_s;
    let travel_m = |obstacle: &Obstacle| match obstacle.motion {
        ObstacleMotion::Static => 0.0,
        ObstacleMotion::Orbit { centre_m, speed_rad_s } => {
            let (x, y) = (obstacle.position_m.x - centre_m.x, obstacle.position_m.y - centre_m.y);
            f64::from(speed_rad_s.value().abs() * period * (x.hypot(y) + obstacle.shape.bounding_radius_m()))
        }
        _ => {
            let (a, b) = (pose_at(obstacle, step, period), pose_at(obstacle, step + 1, period));
            f64::from((b.0 - a.0).hypot(b.1 - a.1))
        }
    };
    let max_travel_m = 1e-9 + distance(from, to) + layout.obstacles.iter().map(travel_m).fold(0.0, f64::max);
    let mut fraction = 0.0;
    loop {
        let moment = between_steps(layout, step, fraction);
        let clear = closed_form::clearance(&moment, 0, interpolate(from, to, fraction));
        if clear < reach_m {
            return Some(fraction);
        }
        if fraction >= 1.0 {
            return None;
        }
        fraction = (fraction + (clear - reach_m).max(2e-4) / max_travel_m).min(1.0);
    }
}

/// A random pose in the enclosure with a clearance above `clear_m`, or None if 1000 attempts find none.
pub fn free_pose(layout: &Scenario, step: u64, clear_m: f64, stream: &mut Stream) -> Option<Pose> {
    let (low, high) = layout.enclosure.bounds_m();
    for _ in 0..1000 {
        let (x_m, y_m) = (uniform(stream, low.x, high.x), uniform(stream, low.y, high.y));
        if closed_form::clearance(layout, step, to_f64(vec2(x_m, y_m))) > clear_m {
            let heading_rad = (2.0 * uniform_01(stream) - 1.0) * std::f32::consts::PI;
            return Some(Pose { x_m, y_m, heading_rad });
        }
    }
    None
}

pub fn interpolate(from: Point, to: Point, fraction: f64) -> Point {
    (from.0 + (to.0 - from.0) * fraction, from.1 + (to.1 - from.1) * fraction)
}

pub fn distance(a: Point, b: Point) -> f64 {
    (a.0 - b.0).hypot(a.1 - b.1)
}

pub fn to_f64(Vec2 { x, y }: Vec2) -> Point {
    (f64::from(x), f64::from(y))
}

/// The position of the robot's centre.
pub fn centre(pose: &Pose) -> Point {
    to_f64(vec2(pose.x_m, pose.y_m))
}

/// The position and heading after `seconds` of constant `v` in m/s and `w` in rad/s, in f64.
pub fn arc((at, heading): (Point, f64), (v, w): (f64, f64), seconds: f64) -> (Point, f64) {
    let half = 0.5 * w * seconds;
    let chord = v * seconds * if half.abs() < 1e-9 { 1.0 } else { half.sin() / half };
    let (sin, cos) = (heading + half).sin_cos();
    ((at.0 + chord * cos, at.1 + chord * sin), heading + 2.0 * half)
}
