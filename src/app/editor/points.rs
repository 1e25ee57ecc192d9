//! Positions, lengths and angles as the editor stores and shows them: lengths to 1 mm, angles to 0.0001 rad, so that
//! files stay readable.

use std::f32::consts::{PI, TAU};

use bevy::math::{Vec2, vec2};

use crate::scenario::Scenario;

/// `value` rounded to a multiple of `1 / steps`, without a negative zero.
fn round_to(value: f32, steps: f64) -> f32 {
    ((f64::from(value) * steps).round() / steps) as f32 + 0.0
}

/// A length in m, rounded to 1 mm.
pub(super) fn to_mm(length_m: f32) -> f32 {
    round_to(length_m, 1000.0)
}

/// A position in m, rounded to 1 mm.
pub(super) fn point_to_mm(Vec2 { x, y }: Vec2) -> Vec2 {
    vec2(to_mm(x), to_mm(y))
}

/// An angle in rad, wrapped to [-π, π] and rounded to four decimals.
pub(super) fn to_angle(angle_rad: f32) -> f32 {
    let wrapped = if angle_rad.abs() <= PI { angle_rad } else { angle_rad - (angle_rad / TAU).round() * TAU };
    round_to(wrapped, 10_000.0)
}

/// The distance between two points, in m, with the precision of `hypot`.
pub(super) fn distance(a: Vec2, b: Vec2) -> f32 {
    (a.x - b.x).hypot(a.y - b.y)
}

/// The centre of the enclosure's bounding box, in m.
pub(super) fn centre_of(scenario: &Scenario) -> Vec2 {
    let (low, high) = scenario.enclosure.bounds_m();
    low.midpoint(high)
}

/// A translated and rotated coordinate frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalFrame {
    origin: Vec2,
    sin: f32,
    cos: f32,
}

impl LocalFrame {
    pub fn new(origin: Vec2, rotation_rad: f32) -> Self {
        // Angles have four decimals; without this, a quarter turn would leave tiny coordinates.
        let (sin, cos) = rotation_rad.sin_cos();
        let tidy = |value: f32| if value.abs() < 1e-4 { 0.0 } else { value };
        Self { origin, sin: tidy(sin), cos: tidy(cos) }
    }

    /// A local point in world coordinates.
    pub fn to_world(self, Vec2 { x, y }: Vec2) -> Vec2 {
        self.origin + vec2(x * self.cos - y * self.sin, x * self.sin + y * self.cos)
    }

    /// A world point in local coordinates.
    pub fn to_local(self, point: Vec2) -> Vec2 {
        let Vec2 { x, y } = point - self.origin;
        vec2(x * self.cos + y * self.sin, y * self.cos - x * self.sin)
    }
}

/// A length in m with two decimals, or three where the third is not zero.
#[must_use]
pub fn format_metres(length_m: f32) -> String {
    let text = format!("{:.3}", to_mm(length_m));
    text.strip_suffix('0').map_or(text.clone(), str::to_owned)
}

/// A position as `x, y m`.
pub(super) fn place_text(Vec2 { x, y }: Vec2) -> String {
    format!("{}, {} m", format_metres(x), format_metres(y))
}

/// A size as `w × h m`.
pub(super) fn size_text(size_m: Vec2) -> String {
    format!("{} × {} m", format_metres(size_m.x), format_metres(size_m.y))
}

/// An angle in degrees with at most one decimal.
pub(super) fn degrees_text(angle_rad: f32) -> String {
    format!("{}°", round_to(angle_rad.to_degrees(), 10.0))
}

#[cfg(test)]
#[expect(clippy::approx_constant, reason = "angles are stored with four decimals")]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_rounded_to_millimetres_and_angles_to_four_decimals() {
        assert_eq!([0.123_456, -0.000_4, 2.999_9].map(to_mm), [0.123, 0.0, 3.0]);
        assert!(to_mm(-0.000_4).is_sign_positive(), "no -0.0 in files");
        assert_eq!(to_angle(PI / 6.0), 0.5236);
        assert_eq!(to_angle(-PI / 2.0 - TAU), -1.5708, "wrapped to half a turn");
        assert_eq!(to_angle(1.5 * PI), -1.5708);
    }

    #[test]
    fn numbers_have_no_needless_decimals() {
        assert_eq!([0.15, 0.125, 3.0, -0.5].map(format_metres), ["0.15", "0.125", "3.00", "-0.50"]);
        assert_eq!(size_text(vec2(0.6, 0.4)), "0.60 × 0.40 m");
        assert_eq!([0.5236, -1.5708, 0.0].map(degrees_text), ["30°", "-90°", "0°"]);
    }

    #[test]
    fn world_and_local_coordinates_convert_both_ways() {
        let frame = LocalFrame::new(vec2(1.0, 2.0), 1.5708);
        assert_eq!(
            frame.to_world(vec2(0.5, 0.25)),
            vec2(0.75, 2.5),
            "a quarter turn: x points up, y to the left"
        );
        assert_eq!(frame.to_local(vec2(0.75, 2.5)), vec2(0.5, 0.25));
    }
}
