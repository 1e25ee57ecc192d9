//! Smoothing of noisy series.

/// The mean of each value and the `window` - 1 values before it; near the start, of as many as there are.
///
/// The result is as long as `values`. A window of 0 counts as 1.
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
    fn the_moving_mean_covers_the_values_up_to_each_one() {
        assert_eq!(moving_mean(&[2.0, 4.0, 9.0, 5.0], 2), [2.0, 3.0, 6.5, 7.0]);
        assert_eq!(moving_mean(&[2.0, 4.0, 9.0], 10), [2.0, 3.0, 5.0]);
        assert_eq!(moving_mean(&[2.0, 4.0], 0), [2.0, 4.0]);
        assert!(moving_mean(&[], 3).is_empty());
    }
}
