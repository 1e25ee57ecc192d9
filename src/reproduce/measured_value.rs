//! Measured values, which may be lower bounds.

/// The value of a measure for one seed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredValue {
    /// The value, in the measure's unit.
    pub value: f64,
    /// Whether the true value is larger: training ended before it reached the goals per episode that the measure names, or every
    /// episode on the benchmark route failed.
    pub is_lower_bound: bool,
}

impl MeasuredValue {
    /// A value that is not a bound.
    pub fn exact(value: f64) -> Self {
        Self { value, is_lower_bound: false }
    }
}

/// The values of a measure for an arm, one for each of its seeds.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ArmValues {
    /// The seeds, in increasing order.
    pub seeds: Vec<u64>,
    /// The value of each seed.
    pub values: Vec<MeasuredValue>,
}

impl ArmValues {
    /// The values, whether or not they are lower bounds.
    pub fn raw(&self) -> Vec<f64> {
        self.values.iter().map(|value| value.value).collect()
    }

    /// The number of lower bounds.
    pub fn lower_bound_count(&self) -> usize {
        self.values.iter().filter(|value| value.is_lower_bound).count()
    }

    /// The value of `seed`.
    pub fn of_seed(&self, seed: u64) -> Option<&MeasuredValue> {
        self.seeds.iter().position(|&known| known == seed).map(|index| &self.values[index])
    }
}
