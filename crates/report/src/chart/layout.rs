//! The size of all figures, and what an empty one shows.

use plotters::style::text_anchor::HPos;

use crate::style::{Canvas, DrawResult, SOFT_INK, TEXT, write};

// In drawn pixels. Text stays legible when a figure is printed 12 cm wide.
pub(crate) const WIDTH: i32 = 1280;
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
