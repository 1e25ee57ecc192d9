//! The pose of an obstacle as a pure function of the step count.
//!
//! In: an [`Obstacle`], a step, the control period. Out: its pose. The arithmetic is f64 with `libm`, so that all platforms
//! agree bit for bit. Poses are computed from the step count, not accumulated, so nothing drifts: after 10^9 steps the angle
//! is accurate to about 1e-8 rad.
//!
//! A new motion needs: a variant of [`ObstacleMotion`], its pose here, the methods in `motion_fields.rs` and `track.rs`, and
//! initial values in the app's editor (`src/app/editor/new_motion.rs`).

use std::f64::consts::{PI, TAU};

use super::key_frames;
use super::schema::{Obstacle, ObstacleMotion};
use glam::{DVec2, Vec2, dvec2};
use wayfield_random::Stream;

/// The pose (x in m, y in m, rotation in rad, in [-pi, pi]) of `obstacle` after `step` steps of
/// `control_period_s`.
///
/// Orbit: the obstacle revolves about the centre and rotates with the revolution. Patrol: it starts at its own position,
/// visits the waypoints in order, returns to its position, and repeats; a negative speed reverses the direction. Back and
/// forth: it goes to the last waypoint and back. Random walk: it starts at its position and moves in straight lines between
/// random points of the disc about that position, at constant speed on each leg; every leg takes the time of the longest possible
/// leg. Key frames: it is at each frame's position at the frame's time, and moves in straight lines between them;
/// [`KeyFrameEnd`](super::KeyFrameEnd) determines what follows the last one.
///
/// Pedestrian: its position at the start of an episode. [`IndexedScenario::pose_at`](super::IndexedScenario::pose_at) gives its
/// current position.
///
/// Numbers that [`diagnostics`](super::diagnostics) would reject may give NaN but never a panic.
#[must_use]
pub fn pose_at(obstacle: &Obstacle, step: u64, control_period_s: f32) -> (f32, f32, f32) {
    let position = obstacle.position_m.as_dvec2();
    let rotation = f64::from(obstacle.rotation_rad);
    // The product of two f32 is exact in f64; only the multiplication by `step` rounds.
    let travelled = |speed: f32| f64::from(speed) * f64::from(control_period_s) * step as f64;
    let (point, rotation) = match &obstacle.motion {
        ObstacleMotion::Static | ObstacleMotion::Pedestrian { .. } => (position, rotation),
        ObstacleMotion::Orbit { centre_m, speed_rad_s } => {
            let angle = travelled(speed_rad_s.value());
            (rotate_about(position, centre_m.as_dvec2(), angle), rotation + angle)
        }
        ObstacleMotion::Patrol { waypoints_m, speed_m_s } => {
            (along(position, waypoints_m, travelled(speed_m_s.value())), rotation)
        }
        ObstacleMotion::BackAndForth { waypoints_m, speed_m_s } => {
            (back_and_forth(position, waypoints_m, travelled(speed_m_s.value())), rotation)
        }
        ObstacleMotion::RandomWalk { radius_m, speed_m_s, seed } => {
            (random_walk(position, f64::from(*radius_m), *seed, travelled(speed_m_s.value())), rotation)
        }
        ObstacleMotion::KeyFrames { frames, end } => {
            (key_frames::position_m(position, frames, *end, travelled(1.0)), rotation)
        }
    };
    (point.x as f32, point.y as f32, wrapped(rotation) as f32)
}

/// `point` rotated about `centre` by `angle`.
fn rotate_about(point: DVec2, centre: DVec2, angle: f64) -> DVec2 {
    let (sin, cos) = libm::sincos(angle);
    let arm = point - centre;
    dvec2(centre.x + arm.x * cos - arm.y * sin, centre.y + arm.x * sin + arm.y * cos)
}

/// The point at `distance` along the closed loop from `start` through the waypoints.
fn along(start: DVec2, waypoints: &[Vec2], distance: f64) -> DVec2 {
    let corners = || std::iter::once(start).chain(waypoints.iter().map(|corner| corner.as_dvec2()));
    let legs = || corners().zip(corners().skip(1).chain(std::iter::once(start)));
    let perimeter: f64 = legs().map(|(from, to)| length(from, to)).sum();
    if perimeter == 0.0 {
        return start;
    }
    let mut remaining = libm::fmod(distance, perimeter);
    if remaining < 0.0 {
        remaining += perimeter;
    }
    for (from, to) in legs() {
        let leg = length(from, to);
        if remaining < leg {
            return between(from, to, remaining / leg);
        }
        remaining -= leg;
    }
    start
}

