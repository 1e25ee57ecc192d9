//! One column of a dot plot: its axis and its cells.

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::model::{DotCell, DotColumn};
use super::symbols::{SEED_DROP, draw_arrow, draw_mean, draw_paper, draw_seed};
use crate::chart::layout::draw_no_data;
use crate::statistics::Estimate;
use crate::style::{
    Axis, Canvas, DrawResult, GRID, HAIRLINE, Pixel, SOFT_INK, TEXT, bounds, ellipsized, line, text_width,
    write,
};

/// Space between a column's sides and its range of values, for dots and arrows at the ends, in drawn pixels.
const PADDING: i32 = 36;

/// The drawable values of a column: one cell per row.
pub(super) struct ColumnDrawing<'a> {
    pub(super) heading: &'a str,
    unit: &'a str,
    limits: Option<(f64, f64)>,
    pub(super) cells: Vec<DotCell>,
}

impl<'a> ColumnDrawing<'a> {
    pub(super) fn new(column: &'a DotColumn, rows: usize) -> Self {
        let mut cells: Vec<_> = column.cells.iter().take(rows).map(DotCell::drawable).collect();
        cells.resize(rows, DotCell::default());
        Self { heading: &column.heading, unit: &column.unit, limits: column.limits, cells }
    }

    /// The ends of an interval, cut off at the limits.
    fn ends(&self, estimate: &Estimate) -> [f64; 2] {
        let (low, high) = self.limits.unwrap_or((f64::NEG_INFINITY, f64::INFINITY));
        [estimate.low(), estimate.high()].map(|x| x.max(low).min(high))
    }

    /// The axis. It spans all values; intervals extend it to at most twice that range.
    fn axis(&self, pixels: i32) -> Axis {
        let shown = || {
            let values = self.cells.iter().flat_map(|c| &c.values).copied();
            let means = self.cells.iter().filter_map(|c| c.estimate.map(|e| e.mean));
            values.chain(means).chain(self.cells.iter().filter_map(|c| c.paper))
        };
        let (low, high) = bounds(shown());
        let margin = (high - low) / 2.0;
        let ends = self.cells.iter().filter_map(|c| c.estimate).flat_map(|e| self.ends(&e));
        let ends: Vec<f64> = ends.map(|x| x.clamp(low - margin, high + margin)).collect();
        let with_ticks = |count| Axis::within_limits(shown().chain(ends.iter().copied()), self.limits, count);
        // The number of ticks is limited so that their labels do not touch.
        let fits = |axis: &Axis| {
            let widths = axis.ticks().into_iter().map(|t| text_width(&axis.label(t), TEXT) + 24);
            let gap = axis.step / (axis.range.end - axis.range.start) * f64::from(pixels);
            f64::from(widths.max().unwrap_or(0)) <= gap
        };
        let axis = [5.0, 4.0, 3.0, 2.0].map(with_ticks).into_iter().find(fits);
        // For a count of 1, the distance between ticks may be so large that the range contains no tick.
        let coarsest = || Some(with_ticks(1.0)).filter(|axis| !axis.ticks().is_empty());
        axis.or_else(coarsest).unwrap_or_else(|| with_ticks(2.0))
    }

    /// Draws the column between two x and two y positions; `row_middles` are the rows' y positions.
    pub(super) fn draw(
        &self,
        root: &Canvas,
        (left, right): Pixel,
        (upper, lower): Pixel,
        row_middles: &[i32],
    ) -> DrawResult {
        let (from, to) = (left + PADDING, right - PADDING);
        let axis = self.axis(to - from);
        for tick in axis.ticks() {
            let at = axis.pixel(tick, (from, to));
            line(root, vec![(at, upper), (at, lower)], GRID.stroke_width(HAIRLINE))?;
            line(root, vec![(at, lower), (at, lower + 10)], SOFT_INK.stroke_width(HAIRLINE))?;
            write(root, &axis.label(tick), (at, lower + 32), TEXT, &SOFT_INK, HPos::Center)?;
        }
        line(root, vec![(left, lower), (right, lower)], SOFT_INK.stroke_width(HAIRLINE))?;
        let unit = ellipsized(self.unit, TEXT, right - left);
        write(root, &unit, ((left + right) / 2, lower + 76), TEXT, &SOFT_INK, HPos::Center)?;
        for (cell, &y) in self.cells.iter().zip(row_middles) {
            self.draw_cell(root, cell, (left, right, y), &axis)?;
        }
        if self.cells.iter().all(DotCell::is_empty) {
            draw_no_data(root, (left, right), (upper, lower))?;
        }
        Ok(())
    }

    fn draw_cell(
        &self,
        root: &Canvas,
        cell: &DotCell,
        (left, right, y): (i32, i32, i32),
        axis: &Axis,
    ) -> DrawResult {
        let pixel_x = |value| axis.pixel(value, (left + PADDING, right - PADDING));
        if !cell.is_empty() {
            line(root, vec![(left, y), (right, y)], GRID.stroke_width(HAIRLINE))?;
        }
        if let Some(paper) = cell.paper {
            draw_paper(root, (pixel_x(paper), y))?;
        }
        if cell.censored {
            draw_arrow(root, (right, y))?;
        }
        for &value in &cell.values {
            draw_seed(root, (pixel_x(value), y + SEED_DROP))?;
        }
        if let Some(estimate) = cell.estimate {
            let is_shown = |end: f64| axis.range.start <= end && end <= axis.range.end;
            let ends = self.ends(&estimate).map(|end| (pixel_x(end), is_shown(end)));
            draw_mean(root, (pixel_x(estimate.mean), y), ends)?;
        }
        Ok(())
    }
}
