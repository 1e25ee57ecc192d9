//! Curves of several seeds, whose points need not have the same x.

use crate::statistics::{Estimate, band};

/// The number of points of a mean curve over seeds whose points have different x.
const POINTS: usize = 500;

/// The mean of several curves with its 95 % interval, as (x, estimate), where all curves have values.
///
/// Each curve must be sorted by x. If all have the same x up to the end of the shortest, the mean has these x, too; otherwise
/// the curves are interpolated linearly at evenly spaced x.
#[must_use]
pub fn mean_curve(curves: &[Vec<(f64, f64)>]) -> Vec<(f64, Estimate)> {
    let xs = common_xs(curves);
    let values: Vec<Vec<f64>> =
        curves.iter().map(|curve| xs.iter().map(|&x| value_at(curve, x)).collect()).collect();
    xs.into_iter().zip(band(&values)).collect()
}

fn common_xs(curves: &[Vec<(f64, f64)>]) -> Vec<f64> {
    let xs = |curve: &[(f64, f64)]| curve.iter().map(|point| point.0).collect::<Vec<_>>();
    let Some(shortest) = curves.iter().min_by_key(|curve| curve.len()).filter(|curve| !curve.is_empty())
    else {
        return Vec::new();
    };
    let same =
        |curve: &Vec<(f64, f64)>| curve.iter().zip(shortest).all(|(a, b)| a.0.to_bits() == b.0.to_bits());
    if curves.iter().all(same) {
        return xs(shortest);
    }
    let low = curves.iter().filter_map(|curve| Some(curve.first()?.0)).fold(f64::NEG_INFINITY, f64::max);
    let high = curves.iter().filter_map(|curve| Some(curve.last()?.0)).fold(f64::INFINITY, f64::min);
    if low > high {
        return Vec::new();
    }
    if low == high {
        return vec![low];
    }
    (0..POINTS).map(|i| low + (high - low) * i as f64 / (POINTS - 1) as f64).collect()
}

/// The value at `x` of `curve`, whose points are sorted by x, interpolated linearly between two points. Of several points at
/// the same x, the last counts. Outside the curve, it is the value at the nearest end. NaN for a curve without points.
#[must_use]
pub fn value_at(curve: &[(f64, f64)], x: f64) -> f64 {
    let next = curve.partition_point(|point| point.0 <= x);
    match (next.checked_sub(1).map(|last| curve[last]), curve.get(next)) {
        (Some((x0, y0)), Some(&(x1, y1))) => y0 + (y1 - y0) * (x - x0) / (x1 - x0),
        (Some((_, y)), None) | (None, Some(&(_, y))) => y,
        (None, None) => f64::NAN,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_with_the_same_x_are_averaged_point_by_point() {
        let curves = [vec![(1.0, 2.0), (2.0, 4.0), (3.0, 9.0)], vec![(1.0, 4.0), (2.0, 6.0)]];
        let mean = mean_curve(&curves);
        let points: Vec<_> = mean.iter().map(|(x, estimate)| (*x, estimate.mean)).collect();
        assert_eq!(points, [(1.0, 3.0), (2.0, 5.0)], "as long as the shorter curve");
        assert_eq!(mean[0].1.n, 2);
    }

    #[test]
    fn curves_with_different_x_are_averaged_where_both_have_values() {
        // y = x and y = 10 x, so the mean is 5.5 x, from 2 to 8.
        let curves =
            [vec![(0.0, 0.0), (8.0, 8.0)], vec![(2.0, 20.0), (2.0, 20.0), (5.0, 50.0), (10.0, 100.0)]];
        let mean = mean_curve(&curves);
        assert_eq!((mean.len(), mean[0].0, mean[POINTS - 1].0), (POINTS, 2.0, 8.0));
        for (x, estimate) in mean {
            assert!((estimate.mean - 5.5 * x).abs() < 1e-9, "{x}: {}", estimate.mean);
        }
        assert!(mean_curve(&[vec![(0.0, 1.0)], vec![(2.0, 1.0)]]).is_empty(), "no common x");
        assert!(mean_curve(&[vec![(0.0, 1.0)], Vec::new()]).is_empty());
        assert!(mean_curve(&[]).is_empty());
    }

    #[test]
    fn a_curve_has_values_between_its_points_and_keeps_those_of_its_ends() {
        let curve = [(0.0, 10.0), (0.0, 20.0), (10.0, 40.0)];
        let values = [-1.0, 0.0, 5.0, 10.0, 11.0].map(|x| value_at(&curve, x));
        assert_eq!(values, [10.0, 20.0, 30.0, 40.0, 40.0]);
        assert!(value_at(&[], 0.0).is_nan());
    }
}
