//! The key under a figure's title: what its signs stand for.
//!
//! In: signs with their meaning. Out: they are drawn in a row, or in several if one is too short.

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::{
    Area, At, DrawResult, HAIRLINE, LINE_HEIGHT, SOFT_INK, STROKE, TEXT, area, ellipsized, line, mark,
    text_width, write,
};

/// Draws a sign around a place, in a field of `SIGN_WIDTH`.
type Symbol = fn(&Area, At) -> DrawResult;

/// What a sign means.
pub(crate) enum LegendEntry {
    /// A line of the palette with its mark, by number.
    Line(usize, String),
    /// Any other sign.
    Symbol(Symbol, &'static str),
}

/// The entries, laid out.
pub(crate) struct Legend {
    entries: Vec<(LegendEntry, At)>,
    rows: i32,
}

const SIGN_WIDTH: i32 = 60;
const SIGN_GAP: i32 = 12;
const ENTRY_GAP: i32 = 36;
const ROW_HEIGHT: i32 = LINE_HEIGHT + 6;

impl LegendEntry {
    fn text(&self) -> &str {
        match self {
            Self::Line(_, name) => name,
            Self::Symbol(_, name) => name,
        }
    }
}

impl Legend {
    /// Lays out the entries in rows of that width, in drawn pixels.
    pub fn new(entries: Vec<LegendEntry>, width: i32) -> Self {
        let (mut x, mut row) = (0, 0);
        let mut placed = Vec::new();
        for entry in entries {
            let wide = SIGN_WIDTH + SIGN_GAP + text_width(entry.text(), TEXT).min(width / 2);
            if x > 0 && x + wide > width {
                (x, row) = (0, row + 1);
            }
            placed.push((entry, (x, row * ROW_HEIGHT + ROW_HEIGHT / 2)));
            x += wide + ENTRY_GAP;
        }
        let rows = if placed.is_empty() { 0 } else { row + 1 };
        Self { entries: placed, rows }
    }

    /// What it takes, in drawn pixels.
    pub fn height(&self) -> i32 {
        self.rows * ROW_HEIGHT
    }

    /// Draws it, its upper left corner at a place.
    pub fn draw(&self, root: &Area, (left, top): At, width: i32) -> DrawResult {
        for (entry, (x, y)) in &self.entries {
            let (x, y) = (left + x, top + y);
            let middle = (x + SIGN_WIDTH / 2, y);
            match entry {
                LegendEntry::Symbol(sign, _) => sign(root, middle)?,
                LegendEntry::Line(number, _) => {
                    let colour = super::colour(*number);
                    line(root, vec![(x, y), (x + SIGN_WIDTH, y)], colour.stroke_width(STROKE))?;
                    mark(root, *number, middle)?;
                }
            }
            let text = ellipsized(entry.text(), TEXT, width / 2);
            write(root, &text, (x + SIGN_WIDTH + SIGN_GAP, y), TEXT, &SOFT_INK, HPos::Left)?;
        }
        Ok(())
    }
}

impl Legend {
    /// The sign of a band of values.
    pub fn band(root: &Area, (x, y): At) -> DrawResult {
        let corners = vec![(x - 28, y - 11), (x + 28, y - 11), (x + 28, y + 11), (x - 28, y + 11)];
        area(root, corners, SOFT_INK.mix(0.25).filled())
    }

    /// The sign of a smoothed line.
    pub fn smooth(root: &Area, (x, y): At) -> DrawResult {
        line(root, vec![(x - 28, y), (x + 28, y)], SOFT_INK.stroke_width(STROKE))
    }

    /// The sign of an unsmoothed line.
    pub fn raw(root: &Area, (x, y): At) -> DrawResult {
        let places = [(-28, 4), (-20, -7), (-12, 8), (-4, -3), (4, 6), (12, -8), (20, 3), (28, -4)];
        let places = places.into_iter().map(|(dx, dy)| (x + dx, y + dy)).collect();
        line(root, places, SOFT_INK.mix(0.6).stroke_width(HAIRLINE))
    }
}
