//! The figures of an experiment, as SVG.

use std::sync::Arc;

use super::figure_spec::{EpisodeSeries, FigureKind, FigureSpec, ReferenceLineSpec};
use super::measure::Measure;
use super::measured_value::raw_values;
use super::policy_test::read_policy;
use super::results::Results;
use super::rows::{row_name, rows};
use crate::planner::{Resolution, plan_path};
use crate::report::DrawError;
use crate::report::chart::{
    BandPoint, ChartPanel, CurveChart, CurveLine, DotCell, DotColumn, DotPlot, EventMarker, MapTrajectory,
    RawStyle, ReferenceLine, ScenarioMap,
};
use crate::report::smoothing::moving_mean;
use crate::report::statistics::{Estimate, band};
use crate::run::RunError;
use crate::run::evaluate::Evaluator;
use crate::run::scenario_image;
use crate::scenario::{Scenario, printable};
use crate::task::{EpisodeSetup, Pose};

/// Draws a figure of the experiment at `index`.
///
/// # Errors
/// Results are missing, or the drawing failed.
pub fn draw(results: &Results<'_>, index: usize, figure: &FigureSpec) -> Result<String, RunError> {
    let title = &figure.title;
    let svg = match &figure.draw {
        FigureKind::LearningCurves { series, smoothing, reference_lines } => {
            learning_curves(results, index, title, series, *smoothing, reference_lines).svg()
        }
        FigureKind::DotPlot { measures, after } => dot_plot(results, index, title, measures, *after)?.svg(),
        FigureKind::BenchmarkRoute { after } => benchmark_route(results, index, title, *after)?.svg(),
    };
    svg.map_err(|error: DrawError| RunError::Failed(format!("figure {}: {error}", figure.name)))
}

fn learning_curves(
    results: &Results<'_>,
    index: usize,
    title: &str,
    series: &[EpisodeSeries],
    smoothing: usize,
    reference_lines: &[ReferenceLineSpec],
) -> CurveChart {
    let panel = |&series: &EpisodeSeries| {
        let (heading, include_y, limits) = match series {
            EpisodeSeries::Return => ("Return per episode", Vec::new(), None),
            EpisodeSeries::Goals => ("Goals reached per episode", vec![0.0], Some((0.0, f64::INFINITY))),
        };
        let rows = rows(results, index).into_iter().enumerate();
        let references = reference_lines.iter().filter(|line| line.series == series);
        ChartPanel {
            heading: heading.into(),
            y_unit: String::new(),
            lines: rows.map(|(colour, row)| curve(results, index, row, series, smoothing, colour)).collect(),
            reference_lines: references
                .map(|line| ReferenceLine { value: line.value, label: line.label.clone() })
                .collect(),
            include_y,
            limits,
        }
    };
    CurveChart {
        title: title.into(),
        x_label: "episodes".into(),
        include_x: Vec::new(),
        mean_label: "smoothed mean".into(),
        band_label: "95 % interval".into(),
        raw_label: "mean of each episode".into(),
        panels: series.iter().map(panel).collect(),
        markers: stage_markers(results, index),
    }
}

/// The curve of an arm under a condition: smoothed over episodes, then averaged over seeds.
fn curve(
    results: &Results<'_>,
    index: usize,
    (condition, arm): (usize, usize),
    series: EpisodeSeries,
    smoothing: usize,
    colour: usize,
) -> CurveLine {
    let runs = results.curves(index, condition, arm, series);
    let smoothed: Vec<Vec<f64>> = runs.iter().map(|run| moving_mean(run, smoothing)).collect();
    let episode = |i: usize| (i + 1) as f64;
    let point =
        |(i, e): (usize, &Estimate)| BandPoint { x: episode(i), mean: e.mean, low: e.low(), high: e.high() };
    CurveLine {
        name: row_name(results, index, (condition, arm)),
        colour,
        points: band(&smoothed).iter().enumerate().map(point).collect(),
        raw: band(&runs).iter().enumerate().map(|(i, e)| (episode(i), e.mean)).collect(),
        raw_style: RawStyle::Line,
        faint: false,
    }
}

