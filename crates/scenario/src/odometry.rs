//! Wheel slip and odometry drift: the differences between the motion of the wheels, the motion of the robot, and the
//! motion that odometry reports.

use wayfield_random::{normal, stream};

use super::ranged::Ranged;
use super::schema::{Motion, OdometryDrift, Slip};

impl Slip {
    /// The motion of the robot in the control step that ends at `clock` if its wheels have the motion `wheels`. The
    /// slip of a step is a function of the episode's layout seed and the clock.
    #[must_use]
    pub fn robot_motion(&self, wheels: &Motion, layout_seed: u64, clock: u64) -> Motion {
        let mut stream = stream(layout_seed, "slip", clock);
        let std = self.std.value();
        let mut kept = |slip: Ranged<f32>| (1.0 - slip.value() - std * normal(&mut stream)).clamp(0.0, 1.0);
        Motion { v_m_s: wheels.v_m_s * kept(self.forward), w_rad_s: wheels.w_rad_s * kept(self.turning) }
    }
}

impl OdometryDrift {
    /// The motion that odometry reports if the wheels have the motion `wheels`. If an error is given as a range, its middle
    /// is used.
    #[must_use]
    pub fn reported_motion(&self, wheels: &Motion) -> Motion {
        let v_m_s = wheels.v_m_s * (1.0 + self.distance_error.value());
        let rotation = wheels.w_rad_s * (1.0 + self.rotation_error.value());
        Motion { v_m_s, w_rad_s: rotation + wheels.v_m_s.abs() * self.heading_drift_rad_m.value() }
    }
}
