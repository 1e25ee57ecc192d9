//! The figures of an experiment.
//!
//! In: what a figure is to show, and the results. Out: its picture as SVG.

use super::experiment::{Draw, FigureSpec, LevelSpec, Series};
use super::measure::Measure;
use super::results::Results;
use super::trial::read_policy;
use super::verdict::plain;
use crate::planner::{Resolution, least_time};
use crate::report::DrawError;
use crate::report::chart::{Curves, DotCell, DotColumn, Dots, Level, Line, Map, Panel, Path, Point, XMark};
use crate::report::statistics::{Estimate, band, moving_mean};
use crate::run::RunError;
use crate::run::evaluate::Evaluator;
use crate::run::picture;
use crate::task::{Places, Pose};

/// Draws a figure of experiment `index`.
///
/// # Errors
/// Results are missing; the drawing failed.
pub fn draw(results: &Results<'_>, index: usize, figure: &FigureSpec) -> Result<String, RunError> {
    let failed = |error: DrawError| RunError::Failed(format!("figure {}: {error}", figure.name));
    match &figure.draw {
        Draw::Curves { series, smoothing, levels } => {
            curves(results, index, &figure.title, series, *smoothing, levels).svg().map_err(failed)
        }
        Draw::Dots { measures, after } => {
            dots(results, index, &figure.title, measures, *after)?.svg().map_err(failed)
        }
        Draw::Course { after } => course(results, index, &figure.title, *after)?.svg().map_err(failed),
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
    series: &[Series],
    smoothing: usize,
    levels: &[LevelSpec],
) -> Curves {
    let experiment = results.experiment(index);
    let line = |series: Series, colour: usize, (condition, arm): (usize, usize)| {
        let runs = results.curves(index, condition, arm, series);
        let smoothed: Vec<Vec<f64>> = runs.iter().map(|run| moving_mean(run, smoothing)).collect();
        let point = |(i, e): (usize, &Estimate)| Point {
            x: (i + 1) as f64,
            mean: e.mean,
            low: e.low(),
            high: e.high(),
        };
        Line {
            name: row_name(results, index, condition, arm),
            colour,
            points: band(&smoothed).iter().enumerate().map(point).collect(),
            raw: band(&runs).iter().enumerate().map(|(i, e)| ((i + 1) as f64, e.mean)).collect(),
        }
    };
    let panel = |&series: &Series| {
        let (heading, y_from) = match series {
            Series::Return => ("Return per episode", None),
            Series::Targets => ("Targets reached per episode", Some(0.0)),
        };
        let lines = rows(results, index).into_iter().enumerate();
        Panel {
            heading: heading.into(),
            y_unit: String::new(),
            lines: lines.map(|(colour, row)| line(series, colour, row)).collect(),
            levels: levels
                .iter()
                .filter(|level| level.series == series)
                .map(|level| Level { value: level.value, label: level.label.clone() })
                .collect(),
            y_from,
        }
    };
    // Where an arm goes on in another world.
    let mut marks: Vec<XMark> = Vec::new();
    for (condition, arm) in rows(results, index) {
        let mut episodes = 0;
        for pair in results.chain(index, condition, arm, 1).stages.windows(2) {
            episodes += pair[0].1.unwrap_or(0);
            let x = episodes as f64;
            if !marks.iter().any(|mark| mark.x == x) {
                let world = &results.training(pair[1].0).config.scenario.name;
                let label = format!("{} goes on in {world}", experiment.arms[arm].name);
                marks.push(XMark { x, label });
            }
        }
    }
    Curves {
        title: title.into(),
        x_label: "episodes".into(),
        panels: series.iter().map(panel).collect(),
        marks,
    }
}

fn dots(
    results: &Results<'_>,
    index: usize,
    title: &str,
    measures: &[Measure],
    after: u64,
) -> Result<Dots, RunError> {
    let rows = rows(results, index);
    let column = |&measure: &Measure| {
        let cell = |&(condition, arm): &(usize, usize)| {
            let values = results.values(index, condition, arm, measure, after)?;
            Ok(DotCell {
                estimate: Estimate::of(&plain(&values)),
                censored: values.iter().any(|value| value.at_least),
                values: plain(&values),
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
    Ok(Dots {
        title: title.into(),
        rows: rows.iter().map(|&(condition, arm)| row_name(results, index, condition, arm)).collect(),
        columns: measures.iter().map(column).collect::<Result<_, RunError>>()?,
    })
}

fn course(results: &Results<'_>, index: usize, title: &str, after: u64) -> Result<Map, RunError> {
    let mut paths = Vec::new();
    let mut world = None;
    let points = |poses: &[Pose]| poses.iter().map(|p| (f64::from(p.x_m), f64::from(p.y_m))).collect();
    for (colour, (condition, arm)) in (1..).zip(rows(results, index)) {
        let (training, which) = results.policy(index, condition, arm, 1, after);
        let scenario = &results.training(training).config.scenario;
        let policy = read_policy(&results.policy_file(training, which))?;
        let rule = results.experiment(index).test;
        let mut evaluator = Evaluator::new(&std::sync::Arc::new(scenario.clone()), 1);
        let (drive, poses) = evaluator.trace(&policy, rule.seed, Places::Course)?;
        let time_s = f64::from(drive.steps) * f64::from(scenario.task.control_period_s);
        let name = row_name(results, index, condition, arm);
        let name = if drive.succeeded() { format!("{name} {time_s:.1} s") } else { format!("{name} failed") };
        paths.push(Path { name, colour, points: points(&poses) });
        world.get_or_insert((scenario, drive.layout, drive.clock.0));
    }
    let (scenario, layout, clock) =
        world.ok_or_else(|| RunError::Failed("a figure of a course needs at least one arm".into()))?;
    let course = &scenario.course;
    let start = (course.start_m.0, course.start_m.1, course.heading_rad);
    let furnished = scenario.furnished(layout);
    if let Some(plan) = least_time(&furnished, start, course.target_m, clock, Resolution::default()) {
        let name = format!("the planner {:.1} s", plan.time_s);
        let points = plan.poses.iter().map(|pose| (f64::from(pose.0), f64::from(pose.1))).collect();
        paths.insert(0, Path { name, colour: 0, points });
    }
    Ok(Map { title: title.into(), paths, ..picture::map(scenario, layout, clock) })
}
