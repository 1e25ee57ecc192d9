//! Numbers that a scenario may give as ranges, from which each episode draws (domain randomization).
//!
//! In: a [`Scenario`] with ranges, and a layout seed. Out: the scenario of one episode, which has only numbers
//! ([`Scenario::with_drawn_numbers`]). The same seed gives the same numbers on every platform.

use std::fmt;
use std::marker::PhantomData;

use serde::de::{Error, SeqAccess, Unexpected, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use wayfield_random::{Stream, stream, uniform, uniform_index};

use super::schema::{ObstacleMotion, OdometryDrift, Scenario, Slip};

/// A number, or a range from which each episode draws a number, uniformly. In a file: `0.1`, or `(0.0, 0.2)` for the lowest and
/// the highest number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Ranged<T> {
    /// The same number in every episode.
    Number(T),
    /// The lowest and the highest number.
    Range(T, T),
}

/// A type of number that may be given as a range.
pub trait RangeNumber: Copy + PartialOrd + fmt::Display {
    /// The number midway between `low` and `high`, rounded down if it must be whole.
    #[must_use]
    fn middle(low: Self, high: Self) -> Self;

    /// A uniform draw from `low` to `high`.
    #[must_use]
    fn draw(stream: &mut Stream, low: Self, high: Self) -> Self;

    /// Converts a number in a file to this type; `None` if that is impossible.
    #[must_use]
    fn from_f64(number: f64) -> Option<Self>;
}

impl RangeNumber for f32 {
    fn middle(low: Self, high: Self) -> Self {
        low + 0.5 * (high - low)
    }

    fn draw(stream: &mut Stream, low: Self, high: Self) -> Self {
        // Rounding may give more than the highest number.
        uniform(stream, low, high).min(high)
    }

    fn from_f64(number: f64) -> Option<Self> {
        Some(number as Self)
    }
}

impl RangeNumber for u32 {
    fn middle(low: Self, high: Self) -> Self {
        low + high.saturating_sub(low) / 2
    }

    fn draw(stream: &mut Stream, low: Self, high: Self) -> Self {
        low + uniform_index(stream, high.saturating_sub(low) as usize + 1) as Self
    }

    fn from_f64(number: f64) -> Option<Self> {
        // A number that is too large becomes the largest one, which no field allows.
        (number >= 0.0 && number.fract() == 0.0).then_some(number as Self)
    }
}

impl<T: RangeNumber> Ranged<T> {
    /// The number, or the middle of the range. The scenario of an episode has no ranges.
    #[inline]
    #[must_use]
    pub fn value(self) -> T {
        match self {
            Self::Number(value) => value,
            Self::Range(low, high) => T::middle(low, high),
        }
    }

    /// The lowest and the highest number.
    #[must_use]
    pub fn ends(self) -> [T; 2] {
        match self {
            Self::Number(value) => [value; 2],
            Self::Range(low, high) => [low, high],
        }
    }

    /// Whether it is a range.
    #[must_use]
    pub fn is_range(self) -> bool {
        matches!(self, Self::Range(..))
    }

    /// Replaces a range by a number that is drawn from the stream with this `name` and `index`.
    fn draw(&mut self, layout_seed: u64, name: &str, index: u64) {
        if let Self::Range(low, high) = *self {
            *self = Self::Number(T::draw(&mut stream(layout_seed, name, index), low, high));
        }
    }
}

impl<T> From<T> for Ranged<T> {
    fn from(number: T) -> Self {
        Self::Number(number)
    }
}

impl<T: fmt::Display> fmt::Display for Ranged<T> {
    /// As in a file.
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(value) => value.fmt(to),
            Self::Range(low, high) => write!(to, "({low}, {high})"),
        }
    }
}

impl<T: Serialize> Serialize for Ranged<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        match self {
            Self::Number(value) => value.serialize(serializer),
            Self::Range(low, high) => (low, high).serialize(serializer),
        }
    }
}

impl<'de, T: RangeNumber + Deserialize<'de>> Deserialize<'de> for Ranged<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_any(RangedVisitor(PhantomData))
    }
}

struct RangedVisitor<T>(PhantomData<T>);

