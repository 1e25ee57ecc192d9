//! The data of a curve chart, and its drawable part.

use crate::chart::layout::WIDTH;
use crate::style::{Axis, TEXT, bounds, is_drawable, text_width, thinned};

/// Curves in panels that share one x axis, such as the learning curves of several algorithms.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CurveChart {
    /// The title above the figure.
    pub title: String,
    /// The name of the x axis, with its unit.
    pub x_label: String,
    /// Values that the x axis must include, such as 0.
    pub include_x: Vec<f64>,
    /// The legend's text for the curves' means; an empty one is left out.
    pub mean_label: String,
    /// The legend's text for the bands.
    pub band_label: String,
    /// The legend's text for the raw values; an empty one is left out.
    pub raw_label: String,
    /// The panels, from top to bottom.
    pub panels: Vec<ChartPanel>,
    /// Events marked in every panel.
    pub markers: Vec<EventMarker>,
}

/// A vertical dashed line at an event, such as a change of the scenario.
#[derive(Clone, Debug, PartialEq)]
pub struct EventMarker {
    /// The position, in units of the x axis.
    pub x: f64,
    /// The event, in a few words.
    pub label: String,
}

/// One panel of a curve chart: a plot below the previous one.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChartPanel {
    /// The heading above the plot.
    pub heading: String,
    /// The unit after each number of the y axis, such as "%" or " s"; it may be empty.
    pub y_unit: String,
    /// The curves; more than six are hard to tell apart.
    pub lines: Vec<CurveLine>,
    /// Reference values.
    pub reference_lines: Vec<ReferenceLine>,
    /// Values that the y axis must include, such as 0.
    pub include_y: Vec<f64>,
    /// The range of possible values, such as 0 to 100 for percentages; the axis and the bands end there. `None` means no
    /// limits.
    pub limits: Option<(f64, f64)>,
}

/// A horizontal dashed line at a reference value, such as the paper's.
#[derive(Clone, Debug, PartialEq)]
pub struct ReferenceLine {
    /// The value, in units of the y axis.
    pub value: f64,
    /// The text, such as "paper: 2500".
    pub label: String,
}

/// One curve: a smoothed mean with a band around it, over the raw values.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct CurveLine {
    /// The short name at the curve's right end.
    pub name: String,
    /// The colour's index in the palette, modulo the palette's length.
    pub colour: usize,
    /// The smoothed mean and its band, in any order.
    pub points: Vec<BandPoint>,
    /// The raw values as (x, y), in any order.
    pub raw: Vec<(f64, f64)>,
    /// The style of the raw values.
    pub raw_style: RawStyle,
    /// Whether the curve is in the background: a thin, pale line without markers.
    pub faint: bool,
}

/// The style of raw values.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum RawStyle {
    /// A thin line.
    #[default]
    Line,
    /// Dots.
    Dots,
}

/// A point of a smoothed mean.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BandPoint {
    /// The x value, in units of the x axis.
    pub x: f64,
    /// The smoothed mean, in units of the y axis; not finite if there is only a band.
    pub mean: f64,
    /// The lower end of the band; not finite if there is no band.
    pub low: f64,
    /// The upper end of the band; not finite if there is no band.
    pub high: f64,
}

/// The maximum number of vertices of a line, or of one side of a band.
pub(crate) const MAX_VERTICES: usize = 320;
/// The maximum number of dots of a curve.
const MAX_DOTS: usize = 900;

impl ChartPanel {
    /// The finite values of the panel, sorted by x and thinned to the visible resolution.
    pub(super) fn drawable(&self) -> Self {
        Self {
            lines: self.lines.iter().map(|line| line.drawable(self.limits)).collect(),
            reference_lines: self.reference_lines.iter().filter(|l| is_drawable(l.value)).cloned().collect(),
            include_y: self.include_y.iter().copied().filter(|&y| is_drawable(y)).collect(),
            ..self.clone()
        }
    }

