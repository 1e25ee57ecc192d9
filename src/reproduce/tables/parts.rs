//! Columns and cells that several kinds of tables use.

use crate::report::statistics::Estimate;
use crate::report::table::{Cell, Column, ColumnKind};
use crate::reproduce::measure::Measure;
use crate::reproduce::measured_value::{ArmValues, MeasuredValue};

/// The columns, rows and notes of a table.
#[derive(Default)]
pub(super) struct TableParts {
    pub(super) columns: Vec<Column>,
    pub(super) rows: Vec<Vec<Cell>>,
    pub(super) notes: Vec<String>,
}

pub(super) fn text_column(heading: &str) -> Column {
    Column { heading: heading.into(), unit: String::new(), kind: ColumnKind::Text }
}

pub(super) fn number_column(heading: impl Into<String>, unit: &str) -> Column {
    Column { heading: heading.into(), unit: unit.into(), kind: ColumnKind::Number }
}

pub(super) fn value_cell(value: &MeasuredValue, digits: usize) -> Cell {
    match *value {
        MeasuredValue { value, is_lower_bound: true } => Cell::AtLeast { value, digits },
        MeasuredValue { value, is_lower_bound: false } => Cell::Number { value, digits },
    }
}

pub(super) fn estimate_cell(estimate: Option<Estimate>, measure: Measure) -> Cell {
    estimate.map_or(Cell::Empty, |e| Cell::Estimate {
        mean: e.mean,
        half_width: e.half_width,
        limits: measure.limits(),
        digits: measure.digits(),
    })
}

/// The mean over the seeds with its interval; a lower bound if any value is one.
pub(super) fn mean_cell(values: &ArmValues, measure: Measure) -> Cell {
    match Estimate::from_values(&values.raw()) {
        Some(mean) if values.lower_bound_count() > 0 => {
            Cell::AtLeast { value: mean.mean, digits: measure.digits() }
        }
        mean => estimate_cell(mean, measure),
    }
}
