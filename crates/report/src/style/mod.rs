//! The common style of all figures: sizes, colours, lines, text, axes and the legend.
//!
//! Sizes are in drawn pixels, two per pixel of the displayed SVG. Figures can be read without colour:
//! every colour of the palette has its own marker shape, for colour-blind readers and for print in grey.

mod axis;
mod canvas;
mod labels;
mod legend;
mod markers;
mod palette;
mod text;

pub(crate) use axis::{Axis, bounds, is_drawable, thinned};
pub use canvas::DrawError;
pub(crate) use canvas::{
    Canvas, DrawResult, HAIRLINE, HEADING, LINE_HEIGHT, Pixel, STROKE, TEXT, area, draw_svg, is_xml, line,
    write,
};
pub(crate) use labels::{draw_title, spread, title_height};
pub(crate) use legend::{Legend, LegendEntry, Symbol};
pub(crate) use markers::{draw_marker, pixels_along};
pub(crate) use palette::{BLUE, GREEN, GRID, INK, SOFT_INK, VERMILION, colour};
pub(crate) use text::{ellipsized, text_width, wrapped};
