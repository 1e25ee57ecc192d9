//! Rows of dots: single values of several kinds of learner, with their mean and what the paper reports.
//!
//! In: for each column a cell per row. Out: an SVG of the columns side by side, which share the rows' names.

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::{WIDTH, draw_nothing};
use crate::statistics::Estimate;
use crate::style::{
    Area, At, Axis, BLUE, DrawError, DrawResult, GRID, HAIRLINE, HEADING, INK, Legend, LegendEntry, SOFT_INK,
    STROKE, TEXT, VERMILION, area, bounds, draw_title, ellipsized, is_drawable, line, picture, text_width,
    title_height, wrapped, write,
};

/// A horizontal dot plot.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DotPlot {
    /// What the figure is about, on top.
    pub title: String,
    /// The rows' names, from top to bottom. An empty name without values leaves a gap between groups.
    pub rows: Vec<String>,
    /// From left to right.
    pub columns: Vec<DotColumn>,
}

/// One measure, over all rows.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DotColumn {
    /// What is measured.
    pub heading: String,
    /// Its unit, written at the axis in words; nothing if empty.
    pub unit: String,
    /// What values there can be, as 0 to 100 for percents: intervals are cut off there. None: any.
    pub limits: Option<(f64, f64)>,
    /// One for each row, in the rows' order; missing ones are empty.
    pub cells: Vec<DotCell>,
}

/// What one row has in one column.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct DotCell {
    /// One for each seed, in the column's unit.
    pub values: Vec<f64>,
    /// Their mean and its interval, in the column's unit.
    pub estimate: Option<Estimate>,
    /// What the paper reports, in the column's unit.
    pub paper: Option<f64>,
    /// Some seeds never got there: their values lie farther right than any drawn.
    pub censored: bool,
}

// Sizes in drawn pixels.
const EDGE: i32 = 32;
const ROW_HEIGHT: i32 = 72;
/// Of a row without a name, which parts groups.
const GAP_HEIGHT: i32 = 32;
const COLUMN_GAP: i32 = 48;
const HEADING_LINE: i32 = 40;
const FOOT: i32 = 128;
/// Between a column's sides and its axis: room for dots and arrows at the ends.
const PADDING: i32 = 36;

impl DotPlot {
    /// Draws the figure, as the text of an SVG file.
    ///
    /// # Errors
    /// When the drawing library fails; none of the input is known to bring that about.
    pub fn svg(&self) -> Result<String, DrawError> {
        let columns: Vec<Column> = self.columns.iter().map(|c| Column::of(c, self.rows.len())).collect();
        let width = WIDTH - 2 * EDGE;
        let key = Legend::new(entries(&columns), width);
        let title_end = title_height(&self.title, width);

        let names = self.rows.iter().map(|row| text_width(row, TEXT)).max().unwrap_or(0).min(WIDTH / 3);
        let left = EDGE + names + 24;
        let count = columns.len().max(1) as i32;
        let column_width = (WIDTH - EDGE - left - (count - 1) * COLUMN_GAP) / count;
        let headings: Vec<_> = columns.iter().map(|c| wrapped(&c.heading, HEADING, column_width)).collect();
        let heading_lines = headings.iter().map(Vec::len).max().unwrap_or(1) as i32;
        let upper = title_end + key.height() + 24 + heading_lines * HEADING_LINE + 12;
        let (middles, end) = self.row_middles(upper);
        let lower = end.max(upper + 2 * ROW_HEIGHT);

        picture((WIDTH as u32, (lower + FOOT) as u32), |root| {
            draw_title(root, &self.title, (EDGE, width))?;
            key.draw(root, (EDGE, title_end), width)?;
            for (row, &y) in self.rows.iter().zip(&middles) {
                write(root, &ellipsized(row, TEXT, names), (left - 24, y), TEXT, &INK, HPos::Right)?;
            }
            for (i, (column, heading)) in (0..).zip(columns.iter().zip(&headings)) {
                let from = left + i * (column_width + COLUMN_GAP);
                for (row, text) in (0..).zip(heading.iter().rev()) {
                    let at = (from, upper - 32 - row * HEADING_LINE);
                    write(root, text, at, HEADING, &INK, HPos::Left)?;
                }
                column.draw(root, (from, from + column_width), (upper, lower), &middles)?;
            }
            if columns.is_empty() {
                draw_nothing(root, (left, WIDTH - EDGE), (upper, lower))?;
            }
            Ok(())
        })
    }

