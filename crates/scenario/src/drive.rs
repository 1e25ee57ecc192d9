//! The response of the robot's drive to its commands: actuator lag and limited accelerations.
//!
//! In: the actual motion at the start of a control step, and the commanded one. Out: the mean motion over the step, and the
//! motion at its end. The simulation and the classical drivers both use it.

use super::schema::{Motion, Robot};

/// The drive over steps of a given duration. v and w respond independently: each approaches its command u* as
/// du/dt = (u* - u) / lag, but not faster than its acceleration limit allows. Without lag and limits, the robot drives the
/// commanded motion, bit for bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Drive {
    lag_s: f32,
    seconds: f32,
    /// The mean difference from the command over the step, as a fraction of the difference at the step's start, without
    /// acceleration limits; 0 to 1.
    mean: f32,
    /// The difference from the command at the step's end, as a fraction of the difference at the step's start, without
    /// acceleration limits; 0 to 1.
    end: f32,
    max_acceleration_m_s2: f32,
    max_angular_acceleration_rad_s2: f32,
}

impl Robot {
    /// The drive over steps of `seconds`, above 0 s; if the actuator lag is a range, with the middle of it.
    #[must_use]
    pub fn drive(&self, seconds: f32) -> Drive {
        let drive = Drive {
            lag_s: self.actuator_lag_s.value(),
            seconds,
            mean: 0.0,
            end: 0.0,
            max_acceleration_m_s2: self.max_acceleration_m_s2.unwrap_or(f32::INFINITY),
            max_angular_acceleration_rad_s2: self.max_angular_acceleration_rad_s2.unwrap_or(f32::INFINITY),
        };
        drive.over(seconds)
    }
}

impl Drive {
    /// The same drive over steps of `seconds`, above 0 s.
    #[must_use]
    pub fn over(self, seconds: f32) -> Self {
        if self.lag_s <= 0.0 {
            return Self { seconds, mean: 0.0, end: 0.0, ..self };
        }
        // With du/dt = (commanded - u) / lag, the difference decays as e^(-t / lag). Its mean over T seconds is
        // (lag / T)(1 - e^(-T / lag)) of the initial difference.
        let lags = seconds / self.lag_s;
        Self { seconds, mean: -libm::expm1f(-lags) / lags, end: libm::expf(-lags), ..self }
    }

    /// An upper bound on the time, in s, that v takes to change by `change_m_s`; if there is a lag, by 95 % of it.
    #[must_use]
    pub fn settling_time_s(&self, change_m_s: f32) -> f32 {
        3.0 * self.lag_s + change_m_s.abs() / self.max_acceleration_m_s2
    }

    /// The mean motion over a step that starts with the motion `actual` while `commanded` is commanded, and the motion at its
    /// end.
    #[must_use]
    pub fn step(&self, actual: &Motion, commanded: &Motion) -> (Motion, Motion) {
        let (mean_v, end_v) = self.respond(actual.v_m_s, commanded.v_m_s, self.max_acceleration_m_s2);
        let (mean_w, end_w) =
            self.respond(actual.w_rad_s, commanded.w_rad_s, self.max_angular_acceleration_rad_s2);
        (Motion { v_m_s: mean_v, w_rad_s: mean_w }, Motion { v_m_s: end_v, w_rad_s: end_w })
    }

    /// The mean of one speed over the step, and the speed at its end. `max_rate` is its highest acceleration.
    fn respond(&self, actual: f32, commanded: f32, max_rate: f32) -> (f32, f32) {
        let difference = actual - commanded;
        if max_rate == f32::INFINITY {
            // Without a lag, returns exactly the commanded value, including the sign of a zero.
            let blend = |remaining: f32| {
                if remaining == 0.0 { commanded } else { commanded + difference * remaining }
            };
            return (blend(self.mean), blend(self.end));
        }
        // First the difference shrinks at the highest rate, until the lag asks for less; then it decays.
        let at_limit_s = (difference.abs() / max_rate - self.lag_s).clamp(0.0, self.seconds);
        let then = (difference.abs() - max_rate * at_limit_s).max(0.0);
        let left_s = self.seconds - at_limit_s;
        let (integral, last) = if self.lag_s > 0.0 {
            let lags = left_s / self.lag_s;
            (-then * self.lag_s * libm::expm1f(-lags), then * libm::expf(-lags))
        } else {
            (0.0, if left_s > 0.0 { 0.0 } else { then })
        };
        let mean = (0.5 * (difference.abs() + then) * at_limit_s + integral) / self.seconds;
        let speed = |difference_left: f32| {
            if difference_left == 0.0 { commanded } else { commanded + difference_left.copysign(difference) }
        };
        (speed(mean), speed(last))
    }
}