impl<'de, T: RangeNumber + Deserialize<'de>> Visitor<'de> for RangedVisitor<T> {
    type Value = Ranged<T>;

    fn expecting(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        let number = if T::from_f64(0.5).is_some() { "a number" } else { "a non-negative whole number" };
        write!(to, "{number}, or a range (lowest, highest)")
    }

    fn visit_f64<E: Error>(self, number: f64) -> Result<Self::Value, E> {
        let value = T::from_f64(number).ok_or_else(|| E::invalid_type(Unexpected::Float(number), &self))?;
        Ok(Ranged::Number(value))
    }

    fn visit_i64<E: Error>(self, number: i64) -> Result<Self::Value, E> {
        self.visit_f64(number as f64)
    }

    fn visit_u64<E: Error>(self, number: u64) -> Result<Self::Value, E> {
        self.visit_f64(number as f64)
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut numbers: A) -> Result<Self::Value, A::Error> {
        let low = numbers.next_element()?.ok_or_else(|| A::Error::invalid_length(0, &self))?;
        let high = numbers.next_element()?.ok_or_else(|| A::Error::invalid_length(1, &self))?;
        Ok(Ranged::Range(low, high))
    }
}

impl ObstacleMotion {
    /// The speed as the scenario gives it, a number or a range, in m/s or rad/s; `None` if the motion has none.
    pub(super) fn given_speed_mut(&mut self) -> Option<&mut Ranged<f32>> {
        match self {
            Self::Static | Self::KeyFrames { .. } => None,
            Self::Orbit { speed_rad_s: speed, .. }
            | Self::Patrol { speed_m_s: speed, .. }
            | Self::BackAndForth { speed_m_s: speed, .. }
            | Self::RandomWalk { speed_m_s: speed, .. }
            | Self::Pedestrian { speed_m_s: speed, .. } => Some(speed),
        }
    }

    /// The speed as the scenario gives it, a number or a range, in m/s or rad/s; `None` if the motion has none.
    #[must_use]
    pub fn given_speed(&self) -> Option<Ranged<f32>> {
        match *self {
            Self::Static | Self::KeyFrames { .. } => None,
            Self::Orbit { speed_rad_s: speed, .. }
            | Self::Patrol { speed_m_s: speed, .. }
            | Self::BackAndForth { speed_m_s: speed, .. }
            | Self::RandomWalk { speed_m_s: speed, .. }
            | Self::Pedestrian { speed_m_s: speed, .. } => Some(speed),
        }
    }
}

impl OdometryDrift {
    fn has_ranges(&self) -> bool {
        [self.distance_error, self.rotation_error, self.heading_drift_rad_m]
            .iter()
            .any(|error| error.is_range())
    }
}

impl Scenario {
    /// Whether any number is given as a range.
    #[must_use]
    pub fn has_ranges(&self) -> bool {
        let Self { robot, lidar, .. } = self;
        let Slip { forward, turning, std } = robot.slip.unwrap_or_default();
        [robot.actuator_lag_s, forward, turning, std, lidar.noise_std_m, lidar.dropout]
            .iter()
            .any(|number| number.is_range())
            || robot.odometry_drift.is_some_and(|drift| drift.has_ranges())
            || lidar.latency_steps.is_range()
            || self.obstacles.iter().any(|o| o.motion.given_speed().is_some_and(Ranged::is_range))
    }

    /// Whether every episode has a layout of its own: generated obstacles, numbers that are drawn from ranges, or random slip.
    #[must_use]
    pub fn varies_by_episode(&self) -> bool {
        !self.generators.is_empty()
            || self.has_ranges()
            || self.robot.slip.is_some_and(|slip| slip.std.ends() != [0.0; 2])
    }

    /// The scenario with each range replaced by a number that is drawn with `layout_seed`. Each range has its own random
    /// stream, so that adding or removing one does not change the numbers drawn from the others.
    #[must_use]
    pub(super) fn with_drawn_numbers(&self, layout_seed: u64) -> Self {
        let mut drawn = self.clone();
        if !self.has_ranges() {
            return drawn;
        }
        let Self { robot, lidar, obstacles, .. } = &mut drawn;
        robot.actuator_lag_s.draw(layout_seed, "range: actuator lag", 0);
        if let Some(slip) = &mut robot.slip {
            slip.forward.draw(layout_seed, "range: forward slip", 0);
            slip.turning.draw(layout_seed, "range: turning slip", 0);
            slip.std.draw(layout_seed, "range: slip from step to step", 0);
        }
        if let Some(drift) = &mut robot.odometry_drift {
            drift.distance_error.draw(layout_seed, "range: distance error", 0);
            drift.rotation_error.draw(layout_seed, "range: rotation error", 0);
            drift.heading_drift_rad_m.draw(layout_seed, "range: heading drift", 0);
        }
        lidar.noise_std_m.draw(layout_seed, "range: noise", 0);
        lidar.dropout.draw(layout_seed, "range: dropout", 0);
        lidar.latency_steps.draw(layout_seed, "range: latency", 0);
        for (k, obstacle) in (0..).zip(obstacles) {
            if let Some(speed) = obstacle.motion.given_speed_mut() {
                speed.draw(layout_seed, "range: obstacle speed", k);
            }
        }
        drawn
    }
}