    /// The rows' heights on the drawing, and where the last ends.
    fn row_middles(&self, upper: i32) -> (Vec<i32>, i32) {
        let mut end = upper;
        let mut middle = |row: &String| {
            let height = if row.is_empty() { GAP_HEIGHT } else { ROW_HEIGHT };
            end += height;
            end - height / 2
        };
        let middles = self.rows.iter().map(&mut middle).collect();
        (middles, end)
    }
}

/// What of a column can be drawn, a cell to each row.
struct Column {
    heading: String,
    unit: String,
    limits: (f64, f64),
    cells: Vec<DotCell>,
}

impl Column {
    fn of(column: &DotColumn, rows: usize) -> Self {
        let drawable = |cell: &DotCell| DotCell {
            values: cell.values.iter().copied().filter(|&x| is_drawable(x)).collect(),
            estimate: cell.estimate.filter(|e| is_drawable(e.mean)),
            paper: cell.paper.filter(|&x| is_drawable(x)),
            censored: cell.censored,
        };
        let mut cells: Vec<_> = column.cells.iter().take(rows).map(drawable).collect();
        cells.resize(rows, DotCell::default());
        let limits = column.limits.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        Self { heading: column.heading.clone(), unit: column.unit.clone(), limits, cells }
    }

    /// An interval's ends, where values can be.
    fn ends(&self, estimate: &Estimate) -> [f64; 2] {
        let (least, most) = self.limits;
        [estimate.low(), estimate.high()].map(|x| x.max(least).min(most))
    }

    /// Around all values; intervals are cut off where they would more than double it.
    fn axis(&self, pixels: i32) -> Axis {
        let shown = || {
            let values = self.cells.iter().flat_map(|c| &c.values).copied();
            let means = self.cells.iter().filter_map(|c| c.estimate.map(|e| e.mean));
            values.chain(means).chain(self.cells.iter().filter_map(|c| c.paper))
        };
        let (low, high) = bounds(shown());
        let room = (high - low) / 2.0;
        let ends = self.cells.iter().filter_map(|c| c.estimate).flat_map(|e| self.ends(&e));
        let ends: Vec<f64> = ends.map(|x| x.clamp(low - room, high + room)).collect();
        let within = |ticks| Axis::within(shown().chain(ends.iter().copied()), ticks);
        // Ticks so far apart that their texts do not touch.
        let fits = |axis: &Axis| {
            let texts = axis.ticks().into_iter().map(|t| text_width(&axis.label(t), TEXT) + 24);
            let gap = axis.step / (axis.range.end - axis.range.start) * f64::from(pixels);
            f64::from(texts.max().unwrap_or(0)) <= gap
        };
        [5.0, 4.0, 3.0, 2.0].map(within).into_iter().find(fits).unwrap_or_else(|| within(1.0))
    }

