//! Action sets: the motions that a policy chooses among.

use serde::{Deserialize, Serialize};

/// The allowed numbers of relative motions.
const COUNT: core::ops::RangeInclusive<usize> = 1..=64;

/// The motions that a policy chooses among.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum ActionSet {
    /// The motions of the scenario's robot. The paper: the five of eq. (9).
    #[default]
    Robot,
    /// 1 to 64 motions in units of the robot's limits, for robots of any speed. Action k is the motion at index k.
    Relative(Vec<RelativeMotion>),
}

/// A motion in units of a robot's limits.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RelativeMotion {
    /// Speed as a fraction of the highest speed, -1 to 1. Below 0: of the highest speed backwards, which is 0 for a robot
    /// that only drives forwards.
    pub speed: f32,
    /// Turning rate as a fraction of the highest turning rate, -1 (right) to 1 (left).
    pub turn: f32,
}

/// The range of the speeds and turning rates of a robot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotionLimits {
    /// The lowest speed, at most 0, and the highest, at least 0, in m/s.
    pub v_m_s: (f32, f32),
    /// The lowest turning rate, at most 0, and the highest, at least 0, in rad/s.
    pub w_rad_s: (f32, f32),
}

impl ActionSet {
    /// The number of actions, if the robot has `robot_motions` motions.
    #[must_use]
    pub fn len(&self, robot_motions: usize) -> usize {
        match self {
            Self::Robot => robot_motions,
            Self::Relative(motions) => motions.len(),
        }
    }

    /// Checks that there are 1 to 64 relative motions, each within the limits.
    ///
    /// # Errors
    /// The problem and its fix.
    pub fn check(&self) -> Result<(), String> {
        let Self::Relative(motions) = self else { return Ok(()) };
        if !COUNT.contains(&motions.len()) {
            return Err(format!(
                "has {} motions; help: give {} to {}",
                motions.len(),
                COUNT.start(),
                COUNT.end()
            ));
        }
        let is_valid = |value: f32| (-1.0..=1.0).contains(&value);
        let outside = motions.iter().position(|motion| !is_valid(motion.speed) || !is_valid(motion.turn));
        match outside {
            Some(k) => Err(format!(
                "has a motion outside the limits at index {k}; help: give fractions from -1 to 1"
            )),
            None => Ok(()),
        }
    }
}

impl RelativeMotion {
    /// The motion of a robot with these limits: speed in m/s and turning rate in rad/s.
    #[must_use]
    pub fn of(self, limits: &MotionLimits) -> (f32, f32) {
        let scaled = |fraction: f32, (low, high): (f32, f32)| {
            if fraction < 0.0 { -fraction * low } else { fraction * high }
        };
        (scaled(self.speed, limits.v_m_s), scaled(self.turn, limits.w_rad_s))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn motion(speed: f32, turn: f32) -> RelativeMotion {
        RelativeMotion { speed, turn }
    }

    #[test]
    fn a_relative_motion_is_a_fraction_of_the_limit_on_its_side() {
        let limits = MotionLimits { v_m_s: (-0.1, 0.5), w_rad_s: (-1.0, 2.0) };
        assert_eq!(motion(0.5, 1.0).of(&limits), (0.25, 2.0));
        assert_eq!(motion(-1.0, -0.5).of(&limits), (-0.1, -0.5));
        assert_eq!(motion(0.0, 0.0).of(&limits), (0.0, 0.0));
    }

    #[test]
    fn fractions_outside_the_limits_are_rejected() {
        assert_eq!(ActionSet::Robot.check(), Ok(()));
        for motions in [vec![], vec![motion(1.1, 0.0)], vec![motion(0.0, f32::NAN)]] {
            let error = ActionSet::Relative(motions).check().expect_err("rejected");
            assert!(error.contains("; help: "), "{error}");
        }
    }
}
