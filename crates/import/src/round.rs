//! Rounding to tenths of a millimetre, so that numbers in a scenario file are short.

use glam::{DVec2, Vec2, vec2};

/// `value` in m, rounded to tenths of a millimetre.
pub fn metres(value: f64) -> f32 {
    // Adding 0 turns -0 into 0.
    ((value * 1e4).round() / 1e4 + 0.0) as f32
}

/// A point in m, rounded.
pub fn point(value: DVec2) -> Vec2 {
    vec2(metres(value.x), metres(value.y))
}
