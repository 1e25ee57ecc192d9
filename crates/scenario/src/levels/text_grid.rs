//! Walls drawn as text: rows of characters, each of which is a solid or a free cell.

use std::fmt::Arguments;

use super::blocks::Blocks;
use super::cells::even_edges;
use super::draft::Draft;
use super::schema::LevelGenerator;
use crate::check::Diagnostics;
use crate::limits::{LEVEL_CELL_M, MAX_LEVEL_CELLS};
use crate::text::printable;

/// Characters of solid and of free cells.
const SOLID: char = '#';
const FREE: [char; 2] = ['.', ' '];

/// Adds the solid cells of the `rows`, the upper one first, which cover the enclosure.
pub(super) fn add(draft: &mut Draft, rows: &[String]) {
    let size = draft.size_m();
    let columns = rows.first().map_or(0, |row| row.chars().count());
    let solid = rows.iter().rev().flat_map(|row| row.chars().map(|cell| cell == SOLID)).collect();
    let (xs, ys) = (even_edges(size.x, columns), even_edges(size.y, rows.len()));
    let mut blocks = Blocks { xs, ys, solid };
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
    let columns = rows.first().map_or(0, |row| row.chars().count());
    let cells = rows.len().saturating_mul(columns);
    if cells == 0 || cells > MAX_LEVEL_CELLS as usize {
        let message = format!("has {cells} cells: write 1 to {MAX_LEVEL_CELLS}");
        return diagnostics.push(path, message);
    }
    for (k, row) in rows.iter().enumerate() {
        let path = format_args!("{path}[{k}]");
        let count = row.chars().count();
        let unknown = row.chars().enumerate().find(|(_, cell)| *cell != SOLID && !FREE.contains(cell));
        if let Some((column, cell)) = unknown {
            let cell = printable(&cell.to_string()).into_owned();
            let message = format!(
                "has `{cell}` in column {}: write # for a solid cell, or . for a free one",
                column + 1
            );
            diagnostics.push(path, message);
        } else if count != columns {
            let message =
                format!("has {count} cells, but the first row has {columns}: write rows of the same length");
            diagnostics.push(path, message);
        }
    }
    let least_m = *LEVEL_CELL_M.start();
    let sizes = [(generator.width_m.0, columns, "wide"), (generator.height_m.0, rows.len(), "high")];
    for (size_m, count, wide) in sizes {
        let cell_m = size_m / count as f32;
        if cell_m < least_m {
            let message = format!(
                "has cells only {cell_m} m {wide}: write fewer, or a larger enclosure; at least {least_m} m"
            );
            diagnostics.push(path, message);
        }
    }
}