/// The point at `distance` along the path from `start` through the waypoints and back, repeated.
fn back_and_forth(start: DVec2, waypoints: &[Vec2], distance: f64) -> DVec2 {
    let corners = || std::iter::once(start).chain(waypoints.iter().map(|corner| corner.as_dvec2()));
    let legs = || corners().zip(corners().skip(1));
    let one_way: f64 = legs().map(|(from, to)| length(from, to)).sum();
    if one_way == 0.0 {
        return start;
    }
    let gone = libm::fmod(distance.abs(), 2.0 * one_way);
    let mut remaining = if gone <= one_way { gone } else { 2.0 * one_way - gone };
    for (from, to) in legs() {
        let leg = length(from, to);
        if remaining < leg {
            return between(from, to, remaining / leg);
        }
        remaining -= leg;
    }
    corners().last().unwrap_or(start)
}

/// The point of a random walk about `middle` after the time in which its highest speed would cover `distance`. Every leg takes
/// the time of the longest possible leg, whose length is twice the `reach`.
fn random_walk(middle: DVec2, reach: f64, seed: u32, distance: f64) -> DVec2 {
    let legs = distance.abs() / (2.0 * reach);
    if !legs.is_finite() {
        return middle;
    }
    let point = |leg: f64| {
        if leg <= 0.0 {
            return middle;
        }
        let mut stream = wayfield_random::stream(u64::from(seed), "random walk", leg as u64);
        middle + reach * in_disc(&mut stream)
    };
    let begun = legs.floor();
    between(point(begun), point(begun + 1.0), legs - begun)
}

/// A uniformly random point of the unit disc, by rejection sampling from the square.
fn in_disc(stream: &mut Stream) -> DVec2 {
    let mut coordinate = || f64::from(wayfield_random::uniform(stream, -1.0, 1.0));
    loop {
        let point = dvec2(coordinate(), coordinate());
        if point.dot(point) <= 1.0 {
            return point;
        }
    }
}

fn between(from: DVec2, to: DVec2, part: f64) -> DVec2 {
    from + (to - from) * part
}

fn length(from: DVec2, to: DVec2) -> f64 {
    let (dx, dy) = (to.x - from.x, to.y - from.y);
    (dx * dx + dy * dy).sqrt()
}

