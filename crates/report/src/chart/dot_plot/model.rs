//! The data of a dot plot.

use crate::statistics::Estimate;
use crate::style::is_drawable;

/// A horizontal dot plot: a row for each algorithm or condition, a column for each measure.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DotPlot {
    /// The title above the figure.
    pub title: String,
    /// The rows' names, from top to bottom. An empty name without values is a gap between groups.
    pub rows: Vec<String>,
    /// The columns, from left to right.
    pub columns: Vec<DotColumn>,
}

/// One measure, over all rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DotColumn {
    /// The name of the measure.
    pub heading: String,
    /// The unit, written below the axis; it may be empty.
    pub unit: String,
    /// The range of possible values, such as 0 to 100 for percentages; intervals are cut off at its ends. `None` means no limits.
    pub limits: Option<(f64, f64)>,
    /// A cell for each row, in the rows' order; missing cells are empty.
    pub cells: Vec<DotCell>,
}

/// The values of one row in one column, all in the column's unit.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DotCell {
    /// A value for each seed.
    pub values: Vec<f64>,
    /// The mean of the values and its interval.
    pub estimate: Option<Estimate>,
    /// The paper's value.
    pub paper: Option<f64>,
    /// Whether some seeds never reached the measured event, so that their true values lie further to the right.
    pub censored: bool,
}

impl DotCell {
    /// The cell with only the values that can be drawn.
    pub(super) fn drawable(&self) -> Self {
        Self {
            values: self.values.iter().copied().filter(|&x| is_drawable(x)).collect(),
            estimate: self.estimate.filter(|e| is_drawable(e.mean)),
            paper: self.paper.filter(|&x| is_drawable(x)),
            censored: self.censored,
        }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.values.is_empty() && self.estimate.is_none() && self.paper.is_none() && !self.censored
    }
}
