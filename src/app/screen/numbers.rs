//! Number formatting for display: grouped, rounded and short, so that the width of a changing number stays
//! about the same.

/// A count with thousands separators (12,345); a million or more in short form (1.23M).
pub fn format_count(n: u64) -> String {
    if n >= 1_000_000 {
        let scaled = n as f64;
        return if n < 999_995_000 {
            format!("{:.2}M", scaled / 1e6)
        } else {
            format!("{:.2}G", scaled / 1e9)
        };
    }
    if n >= 1000 { format!("{},{:03}", n / 1000, n % 1000) } else { n.to_string() }
}

/// A number of episodes with its unit: 1 episode, 12,345 episodes.
pub fn format_episodes(count: u64) -> String {
    format!("{} {}", format_count(count), if count == 1 { "episode" } else { "episodes" })
}

/// A rate, rounded and formatted as by [`format_count`]; a dash if it is not finite.
pub fn format_rate(per_s: f64) -> String {
    if per_s.is_finite() { format_count(per_s.max(0.0).round() as u64) } else { "–".into() }
}

/// A factor: 0.4×, 12×, 1,200×.
pub fn format_factor(factor: f64) -> String {
    if factor.is_finite() && factor < 9.95 {
        format!("{:.1}×", factor.max(0.0))
    } else {
        format!("{}×", format_rate(factor))
    }
}

pub use crate::report::format::percent as format_percent;

/// A number with about three significant digits and a true minus sign.
#[must_use]
pub fn format_value(value: f32) -> String {
    format_decimals(value, decimals_for(value))
}

/// The number of decimals with which `value` has about three significant digits, at most 2.
#[must_use]
pub fn decimals_for(value: f32) -> usize {
    match value.abs() {
        size if size >= 99.95 => 0,
        size if size >= 9.995 => 1,
        _ => 2,
    }
}

/// A number with `decimals` decimals and a true minus sign; a rounded zero has no sign.
#[must_use]
pub fn format_decimals(value: f32, decimals: usize) -> String {
    let text = format!("{value:.decimals$}");
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| c == '0' || c == '.') => rest.to_owned(),
        Some(rest) => format!("\u{2212}{rest}"),
        None => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_grouped_and_short() {
        assert_eq!(
            [0, 999, 1000, 12_345, 999_999].map(format_count),
            ["0", "999", "1,000", "12,345", "999,999"]
        );
        assert_eq!([0, 1, 12_345].map(format_episodes), ["0 episodes", "1 episode", "12,345 episodes"]);
        assert_eq!([1_234_567, 999_999_999, 2_500_000_000].map(format_count), ["1.23M", "1.00G", "2.50G"]);
        assert_eq!([f64::NAN, -3.0, 1234.5].map(format_rate), ["–", "0", "1,235"]);
        assert_eq!([0.97, 12.4, 1234.0].map(format_factor), ["1.0×", "12×", "1,234×"]);
    }

    #[test]
    fn values_have_about_three_significant_digits() {
        assert_eq!(
            ["0.00", "\u{2212}1.25", "12.3", "100"],
            [-0.001, -1.25, 12.34, 99.96].map(format_value)[..]
        );
    }
}
