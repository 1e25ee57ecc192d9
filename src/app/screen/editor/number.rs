//! Numbers with units: conversion between stored and shown values, precision and range.

use std::f32::consts::TAU;
use std::ops::RangeInclusive;

use egui::{DragValue, Id, Response, Ui, vec2};

use super::controls::set_accessible_name;
use crate::scenario::Quantity;
use crate::scenario::limits::{COORDINATE_M, MAX_ANGULAR_SPEED_RAD_S, MAX_SPEED_M_S};

/// Width of a number's field, in points.
pub const WIDTH: f32 = 66.0;
/// Height of a row, in points.
pub const HEIGHT: f32 = 24.0;

const DEGREES: f64 = 180.0 / std::f64::consts::PI;

/// The unit, precision and range of a number.
#[derive(Clone, Copy, Debug)]
pub struct NumberSpec {
    suffix: &'static str,
    /// The shown value of a stored 1.
    factor: f64,
    /// Decimals of the stored value.
    stored: i32,
    /// Smallest and largest number of decimals of the shown value.
    shown: (usize, usize),
    /// Change of the stored value per dragged point.
    speed: f64,
    /// Smallest and largest stored value.
    range: (f32, f32),
}

impl NumberSpec {
    /// A coordinate, in m.
    pub const POSITION: Self = Self::length(COORDINATE_M);
    /// An angle, stored in rad and shown in degrees: a full turn either way.
    pub const ANGLE: Self =
        Self { suffix: "°", factor: DEGREES, stored: 4, shown: (0, 1), speed: 0.017, range: (-TAU, TAU) };
    /// A linear velocity, in m/s.
    pub const VELOCITY: Self =
        Self { suffix: " m/s", speed: 0.005, ..Self::length(-MAX_SPEED_M_S..=MAX_SPEED_M_S) };
    /// An angular velocity, stored in rad/s and shown in degrees per second.
    pub const ANGULAR_VELOCITY: Self = Self {
        suffix: " °/s",
        speed: 0.01,
        range: (-MAX_ANGULAR_SPEED_RAD_S, MAX_ANGULAR_SPEED_RAD_S),
        ..Self::ANGLE
    };
    /// A fraction, shown in percent.
    pub const FRACTION: Self =
        Self { suffix: "%", factor: 100.0, stored: 4, shown: (0, 2), speed: 0.005, range: (0.0, 1.0) };

    /// A length, in m.
    pub const fn length(range: RangeInclusive<f32>) -> Self {
        let range = (*range.start(), *range.end());
        Self { suffix: " m", factor: 1.0, stored: 3, shown: (2, 3), speed: 0.01, range }
    }

    /// A time, in s.
    pub const fn seconds(range: RangeInclusive<f32>) -> Self {
        Self { suffix: " s", shown: (1, 3), ..Self::length(range) }
    }

    /// An acceleration, in m/s^2.
    pub const fn acceleration(range: RangeInclusive<f32>) -> Self {
        Self { suffix: " m/s²", ..Self::length(range) }
    }

    /// A drift of the heading, in rad/m.
    pub const fn heading_drift(range: RangeInclusive<f32>) -> Self {
        Self { suffix: " rad/m", ..Self::length(range) }
    }

    /// An angular acceleration, in rad/s^2.
    pub const fn angular_acceleration(range: RangeInclusive<f32>) -> Self {
        Self { suffix: " rad/s²", ..Self::length(range) }
    }

    /// The spec of a field of a shape or a motion.
    pub fn of(quantity: Quantity) -> Self {
        let spec = match quantity {
            Quantity::Size | Quantity::Reach => Self::POSITION,
            Quantity::Speed => Self::VELOCITY,
            Quantity::AngularSpeed => Self::ANGULAR_VELOCITY,
        };
        spec.with_range(quantity.range())
    }

    /// This spec with another range of stored values.
    pub const fn with_range(self, range: RangeInclusive<f32>) -> Self {
        Self { range: (*range.start(), *range.end()), ..self }
    }
}

/// The name of a field for screen readers.
pub enum FieldName {
    /// The text of this label.
    Label(Id),
    /// This text.
    Text(String),
}

