//! Learning curves: series during training, over episodes or env steps.

use super::figure_spec::{Axis, FigureSpec, ReferenceLineSpec, Series};
use super::measure::Measure;
use super::results::{ArmIndex, Results};
use super::rows::{row_name, rows};
use crate::report::chart::{
    BandPoint, ChartPanel, CurveChart, CurveLine, EventMarker, RawStyle, ReferenceLine,
};
use crate::report::curves::mean_curve;
use crate::report::smoothing::moving_mean;
use crate::report::statistics::Estimate;
use crate::run::RunError;
use crate::run::preset::Budget;

/// The contents of a figure of learning curves.
pub struct LearningCurves<'a> {
    /// The figure.
    pub figure: &'a FigureSpec,
    /// The series, one panel each.
    pub series: &'a [Series],
    /// The x axis.
    pub axis: Axis,
    /// The number of episodes in the moving mean.
    pub smoothing: usize,
    /// Horizontal lines.
    pub reference_lines: &'a [ReferenceLineSpec],
}

impl LearningCurves<'_> {
    /// The chart for the experiment at `index`.
    ///
    /// # Errors
    /// An arm has no run.
    pub fn chart(&self, results: &Results<'_>, index: usize) -> Result<CurveChart, RunError> {
        Ok(CurveChart {
            title: self.figure.title.clone(),
            x_label: if self.axis == Axis::Episodes { "episodes" } else { "env steps" }.into(),
            include_x: Vec::new(),
            mean_label: self.mean_label().into(),
            band_label: "95 % interval".into(),
            raw_label: "mean of each episode".into(),
            panels: self.series.iter().map(|&series| self.panel(results, index, series)).collect(),
            markers: self.stage_markers(results, index)?,
        })
    }

    /// The label of the curves. Evaluations are not smoothed.
    fn mean_label(&self) -> &'static str {
        let evaluations = self.series.iter().filter(|&&series| series == Series::SuccessRate).count();
        match evaluations {
            0 if self.smoothing > 1 => "smoothed mean",
            n if n < self.series.len() && self.smoothing > 1 => "mean (smoothed, except success)",
            _ => "mean",
        }
    }

    fn panel(&self, results: &Results<'_>, index: usize, series: Series) -> ChartPanel {
        let (heading, y_unit, limits) = match series {
            Series::Return => ("Return per episode", "", None),
            Series::Goals => ("Goals reached per episode", "", Measure::Goals.limits()),
            Series::SuccessRate => {
                ("Success in evaluations during training", " %", Measure::Success.limits())
            }
        };
        let rows = rows(results, index).into_iter().enumerate();
        let references = self.reference_lines.iter().filter(|line| line.series == series);
        ChartPanel {
            heading: heading.into(),
            y_unit: y_unit.into(),
            lines: rows.map(|(colour, row)| self.line(results, row, series, colour)).collect(),
            reference_lines: references
                .map(|line| ReferenceLine { value: line.value, label: line.label.clone() })
                .collect(),
            include_y: limits.map_or_else(Vec::new, |(low, _)| vec![low]),
            limits,
        }
    }

    /// The curve of an arm: smoothed over episodes, then averaged over seeds. Evaluations are not smoothed, because each is
    /// a mean over many episodes.
    fn line(&self, results: &Results<'_>, row: ArmIndex, series: Series, colour: usize) -> CurveLine {
        let runs = results.curves(row, series, self.axis);
        let point = |(x, e): (f64, Estimate)| BandPoint { x, mean: e.mean, low: e.low(), high: e.high() };
        let smoothed: Vec<_> = runs.iter().map(|run| smoothed(run, self.smoothing)).collect();
        let (means, raw) = match series {
            Series::SuccessRate => (&runs, Vec::new()),
            Series::Return | Series::Goals => (&smoothed, mean_curve(&runs)),
        };
        CurveLine {
            name: row_name(results, row),
            colour,
            points: mean_curve(means).into_iter().map(point).collect(),
            raw: raw.into_iter().map(|(x, e)| (x, e.mean)).collect(),
            raw_style: RawStyle::Line,
            faint: false,
        }
    }

    /// Markers where arms continue in another stage (on average over the seeds).
    fn stage_markers(&self, results: &Results<'_>, index: usize) -> Result<Vec<EventMarker>, RunError> {
        let mut changes = Vec::new();
        for row in rows(results, index) {
            let arm = results.experiment(index).arms[row.arm].name.as_str();
            let stages = &results.first_run(row)?.stages;
            for (before, &(next, _)) in stages.iter().enumerate().skip(1) {
                let scenario = results.training(next).config.scenario.name.as_str();
                changes.push(StageChange { x: self.mean_length(results, row, before), scenario, arm });
            }
        }
        Ok(merged_markers(&changes))
    }

    /// The mean length of the first `stages` stages of an arm over its seeds, in units of the axis.
    fn mean_length(&self, results: &Results<'_>, row: ArmIndex, stages: usize) -> f64 {
        let length = |&(training, length): &(usize, Budget)| {
            results.records(training).length(results.end(training, length), self.axis)
        };
        let lengths: Vec<f64> =
            results.arm_runs(row).map(|(_, run)| run.stages.iter().take(stages).map(length).sum()).collect();
        lengths.iter().sum::<f64>() / lengths.len().max(1) as f64
    }
}

