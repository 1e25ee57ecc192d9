//! Checks that a number is in its range, with one wording for all errors.

use std::fmt::Display;
use std::ops::{Bound, RangeBounds};

/// The error of a value that is out of range.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("`{field}` {problem}")]
pub struct ConfigError {
    /// The name of the value, such as `network.hidden[1]` or `replay.capacity`.
    pub field: String,
    /// The problem and the fix, as the rest of a sentence that begins with `field`.
    pub problem: String,
}

/// Checks that `value` is in `range`. NaN is in no range with a bound.
///
/// # Errors
/// `value` is out of range. The error names `field` and the range.
pub fn within<T: PartialOrd + Display>(
    field: &str,
    value: T,
    range: impl RangeBounds<T>,
) -> Result<(), ConfigError> {
    if range.contains(&value) {
        return Ok(());
    }
    let allowed = match (range.start_bound(), range.end_bound()) {
        (Bound::Included(low), Bound::Included(high)) => format!("{low} to {high}"),
        (Bound::Included(low), Bound::Excluded(high)) => format!("at least {low} and less than {high}"),
        (Bound::Included(low), Bound::Unbounded) => format!("at least {low}"),
        (Bound::Excluded(low), Bound::Included(high)) => format!("a number above {low}, at most {high}"),
        (Bound::Excluded(low), Bound::Excluded(high)) => {
            format!("a number above {low} and less than {high}")
        }
        (Bound::Excluded(low), Bound::Unbounded) => format!("a number above {low}"),
        (Bound::Unbounded, Bound::Included(high)) => format!("at most {high}"),
        (Bound::Unbounded, Bound::Excluded(high)) => format!("less than {high}"),
        (Bound::Unbounded, Bound::Unbounded) => "a number".into(),
    };
    Err(ConfigError { field: field.into(), problem: format!("is {value}; help: give {allowed}") })
}

/// Checks that `value` is a finite number above 0.
///
/// # Errors
/// `value` is out of range. The error names `field`.
pub fn above_zero(field: &str, value: f32) -> Result<(), ConfigError> {
    if value > 0.0 && value.is_finite() {
        return Ok(());
    }
    let problem = format!("is {value}; help: give a finite number above 0");
    Err(ConfigError { field: field.into(), problem })
}

/// Checks that `value` is above 0 and at most `max`. NaN is not.
///
/// # Errors
/// `value` is out of range. The error names `field` and the range.
pub fn within_above_zero(field: &str, value: f32, max: f32) -> Result<(), ConfigError> {
    within(field, value, (Bound::Excluded(0.0), Bound::Included(max)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_error_names_the_value_and_the_range() {
        let problem = |checked: Result<(), ConfigError>| checked.expect_err("out of range").to_string();
        assert_eq!(problem(within("layers", 9, 1..=8)), "`layers` is 9; help: give 1 to 8");
        assert_eq!(problem(within("every", 0_u64, 1..)), "`every` is 0; help: give at least 1");
        assert_eq!(
            problem(within("beta", 1.0, 0.0..1.0)),
            "`beta` is 1; help: give at least 0 and less than 1"
        );
        assert_eq!(problem(within("arenas", 9, ..9)), "`arenas` is 9; help: give less than 9");
        assert_eq!(problem(within("gamma", f32::NAN, 0.0..=1.0)), "`gamma` is NaN; help: give 0 to 1");
        for value in [0.0, -1.0, f32::NAN, f32::INFINITY] {
            assert_eq!(
                problem(above_zero("tau", value)),
                format!("`tau` is {value}; help: give a finite number above 0")
            );
        }
        for value in [0.0, 1.5, f32::NAN] {
            assert_eq!(
                problem(within_above_zero("tau", value, 1.0)),
                format!("`tau` is {value}; help: give a number above 0, at most 1")
            );
        }
        assert_eq!(within_above_zero("tau", 1.0, 1.0), Ok(()));
        assert_eq!(within("gamma", 1.0, 0.0..=1.0).and(above_zero("tau", 1e-30)), Ok(()));
    }
}