    fn draw(&self, root: &Area, (left, right): At, (upper, lower): At, middles: &[i32]) -> DrawResult {
        let (from, to) = (left + PADDING, right - PADDING);
        let axis = self.axis(to - from);
        let at_x = |value| axis.place(value, (from, to));
        for tick in axis.ticks() {
            let at = at_x(tick);
            line(root, vec![(at, upper), (at, lower)], GRID.stroke_width(HAIRLINE))?;
            line(root, vec![(at, lower), (at, lower + 10)], SOFT_INK.stroke_width(HAIRLINE))?;
            write(root, &axis.label(tick), (at, lower + 32), TEXT, &SOFT_INK, HPos::Center)?;
        }
        line(root, vec![(left, lower), (right, lower)], SOFT_INK.stroke_width(HAIRLINE))?;
        let unit = ellipsized(&self.unit, TEXT, right - left);
        write(root, &unit, ((left + right) / 2, lower + 76), TEXT, &SOFT_INK, HPos::Center)?;

        for (cell, &y) in self.cells.iter().zip(middles) {
            if !cell.is_empty() {
                line(root, vec![(left, y), (right, y)], GRID.stroke_width(HAIRLINE))?;
            }
            if let Some(paper) = cell.paper {
                draw_paper(root, (at_x(paper), y))?;
            }
            if cell.censored {
                draw_arrow(root, (right, y))?;
            }
            for &value in &cell.values {
                draw_seed(root, (at_x(value), y + SEED_DROP))?;
            }
            if let Some(estimate) = cell.estimate {
                let ends = self.ends(&estimate).map(at_x);
                draw_mean(root, (at_x(estimate.mean), y), ends)?;
            }
        }
        if self.cells.iter().all(DotCell::is_empty) {
            draw_nothing(root, (left, right), (upper, lower))?;
        }
        Ok(())
    }
}

impl DotCell {
    fn is_empty(&self) -> bool {
        self.values.is_empty() && self.estimate.is_none() && self.paper.is_none() && !self.censored
    }
}

/// The key's entries: only of what there is.
fn entries(columns: &[Column]) -> Vec<LegendEntry> {
    let any = |has: fn(&DotCell) -> bool| columns.iter().flat_map(|c| &c.cells).any(has);
    let mut entries = Vec::new();
    if any(|c| c.estimate.is_some()) {
        let sign = |root: &Area, (x, y): At| draw_mean(root, (x, y), [x - 28, x + 28]);
        entries.push(LegendEntry::Symbol(sign, "mean and 95 % interval"));
    }
    if any(|c| !c.values.is_empty()) {
        entries.push(LegendEntry::Symbol(draw_seed, "one seed"));
    }
    if any(|c| c.paper.is_some()) {
        entries.push(LegendEntry::Symbol(|root, (x, y)| draw_paper(root, (x, y + 8)), "paper"));
    }
    if any(|c| c.censored) {
        entries.push(LegendEntry::Symbol(
            |root, (x, y)| draw_arrow(root, (x + 20, y)),
            "some seeds never got there",
        ));
    }
    entries
}

/// How far under the mean its seeds are drawn.
const SEED_DROP: i32 = 22;

fn draw_seed(root: &Area, at: At) -> DrawResult {
    root.draw(&Circle::new(at, 7, BLUE.mix(0.8).stroke_width(HAIRLINE)))?;
    Ok(())
}

fn draw_mean(root: &Area, (x, y): At, [low, high]: [i32; 2]) -> DrawResult {
    line(root, vec![(low, y), (high, y)], BLUE.stroke_width(STROKE))?;
    for end in [low, high].into_iter().filter(|_| low < high) {
        line(root, vec![(end, y - 8), (end, y + 8)], BLUE.stroke_width(STROKE))?;
    }
    root.draw(&Circle::new((x, y), 10, BLUE.filled()))?;
    Ok(())
}

fn draw_paper(root: &Area, (x, y): At) -> DrawResult {
    let top = y - 20;
    line(root, vec![(x, top), (x, y + 12)], VERMILION.stroke_width(STROKE))?;
    area(root, vec![(x, top - 10), (x + 10, top), (x, top + 10), (x - 10, top)], VERMILION.filled())
}

/// An arrow to the right that ends at a place.
fn draw_arrow(root: &Area, (x, y): At) -> DrawResult {
    line(root, vec![(x - 40, y), (x - 12, y)], INK.stroke_width(STROKE))?;
    area(root, vec![(x, y), (x - 18, y - 10), (x - 18, y + 10)], INK.filled())
}
