//! The drawing surface of figures: an SVG at twice the displayed size, with lines, areas and text.

use std::error::Error;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

/// The error of a figure that cannot be drawn.
#[derive(Debug, thiserror::Error)]
#[error("the figure could not be drawn: {0}")]
pub struct DrawError(String);

impl DrawError {
    pub(crate) fn new(why: impl ToString) -> Self {
        Self(why.to_string())
    }
}

/// Drawn pixels per pixel of the displayed SVG. plotters draws at whole pixels only, so figures are drawn at twice their
/// size.
const SCALE: u32 = 2;
// Line widths, in drawn pixels.
pub(crate) const HAIRLINE: u32 = 2;
pub(crate) const STROKE: u32 = 4;
/// The height of a line of text with its spacing, in drawn pixels.
pub(crate) const LINE_HEIGHT: i32 = 34;

// Text sizes: title, headings, everything else. plotters' SVG backend divides sizes by 1.24.
pub(crate) const TITLE: f64 = 20.0 * SCALE as f64 * 1.24;
pub(crate) const HEADING: f64 = 15.0 * SCALE as f64 * 1.24;
pub(crate) const TEXT: f64 = 13.0 * SCALE as f64 * 1.24;
const FONT: &str = "Helvetica, Arial, sans-serif";

pub(crate) type Canvas<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(crate) type DrawResult = Result<(), Box<dyn Error>>;
/// A position in drawn pixels: x to the right, y down.
pub(crate) type Pixel = (i32, i32);

/// The SVG of a figure on white, with the given size in drawn pixels. It is displayed at half that size.
pub(crate) fn draw_svg(
    (width, height): (u32, u32),
    draw: impl FnOnce(&Canvas) -> DrawResult,
) -> Result<String, DrawError> {
    let mut svg = String::new();
    let root = SVGBackend::with_string(&mut svg, (width, height)).into_drawing_area();
    root.fill(&WHITE).map_err(DrawError::new)?;
    draw(&root).map_err(DrawError::new)?;
    root.present().map_err(DrawError::new)?;
    drop(root);
    svg.retain(is_xml);
    let size = |scale| format!(r#"width="{}" height="{}""#, width / scale, height / scale);
    Ok(svg.replacen(&size(1), &size(SCALE), 1))
}

/// Whether XML 1.0 allows `c`. A file with any other character, even escaped, is not XML.
pub(crate) fn is_xml(c: char) -> bool {
    matches!(c, '\t' | '\n' | '\r' | ' '..='\u{fffd}' | '\u{10000}'..)
}

/// Writes a line of text, centred vertically at `at`.
pub(crate) fn write(
    root: &Canvas,
    text: &str,
    at: Pixel,
    size: f64,
    colour: &RGBColor,
    side: HPos,
) -> DrawResult {
    let style = (FONT, size).into_text_style(root).color(colour).pos(Pos::new(side, VPos::Center));
    root.draw(&Text::new(text, at, style))?;
    Ok(())
}

/// Draws a line through at least two points; fewer draw nothing.
pub(crate) fn line(root: &Canvas, points: Vec<Pixel>, style: ShapeStyle) -> DrawResult {
    if points.len() > 1 {
        root.draw(&PathElement::new(points, style))?;
    }
    Ok(())
}

/// Fills a polygon of at least three corners; fewer draw nothing.
pub(crate) fn area(root: &Canvas, corners: Vec<Pixel>, style: ShapeStyle) -> DrawResult {
    if corners.len() > 2 {
        root.draw(&Polygon::new(corners, style))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn characters_that_xml_does_not_allow_are_left_out() {
        let text = "A\u{0}\u{8}\u{1b}B\u{ffff}\u{fffe}C 迷路\u{1f916}";
        let write = |root: &Canvas| write(root, text, (10, 10), TEXT, &BLACK, HPos::Left);
        let svg = draw_svg((200, 100), write).expect("the image is drawn");
        assert!(svg.contains("ABC 迷路\u{1f916}") && svg.chars().all(is_xml), "{svg}");
    }

    #[test]
    fn a_figure_is_displayed_at_half_its_drawn_size() {
        let svg = draw_svg((200, 100), |_| Ok(())).expect("the image is drawn");
        assert!(svg.contains(r#"width="100" height="50" viewBox="0 0 200 100""#));
    }
}
