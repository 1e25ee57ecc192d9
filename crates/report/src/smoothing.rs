//! Smoothing of noisy series.

/// The trailing moving mean: element `i` is the mean of `values[i]` and up to `window` - 1 values before it.
///
/// The result has the length of `values`. A window of 0 counts as 1.
#[must_use]
pub fn moving_mean(values: &[f64], window: usize) -> Vec<f64> {
    let mean_up_to = |end: usize| {
        let recent = &values[end.saturating_sub(window.max(1))..end];
        recent.iter().sum::<f64>() / recent.len() as f64
    };
    (1..=values.len()).map(mean_up_to).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_moving_mean_covers_each_value_and_those_before_it() {
        assert_eq!(moving_mean(&[2.0, 4.0, 9.0, 5.0], 2), [2.0, 3.0, 6.5, 7.0]);
        assert_eq!(moving_mean(&[2.0, 4.0, 9.0], 10), [2.0, 3.0, 5.0]);
        assert_eq!(moving_mean(&[2.0, 4.0], 0), [2.0, 4.0]);
        assert!(moving_mean(&[], 3).is_empty());
    }
}
