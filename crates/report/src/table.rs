//! Tables: headings with units, cells and notes.
//!
//! A table is written as CSV or Markdown, or as HTML in a [page](crate::page).

use crate::claim::ClaimOutcome;
use crate::format::{cut, interval, is_zero, number};

/// A table.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// The stem of the table's file names, such as `table2`.
    pub name: String,
    /// The title, in one line.
    pub title: String,
    /// The columns, from left to right. The first one names the rows.
    pub columns: Vec<Column>,
    /// The rows, from top to bottom, with a cell for each column. Missing cells at the end of a row are empty.
    pub rows: Vec<Vec<Cell>>,
    /// Notes below the table, a sentence or two each.
    pub notes: Vec<String>,
}

/// A column: its heading, its unit and the kind of its cells.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// The heading.
    pub heading: String,
    /// The unit of the numbers; it may be empty.
    pub unit: String,
    /// The kind of the cells.
    pub kind: ColumnKind,
}

/// The kind of a column's cells, which determines their alignment.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnKind {
    /// Text, aligned to the left.
    Text,
    /// Numbers, aligned to the right.
    Number,
}

/// A cell of a table. A non-finite value is displayed as a dash; an unknown or non-finite half width is left out.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Nothing.
    Empty,
    /// Text.
    Text(String),
    /// An exact number: `1,500`.
    Number {
        /// The number.
        value: f64,
        /// Decimals shown.
        digits: usize,
    },
    /// A mean with its interval: `99.4 ± 0.8`, or `99.9 (99.6 to 100.0)` if an end is cut off.
    Estimate {
        /// The mean.
        mean: f64,
        /// Half the width of its 95 % confidence interval, if known.
        half_width: Option<f64>,
        /// The range of possible values, if it is bounded.
        limits: Option<(f64, f64)>,
        /// Decimals shown.
        digits: usize,
    },
    /// A lower bound, such as the time to an event that never happened: `> 1,000`.
    AtLeast {
        /// The bound.
        value: f64,
        /// Decimals shown.
        digits: usize,
    },
    /// A difference, always with its sign: `+3.4 ± 1.2`.
    Signed {
        /// The difference.
        value: f64,
        /// Half the width of its 95 % confidence interval, if known.
        half_width: Option<f64>,
        /// The range of possible differences, if it is bounded.
        limits: Option<(f64, f64)>,
        /// Decimals shown.
        digits: usize,
    },
    /// The outcome of a claim: `✓ held`.
    Outcome(ClaimOutcome),
}

impl Column {
    /// The heading with its unit in brackets.
    #[must_use]
    pub fn text(&self) -> String {
        if self.unit.is_empty() { self.heading.clone() } else { format!("{} ({})", self.heading, self.unit) }
    }
}

impl Cell {
    /// The cell as shown: with a true minus sign, commas between thousands, and the interval.
    #[must_use]
    pub fn text(&self) -> String {
        self.value_text() + &self.interval_text()
    }

    /// Whether an end of the cell's interval is cut off because values beyond it are impossible.
    #[must_use]
    pub fn is_cut(&self) -> bool {
        let (Self::Estimate { mean: value, limits, .. } | Self::Signed { value, limits, .. }) = *self else {
            return false;
        };
        self.half_width().is_some_and(|(half, _)| cut(value, half, limits).is_some())
    }

    /// The cell as shown, without its interval.
    pub(crate) fn value_text(&self) -> String {
        match self {
            Self::Empty => String::new(),
            Self::Text(text) => text.clone(),
            Self::Number { value, digits } | Self::Estimate { mean: value, digits, .. } => {
                number(*value, *digits)
            }
            Self::AtLeast { value, digits } => format!("> {}", number(*value, *digits)),
            Self::Signed { value, digits, .. } => {
                let text = number(*value, *digits);
                if *value > 0.0 && !is_zero(&text) { format!("+{text}") } else { text }
            }
            Self::Outcome(outcome) => format!("{} {}", outcome.glyph(), outcome.word()),
        }
    }

    /// The interval as shown after the value; empty if the cell has none.
    pub(crate) fn interval_text(&self) -> String {
        match *self {
            Self::Estimate { mean: value, half_width, limits, digits }
            | Self::Signed { value, half_width, limits, digits } => {
                interval(value, half_width, limits, digits)
            }
            _ => String::new(),
        }
    }

    /// The half width and its decimals, if both the half width and the value are finite.
    pub(crate) fn half_width(&self) -> Option<(f64, usize)> {
        match *self {
            Self::Estimate { mean: value, half_width: Some(half), digits, .. }
            | Self::Signed { value, half_width: Some(half), digits, .. } => {
                (value.is_finite() && half.is_finite()).then_some((half.abs(), digits))
            }
            _ => None,
        }
    }
}

impl Table {
    /// The cell of a row in a column; empty if the row is too short.
    pub(crate) fn cell(row: &[Cell], column: usize) -> &Cell {
        row.get(column).unwrap_or(&Cell::Empty)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cells_are_shown_with_sign_half_width_and_bound() {
        let signed = |value, half_width| Cell::Signed { value, half_width, limits: None, digits: 1 }.text();
        assert_eq!(signed(3.4, Some(1.2)), "+3.4 \u{b1} 1.2");
        assert_eq!(signed(-3.4, None), "\u{2212}3.4");
        assert_eq!(signed(0.01, None), "0.0", "a value that rounds to zero has no sign");
        assert_eq!(signed(1.0, Some(f64::NAN)), "+1.0");
        let limits = Some((0.0, 100.0));
        let estimate = |mean, half| Cell::Estimate { mean, half_width: Some(half), limits, digits: 1 };
        assert_eq!(
            (estimate(99.04, 0.81).text().as_str(), estimate(99.04, 0.81).is_cut()),
            ("99.0 \u{b1} 0.8", false)
        );
        let cut = estimate(99.44, 0.81);
        assert_eq!(
            (cut.text().as_str(), cut.is_cut()),
            ("99.4 (98.6 to 100.0)", true),
            "no rate is above 100 %"
        );
        assert_eq!(estimate(62.5, 158.8).text(), "62.5 (0.0 to 100.0)", "two seeds");
        assert_eq!(Cell::AtLeast { value: 1000.0, digits: 0 }.text(), "> 1,000");
        assert_eq!(Cell::Outcome(ClaimOutcome::NotShown).text(), "\u{25cb} not shown");
        assert_eq!(Cell::Empty.text(), "");
    }
}