/// The events of a field in this frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FieldEvents {
    /// The value changed.
    pub changed: bool,
    /// The field lost the focus, or a drag of its value ended.
    pub edit_ended: bool,
}

impl FieldEvents {
    /// The events of either field.
    #[must_use]
    pub fn or(self, other: Self) -> Self {
        Self { changed: self.changed || other.changed, edit_ended: self.edit_ended || other.edit_ended }
    }
}

/// Shows the field of a number.
pub fn number_ui(ui: &mut Ui, name: FieldName, tip: &str, value: &mut f32, spec: NumberSpec) -> FieldEvents {
    let mut shown = f64::from(*value) * spec.factor;
    let before = shown;
    // A value out of range, which a file may contain, stays until it is changed.
    let (low, high) = (f64::from(spec.range.0) * spec.factor, f64::from(spec.range.1) * spec.factor);
    let (min, max) = (before.min(low), before.max(high));
    let field = DragValue::new(&mut shown)
        .speed(spec.speed * spec.factor)
        .range(min..=max)
        .clamp_existing_to_range(false)
        .custom_formatter(move |value, _| format_number(value, spec.shown))
        .suffix(spec.suffix);
    let response = named(ui.add_sized(vec2(WIDTH, HEIGHT), field), name);
    // When a field loses the focus, egui parses its text, which has fewer decimals than the stored value.
    let changed = format_number(shown, spec.shown) != format_number(before, spec.shown);
    if changed {
        let steps = 10_f64.powi(spec.stored);
        // Adding 0 turns -0 into 0.
        *value = ((shown / spec.factor * steps).round() / steps) as f32 + 0.0;
    }
    FieldEvents { changed, edit_ended: has_edit_ended(&with_tip(response, tip)) }
}

/// Shows the field of a whole number.
pub fn count_ui<T: egui::emath::Numeric>(
    ui: &mut Ui,
    name: FieldName,
    tip: &str,
    value: &mut T,
    range: RangeInclusive<T>,
) -> FieldEvents {
    let before = value.to_f64();
    let field = DragValue::new(value).range(range).clamp_existing_to_range(false).speed(0.1);
    let response = named(ui.add_sized(vec2(WIDTH, HEIGHT), field), name);
    let changed = value.to_f64() != before;
    FieldEvents { changed, edit_ended: has_edit_ended(&with_tip(response, tip)) }
}

/// The response of a field with a name for screen readers.
fn named(response: Response, name: FieldName) -> Response {
    match name {
        FieldName::Label(label) => response.labelled_by(label),
        FieldName::Text(text) => {
            set_accessible_name(&response, &text);
            response
        }
    }
}

/// A number with between `min` and `max` decimals, as many as it needs. If all digits are 0, it has no sign.
fn format_number(value: f64, (min, max): (usize, usize)) -> String {
    let mut text = format!("{value:.max$}");
    if text.starts_with('-') && text.trim_start_matches(['-', '0', '.']).is_empty() {
        text.remove(0);
    }
    for _ in min..max {
        match text.strip_suffix('0') {
            Some(shorter) => text.truncate(shorter.len()),
            None => return text,
        }
    }
    text.truncate(text.trim_end_matches('.').len());
    text
}

/// Whether the field lost the focus or a drag of its value ended.
pub fn has_edit_ended(response: &Response) -> bool {
    response.lost_focus() || response.drag_stopped()
}

/// The response, with a tooltip unless `tip` is empty.
pub fn with_tip(response: Response, tip: &str) -> Response {
    if tip.is_empty() { response } else { response.on_hover_text(tip) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_no_needless_decimals_or_signs() {
        assert_eq!(
            [0.15, 0.125, 4.0, -1.2].map(|value| format_number(value, (2, 3))),
            ["0.15", "0.125", "4.00", "-1.20"]
        );
        assert_eq!([30.0, 0.06, -85.94].map(|value| format_number(value, (0, 1))), ["30", "0.1", "-85.9"]);
        assert_eq!([100.0, 2.5, 0.0].map(|value| format_number(value, (0, 2))), ["100", "2.5", "0"]);
        assert_eq!([-0.0, -0.004, -0.006].map(|value| format_number(value, (0, 2))), ["0", "0", "-0.01"]);
    }
}
