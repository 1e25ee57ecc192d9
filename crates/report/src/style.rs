//! The look that all figures share.
//!
//! In: what is to be drawn, in drawn pixels. Out: the text of an SVG; sizes, colours and marks for it. Colours are
//! Okabe and Ito's, which colour-blind readers can tell apart; each comes with a mark of its own shape, for print
//! in grey.

mod axis;
mod legend;
mod text;

use std::error::Error;

use plotters::coord::Shift;
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

pub(super) use axis::{Axis, bounds, is_drawable, thinned};
pub(super) use legend::{Legend, LegendEntry};
pub(super) use text::{ellipsized, text_width, wrapped};

/// The figure could not be drawn.
#[derive(Debug, thiserror::Error)]
#[error("the figure could not be drawn: {0}")]
pub struct DrawError(String);

impl DrawError {
    pub(super) fn new(why: impl ToString) -> Self {
        Self(why.to_string())
    }
}

// Sizes in drawn pixels: SCALE of them are one pixel shown. plotters knows whole pixels only.
pub(super) const SCALE: u32 = 2;
pub(super) const HAIRLINE: u32 = 2;
pub(super) const STROKE: u32 = 4;
/// A line of text with the room it needs.
pub(super) const LINE_HEIGHT: i32 = 34;

// One scale of type: title, headings, all else. plotters' SVG divides sizes by 1.24.
pub(super) const TITLE: f64 = 20.0 * SCALE as f64 * 1.24;
pub(super) const HEADING: f64 = 15.0 * SCALE as f64 * 1.24;
pub(super) const TEXT: f64 = 13.0 * SCALE as f64 * 1.24;
const FONT: &str = "Helvetica, Arial, sans-serif";

pub(super) const GREEN: RGBColor = RGBColor(0, 158, 115);
pub(super) const BLUE: RGBColor = RGBColor(0, 114, 178);
pub(super) const VERMILION: RGBColor = RGBColor(213, 94, 0);
pub(super) const INK: RGBColor = RGBColor(34, 34, 34);
pub(super) const SOFT_INK: RGBColor = RGBColor(96, 96, 96);
pub(super) const GRID: RGBColor = RGBColor(226, 226, 226);

const PALETTE: [RGBColor; 7] =
    [BLUE, VERMILION, GREEN, RGBColor(204, 121, 167), RGBColor(230, 159, 0), RGBColor(86, 180, 233), INK];

/// The palette's colour of that number, counted round.
pub(super) fn colour(number: usize) -> RGBColor {
    PALETTE[number % PALETTE.len()]
}

pub(super) type Area<'a> = DrawingArea<SVGBackend<'a>, Shift>;
pub(super) type DrawResult = Result<(), Box<dyn Error>>;
/// A place on the drawing.
pub(super) type At = (i32, i32);

