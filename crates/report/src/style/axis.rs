//! Axes: what they span, where their ticks are, and how numbers are written.
//!
//! In: the values to be shown. Out: round ticks around them, and their text.

use std::ops::Range;

use crate::table::number;

/// What an axis spans, and the distance of its ticks (which lie at whole multiples of it).
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Axis {
    pub range: Range<f64>,
    pub step: f64,
}

impl Axis {
    /// Around all values, from a tick to a tick at least `least_step` apart, about four of them.
    pub fn around(values: impl Iterator<Item = f64>, least_step: f64) -> Self {
        let (low, high) = bounds(values);
        let step = nice_step((high - low) / 4.0).max(least_step);
        Self { range: (low / step).floor() * step..(high / step).ceil() * step, step }
    }

    /// From the least to the greatest value, about `count` ticks between; from 0 if that is not far off.
    pub fn within(values: impl Iterator<Item = f64>, count: f64) -> Self {
        let (low, high) = bounds(values);
        let low = if low > 0.0 && low < 0.1 * high { 0.0 } else { low };
        Self { range: low..high, step: nice_step((high - low) / count) }
    }

    pub fn ticks(&self) -> Vec<f64> {
        let first = (self.range.start / self.step - 1e-6).ceil();
        let last = (self.range.end / self.step + 1e-6).floor();
        (0..=(last - first) as u32).map(|i| (first + f64::from(i)) * self.step).collect()
    }

    /// A tick's text: as many decimals as the ticks need, a true minus, thousands set apart.
    pub fn label(&self, tick: f64) -> String {
        let digits = (-self.step.log10().floor()).clamp(0.0, 6.0) as usize;
        let digits = if self.step * 10_f64.powi(digits as i32) % 1.0 > 1e-6 { digits + 1 } else { digits };
        number(tick, digits)
    }

    /// Where a value lies between two places; one beyond the axis lies at its end.
    pub fn place(&self, value: f64, (from, to): (i32, i32)) -> i32 {
        let share = (value - self.range.start) / (self.range.end - self.range.start);
        from + (share.clamp(0.0, 1.0) * f64::from(to - from)).round() as i32
    }
}

/// The least and the greatest value, moved apart where they are all but the same; 0 and 1 of no values.
pub(crate) fn bounds(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    if low > high {
        return (0.0, 1.0);
    }
    let size = high.abs().max(low.abs());
    if high - low <= size * 1e-6 {
        let room = size.max(1.0) * 0.5;
        return (low - room, high + room);
    }
    (low, high)
}

/// Whether a value can be drawn at all.
pub(crate) fn is_drawable(value: f64) -> bool {
    value.abs() < 1e12
}

/// The smallest of 1, 2, 2.5, 5 times a power of ten that is not under `least`.
pub(crate) fn nice_step(least: f64) -> f64 {
    let power = 10_f64.powf(least.log10().floor());
    [1.0, 2.0, 2.5, 5.0].into_iter().map(|m| m * power).find(|&s| s >= least * 0.999).unwrap_or(10.0 * power)
}

/// At most `most` (2 or more) of the points, evenly taken, the first and the last among them.
pub(crate) fn thinned<T: Clone>(points: &[T], most: usize) -> Vec<T> {
    if points.len() <= most {
        return points.to_vec();
    }
    (0..most).map(|i| points[i * (points.len() - 1) / (most - 1)].clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_enclose_the_values() {
        let axis = Axis::around([-13.0, 71.0].into_iter(), 0.0);
        assert_eq!(axis.ticks(), [-25.0, 0.0, 25.0, 50.0, 75.0]);
        let axis = Axis::around([2.0, 0.0, 1.0].into_iter(), 1.0);
        assert_eq!(axis.ticks(), [0.0, 1.0, 2.0], "counts have whole ticks");
        let constant = Axis::around([-7.5].into_iter(), 0.0);
        assert!(constant.ticks().len() >= 3, "a constant has room");
        let labels = |axis: Axis| axis.ticks().into_iter().map(|t| axis.label(t)).collect::<Vec<_>>();
        assert_eq!(labels(Axis { range: 0.0..0.5, step: 0.25 }), ["0.00", "0.25", "0.50"]);
        assert_eq!(labels(Axis { range: -2500.0..0.0, step: 2500.0 }), ["\u{2212}2,500", "0"]);
    }

    #[test]
    fn an_axis_within_its_values_begins_at_zero_if_that_is_near() {
        assert_eq!(Axis::within([1.0, 1500.0].into_iter(), 6.0).range, 0.0..1500.0);
        assert_eq!(Axis::within([1000.0, 1500.0].into_iter(), 6.0).range, 1000.0..1500.0);
        assert_eq!(Axis::within([].into_iter(), 6.0).range, 0.0..1.0);
    }

    #[test]
    fn places_are_on_the_axis() {
        let axis = Axis { range: 0.0..10.0, step: 5.0 };
        assert_eq!([-1.0, 0.0, 5.0, 99.0].map(|x| axis.place(x, (300, 100))), [300, 300, 200, 100]);
    }

    #[test]
    fn thinning_keeps_both_ends() {
        let points: Vec<u32> = (0..1000).collect();
        let few = thinned(&points, 10);
        assert_eq!((few.len(), few[0], few[9]), (10, 0, 999));
        assert_eq!(thinned(&points[..3], 10), [0, 1, 2]);
    }
}