    /// The y axis. It spans the means, the dots, the reference lines and the values to include; raw lines and bands extend it to
    /// at most twice that range. Without any of the former, it spans the raw lines, or else the bands.
    pub(super) fn y_axis(&self) -> Axis {
        let means = self.lines.iter().flat_map(|l| l.points.iter().filter(|p| p.has_mean()).map(|p| p.mean));
        let references = self.reference_lines.iter().map(|l| l.value);
        let raw = || self.lines.iter().flat_map(|l| l.raw.iter().map(|p| p.1));
        let dots = self.lines.iter().filter(|l| l.raw_style == RawStyle::Dots);
        let dots = dots.flat_map(|l| l.raw.iter().map(|p| p.1));
        let bands = || self.lines.iter().flat_map(|l| l.band().flat_map(|p| [p.low, p.high]));
        let mut shown: Vec<f64> =
            means.chain(references).chain(self.include_y.iter().copied()).chain(dots).collect();
        if shown.is_empty() {
            shown.extend(raw());
        }
        if shown.is_empty() {
            shown.extend(bands());
        }
        let (low, high) = bounds(shown.iter().copied());
        let margin = (high - low) / 2.0;
        let others = raw().chain(bands()).map(|y| y.clamp(low - margin, high + margin));
        Axis::within_limits(shown.iter().copied().chain(others), self.limits, 5.0)
    }

    /// Whether the y axis is too short for a band.
    pub(super) fn cuts_a_band(&self) -> bool {
        let Axis { range, .. } = self.y_axis();
        let mut bands = self.lines.iter().flat_map(CurveLine::band);
        bands.any(|p| p.low < range.start || range.end < p.high)
    }

    /// The width of the widest label at the right end, in drawn pixels; at most a third of the figure.
    pub(super) fn label_width(&self) -> i32 {
        let names = self.lines.iter().map(|l| &l.name).chain(self.reference_lines.iter().map(|l| &l.label));
        names.map(|name| text_width(name, TEXT)).max().unwrap_or(0).min(WIDTH / 3)
    }

    pub(super) fn is_empty(&self) -> bool {
        self.lines.iter().all(|l| l.points.is_empty() && l.raw.is_empty())
    }
}

impl CurveLine {
    fn drawable(&self, limits: Option<(f64, f64)>) -> Self {
        let drawable =
            self.points.iter().filter(|p| is_drawable(p.x) && (p.has_mean() || p.has_band())).copied();
        let mut points: Vec<BandPoint> = match limits {
            Some(limits) => drawable.map(|p| p.limited(limits)).collect(),
            None => drawable.collect(),
        };
        points.sort_by(|a, b| a.x.total_cmp(&b.x));
        let mut raw: Vec<(f64, f64)> =
            self.raw.iter().filter(|p| is_drawable(p.0) && is_drawable(p.1)).copied().collect();
        raw.sort_by(|a, b| a.0.total_cmp(&b.0));
        let raw = match self.raw_style {
            RawStyle::Line => thinned_to_extremes(&raw, MAX_VERTICES),
            RawStyle::Dots => thinned(&raw, MAX_DOTS),
        };
        Self { points: thinned(&points, MAX_VERTICES), raw, ..self.clone() }
    }

    /// The points that have a band.
    pub(super) fn band(&self) -> impl Iterator<Item = &BandPoint> {
        self.points.iter().filter(|p| p.has_band())
    }
}

impl BandPoint {
    pub(super) fn has_mean(&self) -> bool {
        is_drawable(self.mean)
    }

    fn has_band(&self) -> bool {
        is_drawable(self.low) && is_drawable(self.high)
    }

    /// The point with its band cut off at the ends of the possible range.
    fn limited(self, (least, most): (f64, f64)) -> Self {
        let cut = |end: f64| if end.is_finite() { end.max(least).min(most) } else { end };
        Self { low: cut(self.low), high: cut(self.high), ..self }
    }
}

/// At most `max` of the points: the lowest and the highest of each group of neighbours, so that noise keeps its height.
fn thinned_to_extremes(points: &[(f64, f64)], max: usize) -> Vec<(f64, f64)> {
    if points.len() <= max {
        return points.to_vec();
    }
    let group_size = points.len().div_ceil(max / 2);
    let extremes = |group: &[(f64, f64)]| {
        let by_value = |a: &&(f64, f64), b: &&(f64, f64)| a.1.total_cmp(&b.1);
        let (a, b) = (*group.iter().min_by(by_value)?, *group.iter().max_by(by_value)?);
        Some(if a.0 <= b.0 { [a, b] } else { [b, a] })
    };
    points.chunks(group_size).filter_map(extremes).flatten().collect()
}
