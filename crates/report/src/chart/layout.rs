//! The dimensions that all figures share, and the text of an empty plot.

use plotters::style::text_anchor::HPos;

use crate::style::{Canvas, DrawResult, SOFT_INK, TEXT, write};

/// The width of a figure, in drawn pixels (two per displayed pixel). Text stays legible when the figure is printed 12 cm wide.
pub(crate) const WIDTH: i32 = 1280;
/// The left edge of the plots, in drawn pixels.
pub(crate) const LEFT: i32 = 128;

/// Writes "no data yet" into the middle of an empty plot.
pub(crate) fn draw_no_data(
    root: &Canvas,
    (left, right): (i32, i32),
    (upper, lower): (i32, i32),
) -> DrawResult {
    let middle = ((left + right) / 2, (upper + lower) / 2);
    write(root, "no data yet", middle, TEXT, &SOFT_INK, HPos::Center)
}
