//! Series: curves of any length in a bounded number of points.
//!
//! In: rows of an x and a value, one at a time. Out: points to draw. A [`DownsampledSeries`] keeps at most
//! [`MAX_POINTS`] buckets. Each covers the same number of rows (the last one possibly fewer) and stores
//! their mean, minimum and maximum. When all are full, neighbours are merged in pairs, and a bucket then covers
//! twice as many rows. The curve keeps its whole length, and a day of training takes no more memory or drawing
//! time than a minute.

use std::collections::VecDeque;

use egui_plot::PlotPoint;

use crate::report::run_figure::{MAX_SINGLE_EPISODES, MEAN_EPISODES};

/// The maximum number of points of a series. It is even, so that full buckets merge in pairs.
pub const MAX_POINTS: usize = MAX_SINGLE_EPISODES;
/// The window of a moving average, in episodes; shorter at the start of training.
pub const MOVING_AVERAGE_EPISODES: usize = MEAN_EPISODES;

/// A curve of at most [`MAX_POINTS`] points.
#[derive(Clone, Debug, PartialEq)]
pub struct DownsampledSeries {
    /// The mean x and the mean value of each bucket.
    means: Vec<PlotPoint>,
    lows: Vec<f64>,
    highs: Vec<f64>,
    /// Rows in a full bucket.
    stride: u64,
    /// Rows in the last bucket.
    filled: u64,
    latest: Option<PlotPoint>,
}

impl Default for DownsampledSeries {
    fn default() -> Self {
        Self { means: Vec::new(), lows: Vec::new(), highs: Vec::new(), stride: 1, filled: 0, latest: None }
    }
}

impl DownsampledSeries {
    /// Adds a row. Non-finite values are ignored. An x smaller than the latest is replaced by the latest, so
    /// that points stay in order.
    pub fn push(&mut self, x: f64, value: f64) {
        if !x.is_finite() || !value.is_finite() {
            return;
        }
        let x = self.latest.map_or(x, |latest| latest.x.max(x));
        self.latest = Some(PlotPoint::new(x, value));
        if self.means.is_empty() || self.filled == self.stride {
            if self.means.len() == MAX_POINTS {
                self.merge();
            }
            self.filled = 0;
            self.means.push(PlotPoint::new(x, value));
            self.lows.push(value);
            self.highs.push(value);
        }
        self.filled += 1;
        let (Some(mean), Some(low), Some(high)) =
            (self.means.last_mut(), self.lows.last_mut(), self.highs.last_mut())
        else {
            return;
        };
        mean.x += (x - mean.x) / self.filled as f64;
        mean.y += (value - mean.y) / self.filled as f64;
        *low = low.min(value);
        *high = high.max(value);
    }

    /// Merges the buckets in pairs; all of them must be full.
    fn merge(&mut self) {
        let midpoint = |a: f64, b: f64| a + (b - a) / 2.0;
        merge_pairs(&mut self.means, |a, b| PlotPoint::new(midpoint(a.x, b.x), midpoint(a.y, b.y)));
        merge_pairs(&mut self.lows, f64::min);
        merge_pairs(&mut self.highs, f64::max);
        self.stride *= 2;
    }

    /// The mean x and mean value of each bucket, in order of x.
    #[must_use]
    pub fn points(&self) -> &[PlotPoint] {
        &self.means
    }

    /// The minimum of each bucket.
    #[must_use]
    pub fn lows(&self) -> &[f64] {
        &self.lows
    }

    /// The maximum of each bucket.
    #[must_use]
    pub fn highs(&self) -> &[f64] {
        &self.highs
    }

    /// Whether every point is a single row: true up to [`MAX_POINTS`] rows.
    #[must_use]
    pub fn is_full_resolution(&self) -> bool {
        self.stride == 1
    }

    /// The last row: x and value.
    #[must_use]
    pub fn latest(&self) -> Option<PlotPoint> {
        self.latest
    }

    /// The value of the point nearest to `x`; `None` without points.
    #[must_use]
    pub fn value_near(&self, x: f64) -> Option<f64> {
        let after = self.means.partition_point(|point| point.x < x);
        let neighbours = [after.checked_sub(1), Some(after)].into_iter().flatten();
        let points = neighbours.filter_map(|index| self.means.get(index));
        let nearest = points.min_by(|a, b| (a.x - x).abs().total_cmp(&(b.x - x).abs()));
        nearest.map(|point| point.y)
    }
}

/// Replaces each pair of neighbours by the result of `merged`.
fn merge_pairs<T: Copy>(values: &mut Vec<T>, merged: impl Fn(T, T) -> T) {
    let half = values.len() / 2;
    for index in 0..half {
        values[index] = merged(values[2 * index], values[2 * index + 1]);
    }
    values.truncate(half);
}

/// The moving average over the last [`MOVING_AVERAGE_EPISODES`] rows, as a series.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MovingAverage {
    /// Numerator and denominator of the last rows.
    rows: VecDeque<(f64, f64)>,
    series: DownsampledSeries,
}

impl MovingAverage {
    /// Adds a value.
    pub fn push(&mut self, x: f64, value: f64) {
        self.push_ratio(x, value, 1.0);
    }

    /// Adds the ratio `part` / `whole`. The average is the sum of the parts over the sum of the wholes.
    pub fn push_ratio(&mut self, x: f64, part: f64, whole: f64) {
        if !part.is_finite() || !whole.is_finite() {
            return;
        }
        if self.rows.len() == MOVING_AVERAGE_EPISODES {
            self.rows.pop_front();
        }
        self.rows.push_back((part, whole));
        // The sums are recomputed for each row, so that rounding errors do not accumulate.
        let (parts, wholes) = self.rows.iter().fold((0.0, 0.0), |sum, row| (sum.0 + row.0, sum.1 + row.1));
        self.series.push(x, parts / wholes);
    }

    /// The average after each row.
    #[must_use]
    pub fn series(&self) -> &DownsampledSeries {
        &self.series
    }
}
