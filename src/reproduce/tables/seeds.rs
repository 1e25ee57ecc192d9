//! Tables with the value of every seed, their mean, the paper's value and, for times, the ratio to the optimal time.

use super::parts::{TableParts, mean_cell, number_column, text_column, value_cell};
use crate::planner::StepBounds;
use crate::report::format::number;
use crate::report::statistics::Estimate;
use crate::report::table::{Cell, Column};
use crate::reproduce::measure::Measure;
use crate::reproduce::records::Windows;
use crate::reproduce::results::{ArmIndex, Results};
use crate::reproduce::rows::{row_name, rows, seeds as all_seeds};
use crate::reproduce::test_point::TestPoint;
use crate::run::RunError;
use crate::run::evaluate::period_s;

pub(super) fn seeds(
    results: &Results<'_>,
    index: usize,
    measure: Measure,
    point: TestPoint,
    paper: &[(String, f64)],
) -> Result<TableParts, RunError> {
    let experiment = results.experiment(index);
    let digits = measure.digits();
    let seeds = all_seeds(results, index);
    let columns = columns(measure, &seeds, !paper.is_empty());
    let mut parts = TableParts { columns, ..TableParts::default() };
    for arm in rows(results, index) {
        let values = results.values(arm, measure, point, Windows::default())?;
        // If any value is a lower bound, the mean is only a lower bound, too, and is not compared.
        let mean = Estimate::from_values(&values.raw()).filter(|_| values.lower_bound_count() == 0);
        let mut row = vec![Cell::Text(row_name(results, arm))];
        let cell = |&seed: &u64| values.of_seed(seed).map_or(Cell::Empty, |value| value_cell(value, digits));
        row.extend(seeds.iter().map(cell));
        row.push(mean_cell(&values, measure));
        let of_paper = paper.iter().find(|(name, _)| *name == experiment.arms[arm.arm].name).map(|p| p.1);
        if !paper.is_empty() {
            row.extend(paper_cells(of_paper, mean, measure));
        }
        if is_time(measure) {
            let optimal = mean_optimal_time(results, arm, measure, point)?;
            let ratio = |time_s: Option<f64>| match time_s.zip(optimal) {
                Some((time_s, (plan_s, _))) => Cell::Number { value: time_s / plan_s, digits: 3 },
                None => Cell::Empty,
            };
            row.push(ratio(mean.map(|mean| mean.mean)));
            if !paper.is_empty() {
                row.push(ratio(of_paper));
            }
            if let Some(optimal) = optimal {
                let (training, _) = results.policy(arm, results.first_run(arm)?, point)?;
                let note = optimal_time_note(&results.training(training).config.scenario.name, optimal);
                if !parts.notes.contains(&note) {
                    parts.notes.push(note);
                }
            }
        }
        parts.rows.push(row);
    }
    Ok(parts)
}

fn is_time(measure: Measure) -> bool {
    matches!(measure, Measure::BenchmarkRouteTime | Measure::MeanTime)
}

fn columns(measure: Measure, seeds: &[u64], with_paper: bool) -> Vec<Column> {
    let unit = measure.unit();
    let mut columns = vec![text_column("")];
    columns.extend(seeds.iter().map(|seed| number_column(format!("Seed {seed}"), "")));
    columns.push(number_column("Mean", unit));
    if with_paper {
        columns.push(number_column("Paper", unit));
        columns.push(number_column("Difference", unit));
    }
    if is_time(measure) {
        columns.push(number_column("Mean / optimal", ""));
        if with_paper {
            columns.push(number_column("Paper / optimal", ""));
        }
    }
    columns
}

/// The paper's value, and our mean minus that value.
fn paper_cells(paper: Option<f64>, mean: Option<Estimate>, measure: Measure) -> [Cell; 2] {
    let digits = measure.digits();
    let value = |value| Cell::Number { value, digits: digits.max(decimals(value)) };
    let difference = match paper.zip(mean) {
        Some((paper, mean)) => Cell::Signed {
            value: mean.mean - paper,
            half_width: mean.half_width,
            // The measure's limits, minus the paper's value.
            limits: measure.limits().map(|(low, high)| (low - paper, high - paper)),
            digits,
        },
        None => Cell::Empty,
    };
    [paper.map_or(Cell::Empty, value), difference]
}

fn optimal_time_note(scenario: &str, (plan_s, bound_s): (f64, f64)) -> String {
    format!(
        "Optimal time in {scenario}, mean over the episodes: {}\u{a0}s by a planner that knows the scenario; the proven \
         lower bound is {}\u{a0}s. Both keep the exact distance to obstacles, while the collision check, which uses the \
         LIDAR beams, can miss a few millimetres (docs/optimum.md).",
        number(plan_s, 2),
        number(bound_s, 2)
    )
}

/// The planner's mean time and the mean lower bound, in s, over the episodes that `measure` refers to. `None` if
/// there are no such episodes, or the planner found no path for one of them.
fn mean_optimal_time(
    results: &Results<'_>,
    arm: ArmIndex,
    measure: Measure,
    point: TestPoint,
) -> Result<Option<(f64, f64)>, RunError> {
    let (training, policy) = results.policy(arm, results.first_run(arm)?, point)?;
    let optimal = results.optimal_times(training, policy, results.experiment(arm.experiment).test)?;
    let bounds =
        if measure == Measure::BenchmarkRouteTime { &optimal.benchmark_route } else { &optimal.episodes };
    let period_s = period_s(results.training(training).config.scenario.task.control_period_s);
    let known: Option<Vec<(u32, u32)>> = bounds
        .iter()
        .map(|&StepBounds { lower_steps, plan_steps }| Some((plan_steps?, lower_steps)))
        .collect();
    Ok(known.filter(|known| !known.is_empty()).map(|known| {
        let mean = |of: fn(&(u32, u32)) -> u32| {
            known.iter().map(|pair| f64::from(of(pair))).sum::<f64>() / known.len() as f64 * period_s
        };
        (mean(|pair| pair.0), mean(|pair| pair.1))
    }))
}

/// The number of decimals of a number in the paper, at most 3.
fn decimals(value: f64) -> usize {
    let is_whole = |x: f64| (x - x.round()).abs() < 1e-6;
    (0..3).find(|&digits| is_whole(value * 10_f64.powi(digits))).unwrap_or(3) as usize
}