/// Markers at the episodes where arms continue in another stage.
fn stage_markers(results: &Results<'_>, index: usize) -> Vec<EventMarker> {
    let mut markers: Vec<EventMarker> = Vec::new();
    for (condition, arm) in rows(results, index) {
        let mut episodes = 0;
        for pair in results.arm_run(index, condition, arm, 1).stages.windows(2) {
            episodes += pair[0].1.unwrap_or(0);
            let x = episodes as f64;
            if !markers.iter().any(|marker| marker.x == x) {
                let scenario = &results.training(pair[1].0).config.scenario.name;
                let label = format!("{} continues in {scenario}", results.experiment(index).arms[arm].name);
                markers.push(EventMarker { x, label });
            }
        }
    }
    markers
}

fn dot_plot(
    results: &Results<'_>,
    index: usize,
    title: &str,
    measures: &[Measure],
    after: u64,
) -> Result<DotPlot, RunError> {
    let rows = rows(results, index);
    let column = |&measure: &Measure| {
        let cell = |&(condition, arm): &(usize, usize)| {
            let values = results.values(index, condition, arm, measure, after)?;
            Ok(DotCell {
                estimate: Estimate::from_values(&raw_values(&values)),
                censored: values.iter().any(|value| value.is_lower_bound),
                values: raw_values(&values),
                paper: None,
            })
        };
        Ok(DotColumn {
            heading: measure.heading(),
            unit: measure.unit().into(),
            limits: measure.limits(),
            cells: rows.iter().map(cell).collect::<Result<_, RunError>>()?,
        })
    };
    Ok(DotPlot {
        title: title.into(),
        rows: rows.iter().map(|&row| row_name(results, index, row)).collect(),
        columns: measures.iter().map(column).collect::<Result<_, RunError>>()?,
    })
}

/// The map of the benchmark route: the planner's path, and the trajectory of each arm's policy of seed 1.
fn benchmark_route(
    results: &Results<'_>,
    index: usize,
    title: &str,
    after: u64,
) -> Result<ScenarioMap, RunError> {
    let mut trajectories = Vec::new();
    let mut first = None;
    for (colour, (condition, arm)) in (1..).zip(rows(results, index)) {
        let (training, policy) = results.policy(index, condition, arm, 1, after);
        let scenario = &results.training(training).config.scenario;
        let policy = read_policy(&results.policy_file(training, policy))?;
        let seed = results.experiment(index).test.seed;
        let mut evaluator = Evaluator::new(&Arc::new(scenario.clone()), 1);
        let route = scenario.benchmark_route.ok_or_else(|| {
            RunError::Failed(format!("{} has no benchmark route", printable(&scenario.name)))
        })?;
        let (episode, poses) = evaluator.trace(&policy, seed, EpisodeSetup::Route(route))?;
        let time_s = f64::from(episode.steps) * f64::from(scenario.task.control_period_s);
        let arm = row_name(results, index, (condition, arm));
        let name = if episode.succeeded() { format!("{arm} {time_s:.1} s") } else { format!("{arm} failed") };
        trajectories.push(MapTrajectory { name, colour, points: points(&poses) });
        first.get_or_insert((scenario, episode.layout_seed, episode.clock.0));
    }
    let (scenario, layout_seed, clock) = first
        .ok_or_else(|| RunError::Failed("a map of the benchmark route needs at least one arm".into()))?;
    trajectories.splice(0..0, planned_trajectory(scenario, layout_seed, clock));
    Ok(ScenarioMap { title: title.into(), trajectories, ..scenario_image::map(scenario, layout_seed, clock) })
}

/// The planner's path on the benchmark route, if it finds one.
fn planned_trajectory(scenario: &Scenario, layout_seed: u64, clock: u64) -> Option<MapTrajectory> {
    let route = scenario.benchmark_route?;
    let start = (route.start_m.x, route.start_m.y, route.heading_rad);
    let generated = scenario.with_generated_obstacles(layout_seed);
    let plan = plan_path(&generated, start, route.goal_m, clock, Resolution::default())?;
    Some(MapTrajectory {
        name: format!("planner {:.1} s", plan.time_s),
        colour: 0,
        points: plan.poses.iter().map(|pose| (f64::from(pose.0), f64::from(pose.1))).collect(),
    })
}

fn points(poses: &[Pose]) -> Vec<(f64, f64)> {
    poses.iter().map(|pose| (f64::from(pose.x_m), f64::from(pose.y_m))).collect()
}
