//! Means over several seeds, with 95 % confidence intervals.
//!
//! Intervals of means use Student's t distribution, because there are few seeds and their variance is estimated from the same
//! values. Results are in the unit of the values.

use statrs::distribution::{ContinuousCDF, StudentsT};

/// A mean with its 95 % confidence interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// The mean, in the values' unit.
    pub mean: f64,
    /// Half the width of the interval, in the values' unit; `None` for a single value.
    pub half_width: Option<f64>,
    /// The number of values: of both sides together for [`difference`], of pairs for [`paired_difference`].
    pub n: usize,
}

impl Estimate {
    /// The mean of `values` and its interval, by Student's t with n - 1 degrees of freedom.
    ///
    /// `None` without values, or if one of them is not finite.
    #[must_use]
    pub fn from_values(values: &[f64]) -> Option<Self> {
        let sample = Sample::of(values)?;
        let half_width = sample.error2().map(|error2| half_width(error2, sample.n - 1.0));
        Some(Self { mean: sample.mean, half_width, n: values.len() })
    }

    /// Lower end of the interval, in the values' unit; the mean itself if there is no interval.
    #[must_use]
    pub fn low(&self) -> f64 {
        self.mean - self.half_width.unwrap_or(0.0)
    }

    /// Upper end of the interval, in the values' unit; the mean itself if there is no interval.
    #[must_use]
    pub fn high(&self) -> f64 {
        self.mean + self.half_width.unwrap_or(0.0)
    }
}

/// mean(a) - mean(b) with Welch's interval: the sides may differ in size and in variance.
///
/// The half width is `None` if either side is a single value. The result is `None` if a side is empty or has a value
/// that is not finite.
#[must_use]
pub fn difference(a: &[f64], b: &[f64]) -> Option<Estimate> {
    let (n, a, b) = (a.len() + b.len(), Sample::of(a)?, Sample::of(b)?);
    let half_width = a.error2().zip(b.error2()).map(|(of_a, of_b)| {
        let both = of_a + of_b;
        if both == 0.0 {
            return 0.0;
        }
        // Welch and Satterthwaite: (va + vb)^2 / (va^2 / (na - 1) + vb^2 / (nb - 1)), with va and vb as fractions of their sum.
        let (a_fraction, b_fraction) = (of_a / both, of_b / both);
        let freedom = 1.0 / (a_fraction * a_fraction / (a.n - 1.0) + b_fraction * b_fraction / (b.n - 1.0));
        half_width(both, freedom)
    });
    Some(Estimate { mean: a.mean - b.mean, half_width, n })
}

/// The mean of a - b over pairs, such as two algorithms with the same seeds, with Student's interval of the differences.
///
/// `None` without pairs, if the sides differ in length, or if a value is not finite.
#[must_use]
pub fn paired_difference(a: &[f64], b: &[f64]) -> Option<Estimate> {
    let differences: Vec<f64> = a.iter().zip(b).map(|(a, b)| a - b).collect();
    (a.len() == b.len()).then(|| Estimate::from_values(&differences)).flatten()
}

/// With fewer seeds than this, [`small_sample_note`] warns.
pub const MIN_SEEDS: usize = 5;

/// A note that `n` seeds are too few, such as "n = 2 says little: ...". `None` if `n` is 0, or at least [`MIN_SEEDS`].
#[must_use]
pub fn small_sample_note(n: usize) -> Option<String> {
    let advice = format!("Use at least {MIN_SEEDS} seeds");
    match n {
        0 => None,
        1 => Some(format!("n = 1 says nothing about other seeds: there is no interval. {advice}.")),
        n if n < MIN_SEEDS => {
            let quantile =
                StudentsT::new(0.0, 1.0, n as f64 - 1.0).map_or(f64::NAN, |t| t.inverse_cdf(0.975));
            Some(format!(
                "n = {n} says little: a 95 % interval is {quantile:.1} standard errors on each side (2.0 with many seeds), \
                 and the spread is itself a guess from {n} values. {advice}."
            ))
        }
        _ => None,
    }
}

