//! What a driver knows about its robot, and the effect of a motion.

use std::f32::consts::FRAC_PI_2;

use glam::{Vec2, vec2};
use wayfield_scenario::{Drive, Motion, Scenario};

use crate::percept::Odometry;

/// What a driver knows about its robot, its LIDAR and the rules of the task.
#[derive(Clone, Debug, PartialEq)]
pub struct Robot {
    /// The motions to choose from; at least one.
    pub motions: Vec<Motion>,
    /// The drive over steps of one control period. If the actuator lag is a range, its midpoint is used.
    pub drive: Drive,
    /// Simulated time per control step, in s.
    pub control_period_s: f32,
    /// The unit of lengths relative to the robot, in m ([`Scenario::robot_unit_m`]): the collision range, or the reach of its
    /// body, whichever is larger. Drivers keep the robot's centre at least this far from every surface.
    pub unit_m: f32,
    /// The goal is reached when the robot's centre is closer to it than this, in m.
    pub goal_radius_m: f32,
    /// The direction of each LIDAR beam in the robot's frame, as a unit vector.
    pub beams: Vec<Vec2>,
    /// The maximum range of the LIDAR, in m.
    pub max_range_m: f32,
    /// The angle between neighbouring beams, in rad.
    pub beam_spacing_rad: f32,
}

impl Robot {
    /// The robot of `scenario`.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Self {
        let Scenario { robot, lidar, task, .. } = scenario;
        Self {
            motions: robot.motions.clone(),
            drive: robot.drive(task.control_period_s),
            control_period_s: task.control_period_s,
            unit_m: scenario.robot_unit_m(),
            goal_radius_m: task.goal_radius_m,
            beams: lidar.beam_directions(),
            max_range_m: lidar.max_range_m,
            beam_spacing_rad: lidar.beam_spacing_rad(),
        }
    }

    /// The highest forward speed of the motions, in m/s; at least 0.001.
    #[must_use]
    pub fn max_forward_speed_m_s(&self) -> f32 {
        self.motions.iter().map(|motion| motion.v_m_s).fold(0.001, f32::max)
    }

    /// The highest speed of the motions in either direction, forward or backward, in m/s; at least 0.001.
    #[must_use]
    pub fn max_speed_m_s(&self) -> f32 {
        self.motions.iter().map(|motion| motion.v_m_s.abs()).fold(0.001, f32::max)
    }

    /// The highest turning rate of the motions, in rad/s; at least 0.001.
    #[must_use]
    pub fn max_turn_rad_s(&self) -> f32 {
        self.motions.iter().map(|motion| motion.w_rad_s.abs()).fold(0.001, f32::max)
    }

    /// The points that a scan hit, in the robot's frame, in m.
    pub(crate) fn hits<'a>(&'a self, ranges_m: &'a [f32]) -> impl Iterator<Item = Vec2> + 'a {
        let hits = self.beams.iter().zip(ranges_m).filter(|(_, range)| **range < self.max_range_m);
        hits.map(|(beam, range)| *beam * *range)
    }

    /// The displacement of the robot after `seconds` of `motion`, without actuator lag.
    pub(crate) fn arc(motion: &Motion, seconds: f32) -> Odometry {
        let half = 0.5 * motion.w_rad_s * seconds;
        let sinc = if half.abs() < 1e-4 { 1.0 } else { libm::sinf(half) / half };
        let (sin, cos) = libm::sincosf(half);
        Odometry { translation_m: vec2(cos, sin) * (motion.v_m_s * seconds * sinc), rotation_rad: 2.0 * half }
    }

    /// The index of the motion that best brings the robot to `velocity` (in the robot's frame, in m/s) within `turn_time_s`.
    ///
    /// The desired turning rate is the angle to `velocity` divided by the time, at most the robot's highest. The desired speed
    /// is the component of `velocity` along the heading, or 0 if that is backwards. The result is the
    /// [closest motion](Robot::closest_motion) to the two.
    pub(crate) fn motion_towards(&self, velocity: Vec2, turn_time_s: f32) -> usize {
        let speed = velocity.length();
        let angle = if speed > 0.0 { libm::atan2f(velocity.y, velocity.x) } else { 0.0 };
        let ahead = if angle.abs() < FRAC_PI_2 { libm::cosf(angle) } else { 0.0 };
        let max_turn = self.max_turn_rad_s();
        let turn = (angle / turn_time_s).clamp(-max_turn, max_turn);
        self.closest_motion(speed * ahead, turn)
    }

    /// The index of the motion that is closest to the speed `v_m_s` and the turning rate `w_rad_s`; the first of equally close
    /// ones. Differences are relative to the highest forward speed and turning rate.
    pub(crate) fn closest_motion(&self, v_m_s: f32, w_rad_s: f32) -> usize {
        let (max_v, max_w) = (self.max_forward_speed_m_s(), self.max_turn_rad_s());
        let difference = |motion: &Motion| {
            let (dv, dw) = ((motion.v_m_s - v_m_s) / max_v, (motion.w_rad_s - w_rad_s) / max_w);
            dv * dv + dw * dw
        };
        argmin(self.motions.iter().map(difference))
    }
}

/// The index of the smallest number; the first of equal ones.
pub(crate) fn argmin(numbers: impl Iterator<Item = f32>) -> usize {
    let least = |best: (usize, f32), (index, number)| if number < best.1 { (index, number) } else { best };
    numbers.enumerate().fold((0, f32::INFINITY), least).0
}

#[cfg(test)]
mod tests {
    use super::*;

    fn robot() -> Robot {
        Robot::of(&Scenario::default())
    }

    #[test]
    fn an_arc_lies_on_a_circle_of_radius_v_over_w() {
        // A circle of radius v / w = 0.1 m, driven from its lowest point for 0.2 s at 1.5 rad/s: 0.3 rad.
        let end = Robot::arc(&Motion { v_m_s: 0.15, w_rad_s: 1.5 }, 0.2);
        assert!((end.translation_m.x - 0.1 * 0.3_f32.sin()).abs() < 1e-7);
        assert!((end.translation_m.y - 0.1 * (1.0 - 0.3_f32.cos())).abs() < 1e-7);
        assert!((end.rotation_rad - 0.3).abs() < 1e-7);
    }

    #[test]
    fn the_motion_towards_a_velocity_turns_to_its_side() {
        // The paper's motions: large left, small left, forward, small right, large right.
        let robot = robot();
        for (velocity, expected) in [
            (vec2(0.15, 0.0), 2),
            (vec2(0.0, 0.15), 0),
            (vec2(0.15, 0.05), 1),
            (vec2(0.15, -0.05), 3),
            (vec2(-0.15, -0.01), 4),
        ] {
            assert_eq!(robot.motion_towards(velocity, 0.4), expected, "{velocity}");
        }
        let stop = Motion { v_m_s: 0.0, w_rad_s: 0.0 };
        let robot = Robot { motions: vec![robot.motions[2], stop], ..robot };
        assert_eq!(robot.motion_towards(Vec2::ZERO, 0.4), 1, "it stops if it can");
    }
}
