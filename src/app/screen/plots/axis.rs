//! Axes of the plots: grid lines at round values, tick labels, and number formats.

use egui_plot::GridMark;

use crate::app::history::DownsampledSeries;
use crate::app::screen::numbers;
use crate::report::format::number;

/// The scale of a y axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum AxisScale {
    /// A fraction from 0 to 1, shown in percent.
    Percent,
    /// A number from 0 to 1.
    Unit,
    /// Any number.
    Linear,
    /// Any number from 0 upwards.
    FromZero,
    /// A logarithmic axis: points are at the base-10 logarithms of their values, and labels show the values.
    Log10,
}

impl AxisScale {
    /// The fixed ends of the axis, if any; a little wider than the values, so that a line at an end is fully
    /// visible.
    #[must_use]
    pub fn fixed_range(self) -> Option<(f64, f64)> {
        match self {
            Self::Percent | Self::Unit => Some((-0.03, 1.05)),
            Self::Linear | Self::FromZero | Self::Log10 => None,
        }
    }

    /// Values that the axis must include: the reference line and, depending on the scale, 0 and 1, or the enclosing powers of
    /// ten.
    pub(super) fn included_values<'a>(
        self,
        series: impl Iterator<Item = &'a DownsampledSeries>,
        reference: Option<f64>,
    ) -> Vec<f64> {
        let mut values: Vec<_> = reference.into_iter().collect();
        match self {
            Self::FromZero => values.extend([0.0, 1.0]),
            Self::Log10 => {
                let points = series.flat_map(DownsampledSeries::points).map(|point| point.y);
                let (low, high) = points.fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), value| {
                    (low.min(value), high.max(value))
                });
                values.extend([low.floor(), high.ceil()].into_iter().filter(|end| end.is_finite()));
            }
            Self::Percent | Self::Unit | Self::Linear => {}
        }
        values
    }

    /// The grid lines of an axis over `bounds`.
    #[must_use]
    pub fn grid_marks(self, bounds: (f64, f64)) -> Vec<GridMark> {
        match self {
            Self::Percent | Self::Unit => {
                [0.0, 0.5, 1.0].map(|value| GridMark { value, step_size: 0.5 }).into()
            }
            Self::Linear | Self::FromZero => round_grid_marks(bounds, 3.0),
            Self::Log10 => {
                let step = ((bounds.1 - bounds.0) / 4.0).ceil().max(1.0);
                every(step, bounds)
            }
        }
    }

    /// The tick label of a grid line, where lines are `step` apart.
    #[must_use]
    pub fn tick_label(self, value: f64, step: f64) -> String {
        match self {
            Self::Percent => format!("{}%", number(100.0 * value, 0)),
            Self::Unit => number(value, if value.fract() == 0.0 { 0 } else { 1 }),
            Self::Linear | Self::FromZero => short(value, (-step.log10().floor()).clamp(0.0, 6.0) as usize),
            Self::Log10 => power(value.round()),
        }
    }

    /// The text of `value`, which is a logarithm on a log axis. `digits` is the number of decimals. On a log axis, it is the
    /// number of significant digits, but all digits before the decimal point are kept. In percent it has no effect.
    #[must_use]
    pub fn format_value(self, value: f64, digits: usize) -> String {
        match self {
            Self::Percent => numbers::format_percent(value),
            Self::Log10 => {
                let decimals = digits as f64 - 1.0 - value.floor();
                short(10.0_f64.powf(value), decimals.clamp(0.0, 9.0) as usize)
            }
            Self::Unit | Self::Linear | Self::FromZero => short(value, digits),
        }
    }
}

/// A number with `decimals` decimals; in scientific notation for a million or more, which occurs when learning diverges.
fn short(value: f64, decimals: usize) -> String {
    if value.abs() < 1e6 { number(value, decimals) } else { format!("{value:.1e}").replace('-', "\u{2212}") }
}

/// The tick label of 10 to the power of a whole number.
fn power(exponent: f64) -> String {
    if (-4.0..=5.0).contains(&exponent) {
        number(10.0_f64.powf(exponent), (-exponent).max(0.0) as usize)
    } else {
        format!("1e{}", number(exponent, 0))
    }
}

/// About `wanted` grid lines over `bounds`, at multiples of 1, 2 or 5 times a power of ten.
#[must_use]
pub fn round_grid_marks(bounds: (f64, f64), wanted: f64) -> Vec<GridMark> {
    let rough = (bounds.1 - bounds.0) / wanted;
    if !rough.is_finite() || rough <= 0.0 {
        return Vec::new();
    }
    let decade = 10.0_f64.powf(rough.log10().floor());
    let factor = match rough / decade {
        r if r < 1.5 => 1.0,
        r if r < 3.5 => 2.0,
        r if r < 7.5 => 5.0,
        _ => 10.0,
    };
    every(factor * decade, bounds)
}

