//! Points and lengths as the editor writes them: in millimetres, so that files stay readable; angles to 0.0001 rad.
//!
//! In: what the pointer or a number field says. Out: what goes into the scenario, and what is written beside a handle.

use std::f32::consts::{PI, TAU};

use bevy::math::{Vec2, vec2};

/// The least size that a drag leaves, in m.
pub(super) const MIN_SIZE_M: f32 = 0.01;

/// `value` as `steps` to one, without a negative zero.
fn to_steps(value: f32, steps: f64) -> f32 {
    ((f64::from(value) * steps).round() / steps) as f32 + 0.0
}

/// A length in m, to the millimetre.
pub(super) fn to_mm(length_m: f32) -> f32 {
    to_steps(length_m, 1000.0)
}

/// A place, to the millimetre.
pub(super) fn point_to_mm(Vec2 { x, y }: Vec2) -> Vec2 {
    vec2(to_mm(x), to_mm(y))
}

/// An angle in rad within half a turn of 0, to the fourth decimal.
pub(super) fn to_angle(angle_rad: f32) -> f32 {
    let within = if angle_rad.abs() <= PI { angle_rad } else { angle_rad - (angle_rad / TAU).round() * TAU };
    to_steps(within, 10_000.0)
}

/// Whether it is a place at all.
pub(super) fn is_finite(Vec2 { x, y }: Vec2) -> bool {
    x.is_finite() && y.is_finite()
}

pub(super) fn plus(a: Vec2, b: Vec2) -> Vec2 {
    vec2(a.x + b.x, a.y + b.y)
}

pub(super) fn minus(a: Vec2, b: Vec2) -> Vec2 {
    vec2(a.x - b.x, a.y - b.y)
}

pub(super) fn middle(a: Vec2, b: Vec2) -> Vec2 {
    vec2((a.x + b.x) / 2.0, (a.y + b.y) / 2.0)
}

pub(super) fn distance(a: Vec2, b: Vec2) -> f32 {
    (a.x - b.x).hypot(a.y - b.y)
}

/// A frame of its own: moved and turned in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct LocalFrame {
    at: Vec2,
    sin: f32,
    cos: f32,
}

impl LocalFrame {
    pub fn new(at: Vec2, turn_rad: f32) -> Self {
        // To the quarter turn exact, as far as four decimals say it.
        let (sin, cos) = turn_rad.sin_cos();
        let tidy = |value: f32| if value.abs() < 1e-4 { 0.0 } else { value };
        Self { at, sin: tidy(sin), cos: tidy(cos) }
    }

    /// Its point in the world.
    pub fn to_world(self, Vec2 { x, y }: Vec2) -> Vec2 {
        plus(self.at, self.rotate(vec2(x, y)))
    }

    /// Its direction in the world.
    pub fn rotate(self, Vec2 { x, y }: Vec2) -> Vec2 {
        vec2(x * self.cos - y * self.sin, x * self.sin + y * self.cos)
    }

    /// A point of the world, as it sees it.
    pub fn to_local(self, point: Vec2) -> Vec2 {
        let Vec2 { x, y } = minus(point, self.at);
        vec2(x * self.cos + y * self.sin, y * self.cos - x * self.sin)
    }
}

/// A length, or a coordinate, as it is written: two decimals, and a third where there is one.
#[must_use]
pub fn format_metres(length_m: f32) -> String {
    let text = format!("{:.3}", to_mm(length_m));
    text.strip_suffix('0').map_or(text.clone(), str::to_owned)
}

/// `x, y m`.
pub(super) fn place_text(Vec2 { x, y }: Vec2) -> String {
    format!("{}, {} m", format_metres(x), format_metres(y))
}

/// `w × h m`.
pub(super) fn size_text(width_m: f32, height_m: f32) -> String {
    format!("{} × {} m", format_metres(width_m), format_metres(height_m))
}

/// An angle in degrees, to the tenth.
pub(super) fn degrees_text(angle_rad: f32) -> String {
    format!("{}°", to_steps(angle_rad.to_degrees(), 10.0))
}

#[cfg(test)]
#[expect(clippy::approx_constant, reason = "angles as a file has them, to four decimals")]
mod tests {
    use super::*;

    #[test]
    fn lengths_are_millimetres_and_angles_four_decimals() {
        assert_eq!([0.123_456, -0.000_4, 2.999_9].map(to_mm), [0.123, 0.0, 3.0]);
        assert!(to_mm(-0.000_4).is_sign_positive(), "a file has no -0.0");
        assert_eq!(to_angle(PI / 6.0), 0.5236);
        assert_eq!(to_angle(-PI / 2.0 - TAU), -1.5708, "a turn less is the same direction");
        assert_eq!(to_angle(1.5 * PI), -1.5708);
    }

    #[test]
    fn numbers_are_written_short() {
        assert_eq!([0.15, 0.125, 3.0, -0.5].map(format_metres), ["0.15", "0.125", "3.00", "-0.50"]);
        assert_eq!(size_text(0.6, 0.4), "0.60 × 0.40 m");
        assert_eq!([0.5236, -1.5708, 0.0].map(degrees_text), ["30°", "-90°", "0°"]);
    }

    #[test]
    fn a_frame_goes_there_and_back() {
        let frame = LocalFrame::new(vec2(1.0, 2.0), 1.5708);
        assert_eq!(
            frame.to_world(vec2(0.5, 0.25)),
            vec2(0.75, 2.5),
            "a quarter turn: x goes up, y to the left"
        );
        assert_eq!(frame.to_local(vec2(0.75, 2.5)), vec2(0.5, 0.25));
    }
}
