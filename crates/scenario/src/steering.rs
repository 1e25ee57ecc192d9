//! Car-like steering: the motions that a minimum turning radius allows.

use super::check::{Diagnostics, rounded_down};
use super::limits::{MAX_ANGULAR_SPEED_RAD_S, MAX_SPEED_M_S, MOTIONS};
use super::schema::{Motion, Robot};

/// Tolerance factor for the rounding errors of a motion at the limit.
const SLACK: f32 = 1.0 + 1e-5;

impl Robot {
    /// The lowest and the highest speed and turning rate of the robot, over all its motions and standing still.
    #[must_use]
    pub fn motion_limits(&self) -> (Motion, Motion) {
        let still = Motion { v_m_s: 0.0, w_rad_s: 0.0 };
        self.motions.iter().fold((still, still), |(low, high), motion| {
            let least =
                Motion { v_m_s: low.v_m_s.min(motion.v_m_s), w_rad_s: low.w_rad_s.min(motion.w_rad_s) };
            let most =
                Motion { v_m_s: high.v_m_s.max(motion.v_m_s), w_rad_s: high.w_rad_s.max(motion.w_rad_s) };
            (least, most)
        })
    }

    /// The motion with its turning rate limited to what the minimum turning radius allows at its speed.
    #[must_use]
    pub fn steerable(&self, motion: Motion) -> Motion {
        let Some(radius_m) = self.min_turning_radius_m else { return motion };
        let most_rad_s = motion.v_m_s.abs() / radius_m;
        Motion { w_rad_s: motion.w_rad_s.clamp(-most_rad_s, most_rad_s), ..motion }
    }
}

/// Reports each motion of a robot that turns more tightly than `radius_m`, its minimum turning radius.
pub(super) fn check(robot: &Robot, radius_m: f32, diagnostics: &mut Diagnostics) {
    for (k, Motion { v_m_s, w_rad_s }) in robot.motions.iter().enumerate().take(*MOTIONS.end()) {
        let (speed_m_s, turn_rad_s) = (v_m_s.abs(), w_rad_s.abs());
        let is_in_range = speed_m_s <= MAX_SPEED_M_S && turn_rad_s <= MAX_ANGULAR_SPEED_RAD_S;
        if !is_in_range || turn_rad_s * radius_m <= speed_m_s * SLACK {
            continue;
        }
        let path = format_args!("robot.motions[{k}]");
        let least = format!("the robot's minimum turning radius is {radius_m} m");
        diagnostics.push(path, if speed_m_s == 0.0 {
            format!("turns on the spot, but {least}: write a w_rad_s of 0 or a larger v_m_s, or remove min_turning_radius_m")
        } else {
            format!(
                "turns with a radius of {:.3} m, but {least}: write a w_rad_s of at most {} either way, or a larger v_m_s",
                speed_m_s / turn_rad_s,
                rounded_down(speed_m_s / radius_m)
            )
        });
    }
}
