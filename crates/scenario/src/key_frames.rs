//! Key frames: the position at a time, and the legs between the frames.
//!
//! In: the frames and the end of a [`KeyFrames`](super::ObstacleMotion::KeyFrames) motion, and the obstacle's position at time
//! 0. The arithmetic is f64.

use super::schema::{KeyFrame, KeyFrameEnd};
use glam::{DVec2, Vec2};

/// The path between two frames.
#[derive(Clone, Copy, Debug)]
pub(super) struct Leg {
    pub(super) length_m: f64,
    pub(super) duration_s: f64,
}

impl Leg {
    /// The speed in m/s, if the times are in order.
    pub(super) fn speed_m_s(self) -> Option<f64> {
        let speed_m_s = self.length_m / self.duration_s;
        (self.duration_s > 0.0 && speed_m_s.is_finite()).then_some(speed_m_s)
    }

    /// This leg and the next one combined.
    pub(super) fn then(self, next: Self) -> Self {
        Self { length_m: self.length_m + next.length_m, duration_s: self.duration_s + next.duration_s }
    }
}

/// The leg to each frame and, in a loop, the leg back to `start_m`.
pub(super) fn legs(start_m: Vec2, frames: &[KeyFrame], end: KeyFrameEnd) -> impl Iterator<Item = Leg> {
    let start = KeyFrame { time_s: 0.0, position_m: start_m };
    let back = match end {
        KeyFrameEnd::Stop => None,
        KeyFrameEnd::Loop { period_s } => Some(KeyFrame { time_s: period_s, position_m: start_m }),
    };
    let mut before = start;
    frames.iter().copied().chain(back).map(move |frame| {
        let from = std::mem::replace(&mut before, frame);
        Leg {
            length_m: from.position_m.as_dvec2().distance(frame.position_m.as_dvec2()),
            duration_s: f64::from(frame.time_s) - f64::from(from.time_s),
        }
    })
}

/// The position in m at `time_s`, which must be at least 0. It is meaningless if the frames are not in order.
pub(super) fn position_m(start_m: DVec2, frames: &[KeyFrame], end: KeyFrameEnd, time_s: f64) -> DVec2 {
    let time_s = match end {
        KeyFrameEnd::Stop => time_s,
        KeyFrameEnd::Loop { period_s } => libm::fmod(time_s, f64::from(period_s)),
    };
    let next = frames.partition_point(|frame| f64::from(frame.time_s) <= time_s);
    let at = |frame: &KeyFrame| (f64::from(frame.time_s), frame.position_m.as_dvec2());
    let (from_s, from) = next.checked_sub(1).and_then(|last| frames.get(last)).map_or((0.0, start_m), at);
    let (to_s, to) = match (frames.get(next), end) {
        (Some(frame), _) => at(frame),
        (None, KeyFrameEnd::Loop { period_s }) => (f64::from(period_s), start_m),
        (None, KeyFrameEnd::Stop) => return from,
    };
    from + (to - from) * ((time_s - from_s) / (to_s - from_s))
}

#[cfg(test)]
mod tests {
    use glam::{dvec2, vec2};

    use super::*;

    /// East, north, and a pause.
    fn frames() -> Vec<KeyFrame> {
        [(2.0, 4.0, 0.0), (3.0, 4.0, 3.0), (5.0, 4.0, 3.0)]
            .map(|(time_s, x, y)| KeyFrame { time_s, position_m: vec2(x, y) })
            .to_vec()
    }

    #[test]
    fn positions_are_linear_between_the_frames() {
        let stop = |time_s| position_m(DVec2::ZERO, &frames(), KeyFrameEnd::Stop, time_s);
        let looped =
            |time_s| position_m(DVec2::ZERO, &frames(), KeyFrameEnd::Loop { period_s: 10.0 }, time_s);
        for (time_s, x, y) in
            [(0.0, 0.0, 0.0), (0.5, 1.0, 0.0), (2.0, 4.0, 0.0), (2.5, 4.0, 1.5), (4.0, 4.0, 3.0)]
        {
            assert_eq!(stop(time_s), dvec2(x, y), "after {time_s} s");
            assert_eq!(looped(time_s), dvec2(x, y), "after {time_s} s");
            assert_eq!(looped(1e9 + time_s), dvec2(x, y), "in another round, {time_s} s");
        }
        assert_eq!(stop(7.5), dvec2(4.0, 3.0), "it stays at the last frame");
        assert_eq!(stop(1e12), dvec2(4.0, 3.0));
        assert_eq!(looped(7.5), dvec2(2.0, 1.5), "it is half-way back");
    }

    #[test]
    fn a_loop_has_one_more_leg() {
        let speeds = |end| legs(Vec2::ZERO, &frames(), end).map(Leg::speed_m_s).collect::<Vec<_>>();
        assert_eq!(speeds(KeyFrameEnd::Stop), [Some(2.0), Some(3.0), Some(0.0)]);
        let period_s = 10.0;
        assert_eq!(speeds(KeyFrameEnd::Loop { period_s }), [Some(2.0), Some(3.0), Some(0.0), Some(1.0)]);
        assert_eq!(speeds(KeyFrameEnd::Loop { period_s: 5.0 })[3], None, "the times are not in order");
    }
}
