//! What a driver perceives before a control step.

use glam::{Vec2, vec2};
use wayfield_scenario::{IndexedScenario, Motion};

/// What a driver perceives before a control step. A driver of class A or B (docs/drivers.md) gets no [`Truth`].
#[derive(Clone, Copy, Debug)]
pub struct Percept<'a> {
    /// The reported ranges, in m, one per beam. A beam that hits nothing reports the maximum range.
    pub ranges_m: &'a [f32],
    /// Distance to the goal's centre, in m.
    pub goal_distance_m: f32,
    /// Bearing of the goal relative to the heading, in rad, counterclockwise positive.
    pub goal_bearing_rad: f32,
    /// The actual speed and turning rate.
    pub twist: Motion,
    /// The robot's own motion since the last percept; zero in the first one of an episode.
    pub odometry: Odometry,
    /// The true scenario and pose, for drivers of class C only.
    pub truth: Option<Truth<'a>>,
}

impl Percept<'_> {
    /// The goal in the robot's frame (x ahead, y to the left), in m.
    #[must_use]
    pub fn goal_m(&self) -> Vec2 {
        let (sin, cos) = libm::sincosf(self.goal_bearing_rad);
        vec2(cos, sin) * self.goal_distance_m
    }
}

/// The true state of the scenario.
#[derive(Clone, Copy, Debug)]
pub struct Truth<'a> {
    /// The scenario, with its generated obstacles and its pedestrians.
    pub layout: IndexedScenario<'a>,
    /// The obstacles' clock, in control steps.
    pub clock: u64,
    /// The robot's pose: x in m, y in m, heading in rad.
    pub pose: (f32, f32, f32),
    /// The goal's centre, in m.
    pub goal_m: Vec2,
}

/// A rigid motion in the plane: the pose of a frame in another one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Odometry {
    /// Displacement, in m. For a robot's own motion: ahead and to the left, in its frame before the motion.
    pub translation_m: Vec2,
    /// Rotation, counterclockwise positive, in rad. It is not wrapped: it may differ from the actual turn by a multiple of 2 pi.
    pub rotation_rad: f32,
}

impl Odometry {
    /// The motion from the pose `from` to the pose `to` (x in m, y in m, heading in rad).
    #[must_use]
    pub fn between(from: (f32, f32, f32), to: (f32, f32, f32)) -> Self {
        let (sin, cos) = libm::sincosf(-from.2);
        let translation_m = vec2(cos, sin).rotate(vec2(to.0 - from.0, to.1 - from.1));
        Self { translation_m, rotation_rad: to.2 - from.2 }
    }

    /// Transforms a point from the moved frame to the frame before the motion.
    #[must_use]
    pub fn to_outer(&self, point: Vec2) -> Vec2 {
        let (sin, cos) = libm::sincosf(self.rotation_rad);
        vec2(cos, sin).rotate(point) + self.translation_m
    }

    /// Transforms a point from the frame before the motion to the moved frame.
    #[must_use]
    pub fn to_inner(&self, point: Vec2) -> Vec2 {
        let (sin, cos) = libm::sincosf(-self.rotation_rad);
        vec2(cos, sin).rotate(point - self.translation_m)
    }

    /// This motion followed by `next`, which is given in the moved frame.
    #[must_use]
    pub fn then(&self, next: &Self) -> Self {
        Self {
            translation_m: self.to_outer(next.translation_m),
            rotation_rad: self.rotation_rad + next.rotation_rad,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::f32::consts::FRAC_PI_2;

    use super::*;

    #[test]
    fn odometry_is_the_pose_after_the_motion_in_the_frame_before_it() {
        // From (1, 1), facing +y, to (1, 3), facing -x: two metres ahead, then a quarter turn to the left.
        let moved = Odometry::between((1.0, 1.0, FRAC_PI_2), (1.0, 3.0, 2.0 * FRAC_PI_2));
        assert!((moved.translation_m - vec2(2.0, 0.0)).length() < 1e-6, "{moved:?}");
        assert!((moved.rotation_rad - FRAC_PI_2).abs() < 1e-6);
        // A point one metre ahead of the moved robot was 2 m ahead and 1 m to the left.
        assert!((moved.to_outer(vec2(1.0, 0.0)) - vec2(2.0, 1.0)).length() < 1e-6);
        assert!((moved.to_inner(vec2(2.0, 1.0)) - vec2(1.0, 0.0)).length() < 1e-6);
        let twice = moved.then(&moved);
        assert!((twice.translation_m - vec2(2.0, 2.0)).length() < 1e-6, "{twice:?}");
    }
}
