//! The panels of a run's figure: their curves, bands and reference lines.

use super::{
    MAX_SINGLE_EPISODES, MEAN_EPISODES, PAPER_RETURN, PAPER_SUCCESS_RATE, PaperResult, RunFigure, thousands,
};
use crate::chart::{BandPoint, ChartPanel, CurveLine, MAX_VERTICES, RawStyle, ReferenceLine};
use crate::format::{number, percent};
use crate::smoothing::moving_mean;
use crate::style::is_drawable;

/// Indices into the palette: blue for the main curves, ink for what is drawn behind them.
const MAIN: usize = 0;
const BACKGROUND: usize = 6;

/// Points (x, y): thousands of env steps, and the value measured there.
type Series = Vec<(f64, f64)>;

impl RunFigure {
    pub(super) fn success_panel(&self) -> ChartPanel {
        let greedy: Series = in_order(self.evaluations.iter().map(|e| (e.env_steps, e.success_rate)));
        let percents = |series: &Series| -> Series {
            series.iter().map(|&(x, y)| (x, 100.0 * y.clamp(0.0, 1.0))).collect()
        };
        // An episode that reached n goals attempted n + 1.
        let goals = smoothed(&self.goals());
        let training: Series = goals.into_iter().map(|(x, goals)| (x, goals / (goals + 1.0))).collect();
        let name = |name: &str, series: &Series| {
            series.last().map_or(String::new(), |last| format!("{name} {}", percent(last.1.clamp(0.0, 1.0))))
        };
        ChartPanel {
            heading: "Success rate".into(),
            y_unit: "%".into(),
            lines: vec![
                self.earlier_line(&percents(&self.earlier.success_rate)),
                line(name("in training", &training), BACKGROUND, true, percents(&training)),
                CurveLine {
                    raw: percents(&greedy),
                    raw_style: RawStyle::Dots,
                    ..line(name("greedy", &greedy), MAIN, false, percents(&greedy))
                },
            ],
            reference_lines: self.paper_line(PAPER_SUCCESS_RATE, 100.0),
            include_y: vec![0.0, 100.0],
            limits: Some((0.0, 100.0)),
        }
    }

    pub(super) fn return_panel(&self) -> ChartPanel {
        let returns = in_order(self.episodes.iter().map(|e| (e.env_steps, e.total_return)));
        let reference_lines = self.paper_line(PAPER_RETURN, 1.0);
        let earlier = self.earlier_line(&self.earlier.return_mean);
        ChartPanel { reference_lines, ..episode_panel("Return per episode", 0, returns, &[0.0], earlier) }
    }

    pub(super) fn goal_panel(&self) -> ChartPanel {
        let earlier = self.earlier_line(&self.earlier.goal_mean);
        let limits = Some((0.0, f64::INFINITY));
        ChartPanel { limits, ..episode_panel("Goals per episode", 1, self.goals(), &[0.0, 1.0], earlier) }
    }

    fn goals(&self) -> Series {
        in_order(self.episodes.iter().map(|e| (e.env_steps, f64::from(e.goals))))
    }

    /// The line of a result of the paper, where it applies; `scale` turns its value into the unit of the axis.
    fn paper_line(&self, PaperResult { value, label }: PaperResult, scale: f64) -> Vec<ReferenceLine> {
        let line = ReferenceLine { value: scale * value, label: label.into() };
        self.is_paper_scenario_1.then_some(line).into_iter().collect()
    }

    /// The curve of the training run before a transfer.
    fn earlier_line(&self, series: &[(f64, f64)]) -> CurveLine {
        let in_thousands = series.iter().map(|&(env_steps, y)| (env_steps / 1000.0, y)).collect();
        let name = if series.is_empty() { "" } else { "before transfer" };
        line(name.into(), MAIN, true, in_thousands)
    }
}

/// A panel with the moving mean in front of the single episodes, or of the band from their minimum to their maximum.
fn episode_panel(
    heading: &str,
    decimals: usize,
    raw: Series,
    include_y: &[f64],
    earlier: CurveLine,
) -> ChartPanel {
    let means = smoothed(&raw);
    let name = means.last().map_or(String::new(), |&(_, last)| number(last, decimals));
    let mut include_y = include_y.to_vec();
    let mut episodes =
        CurveLine { colour: BACKGROUND, faint: true, raw_style: RawStyle::Dots, ..CurveLine::default() };
    if raw.len() <= MAX_SINGLE_EPISODES {
        episodes.raw = raw;
    } else {
        episodes.points = extremes(&raw);
        include_y.extend(episodes.points.iter().flat_map(|p| [p.low, p.high]));
    }
    ChartPanel {
        heading: heading.into(),
        lines: vec![episodes, earlier, line(name, MAIN, false, means)],
        include_y,
        ..ChartPanel::default()
    }
}

fn line(name: String, colour: usize, faint: bool, series: Series) -> CurveLine {
    let point = |(x, mean)| BandPoint { x, mean, low: f64::NAN, high: f64::NAN };
    CurveLine { name, colour, faint, points: series.into_iter().map(point).collect(), ..CurveLine::default() }
}

/// The trailing mean of [`MEAN_EPISODES`] values.
fn smoothed(raw: &Series) -> Series {
    let values: Vec<f64> = raw.iter().map(|point| point.1).collect();
    raw.iter().zip(moving_mean(&values, MEAN_EPISODES)).map(|(&(x, _), mean)| (x, mean)).collect()
}

/// The minimum and the maximum of each group of neighbouring points, without a mean.
fn extremes(raw: &Series) -> Vec<BandPoint> {
    let group = |points: &[(f64, f64)]| {
        let values = || points.iter().map(|point| point.1);
        BandPoint {
            x: points.iter().map(|point| point.0).sum::<f64>() / points.len() as f64,
            mean: f64::NAN,
            low: values().fold(f64::INFINITY, f64::min),
            high: values().fold(f64::NEG_INFINITY, f64::max),
        }
    };
    raw.chunks(raw.len().div_ceil(MAX_VERTICES).max(1)).map(group).collect()
}

/// The points that can be drawn, in order of env steps.
fn in_order(points: impl Iterator<Item = (u64, f64)>) -> Series {
    let mut points: Vec<_> = points.filter(|point| is_drawable(point.1)).collect();
    points.sort_by_key(|point| point.0);
    points.into_iter().map(|(env_steps, value)| (thousands(env_steps), value)).collect()
}
