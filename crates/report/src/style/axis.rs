//! Axes: ranges, ticks and tick labels.

use std::ops::Range;

use crate::format::number;

/// The range of an axis and the distance between its ticks, which lie at multiples of that distance.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Axis {
    pub(crate) range: Range<f64>,
    pub(crate) step: f64,
}

impl Axis {
    /// An axis from the smallest to the largest value with about `count` ticks. It starts at 0 if the smallest value
    /// is positive and less than a tenth of the largest.
    pub(crate) fn within(values: impl Iterator<Item = f64>, count: f64) -> Self {
        Self::within_limits(values, None, count)
    }

    /// Like [`within`](Self::within), but not beyond `limits`, the range of possible values, unless all values lie beyond them.
    pub(crate) fn within_limits(
        values: impl Iterator<Item = f64>,
        limits: Option<(f64, f64)>,
        count: f64,
    ) -> Self {
        let bounds = bounds(values);
        let limited = limits.map(|(least, most)| (bounds.0.max(least), bounds.1.min(most)));
        let (low, high) = limited.filter(|(low, high)| low < high).unwrap_or(bounds);
        let low = if low > 0.0 && low < 0.1 * high { 0.0 } else { low };
        Self { range: low..high, step: nice_step((high - low) / count) }
    }

    /// The ticks in the range; none if it contains no multiple of the distance.
    pub(crate) fn ticks(&self) -> Vec<f64> {
        let first = (self.range.start / self.step - 1e-6).ceil();
        let last = (self.range.end / self.step + 1e-6).floor();
        (0..(last - first + 1.0) as u32).map(|i| (first + f64::from(i)) * self.step).collect()
    }

    /// The text of a tick, with as many decimals as the tick distance needs.
    pub(crate) fn label(&self, tick: f64) -> String {
        let digits = (-self.step.log10().floor()).clamp(0.0, 6.0) as usize;
        let digits = if self.step * 10_f64.powi(digits as i32) % 1.0 > 1e-6 { digits + 1 } else { digits };
        number(tick, digits)
    }

    /// The pixel of a value on an axis that is drawn between two pixels. Values outside the range are clamped to it.
    pub(crate) fn pixel(&self, value: f64, (from, to): (i32, i32)) -> i32 {
        let fraction = (value - self.range.start) / (self.range.end - self.range.start);
        from + (fraction.clamp(0.0, 1.0) * f64::from(to - from)).round() as i32
    }
}

/// The smallest and the largest value; 0 and 1 if there are no values. Almost equal bounds are moved apart.
pub(crate) fn bounds(values: impl Iterator<Item = f64>) -> (f64, f64) {
    let (low, high) = values.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(x), h.max(x)));
    if low > high {
        return (0.0, 1.0);
    }
    let size = high.abs().max(low.abs());
    if high - low <= size * 1e-6 {
        let margin = size.max(1.0) * 0.5;
        return (low - margin, high + margin);
    }
    (low, high)
}

/// Whether a value is finite and small enough to be drawn.
pub(crate) fn is_drawable(value: f64) -> bool {
    value.abs() < 1e12
}

/// The smallest of 1, 2, 2.5 and 5 times a power of ten that is at least `minimum`.
fn nice_step(minimum: f64) -> f64 {
    let power = 10_f64.powf(minimum.log10().floor());
    let mut steps = [1.0, 2.0, 2.5, 5.0].into_iter().map(|factor| factor * power);
    steps.find(|&step| step >= minimum * 0.999).unwrap_or(10.0 * power)
}

/// At most `max` (2 or more) of the points, evenly spaced by index; the first and the last are kept.
pub(crate) fn thinned<T: Clone>(points: &[T], max: usize) -> Vec<T> {
    if points.len() <= max {
        return points.to_vec();
    }
    (0..max).map(|i| points[i * (points.len() - 1) / (max - 1)].clone()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_labelled_with_the_decimals_they_need() {
        assert_eq!(Axis::within([-20.0, 71.0].into_iter(), 4.0).ticks(), [0.0, 25.0, 50.0]);
        assert!(
            Axis::within([-7.5].into_iter(), 4.0).ticks().len() >= 3,
            "a constant gets a range around it"
        );
        assert!(Axis { range: 1.0..3.0, step: 10.0 }.ticks().is_empty(), "no tick is outside the range");
        let labels = |axis: Axis| axis.ticks().into_iter().map(|t| axis.label(t)).collect::<Vec<_>>();
        assert_eq!(labels(Axis { range: 0.0..0.5, step: 0.25 }), ["0.00", "0.25", "0.50"]);
        assert_eq!(labels(Axis { range: -2500.0..0.0, step: 2500.0 }), ["\u{2212}2,500", "0"]);
    }

    #[test]
    fn an_axis_starts_at_zero_if_its_values_start_close_to_zero() {
        assert_eq!(Axis::within([1.0, 1500.0].into_iter(), 6.0).range, 0.0..1500.0);
        assert_eq!(Axis::within([1000.0, 1500.0].into_iter(), 6.0).range, 1000.0..1500.0);
        assert_eq!(Axis::within([].into_iter(), 6.0).range, 0.0..1.0);
    }

    #[test]
    fn an_axis_stays_within_the_limits_unless_all_values_are_outside() {
        let counts = |values: &[f64]| {
            Axis::within_limits(values.iter().copied(), Some((0.0, f64::INFINITY)), 5.0).range
        };
        assert_eq!(counts(&[0.0, 0.0]), 0.0..0.5, "a constant gets a range above it only");
        assert_eq!(counts(&[-3.0, 8.0]), 0.0..8.0);
        let percent = Axis::within_limits([100.0].into_iter(), Some((0.0, 100.0)), 5.0);
        assert_eq!(percent.range, 50.0..100.0);
        assert_eq!(counts(&[-3.0, -2.0]), -3.0..-2.0, "impossible values are shown rather than hidden");
    }

    #[test]
    fn values_outside_the_range_are_clamped_to_the_axis() {
        let axis = Axis { range: 0.0..10.0, step: 5.0 };
        assert_eq!([-1.0, 0.0, 5.0, 99.0].map(|x| axis.pixel(x, (300, 100))), [300, 300, 200, 100]);
    }

    #[test]
    fn thinning_keeps_both_ends() {
        let points: Vec<u32> = (0..1000).collect();
        let few = thinned(&points, 10);
        assert_eq!((few.len(), few[0], few[9]), (10, 0, 999));
        assert_eq!(thinned(&points[..3], 10), [0, 1, 2]);
    }
}
