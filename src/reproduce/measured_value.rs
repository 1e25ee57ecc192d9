//! Measured values, which may be lower bounds.

/// The value of a measure for one seed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredValue {
    /// The value, in the measure's unit.
    pub value: f64,
    /// Whether the true value is larger: the run ended before the event, or every episode failed.
    pub is_lower_bound: bool,
}

impl MeasuredValue {
    /// A value that is not a bound.
    pub fn exact(value: f64) -> Self {
        Self { value, is_lower_bound: false }
    }
}

/// The values without their flags.
pub fn raw_values(values: &[MeasuredValue]) -> Vec<f64> {
    values.iter().map(|value| value.value).collect()
}
