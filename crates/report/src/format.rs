//! The format of numbers in reports and figures.

/// The maximum number of decimals.
pub(crate) const MAX_DECIMALS: usize = 15;

/// `value` with `decimals` decimals (at most 15), a true minus sign and thousands separated by commas. An en dash if
/// `value` is not finite.
///
/// ```
/// assert_eq!(wayfield_report::format::number(-1234.5, 1), "−1,234.5");
/// ```
#[must_use]
pub fn number(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "\u{2013}".to_owned();
    }
    let plain = format!("{:.*}", decimals.min(MAX_DECIMALS), value.abs());
    let whole = plain.find('.').unwrap_or(plain.len());
    let mut text = String::new();
    if value < 0.0 && !is_zero(&plain) {
        text.push('\u{2212}');
    }
    for (i, c) in plain.chars().enumerate() {
        if i > 0 && i < whole && (whole - i) % 3 == 0 {
            text.push(',');
        }
        text.push(c);
    }
    text
}

/// The text of a 95 % interval, to follow its mean: ` ± 0.8`, or ` (0.0 to 100.0)` if an end is cut at `limits`, the range of
/// possible values. Empty without a finite interval.
///
/// ```
/// use wayfield_report::format::interval;
/// assert_eq!(interval(99.4, Some(0.5), Some((0.0, 100.0)), 1), " ± 0.5");
/// assert_eq!(interval(62.5, Some(158.8), Some((0.0, 100.0)), 1), " (0.0 to 100.0)");
/// ```
#[must_use]
pub fn interval(mean: f64, half_width: Option<f64>, limits: Option<(f64, f64)>, decimals: usize) -> String {
    let Some(half) = half_width.map(f64::abs).filter(|half| mean.is_finite() && half.is_finite()) else {
        return String::new();
    };
    match cut(mean, half, limits) {
        Some([low, high]) => format!(" ({} to {})", number(low, decimals), number(high, decimals)),
        None => format!(" \u{b1} {}", number(half, decimals)),
    }
}

/// The ends of the interval of a mean, cut at `limits`; `None` if nothing is cut.
pub(crate) fn cut(mean: f64, half: f64, limits: Option<(f64, f64)>) -> Option<[f64; 2]> {
    let (low, high) = limits?;
    let is_cut = mean - half < low || mean + half > high;
    is_cut.then(|| [mean - half, mean + half].map(|end| end.max(low).min(high)))
}

/// A whole number with its noun, in the singular for 1.
///
/// ```
/// use wayfield_report::format::counted;
/// assert_eq!(counted(1.0, "episode"), "1 episode");
/// assert_eq!(counted(2000.0, "env step"), "2,000 env steps");
/// ```
#[must_use]
pub fn counted(value: f64, noun: &str) -> String {
    let count = number(value, 0);
    let plural = if count == "1" { "" } else { "s" };
    format!("{count} {noun}{plural}")
}

/// A fraction from 0 to 1 in percent, 0.987 as 98.7%. Rounded down, so that 100% means that nothing failed. An en dash if
/// `fraction` is not finite.
#[must_use]
pub fn percent(fraction: f64) -> String {
    let percent = (fraction * 1000.0 + 1e-9).floor() / 10.0;
    if percent.is_finite() {
        format!("{percent:.*}%", usize::from(percent != 100.0))
    } else {
        "\u{2013}".into()
    }
}

/// Whether all digits of a formatted number are 0.
pub(crate) fn is_zero(text: &str) -> bool {
    !text.bytes().any(|b| (b'1'..=b'9').contains(&b))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_a_true_minus_and_commas_between_thousands() {
        for (value, decimals, text) in [
            (0.0, 0, "0"),
            (-0.04, 1, "0.0"),
            (-0.05, 2, "\u{2212}0.05"),
            (999.9, 0, "1,000"),
            (-1_234_567.891, 2, "\u{2212}1,234,567.89"),
            (123.0, 1, "123.0"),
            (f64::NAN, 1, "\u{2013}"),
            (f64::NEG_INFINITY, 1, "\u{2013}"),
        ] {
            assert_eq!(number(value, decimals), text);
        }
        assert!(number(1.0, usize::MAX).starts_with("1.0"));
    }

    #[test]
    fn percentages_are_rounded_down() {
        assert_eq!(
            [0.0, 0.987, 0.9996, 1.0, f64::NAN].map(percent),
            ["0.0%", "98.7%", "99.9%", "100%", "\u{2013}"]
        );
    }
}
