//! The figures of an experiment, as SVG.

use std::collections::BTreeSet;
use std::sync::Arc;

use super::data_note::{data_note, fewest_seeds};
use super::figure_spec::{FigureKind, FigureSpec, Series};
use super::learning_curves::{LearningCurves, default_axis};
use super::measure::Measure;
use super::policy_test::read_policy;
use super::records::Windows;
use super::results::{ArmIndex, Results};
use super::rows::{row_name, rows};
use super::seeds::seeds_text;
use super::test_point::TestPoint;
use crate::planner::{Resolution, plan_path};
use crate::report::DrawError;
use crate::report::chart::{DotCell, DotColumn, DotPlot, MapTrajectory, ScenarioMap};
use crate::report::statistics::{Estimate, small_sample_note};
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
        FigureKind::LearningCurves { series, over, smoothing, reference_lines } => {
            let axis = over.unwrap_or_else(|| default_axis(results, index).0);
            let curves = LearningCurves { figure, series, axis, smoothing: *smoothing, reference_lines };
            curves.chart(results, index)?.svg()
        }
        FigureKind::DotPlot { measures, after } => {
            dot_plot(results, index, title, measures, TestPoint::overall(*after))?.svg()
        }
        FigureKind::BenchmarkRoute { after } => {
            benchmark_route(results, index, title, TestPoint::overall(*after))?.svg()
        }
    };
    svg.map_err(|error: DrawError| RunError::Failed(format!("figure {}: {error}", figure.name)))
}

/// The caption of a figure: its title, the author's words, and how to read it.
///
/// # Errors
/// Results are missing.
pub fn caption(results: &Results<'_>, index: usize, figure: &FigureSpec) -> Result<String, RunError> {
    let mut parts = vec![format!("{}.", figure.title), figure.caption.clone()];
    match &figure.draw {
        FigureKind::LearningCurves { series, over, .. } => {
            if over.is_none() {
                parts.push(default_axis(results, index).1.into());
            }
            if series.contains(&Series::SuccessRate)
                && figure.claims.iter().any(|claim| claim.measure == Measure::Success)
            {
                parts.push("Claims about \"Success\" are about the test after training, not about these evaluations.".into());
            }
        }
        FigureKind::DotPlot { measures, after } => {
            parts.push(arrow_note(results, index, measures, TestPoint::overall(*after))?.into());
            parts.push(data_note(results, index, TestPoint::overall(*after))?);
            if !figure.claims.is_empty() {
                parts.push("The claims are about the differences between the arms, which have intervals of their own.".into());
            }
        }
        FigureKind::BenchmarkRoute { after } => {
            parts.push(driven_note(results, index, TestPoint::overall(*after))?);
        }
    }
    if !matches!(figure.draw, FigureKind::BenchmarkRoute { .. }) {
        parts.extend(small_sample_note(fewest_seeds(results, index)));
    }
    parts.retain(|part| !part.is_empty());
    Ok(parts.join(" "))
}

/// What the arrows of a dot plot mean, if it has any.
fn arrow_note(
    results: &Results<'_>,
    index: usize,
    measures: &[Measure],
    point: TestPoint,
) -> Result<&'static str, RunError> {
    for row in rows(results, index) {
        for &measure in measures {
            if results.values(row, measure, point, Windows::default())?.lower_bound_count() > 0 {
                return Ok(
                    "An arrow marks a lower bound: some seeds never reached the goals, or failed every time.",
                );
            }
        }
    }
    Ok("")
}

