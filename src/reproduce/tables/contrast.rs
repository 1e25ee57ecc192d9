//! Tables of one arm against another, by condition and number of episodes.

use super::parts::{TableParts, mean_cell, number_column, text_column};
use crate::report::table::{Cell, Column};
use crate::reproduce::claim_result::compare;
use crate::reproduce::measure::Measure;
use crate::reproduce::results::Results;
use crate::run::RunError;

pub(super) fn contrast(
    results: &Results<'_>,
    index: usize,
    measures: &[Measure],
    (better, than): (&str, &str),
    afters: &[u64],
    of_last_stage: bool,
) -> Result<TableParts, RunError> {
    let conditions = &results.experiment(index).conditions;
    let mut rows = Vec::new();
    for condition in 0..conditions.len().max(1) {
        for &after in afters {
            let name = conditions.get(condition).map_or("unchanged", |c| c.name.as_str());
            let mut row = vec![Cell::Text(name.into())];
            if afters.len() > 1 {
                row.push(Cell::Number { value: after as f64, digits: 0 });
            }
            for &measure in measures {
                let when = (after, of_last_stage);
                let values = |arm| results.values_by_arm_name(index, condition, arm, measure, when);
                let (first, second) = (values(better)?, values(than)?);
                let comparison = compare(measure, &first, &second);
                row.extend([mean_cell(&first, measure), mean_cell(&second, measure)]);
                row.push(comparison.difference.map_or(Cell::Empty, |difference| Cell::Signed {
                    value: difference.mean,
                    half_width: difference.half_width,
                    digits: measure.digits(),
                }));
                row.push(Cell::Outcome(comparison.outcome));
            }
            rows.push(row);
        }
    }
    let note = format!(
        "\"held\": the 95 % interval of the difference lies entirely on the side where {better} is better; \
         \"reversed\": on the other side; \"not shown\": it contains 0. About one in twenty comparisons is held or \
         reversed by chance."
    );
    Ok(TableParts {
        columns: columns(measures, (better, than), afters.len() > 1, of_last_stage),
        rows,
        notes: vec![note],
    })
}

fn columns(
    measures: &[Measure],
    (better, than): (&str, &str),
    with_episodes: bool,
    of_last_stage: bool,
) -> Vec<Column> {
    let mut columns = vec![text_column("Condition")];
    if with_episodes {
        let heading = if of_last_stage { "Episodes of the last stage" } else { "Episodes" };
        columns.push(number_column(heading, ""));
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