/// All multiples of `step` within `bounds`, at most 50.
fn every(step: f64, bounds: (f64, f64)) -> Vec<GridMark> {
    let (first, last) = ((bounds.0 / step).ceil(), (bounds.1 / step).floor());
    let count = (last - first + 1.0).clamp(0.0, 50.0) as usize;
    (0..count).map(|index| GridMark { value: (first + index as f64) * step, step_size: step }).collect()
}

/// From this number of env steps on, the short form is in thousands: 1k.
const THOUSANDS_FROM: f64 = 999.5;
/// From this number of env steps on, the short form is in millions: 1M.
const MILLIONS_FROM: f64 = 999_950.0;

/// A number of env steps in short form: 800, 50k, 1.25M.
#[must_use]
pub fn format_env_steps(value: f64) -> String {
    let trimmed = |value: f64, unit: &str| {
        let text = format!("{value:.2}");
        format!("{}{unit}", text.trim_end_matches('0').trim_end_matches('.'))
    };
    match value.abs() {
        v if v < THOUSANDS_FROM => number(value, 0),
        v if v < MILLIONS_FROM => trimmed((value / 100.0).round() / 10.0, "k"),
        _ => trimmed(value / 1e6, "M"),
    }
}

/// The tick label of a grid line at `value` env steps, where lines are `step` apart: the short form, or more decimals if it
/// would give neighbouring lines the same label.
#[must_use]
pub fn env_steps_label(value: f64, step: f64) -> String {
    let (unit, suffix) = match value.abs() {
        v if v >= MILLIONS_FROM && step < 10_000.0 => (1e6, "M"),
        v if (THOUSANDS_FROM..MILLIONS_FROM).contains(&v) && step < 100.0 => (1e3, "k"),
        v if v < THOUSANDS_FROM && step < 1.0 => (1.0, ""),
        _ => return format_env_steps(value),
    };
    let decimals = (unit / step).log10().ceil().clamp(0.0, 9.0) as usize;
    format!("{}{suffix}", number(value / unit, decimals))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn env_steps_have_a_short_form() {
        let written = [0.0, 224.0, 999.4, 1000.0, 50_000.0, 96_140.0, 999_960.0, 1_200_000.0, 1_250_000.0]
            .map(format_env_steps);
        assert_eq!(written, ["0", "224", "999", "1k", "50k", "96.1k", "1M", "1.2M", "1.25M"]);
    }

    #[test]
    fn neighbouring_grid_lines_have_different_labels_at_any_zoom() {
        for (lines, step, labels) in [
            ([50_000.0, 100_000.0], 50_000.0, ["50k", "100k"]),
            ([50_000.0, 50_020.0], 20.0, ["50.00k", "50.02k"]),
            ([1_000_000.0, 1_001_000.0], 1000.0, ["1.000M", "1.001M"]),
            ([3.0, 3.2], 0.2, ["3.0", "3.2"]),
            ([1_000_000.0, 1_000_000.2], 0.2, ["1.0000000M", "1.0000002M"]),
        ] {
            assert_eq!(lines.map(|value| env_steps_label(value, step)), labels);
        }
    }

    #[test]
    fn grid_lines_are_few_and_round() {
        let values = |bounds| round_grid_marks(bounds, 4.0).iter().map(|mark| mark.value).collect::<Vec<_>>();
        assert_eq!(values((0.0, 300_000.0)), [0.0, 100_000.0, 200_000.0, 300_000.0]);
        assert_eq!(values((-400.0, 3300.0)), [0.0, 1000.0, 2000.0, 3000.0]);
        assert_eq!(values((1.0, 1.0)), [0.0; 0]);
        assert_eq!(values((f64::NAN, 1.0)), [0.0; 0]);
        for exponent in -12..12 {
            for start in 1..100 {
                let high = f64::from(start) * 10.0_f64.powi(exponent);
                assert!((2..=7).contains(&values((0.0, high)).len()), "0 to {high}");
            }
        }
    }

    #[test]
    fn values_are_formatted_by_their_scale() {
        let percent = [0.0, 0.9996, 1.0].map(|rate| AxisScale::Percent.format_value(rate, 0));
        assert_eq!(percent, ["0.0%", "99.9%", "100%"]);
        let logs =
            [0.000_453_f64, 0.0489, 1.27, 133.0].map(|value| AxisScale::Log10.format_value(value.log10(), 2));
        assert_eq!(logs, ["0.00045", "0.049", "1.3", "133"]);
        assert_eq!(
            [-4.0, 0.0, 3.0].map(|value| AxisScale::Log10.tick_label(value, 1.0)),
            ["0.0001", "1", "1,000"]
        );
        assert_eq!([0.0, 0.5, 1.0].map(|value| AxisScale::Unit.tick_label(value, 0.5)), ["0", "0.5", "1"]);
        assert_eq!(AxisScale::Linear.tick_label(-0.4, 0.2), "\u{2212}0.4");
        assert_eq!(AxisScale::Linear.format_value(3.21e12, 2), "3.2e12");
        assert_eq!(AxisScale::Log10.format_value(30.0, 2), "1.0e30");
    }
}
