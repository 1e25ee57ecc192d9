//! The tables of an experiment, with notes on how the numbers were obtained.
//!
//! | file | contents |
//! |---|---|
//! | `seeds.rs` | a table of every seed's value |
//! | `contrast.rs` | a table of one arm against another |
//! | `parts.rs` | columns and cells |
//! | `notes.rs` | notes |

mod contrast;
mod notes;
mod parts;
mod seeds;

use parts::{TableParts, mean_cell, number_column, text_column};

use super::measure::Measure;
use super::records::Windows;
use super::results::{ArmIndex, Results};
use super::rows::{row_name, rows};
use super::table_spec::{TableKind, TableSpec};
use super::test_point::{TestPoint, contrast_points};
use crate::report::statistics::Estimate;
use crate::report::table::{Cell, Table};
use crate::run::RunError;

/// Makes a table of the experiment at `index`.
///
/// # Errors
/// Results are missing.
pub fn make(results: &Results<'_>, index: usize, spec: &TableSpec) -> Result<Table, RunError> {
    let overall = TestPoint::overall;
    let TableParts { columns, rows, mut notes } = match &spec.show {
        TableKind::Seeds { measure, after, paper } => {
            seeds::seeds(results, index, *measure, overall(*after), paper)?
        }
        TableKind::Rounds { after, paper } => rounds(results, index, overall(*after), paper)?,
        TableKind::Measures { measures, after } => means(results, index, measures, overall(*after))?,
        TableKind::Contrast { measures, better, than, after, of_last_stage } => {
            let points = contrast_points(after, *of_last_stage);
            contrast::contrast(results, index, measures, (better, than), &points)?
        }
    };
    notes.extend(notes::notes(results, index, spec)?);
    if rows.iter().flatten().any(Cell::is_cut) {
        notes.push("(a to b): the 95 % interval, cut off at the limit of possible values.".into());
    }
    Ok(Table { name: spec.name.clone(), title: spec.title.clone(), columns, rows, notes })
}

/// Success round by round: for each arm, a row for the paper's results, if given, and a row for each seed.
fn rounds(
    results: &Results<'_>,
    index: usize,
    point: TestPoint,
    paper: &[(String, Vec<f64>)],
) -> Result<TableParts, RunError> {
    let experiment = results.experiment(index);
    let count = experiment.test.rounds;
    let mut columns = vec![text_column("")];
    columns.extend((1..=count).map(|round| number_column(format!("Round {round}"), "%")));
    columns.push(number_column("Mean", "%"));
    let mut table_rows = Vec::new();
    for row in rows(results, index) {
        let name = row_name(results, row);
        if let Some((_, rounds)) = paper.iter().find(|(of, _)| *of == experiment.arms[row.arm].name) {
            table_rows.push(round_row(format!("{name}: paper"), rounds, count));
        }
        for (seed, run) in results.arm_runs(row) {
            let rounds = results.rounds(row, run, point)?;
            table_rows.push(round_row(format!("{name}: seed {seed}"), &rounds, count));
        }
    }
    Ok(TableParts { columns, rows: table_rows, notes: Vec::new() })
}

/// A row of the first `count` rounds, in percent, and the mean of all rounds. The paper may have more or fewer than `count`.
fn round_row(name: String, rounds: &[f64], count: usize) -> Vec<Cell> {
    let mut row = vec![Cell::Text(name)];
    let cell = |round: usize| match rounds.get(round) {
        Some(&value) => Cell::Number { value, digits: 0 },
        None => Cell::Empty,
    };
    row.extend((0..count).map(cell));
    let mean = Estimate::from_values(rounds);
    row.push(mean.map_or(Cell::Empty, |mean| Cell::Number { value: mean.mean, digits: 1 }));
    row
}

/// Means with their intervals: a row for each arm and condition, a column for each measure.
fn means(
    results: &Results<'_>,
    index: usize,
    measures: &[Measure],
    point: TestPoint,
) -> Result<TableParts, RunError> {
    let mut columns = vec![text_column("")];
    columns.extend(measures.iter().map(|measure| number_column(measure.heading(), measure.unit())));
    let row = |row: ArmIndex| {
        let mut cells = vec![Cell::Text(row_name(results, row))];
        for &measure in measures {
            cells.push(mean_cell(&results.values(row, measure, point, Windows::default())?, measure));
        }
        Ok(cells)
    };
    let rows = rows(results, index).into_iter().map(row).collect::<Result<_, RunError>>()?;
    Ok(TableParts { columns, rows, notes: Vec::new() })
}