/// An arm that continues in another stage.
pub(super) struct StageChange<'a> {
    /// Where, in units of the axis.
    pub(super) x: f64,
    /// The name of the scenario of the stage.
    pub(super) scenario: &'a str,
    /// The name of the arm.
    pub(super) arm: &'a str,
}

/// One marker for all arms that continue in the same scenario at the same x.
pub(super) fn merged_markers(changes: &[StageChange<'_>]) -> Vec<EventMarker> {
    let mut merged: Vec<(f64, &str, Vec<&str>)> = Vec::new();
    for &StageChange { x, scenario, arm } in changes {
        match merged.iter_mut().find(|other| other.0 == x && other.1 == scenario) {
            Some((.., arms)) if arms.contains(&arm) => {}
            Some((.., arms)) => arms.push(arm),
            None => merged.push((x, scenario, vec![arm])),
        }
    }
    let marker = |(x, scenario, arms): (f64, &str, Vec<&str>)| {
        let label = match arms.split_last() {
            Some((last, others)) if !others.is_empty() => {
                format!("{} and {last} continue in {scenario}", others.join(", "))
            }
            _ => format!("{} continues in {scenario}", arms.join("")),
        };
        EventMarker { x, label }
    };
    merged.into_iter().map(marker).collect()
}

/// The moving mean of the values of a curve.
fn smoothed(curve: &[(f64, f64)], window: usize) -> Vec<(f64, f64)> {
    let values: Vec<f64> = curve.iter().map(|point| point.1).collect();
    curve.iter().map(|point| point.0).zip(moving_mean(&values, window)).collect()
}

/// The x axis of a figure that names none, in the experiment at `index`: env steps if a budget is in env steps, or if the
/// training runs differ in the number of arenas. The text gives the reason, if it needs one.
pub fn default_axis(results: &Results<'_>, index: usize) -> (Axis, &'static str) {
    let runs = rows(results, index).into_iter().flat_map(|row| results.arm_runs(row));
    let stages: Vec<(usize, Budget)> = runs.flat_map(|(_, run)| run.stages.iter().copied()).collect();
    let arenas = |&(training, _): &(usize, Budget)| results.training(training).config.preset.arenas;
    if stages.iter().any(|stage| arenas(stage) != arenas(&stages[0])) {
        return (Axis::EnvSteps, "Over env steps, because the training runs differ in the number of arenas.");
    }
    match stages.iter().any(|(_, length)| matches!(length, Budget::EnvSteps(_))) {
        true => (Axis::EnvSteps, ""),
        false => (Axis::Episodes, ""),
    }
}