/// Sentences on which seeds' policies drive the benchmark route, and on the rows that are not drawn.
fn driven_note(results: &Results<'_>, index: usize, point: TestPoint) -> Result<String, RunError> {
    let drawn = rows_on_map(results, index, point)?;
    let first = |row| results.arm_runs(row).next().map(|(seed, _)| seed);
    let seeds: BTreeSet<u64> = drawn.iter().filter_map(|&(_, row)| first(row)).collect();
    let seeds: Vec<u64> = seeds.into_iter().collect();
    let (list, s) = (seeds_text(&seeds), if seeds.len() == 1 { "" } else { "s" });
    let note = format!("The path of each arm is driven by the policy of its first seed (seed{s} {list}).");
    let is_drawn = |row: &ArmIndex| drawn.iter().any(|(_, other)| other == row);
    let others = rows(results, index).into_iter().filter(|row| !is_drawn(row));
    let names: Vec<String> = others.map(|row| row_name(results, row)).collect();
    if names.is_empty() {
        return Ok(note);
    }
    let names = names.join(", ");
    Ok(format!(
        "{note} Not drawn, because their walls, obstacles, robot, goal radius or route differ from those of the map: {names}."
    ))
}

/// The rows that can be drawn on one map with the first row, each with its colour.
fn rows_on_map(
    results: &Results<'_>,
    index: usize,
    point: TestPoint,
) -> Result<Vec<(usize, ArmIndex)>, RunError> {
    let mut drawn = Vec::new();
    let mut first = None;
    for (colour, row) in (1..).zip(rows(results, index)) {
        let (training, _) = results.policy(row, results.first_run(row)?, point)?;
        let scenario = &results.training(training).config.scenario;
        let of_map: &Scenario = first.get_or_insert(scenario);
        if fit_on_one_map(of_map, scenario) {
            drawn.push((colour, row));
        }
    }
    Ok(drawn)
}

/// Whether two scenarios have the same walls, obstacles, robot, goal radius and route, so that the same map and planner's path
/// are right for both.
fn fit_on_one_map(one: &Scenario, other: &Scenario) -> bool {
    one.enclosure == other.enclosure
        && one.walls == other.walls
        && one.obstacles == other.obstacles
        && one.generators == other.generators
        && one.robot == other.robot
        && one.task.goal_radius_m == other.task.goal_radius_m
        && one.benchmark_route == other.benchmark_route
}

fn dot_plot(
    results: &Results<'_>,
    index: usize,
    title: &str,
    measures: &[Measure],
    point: TestPoint,
) -> Result<DotPlot, RunError> {
    let rows = rows(results, index);
    let column = |&measure: &Measure| {
        let cell = |&row: &ArmIndex| {
            let values = results.values(row, measure, point, Windows::default())?;
            Ok(DotCell {
                estimate: Estimate::from_values(&values.raw()),
                censored: values.lower_bound_count() > 0,
                values: values.raw(),
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
        rows: rows.iter().map(|&row| row_name(results, row)).collect(),
        columns: measures.iter().map(column).collect::<Result<_, RunError>>()?,
    })
}

/// The map of the benchmark route in the scenario of the first row: the planner's path, and for each row that
/// [fits](fit_on_one_map) the trajectory of the policy of its first seed.
fn benchmark_route(
    results: &Results<'_>,
    index: usize,
    title: &str,
    point: TestPoint,
) -> Result<ScenarioMap, RunError> {
    let mut trajectories = Vec::new();
    let mut first = None;
    for (colour, row) in rows_on_map(results, index, point)? {
        let (training, policy) = results.policy(row, results.first_run(row)?, point)?;
        let scenario = &results.training(training).config.scenario;
        let policy = read_policy(&results.policy_file(training, policy))?;
        let seed = results.experiment(index).test.seed;
        let mut evaluator = Evaluator::new(&Arc::new(scenario.clone()), 1);
        let route = scenario.benchmark_route.ok_or_else(|| {
            RunError::Failed(format!("{} has no benchmark route", printable(&scenario.name)))
        })?;
        let (episode, poses) = evaluator.trace(&policy, seed, EpisodeSetup::Route(route))?;
        let time_s = f64::from(episode.steps) * f64::from(scenario.task.control_period_s);
        let arm = row_name(results, row);
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
