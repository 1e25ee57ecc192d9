//! The parts that all panels of a curve chart share: the x axis and the event markers.

use plotters::element::DashedPathElement;
use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::model::EventMarker;
use crate::chart::layout::{LEFT, WIDTH};
use crate::style::{Axis, Canvas, DrawResult, HAIRLINE, SOFT_INK, TEXT, ellipsized, line, text_width, write};

/// The minimum space for a shortened label, in drawn pixels.
const MIN_LABEL: i32 = 90;

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

    /// Writes the labels of the markers in one row, each shortened to end before the next marker. One without space for
    /// a few letters is left out.
    pub(super) fn draw_marker_labels(&self, root: &Canvas, markers: &[&EventMarker], y: i32) -> DrawResult {
        let mut labels: Vec<(i32, &str)> =
            markers.iter().map(|m| (self.pixel_x(m.x), m.label.as_str())).collect();
        labels.sort_unstable();
        for (i, &(at, label)) in labels.iter().enumerate() {
            let end = labels.get(i + 1).map_or(WIDTH - 16, |next| next.0 - 16);
            let width = text_width(label, TEXT);
            // A label is written to the right of its line, or to the left if it is the only one and fits only there.
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
