//! The figures of an experiment.
//!
//! In: what a figure is to show, and the results. Out: its picture as SVG.

use super::claim_result::raw_values;
use super::experiment::{EpisodeSeries, FigureKind, FigureSpec, ReferenceLineSpec};
use super::measure::Measure;
use super::policy_test::read_policy;
use super::results::Results;
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
use crate::task::{EpisodeSetup, Pose};

/// Draws a figure of experiment `index`.
///
/// # Errors
/// Results are missing; the drawing failed.
pub fn draw(results: &Results<'_>, index: usize, figure: &FigureSpec) -> Result<String, RunError> {
    let failed = |error: DrawError| RunError::Failed(format!("figure {}: {error}", figure.name));
    match &figure.draw {
        FigureKind::LearningCurves { series, smoothing, reference_lines } => {
            curves(results, index, &figure.title, series, *smoothing, reference_lines).svg().map_err(failed)
        }
        FigureKind::DotPlot { measures, after } => {
            dots(results, index, &figure.title, measures, *after)?.svg().map_err(failed)
        }
        FigureKind::BenchmarkRoute { after } => {
            benchmark_route(results, index, &figure.title, *after)?.svg().map_err(failed)
        }
    }
}

/// The name of an arm, with its condition if there are several.
pub fn row_name(results: &Results<'_>, index: usize, condition: usize, arm: usize) -> String {
    let experiment = results.experiment(index);
    let arm = &experiment.arms[arm].name;
    match experiment.conditions.get(condition) {
        Some(condition) if experiment.arms.len() > 1 => format!("{}: {arm}", condition.name),
        Some(condition) => condition.name.clone(),
        None => arm.clone(),
    }
}

/// Every condition with every arm, by index.
pub fn rows(results: &Results<'_>, index: usize) -> Vec<(usize, usize)> {
    let experiment = results.experiment(index);
    let arms = experiment.arms.len();
    let conditions = experiment.conditions.len().max(1);
    (0..conditions).flat_map(|condition| (0..arms).map(move |arm| (condition, arm))).collect()
}

fn curves(
    results: &Results<'_>,
    index: usize,
    title: &str,
    series: &[EpisodeSeries],
    smoothing: usize,
    reference_lines: &[ReferenceLineSpec],
) -> CurveChart {
    let experiment = results.experiment(index);
    let line = |series: EpisodeSeries, colour: usize, (condition, arm): (usize, usize)| {
        let runs = results.curves(index, condition, arm, series);
        let smoothed: Vec<Vec<f64>> = runs.iter().map(|run| moving_mean(run, smoothing)).collect();
        let point = |(i, e): (usize, &Estimate)| BandPoint {
            x: (i + 1) as f64,
            mean: e.mean,
            low: e.low(),
            high: e.high(),
        };
        CurveLine {
            name: row_name(results, index, condition, arm),
            colour,
            points: band(&smoothed).iter().enumerate().map(point).collect(),
            raw: band(&runs).iter().enumerate().map(|(i, e)| ((i + 1) as f64, e.mean)).collect(),
            raw_style: RawStyle::Line,
        }
    };
    let panel = |&series: &EpisodeSeries| {
        let (heading, include_y) = match series {
            EpisodeSeries::Return => ("Return per episode", Vec::new()),
            EpisodeSeries::Goals => ("Goals reached per episode", vec![0.0]),
        };
        let lines = rows(results, index).into_iter().enumerate();
        ChartPanel {
            heading: heading.into(),
            y_unit: String::new(),
            lines: lines.map(|(colour, row)| line(series, colour, row)).collect(),
            reference_lines: reference_lines
                .iter()
                .filter(|level| level.series == series)
                .map(|level| ReferenceLine { value: level.value, label: level.label.clone() })
                .collect(),
            include_y,
        }
    };
    // Where an arm goes on in another world.
    let mut marks: Vec<EventMarker> = Vec::new();
    for (condition, arm) in rows(results, index) {
        let mut episodes = 0;
        for pair in results.arm_run(index, condition, arm, 1).stages.windows(2) {
            episodes += pair[0].1.unwrap_or(0);
            let x = episodes as f64;
            if !marks.iter().any(|mark| mark.x == x) {
                let world = &results.training(pair[1].0).config.scenario.name;
                let label = format!("{} goes on in {world}", experiment.arms[arm].name);
                marks.push(EventMarker { x, label });
            }
        }
    }
    CurveChart {
        title: title.into(),
        x_label: "episodes".into(),
        include_x: Vec::new(),
        mean_label: "smoothed mean".into(),
        raw_label: "mean of each episode".into(),
        panels: series.iter().map(panel).collect(),
        markers: marks,
    }
}

fn dots(
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
            limits: (measure == Measure::Success).then_some((0.0, 100.0)),
            cells: rows.iter().map(cell).collect::<Result<_, RunError>>()?,
        })
    };
    Ok(DotPlot {
        title: title.into(),
        rows: rows.iter().map(|&(condition, arm)| row_name(results, index, condition, arm)).collect(),
        columns: measures.iter().map(column).collect::<Result<_, RunError>>()?,
    })
}

fn benchmark_route(
    results: &Results<'_>,
    index: usize,
    title: &str,
    after: u64,
) -> Result<ScenarioMap, RunError> {
    let mut trajectories = Vec::new();
    let mut world = None;
    let points = |poses: &[Pose]| poses.iter().map(|p| (f64::from(p.x_m), f64::from(p.y_m))).collect();
    for (colour, (condition, arm)) in (1..).zip(rows(results, index)) {
        let (training, which) = results.policy(index, condition, arm, 1, after);
        let scenario = &results.training(training).config.scenario;
        let policy = read_policy(&results.policy_file(training, which))?;
        let rule = results.experiment(index).test;
        let mut evaluator = Evaluator::new(&std::sync::Arc::new(scenario.clone()), 1);
        let (drive, poses) = evaluator.trace(&policy, rule.seed, EpisodeSetup::BenchmarkRoute)?;
        let time_s = f64::from(drive.steps) * f64::from(scenario.task.control_period_s);
        let name = row_name(results, index, condition, arm);
        let name = if drive.succeeded() { format!("{name} {time_s:.1} s") } else { format!("{name} failed") };
        trajectories.push(MapTrajectory { name, colour, points: points(&poses) });
        world.get_or_insert((scenario, drive.layout_seed, drive.clock.0));
    }
    let (scenario, layout_seed, clock) = world
        .ok_or_else(|| RunError::Failed("a figure of a benchmark route needs at least one arm".into()))?;
    let benchmark_route = &scenario.benchmark_route;
    let start = (benchmark_route.start_m.x, benchmark_route.start_m.y, benchmark_route.heading_rad);
    let generated = scenario.with_generated_obstacles(layout_seed);
    if let Some(plan) = plan_path(&generated, start, benchmark_route.goal_m, clock, Resolution::default()) {
        let name = format!("the planner {:.1} s", plan.time_s);
        let points = plan.poses.iter().map(|pose| (f64::from(pose.0), f64::from(pose.1))).collect();
        trajectories.insert(0, MapTrajectory { name, colour: 0, points });
    }
    Ok(ScenarioMap { title: title.into(), trajectories, ..scenario_image::map(scenario, layout_seed, clock) })
}
