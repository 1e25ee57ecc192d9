//! Dot plots: a dot for each seed, the mean over the seeds with its interval, and the paper's value.
//!
//! | file | contents |
//! |---|---|
//! | `model.rs` | the data of a dot plot |
//! | `column.rs` | one column |
//! | `symbols.rs` | the symbols and their legend |

mod column;
mod model;
mod symbols;

use plotters::style::text_anchor::HPos;

use column::ColumnDrawing;
pub use model::{DotCell, DotColumn, DotPlot};

use super::layout::{WIDTH, draw_no_data};
use crate::style::{
    DrawError, HEADING, INK, TEXT, draw_svg, draw_title, ellipsized, text_width, title_height, wrapped, write,
};

// In drawn pixels.
const EDGE: i32 = 32;
const ROW_HEIGHT: i32 = 72;
/// The height of a row without a name, which separates groups.
const GAP_HEIGHT: i32 = 32;
const COLUMN_GAP: i32 = 48;
/// With many columns, the figure becomes wider than [`WIDTH`] rather than its columns narrower than this.
const MIN_COLUMN_WIDTH: i32 = 200;
const HEADING_LINE: i32 = 40;
const FOOT: i32 = 128;

impl DotPlot {
    /// The figure as the text of an SVG file.
    ///
    /// # Errors
    /// The drawing library failed. No input is known to cause this.
    pub fn svg(&self) -> Result<String, DrawError> {
        let columns: Vec<_> = self.columns.iter().map(|c| ColumnDrawing::new(c, self.rows.len())).collect();
        let width = WIDTH - 2 * EDGE;
        let legend = symbols::legend(columns.iter().flat_map(|c| &c.cells), width);
        let title_end = title_height(&self.title, width);

        let names = self.rows.iter().map(|row| text_width(row, TEXT)).max().unwrap_or(0).min(WIDTH / 3);
        let left = EDGE + names + 24;
        let count = columns.len().max(1) as i32;
        let gaps = (count - 1) * COLUMN_GAP;
        let column_width = ((WIDTH - EDGE - left - gaps) / count).max(MIN_COLUMN_WIDTH);
        let figure_width = WIDTH.max(left + count * column_width + gaps + EDGE);
        let headings: Vec<_> = columns.iter().map(|c| wrapped(c.heading, HEADING, column_width)).collect();
        let heading_lines = headings.iter().map(Vec::len).max().unwrap_or(1) as i32;
        let upper = title_end + legend.height() + 24 + heading_lines * HEADING_LINE + 12;
        let (row_middles, end) = self.row_middles(upper);
        let lower = end.max(upper + 2 * ROW_HEIGHT);

        draw_svg((figure_width as u32, (lower + FOOT) as u32), |root| {
            draw_title(root, &self.title, (EDGE, width))?;
            legend.draw(root, (EDGE, title_end), width)?;
            for (row, &y) in self.rows.iter().zip(&row_middles) {
                write(root, &ellipsized(row, TEXT, names), (left - 24, y), TEXT, &INK, HPos::Right)?;
            }
            for (i, (column, heading)) in (0..).zip(columns.iter().zip(&headings)) {
                let from = left + i * (column_width + COLUMN_GAP);
                for (row, text) in (0..).zip(heading.iter().rev()) {
                    let at = (from, upper - 32 - row * HEADING_LINE);
                    write(root, text, at, HEADING, &INK, HPos::Left)?;
                }
                column.draw(root, (from, from + column_width), (upper, lower), &row_middles)?;
            }
            if columns.is_empty() {
                draw_no_data(root, (left, WIDTH - EDGE), (upper, lower))?;
            }
            Ok(())
        })
    }

    /// The y position of each row's middle, and the lower end of the last row.
    fn row_middles(&self, upper: i32) -> (Vec<i32>, i32) {
        let mut end = upper;
        let mut middle = |row: &String| {
            let height = if row.is_empty() { GAP_HEIGHT } else { ROW_HEIGHT };
            end += height;
            end - height / 2
        };
        let middles = self.rows.iter().map(&mut middle).collect();
        (middles, end)
    }
}
