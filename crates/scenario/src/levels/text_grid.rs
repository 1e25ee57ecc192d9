//! Walls drawn as text: rows of characters, each of which is a solid or a free cell.

use std::fmt::Arguments;

use super::blocks::Blocks;
use super::cells::even_edges;
use super::draft::Draft;
use super::schema::LevelGenerator;
use crate::check::Diagnostics;
use crate::limits::{LEVEL_CELL_M, MAX_LEVEL_CELLS};
use crate::text_rows;

/// Adds the solid cells of the `rows`, given from top to bottom. The grid covers the enclosure. Free cells that are cut off from
/// the largest free area become solid.
pub(super) fn add(draft: &mut Draft, rows: &[String]) {
    let size = draft.size_m();
    let (xs, ys) = (even_edges(size.x, text_rows::columns(rows)), even_edges(size.y, rows.len()));
    let mut blocks = Blocks { xs, ys, solid: text_rows::solid_cells(rows) };
    blocks.fill_pockets();
    blocks.add_to(draft);
}

/// Checks the rows at `path`.
pub(super) fn check(
    path: Arguments<'_>,
    rows: &[String],
    generator: &LevelGenerator,
    diagnostics: &mut Diagnostics,
) {
    if !text_rows::check(path, rows, MAX_LEVEL_CELLS as usize, diagnostics) {
        return;
    }
    let columns = text_rows::columns(rows);
    let least_m = *LEVEL_CELL_M.start();
    let sizes = [(generator.width_m.0, columns, "wide"), (generator.height_m.0, rows.len(), "high")];
    for (size_m, count, adjective) in sizes {
        let cell_m = size_m / count as f32;
        if cell_m < least_m {
            let message = format!(
                "has cells only {cell_m} m {adjective}: write fewer cells or a larger enclosure, so that they are at least \
                 {least_m} m {adjective}"
            );
            diagnostics.push(path, message);
        }
    }
}
