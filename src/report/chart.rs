//! The figures of a comparison, one look for all of them.
//!
//! In: plain numbers, already averaged: [`Curves`] over episodes, [`Dots`] for single values by row, [`Map`] for
//! a world and the ways through it. Out: each as the text of an SVG file. A value that is no finite number is left
//! out, and a figure without any says "nothing yet". No figure needs colour to be read.

use plotters::style::text_anchor::HPos;

use super::style::{Area, Drawn, SOFT_INK, TEXT, write};

mod curves;
mod dots;
mod map;

pub use curves::{Curves, Level, Line, Panel, Point, XMark};
pub use dots::{DotCell, DotColumn, Dots};
pub use map::{Map, Path};

// Sizes in drawn pixels. A figure is narrow enough for its type to be legible 12 cm wide on paper.
const WIDTH: i32 = 1280;
const LEFT: i32 = 128;

/// Says that there is nothing to be shown, between two lines of the grid.
fn draw_nothing(root: &Area, (left, right): (i32, i32), (upper, lower): (i32, i32)) -> Drawn {
    let middle = ((left + right) / 2, upper + (lower - upper) * 5 / 8);
    write(root, "nothing yet", middle, TEXT, &SOFT_INK, HPos::Center)
}