/// The estimate at each index over all curves, up to the length of the shortest curve.
///
/// Where a value is not finite, the mean is NaN.
#[must_use]
pub fn band(curves: &[Vec<f64>]) -> Vec<Estimate> {
    let unknown = Estimate { mean: f64::NAN, half_width: None, n: curves.len() };
    let length = curves.iter().map(Vec::len).min().unwrap_or(0);
    let at = |i: usize| curves.iter().map(|curve| curve[i]).collect::<Vec<_>>();
    (0..length).map(|i| Estimate::from_values(&at(i)).unwrap_or(unknown)).collect()
}

/// The statistics of one sample that the formulas need.
struct Sample {
    n: f64,
    mean: f64,
    /// The sum of squared deviations from the mean.
    squares: f64,
}

impl Sample {
    fn of(values: &[f64]) -> Option<Self> {
        if values.is_empty() || values.iter().any(|x| !x.is_finite()) {
            return None;
        }
        let n = values.len() as f64;
        let mean = values.iter().sum::<f64>() / n;
        Some(Self { n, mean, squares: values.iter().map(|x| (x - mean).powi(2)).sum() })
    }

    /// The squared standard error of the mean: variance / n. `None` for a single value.
    fn error2(&self) -> Option<f64> {
        (self.n > 1.0).then(|| self.squares / (self.n - 1.0) / self.n)
    }
}

