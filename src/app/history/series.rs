//! Series: a curve of any number of rows in a bounded number of points.
//!
//! In: a value at a time, with its place on the x axis. Out: points to draw. [`DownsampledSeries`] keeps at most
//! [`MAX_POINTS`] buckets; each covers the same number of rows (the last maybe fewer) and knows their mean, least and
//! greatest. When all are full, neighbours are merged, two into one, and from then on a bucket covers twice as
//! many. So the curve keeps its whole length, and a day of training costs no more to keep or to draw than a minute.

use std::collections::VecDeque;

use egui_plot::PlotPoint;

/// At most so many points in a series; even, so that full buckets merge without a rest.
pub const MAX_POINTS: usize = 1000;
/// Episodes in a moving mean, as far as there are so many.
pub const MOVING_AVERAGE_EPISODES: usize = 100;

/// A curve in at most [`MAX_POINTS`] points.
#[derive(Clone, Debug, PartialEq)]
pub struct DownsampledSeries {
    /// For each bucket the mean of its rows' x and of their values.
    means: Vec<PlotPoint>,
    lows: Vec<f64>,
    highs: Vec<f64>,
    /// How many rows a full bucket covers.
    stride: u64,
    /// How many the last bucket covers.
    filled: u64,
    latest: Option<PlotPoint>,
}

impl Default for DownsampledSeries {
    fn default() -> Self {
        Self { means: Vec::new(), lows: Vec::new(), highs: Vec::new(), stride: 1, filled: 0, latest: None }
    }
}

impl DownsampledSeries {
    /// Adds a row. A value that is no finite number is left out, and an x before the last one counts as the last one:
    /// points are always in order.
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

    /// Makes one bucket of each two; all are full.
    fn merge(&mut self) {
        let halves = |a: f64, b: f64| a + (b - a) / 2.0;
        merge_pairs(&mut self.means, |a, b| PlotPoint::new(halves(a.x, b.x), halves(a.y, b.y)));
        merge_pairs(&mut self.lows, f64::min);
        merge_pairs(&mut self.highs, f64::max);
        self.stride *= 2;
    }

    /// The buckets' means in order of x, each where its rows are on average.
    #[must_use]
    pub fn points(&self) -> &[PlotPoint] {
        &self.means
    }

    /// The least value of each bucket.
    #[must_use]
    pub fn lows(&self) -> &[f64] {
        &self.lows
    }

    /// The greatest value of each bucket.
    #[must_use]
    pub fn highs(&self) -> &[f64] {
        &self.highs
    }

    /// Whether each point is a row of its own: as long as there are at most [`MAX_POINTS`].
    #[must_use]
    pub fn is_full_resolution(&self) -> bool {
        self.stride == 1
    }

    /// The last row as it was, x and value.
    #[must_use]
    pub fn latest(&self) -> Option<PlotPoint> {
        self.latest
    }

    /// The value of the point nearest to `x`.
    #[must_use]
    pub fn value_near(&self, x: f64) -> Option<f64> {
        let after = self.means.partition_point(|point| point.x < x);
        let neighbours = [after.checked_sub(1), Some(after)].into_iter().flatten();
        let points = neighbours.filter_map(|index| self.means.get(index));
        let nearest = points.min_by(|a, b| (a.x - x).abs().total_cmp(&(b.x - x).abs()));
        nearest.map(|point| point.y)
    }
}

/// Replaces each two neighbours by what `merged` makes of them.
fn merge_pairs<T: Copy>(of: &mut Vec<T>, merged: impl Fn(T, T) -> T) {
    let half = of.len() / 2;
    for index in 0..half {
        of[index] = merged(of[2 * index], of[2 * index + 1]);
    }
    of.truncate(half);
}

/// The mean over the last [`MOVING_AVERAGE_EPISODES`] rows, exactly, as a series.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct MovingAverage {
    /// The last rows: what is to be divided, and by what.
    rows: VecDeque<(f64, f64)>,
    series: DownsampledSeries,
}

impl MovingAverage {
    /// Adds a row of a plain mean.
    pub fn push(&mut self, x: f64, value: f64) {
        self.push_ratio(x, value, 1.0);
    }

    /// Adds a row of a share: `part` out of `whole`. The mean is that of all parts over that of all wholes.
    pub fn push_ratio(&mut self, x: f64, part: f64, whole: f64) {
        if !part.is_finite() || !whole.is_finite() {
            return;
        }
        if self.rows.len() == MOVING_AVERAGE_EPISODES {
            self.rows.pop_front();
        }
        self.rows.push_back((part, whole));
        // Summed anew each time: so no rounding ever piles up.
        let (parts, wholes) = self.rows.iter().fold((0.0, 0.0), |sum, row| (sum.0 + row.0, sum.1 + row.1));
        self.series.push(x, parts / wholes);
    }

    /// The mean as it was after each row.
    #[must_use]
    pub fn series(&self) -> &DownsampledSeries {
        &self.series
    }
}
