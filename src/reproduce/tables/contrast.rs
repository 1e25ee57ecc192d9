//! Tables that compare one arm of an experiment (a training setup) with another, by condition (a change of the scenario) and
//! amount of training.

use super::parts::{TableParts, mean_cell, number_column, text_column};
use crate::report::table::{Cell, Column};
use crate::reproduce::claim_result::compare;
use crate::reproduce::measure::Measure;
use crate::reproduce::records::Windows;
use crate::reproduce::results::Results;
use crate::reproduce::test_point::{TestPoint, amount};
use crate::run::RunError;
use crate::run::preset::Budget;

pub(super) fn contrast(
    results: &Results<'_>,
    index: usize,
    measures: &[Measure],
    (better, than): (&str, &str),
    points: &[TestPoint],
) -> Result<TableParts, RunError> {
    let conditions = &results.experiment(index).conditions;
    let mut rows = Vec::new();
    for condition in 0..conditions.len().max(1) {
        for &point in points {
            let name = conditions.get(condition).map_or("unchanged", |c| c.name.as_str());
            let mut row = vec![Cell::Text(name.into())];
            if points.len() > 1 {
                row.push(Cell::Number {
                    value: point.after.map_or(f64::NAN, |after| amount(after) as f64),
                    digits: 0,
                });
            }
            for &measure in measures {
                let values = |arm| {
                    let arm = results.arm_by_name(index, condition, arm);
                    results.values(arm, measure, point, Windows::default())
                };
                let (first, second) = (values(better)?, values(than)?);
                let comparison = compare(measure, &first, &second);
                row.extend([mean_cell(&first, measure), mean_cell(&second, measure)]);
                row.push(comparison.difference.map_or(Cell::Empty, |difference| Cell::Signed {
                    value: difference.mean,
                    half_width: difference.half_width,
                    limits: measure.difference_limits(),
                    digits: measure.digits(),
                }));
                row.push(Cell::Outcome(comparison.outcome));
            }
            rows.push(row);
        }
    }
    let paired = "If both arms have the same seeds, the difference is paired by seed and its interval is Student's t; \
                  otherwise it is the difference of means with Welch's interval.";
    let note = format!(
        "{paired} \"held\": the 95 % interval of the difference lies entirely on the side where {better} is better; \
         \"reversed\": on the other side; \"not shown\": otherwise. If there were no real differences, \
         about one comparison in twenty would still be held or reversed."
    );
    Ok(TableParts { columns: columns(measures, (better, than), points), rows, notes: vec![note] })
}

fn columns(measures: &[Measure], (better, than): (&str, &str), points: &[TestPoint]) -> Vec<Column> {
    let mut columns = vec![text_column("Condition")];
    if let [first, _, ..] = points {
        let unit = if matches!(first.after, Some(Budget::EnvSteps(_))) { "Env steps" } else { "Episodes" };
        let of_last_stage = if first.of_last_stage { " of the last stage" } else { "" };
        columns.push(number_column(format!("{unit}{of_last_stage}"), ""));
    }
    for measure in measures {
        let heading = |what: &str| format!("{}: {what}", measure.heading());
        columns.push(number_column(heading(better), measure.unit()));
        columns.push(number_column(heading(than), measure.unit()));
        columns.push(number_column(heading("difference"), measure.unit()));
        columns.push(text_column(&heading(&format!("{better} is better"))));
    }
    columns
}