/// Half the width of the 95 % interval of a mean with the squared standard error `error2` and `freedom` degrees of freedom.
fn half_width(error2: f64, freedom: f64) -> f64 {
    // There is at least 1 degree of freedom: two values have n - 1 = 1, and Welch's formula gives at least the smaller n - 1.
    let quantile = StudentsT::new(0.0, 1.0, freedom).map_or(f64::INFINITY, |t| t.inverse_cdf(0.975));
    if error2 == 0.0 { 0.0 } else { quantile * error2.sqrt() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(x: f64, expected: f64) {
        assert!((x - expected).abs() < 5e-5, "{x} instead of {expected}");
    }

    /// Squared deviations from 3 are 4 1 0 1 4, together 10; variance 10 / 4 = 2.5, sd 1.5811; standard error
    /// 1.5811 / sqrt 5 = 0.7071; t(0.975, 4) = 2.7764; 2.7764 * 0.7071 = 1.9632.
    #[test]
    fn a_mean_has_students_interval() {
        let estimate = Estimate::from_values(&[1.0, 2.0, 3.0, 4.0, 5.0]).expect("five values");
        near(estimate.mean, 3.0);
        near(estimate.half_width.expect("five values"), 1.9632);
        near(estimate.low(), 1.0368);
        near(estimate.high(), 4.9632);
        assert_eq!(estimate.n, 5);
    }

    /// t(0.975) is 12.7062, 2.2622 and 2.0452 for 1, 9 and 29 degrees of freedom. For n values, half of them 1 and half
    /// of them -1, the squares add up to n, so the standard error is 1 / sqrt(n - 1).
    #[test]
    fn quantiles_match_the_t_table() {
        for (n, t) in [(2_u32, 12.7062), (10, 2.2622), (30, 2.0452)] {
            let values: Vec<_> = (0..n).map(|i| if i % 2 == 0 { 1.0 } else { -1.0 }).collect();
            let half_width = Estimate::from_values(&values).and_then(|e| e.half_width).expect("many values");
            near(half_width * f64::from(n - 1).sqrt(), t);
        }
    }

    #[test]
    fn single_equal_and_non_finite_values() {
        assert_eq!(Estimate::from_values(&[]), None);
        assert_eq!(Estimate::from_values(&[1.0, f64::NAN]), None);
        let one = Estimate::from_values(&[7.0]).expect("one value");
        assert_eq!((one.half_width, one.low(), one.high(), one.n), (None, 7.0, 7.0, 1));
        assert_eq!(Estimate::from_values(&[2.0, 2.0, 2.0]).and_then(|e| e.half_width), Some(0.0));
    }

    /// a: mean 10, squared deviations 4 4 16, variance 24 / 2 = 12, divided by n: 12 / 3 = 4.
    /// b: mean 5, squared deviations 16 4 0 4 16, variance 40 / 4 = 10, divided by n: 10 / 5 = 2.
    /// Standard error sqrt(4 + 2) = 2.44949; degrees of freedom 6^2 / (4^2 / 2 + 2^2 / 4) = 36 / 9 = 4;
    /// t(0.975, 4) = 2.77645; half width 2.77645 * 2.44949 = 6.80087.
    #[test]
    fn a_difference_has_welchs_interval() {
        let (a, b) = ([12.0, 12.0, 6.0], [1.0, 3.0, 5.0, 7.0, 9.0]);
        let estimate = difference(&a, &b).expect("values on both sides");
        near(estimate.mean, 5.0);
        near(estimate.half_width.expect("several values"), 6.8009);
        assert_eq!(estimate.n, 8);
        let swapped = difference(&b, &a).expect("values on both sides");
        near(swapped.mean, -5.0);
        assert_eq!(swapped.half_width, estimate.half_width);
    }

    /// Only a varies: variance 2, divided by n: 2 / 2 = 1; degrees of freedom 1^2 / (1^2 / 1) = 1, t 12.7062, half width the same.
    #[test]
    fn differences_of_single_and_equal_values() {
        near(difference(&[1.0, 3.0], &[5.0; 3]).and_then(|e| e.half_width).expect("enough"), 12.7062);
        assert_eq!(difference(&[1.0; 2], &[5.0; 3]).and_then(|e| e.half_width), Some(0.0));
        assert_eq!(difference(&[1.0], &[5.0, 6.0]), Some(Estimate { mean: -4.5, half_width: None, n: 3 }));
        assert_eq!(difference(&[], &[1.0]), None);
        assert_eq!(difference(&[1.0], &[f64::INFINITY]), None);
    }

    /// Differences 1, 2, 3: mean 2, sd 1, half width t(0.975, 2) / sqrt 3 = 4.3027 / 1.7321 = 2.4841. The values of each
    /// side spread ten times as much.
    #[test]
    fn a_paired_difference_has_the_interval_of_the_differences() {
        let (a, b) = ([11.0, 22.0, 33.0], [10.0, 20.0, 30.0]);
        let estimate = paired_difference(&a, &b).expect("three pairs");
        near(estimate.mean, 2.0);
        near(estimate.half_width.expect("three pairs"), 2.4841);
        assert_eq!(estimate.n, 3);
        let welch = difference(&a, &b).and_then(|e| e.half_width).expect("three values each");
        assert!(welch > 20.0, "without pairing, the spread of the seeds hides the difference: {welch}");
        assert_eq!(paired_difference(&a, &b[..2]), None);
        assert_eq!(paired_difference(&[], &[]), None);
    }

    #[test]
    fn small_samples_say_little() {
        assert!(small_sample_note(1).is_some_and(|note| note.starts_with("n = 1 says nothing")));
        assert!(
            small_sample_note(2)
                .is_some_and(|note| note.starts_with("n = 2 says little: a 95 % interval is 12.7 "))
        );
        assert_eq!((small_sample_note(0), small_sample_note(5)), (None, None));
    }

    #[test]
    fn a_band_is_as_long_as_the_shortest_curve() {
        let curves = [vec![1.0, 4.0, 0.0], vec![3.0, 4.0], vec![2.0, f64::NAN]];
        let band = band(&curves);
        assert_eq!(band.len(), 2);
        assert_eq!(Some(band[0]), Estimate::from_values(&[1.0, 3.0, 2.0]));
        assert!(band[1].mean.is_nan());
        assert!(super::band(&[]).is_empty());
    }
}
