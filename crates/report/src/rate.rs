//! Rates over episodes, with 95 % confidence intervals (Wilson's).

/// The 0.975 quantile of the standard normal distribution.
const NORMAL_QUANTILE: f64 = 1.959_963_984_540_054;

/// Wilson's 95 % score interval `[low, high]` of a rate, given `hits` successes in `n` independent trials. It lies within
/// 0 to 1 and has a positive width even if all trials agree. Without trials it is `[0, 1]`.
///
/// Source: E. B. Wilson, *Probable inference, the law of succession, and statistical inference*, JASA 22 (1927).
#[must_use]
pub fn rate_interval(hits: usize, n: usize) -> [f64; 2] {
    if n == 0 {
        return [0.0, 1.0];
    }
    let (hits, n) = (hits.min(n) as f64, n as f64);
    let (rate, square) = (hits / n, NORMAL_QUANTILE * NORMAL_QUANTILE / n);
    let centre = (rate + square / 2.0) / (1.0 + square);
    let half_width = (rate * (1.0 - rate) * square + square * square / 4.0).sqrt() / (1.0 + square);
    let low = if hits == 0.0 { 0.0 } else { (centre - half_width).max(0.0) };
    let high = if hits == n { 1.0 } else { (centre + half_width).min(1.0) };
    [low, high]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn near(x: f64, expected: f64) {
        assert!((x - expected).abs() < 5e-5, "{x} instead of {expected}");
    }

    /// Newcombe (Statistics in Medicine 17, 1998, table I) gives Wilson's intervals of 81/263, 15/148, 0/20 and 1/29.
    #[test]
    fn a_rate_has_wilsons_interval_within_0_and_1() {
        for (hits, n, low, high) in [
            (81, 263, 0.2553, 0.3662),
            (15, 148, 0.0624, 0.1605),
            (0, 20, 0.0, 0.1611),
            (20, 20, 0.8389, 1.0),
            (1, 29, 0.0061, 0.1718),
        ] {
            let [found_low, found_high] = rate_interval(hits, n);
            near(found_low, low);
            near(found_high, high);
        }
        for n in 0..40 {
            for hits in 0..=n {
                let [low, high] = rate_interval(hits, n);
                let rate = if n == 0 { 0.5 } else { hits as f64 / n as f64 };
                assert!(
                    0.0 <= low && low <= rate && rate <= high && high <= 1.0,
                    "{hits}/{n}: {low}, {high}"
                );
                assert!(low < high, "{hits}/{n}");
            }
        }
    }
}