/// A white picture of that size in drawn pixels, as SVG, shown at half the size.
pub(super) fn picture(
    (width, height): (u32, u32),
    draw: impl FnOnce(&Area) -> DrawResult,
) -> Result<String, DrawError> {
    let mut svg = String::new();
    let root = SVGBackend::with_string(&mut svg, (width, height)).into_drawing_area();
    root.fill(&WHITE).map_err(DrawError::new)?;
    draw(&root).map_err(DrawError::new)?;
    root.present().map_err(DrawError::new)?;
    drop(root);
    let size = |scale| format!(r#"width="{}" height="{}""#, width / scale, height / scale);
    Ok(svg.replacen(&size(1), &size(SCALE), 1))
}

/// Writes a line of text, centred on `at` in height.
pub(super) fn write(root: &Area, text: &str, at: At, size: f64, colour: &RGBColor, side: HPos) -> DrawResult {
    let style = (FONT, size).into_text_style(root).color(colour).pos(Pos::new(side, VPos::Center));
    root.draw(&Text::new(text, at, style))?;
    Ok(())
}

/// Draws a line through places, if there are two.
pub(super) fn line(root: &Area, points: Vec<At>, style: ShapeStyle) -> DrawResult {
    if points.len() > 1 {
        root.draw(&PathElement::new(points, style))?;
    }
    Ok(())
}

/// Fills the area that places enclose, if they are three.
pub(super) fn area(root: &Area, points: Vec<At>, style: ShapeStyle) -> DrawResult {
    if points.len() > 2 {
        root.draw(&Polygon::new(points, style))?;
    }
    Ok(())
}

/// Draws the palette's mark of that number: a filled shape with a white rim.
pub(super) fn mark(root: &Area, number: usize, (x, y): At) -> DrawResult {
    let corners: &[(f64, f64)] = match number % PALETTE.len() {
        1 => &[(-0.9, -0.9), (0.9, -0.9), (0.9, 0.9), (-0.9, 0.9)],
        2 => &[(0.0, -1.25), (1.15, 0.85), (-1.15, 0.85)],
        3 => &[(0.0, -1.4), (1.1, 0.0), (0.0, 1.4), (-1.1, 0.0)],
        4 => &[(0.0, 1.25), (1.15, -0.85), (-1.15, -0.85)],
        5 => &[
            (-0.4, -1.2),
            (0.4, -1.2),
            (0.4, -0.4),
            (1.2, -0.4),
            (1.2, 0.4),
            (0.4, 0.4),
            (0.4, 1.2),
            (-0.4, 1.2),
            (-0.4, 0.4),
            (-1.2, 0.4),
            (-1.2, -0.4),
            (-0.4, -0.4),
        ],
        6 => &[(-1.4, -0.6), (1.4, -0.6), (1.4, 0.6), (-1.4, 0.6)],
        _ => &[],
    };
    for (radius, colour) in [(13.0, WHITE), (9.0, colour(number))] {
        if corners.is_empty() {
            root.draw(&Circle::new((x, y), radius as i32, colour.filled()))?;
        } else {
            let place =
                |&(dx, dy): &(f64, f64)| (x + (dx * radius).round() as i32, y + (dy * radius).round() as i32);
            area(root, corners.iter().map(place).collect(), colour.filled())?;
        }
    }
    Ok(())
}

/// Places at even distances along a line of drawn pixels, the first after `first`.
pub(super) fn along(points: &[At], first: f64, distance: f64) -> Vec<At> {
    let mut found = Vec::new();
    let mut left = first;
    for pair in points.windows(2) {
        let ((x, y), (to_x, to_y)) = (pair[0], pair[1]);
        let (dx, dy) = (f64::from(to_x - x), f64::from(to_y - y));
        let length = dx.hypot(dy);
        while left <= length && length > 0.0 {
            let share = left / length;
            found.push((x + (dx * share).round() as i32, y + (dy * share).round() as i32));
            left += distance;
        }
        left -= length;
    }
    found
}

/// Moves heights apart until they are `gap` from each other within `low..=high`, or as far as there is room.
///
/// The heights' order stays; the same place in the list belongs to the same label.
pub(super) fn spread(heights: &[i32], gap: i32, (low, high): (i32, i32)) -> Vec<i32> {
    let count = heights.len() as i32;
    let gap = if count > 1 { gap.min((high - low) / (count - 1)) } else { gap };
    let mut order: Vec<usize> = (0..heights.len()).collect();
    order.sort_by_key(|&i| (heights[i], i));
    // Down from the top, each as near as can be; then up from the bottom, each no lower than there is room.
    let mut moved = heights.to_vec();
    let mut least = low;
    for &i in &order {
        moved[i] = moved[i].max(least);
        least = moved[i] + gap;
    }
    let mut most = high;
    for &i in order.iter().rev() {
        moved[i] = moved[i].min(most);
        most = moved[i] - gap;
    }
    moved
}

/// Writes a figure's title, in as many lines as it needs; the height it takes is [`title_height`].
pub(super) fn draw_title(root: &Area, title: &str, (left, width): (i32, i32)) -> DrawResult {
    for (line, text) in (0..).zip(wrapped(title, TITLE, width)) {
        write(root, &text, (left, 52 + line * 50), TITLE, &INK, HPos::Left)?;
    }
    Ok(())
}

/// How far down a title of that width reaches.
pub(super) fn title_height(title: &str, width: i32) -> i32 {
    40 + 50 * wrapped(title, TITLE, width).len() as i32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_are_moved_apart_and_stay_inside() {
        assert_eq!(spread(&[50, 10, 52], 20, (0, 100)), [50, 10, 70]);
        assert_eq!(spread(&[95, 98], 20, (0, 100)), [80, 100]);
        assert_eq!(spread(&[0, 0, 0], 80, (0, 100)), [0, 50, 100]);
        assert_eq!(spread(&[300], 20, (0, 100)), [100]);
        assert!(spread(&[], 20, (0, 100)).is_empty());
    }

    #[test]
    fn marks_lie_evenly_along_a_line() {
        let bent = [(0, 0), (10, 0), (10, 30)];
        assert_eq!(along(&bent, 5.0, 10.0), [(5, 0), (10, 5), (10, 15), (10, 25)]);
        assert!(along(&bent[..1], 5.0, 10.0).is_empty());
        assert!(along(&[(3, 3), (3, 3)], 0.0, 10.0).is_empty());
    }

    #[test]
    fn a_picture_is_drawn_at_twice_its_size() {
        let svg = picture((200, 100), |_| Ok(())).expect("is drawn");
        assert!(svg.contains(r#"width="100" height="50" viewBox="0 0 200 100""#));
    }
}