/// `angle` wrapped to [-pi, pi]. An angle in this range keeps its bits.
fn wrapped(angle: f64) -> f64 {
    if angle.abs() <= PI { angle } else { libm::remainder(angle, TAU) }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use glam::vec2;

    use super::*;
    use crate::Shape;

    fn obstacle(position_m: Vec2, motion: ObstacleMotion) -> Obstacle {
        Obstacle { shape: Shape::Circle { radius_m: 0.15 }, position_m, rotation_rad: 0.0, motion }
    }

    fn assert_near(pose: (f32, f32, f32), expected: (f32, f32, f32)) {
        let near = |a: f32, b: f32| (a - b).abs() < 2e-6;
        assert!(
            near(pose.0, expected.0) && near(pose.1, expected.1) && near(pose.2, expected.2),
            "{pose:?} is not {expected:?}"
        );
    }

    #[test]
    fn a_quarter_turn_takes_a_corner_to_the_next_one_counterclockwise() {
        let quarter_rad_s = FRAC_PI_2 as f32;
        let o = obstacle(
            vec2(0.6, 0.6),
            ObstacleMotion::Orbit { centre_m: vec2(0.0, 0.0), speed_rad_s: quarter_rad_s.into() },
        );
        assert_eq!(pose_at(&o, 0, 0.25), (0.6, 0.6, 0.0), "step 0 is exactly the position");
        assert_near(pose_at(&o, 4, 0.25), (-0.6, 0.6, FRAC_PI_2 as f32));
        assert_near(pose_at(&o, 12, 0.25), (0.6, -0.6, -FRAC_PI_2 as f32));
    }

    #[test]
    fn an_orbit_may_go_clockwise_about_any_centre() {
        let motion =
            ObstacleMotion::Orbit { centre_m: vec2(1.0, 1.0), speed_rad_s: (-(FRAC_PI_2 as f32)).into() };
        assert_near(pose_at(&obstacle(vec2(1.0, 2.0), motion), 1, 1.0), (2.0, 1.0, -FRAC_PI_2 as f32));
    }

    #[test]
    fn a_patrol_visits_its_waypoints_and_returns() {
        // A 3-4-5 triangle at 1 m/s with steps of 1 s: 12 steps per loop.
        let waypoints_m = vec![vec2(3.0, 0.0), vec2(3.0, 4.0)];
        let o = obstacle(vec2(0.0, 0.0), ObstacleMotion::Patrol { waypoints_m, speed_m_s: 1.0.into() });
        for (step, expected) in [
            (0, (0.0, 0.0)),
            (1, (1.0, 0.0)),
            (3, (3.0, 0.0)),
            (5, (3.0, 2.0)),
            (7, (3.0, 4.0)),
            (12, (0.0, 0.0)),
        ] {
            assert_near(pose_at(&o, step, 1.0), (expected.0, expected.1, 0.0));
        }
        assert_near(pose_at(&o, 12_000_000_007, 1.0), (3.0, 4.0, 0.0));
    }

    #[test]
    fn back_and_forth_turns_at_the_last_waypoint() {
        // Legs of 3 m and 4 m at 1 m/s with steps of 1 s: at the end after 7 steps, back after 14.
        let waypoints_m = vec![vec2(3.0, 0.0), vec2(3.0, 4.0)];
        let o = obstacle(vec2(0.0, 0.0), ObstacleMotion::BackAndForth { waypoints_m, speed_m_s: 1.0.into() });
        for (step, (x, y)) in [
            (0, (0.0, 0.0)),
            (2, (2.0, 0.0)),
            (7, (3.0, 4.0)),
            (9, (3.0, 2.0)),
            (12, (2.0, 0.0)),
            (14, (0.0, 0.0)),
            (14_000_000_016, (2.0, 0.0)),
        ] {
            assert_near(pose_at(&o, step, 1.0), (x, y, 0.0));
        }
    }

    #[test]
    fn a_random_walk_stays_within_its_radius_and_speed_and_depends_on_its_seed() {
        let walk = |seed| {
            obstacle(
                vec2(1.0, -1.0),
                ObstacleMotion::RandomWalk { radius_m: 0.5, speed_m_s: 0.2.into(), seed },
            )
        };
        let (one, other) = (walk(1), walk(2));
        assert_eq!(pose_at(&one, 0, 0.2), (1.0, -1.0, 0.0));
        let (mut apart, mut corners) = (0.0_f32, std::collections::BTreeSet::new());
        for step in (0..5_000).chain(3_000_000_000..3_000_000_200) {
            let (now, next) = (pose_at(&one, step, 0.2), pose_at(&one, step + 1, 0.2));
            assert!((now.0 - 1.0).hypot(now.1 + 1.0) <= 0.5 + 1e-6, "out of reach at step {step}");
            assert!((next.0 - now.0).hypot(next.1 - now.1) <= 0.04 + 1e-5, "too quick at step {step}");
            let other_pose = pose_at(&other, step, 0.2);
            apart = apart.max((now.0 - other_pose.0).hypot(now.1 - other_pose.1));
            // A leg takes 2 * 0.5 m / 0.2 m/s = 5 s, 25 steps.
            if step % 25 == 0 {
                corners.insert((now.0.to_bits(), now.1.to_bits()));
            }
        }
        assert!(apart > 0.3, "another seed gives another walk");
        assert!(corners.len() >= 200, "each leg ends at a different point: {}", corners.len());
    }

    #[test]
    fn a_patrol_without_a_path_stays_in_place() {
        for waypoints_m in [vec![], vec![vec2(0.5, 0.5)]] {
            let o = obstacle(vec2(0.5, 0.5), ObstacleMotion::Patrol { waypoints_m, speed_m_s: 1.0.into() });
            assert_eq!(pose_at(&o, 77, 0.2), (0.5, 0.5, 0.0));
        }
    }

    #[test]
    fn an_orbit_does_not_drift_in_a_billion_steps() {
        let motion = ObstacleMotion::Orbit { centre_m: vec2(0.0, 0.0), speed_rad_s: 0.15.into() };
        let o = obstacle(vec2(0.6, 0.6), motion);
        let radius = 0.6 * 2.0_f64.sqrt();
        for step in [1, 1_000, 1_000_000, 999_999_999, 1_000_000_000] {
            let (x, y, rotation) = pose_at(&o, step, 0.2);
            assert!(
                (f64::from(x).hypot(f64::from(y)) - radius).abs() < 1e-6,
                "the distance stays at step {step}"
            );
            // The f32s nearest to 0.15 and 0.2 are 10066330 / 2^26 and 13421773 / 2^26. The angle is their product
            // times the step: exact / 2^52 rad. It is reduced modulo tau in integers, which is exact.
            let exact = 10_066_330_i128 * 13_421_773 * i128::from(step);
            let tau = (TAU * 2.0_f64.powi(50)) as i128 * 4;
            // tau / 2^52 is the f64 nearest to 2 pi, short of it by 2.45e-16.
            let turns = exact / tau;
            let angle = (exact % tau) as f64 / 2.0_f64.powi(52) - turns as f64 * 2.449_293_598_294_706_4e-16;
            let miss = libm::remainder(f64::from(rotation) - angle, TAU);
            assert!(miss.abs() < 1e-6, "at step {step} the rotation is {miss} rad off");
        }
    }
}
