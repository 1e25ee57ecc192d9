//! The legend below a figure's title: symbols with their names, in rows.

use plotters::prelude::*;
use plotters::style::text_anchor::HPos;

use super::canvas::{Canvas, DrawResult, LINE_HEIGHT, Pixel, STROKE, TEXT, line, write};
use super::markers::draw_marker;
use super::palette::{SOFT_INK, colour};
use super::text::{ellipsized, text_width};

/// Draws a symbol centred on a point, at most `SYMBOL_WIDTH` wide.
pub(crate) type Symbol = fn(&Canvas, Pixel) -> DrawResult;

/// A symbol and its name.
pub(crate) enum LegendEntry {
    /// A line in a palette colour, by index, with its marker.
    Line(usize, String),
    /// Any other symbol.
    Symbol(Symbol, String),
}

/// Legend entries with their positions.
pub(crate) struct Legend {
    entries: Vec<(LegendEntry, Pixel)>,
    rows: i32,
}

const SYMBOL_WIDTH: i32 = 60;
const SYMBOL_GAP: i32 = 12;
const ENTRY_GAP: i32 = 36;
const ROW_HEIGHT: i32 = LINE_HEIGHT + 6;

impl LegendEntry {
    fn text(&self) -> &str {
        match self {
            Self::Line(_, name) | Self::Symbol(_, name) => name,
        }
    }
}

impl Legend {
    /// A legend in rows of `width` drawn pixels.
    pub(crate) fn new(entries: Vec<LegendEntry>, width: i32) -> Self {
        let (mut x, mut row) = (0, 0);
        let mut placed = Vec::new();
        for entry in entries {
            let entry_width = SYMBOL_WIDTH + SYMBOL_GAP + text_width(entry.text(), TEXT).min(width / 2);
            if x > 0 && x + entry_width > width {
                (x, row) = (0, row + 1);
            }
            placed.push((entry, (x, row * ROW_HEIGHT + ROW_HEIGHT / 2)));
            x += entry_width + ENTRY_GAP;
        }
        let rows = if placed.is_empty() { 0 } else { row + 1 };
        Self { entries: placed, rows }
    }

    /// The height in drawn pixels.
    pub(crate) fn height(&self) -> i32 {
        self.rows * ROW_HEIGHT
    }

    /// Draws the legend with its upper left corner at the given point. `width` is that of [`Legend::new`].
    pub(crate) fn draw(&self, root: &Canvas, (left, top): Pixel, width: i32) -> DrawResult {
        for (entry, (x, y)) in &self.entries {
            let (x, y) = (left + x, top + y);
            let middle = (x + SYMBOL_WIDTH / 2, y);
            match entry {
                LegendEntry::Symbol(symbol, _) => symbol(root, middle)?,
                LegendEntry::Line(index, _) => {
                    line(root, vec![(x, y), (x + SYMBOL_WIDTH, y)], colour(*index).stroke_width(STROKE))?;
                    draw_marker(root, *index, middle)?;
                }
            }
            let text = ellipsized(entry.text(), TEXT, width / 2);
            write(root, &text, (x + SYMBOL_WIDTH + SYMBOL_GAP, y), TEXT, &SOFT_INK, HPos::Left)?;
        }
        Ok(())
    }
}
