//! The parts that all panels of a curve chart share: the x axis and the event markers.

use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::model::EventMarker;
use crate::chart::layout::{LEFT, WIDTH};
use crate::style::{Axis, Canvas, DrawResult, HAIRLINE, SOFT_INK, TEXT, ellipsized, line, text_width, write};

/// The minimum space for a shortened label, in drawn pixels.
const MIN_LABEL: i32 = 90;
/// The maximum number of rows of labels.
const MAX_MARKER_ROWS: usize = 3;

/// The frame of a curve chart: the x axis and the edges that all panels share.
pub(super) struct Frame {
    /// The x axis.
    pub(super) x: Axis,
    /// The right edge of all plots, in drawn pixels; the left edge is `LEFT`.
    pub(super) right: i32,
}

impl Frame {
    pub(super) fn pixel_x(&self, x: f64) -> i32 {
        self.x.pixel(x, (LEFT, self.right))
    }

    pub(super) fn draw_x_axis(&self, root: &Canvas, name: &str, top: i32) -> DrawResult {
        for tick in self.x.ticks() {
            let at = self.pixel_x(tick);
            line(root, vec![(at, top), (at, top + 10)], SOFT_INK.stroke_width(HAIRLINE))?;
            write(root, &self.x.label(tick), (at, top + 32), TEXT, &SOFT_INK, HPos::Center)?;
        }
        let name = ellipsized(name, TEXT, self.right - LEFT);
        write(root, &name, ((LEFT + self.right) / 2, top + 76), TEXT, &SOFT_INK, HPos::Center)
    }

    /// The labels of the markers, each with its position, in rows from the plot upwards. A label is in the lowest row that has
    /// space for at least a few of its letters before the next label; one without space in any row is left out.
    pub(super) fn marker_rows<'a>(&self, markers: &[&'a EventMarker]) -> Vec<Vec<(i32, &'a str)>> {
        let mut labels: Vec<(i32, &str)> =
            markers.iter().map(|m| (self.pixel_x(m.x), m.label.as_str())).collect();
        labels.sort_unstable();
        let mut rows: Vec<Vec<(i32, &str)>> = Vec::new();
        for &(at, label) in labels.iter().rev() {
            let width = text_width(label, TEXT).min(MIN_LABEL);
            let has_space = |row: &Vec<(i32, &str)>| row.last().is_none_or(|next| at + width <= next.0 - 16);
            match rows.iter().position(has_space) {
                Some(row) => rows[row].push((at, label)),
                None if rows.len() < MAX_MARKER_ROWS => rows.push(vec![(at, label)]),
                None => {}
            }
        }
        rows.iter_mut().for_each(|row| row.reverse());
        rows
    }

    /// Writes a row of labels, each shortened to end before the next one. The last one is left out if it has no space for a
    /// few letters before the edge of the figure.
    pub(super) fn draw_marker_labels(&self, root: &Canvas, labels: &[(i32, &str)], y: i32) -> DrawResult {
        for (i, &(at, label)) in labels.iter().enumerate() {
            let end = labels.get(i + 1).map_or(WIDTH - 16, |next| next.0 - 16);
            let width = text_width(label, TEXT);
            // A label is written to the right of its line, or to the left if it is alone in its row and fits only there.
            if labels.len() == 1 && at + width > end && at - width > LEFT {
                write(root, label, (at, y), TEXT, &SOFT_INK, HPos::Right)?;
            } else if width.min(MIN_LABEL) <= end - at {
                write(root, &ellipsized(label, TEXT, end - at), (at, y), TEXT, &SOFT_INK, HPos::Left)?;
            }
        }
        Ok(())
    }

    pub(super) fn draw_marker_lines(
        &self,
        root: &Canvas,
        markers: &[&EventMarker],
        (upper, lower): (i32, i32),
    ) -> DrawResult {
        for marker in markers {
            let at = self.pixel_x(marker.x);
            let ends = [(at, upper), (at, lower)];
            root.draw(&DashedPathElement::new(ends, 8, 8, SOFT_INK.stroke_width(HAIRLINE)))?;
        }
        Ok(())
    }
}
