//! Grids of cells drawn as text: each character of a row is a solid or a free cell.

use std::fmt::Arguments;
use std::ops::Range;

use super::check::Diagnostics;
use super::text::printable;

/// The character of a solid cell.
const SOLID: char = '#';
/// The characters of a free cell.
const FREE: [char; 2] = ['.', ' '];

/// Number of columns of the `rows`: the length of the first.
pub(super) fn columns(rows: &[String]) -> usize {
    rows.first().map_or(0, |row| row.chars().count())
}

/// Whether each cell of the `rows` is solid, the bottom row first. Rows are padded or cut to the length of the first.
pub(super) fn solid_cells(rows: &[String]) -> Vec<bool> {
    let columns = columns(rows);
    let cells = |row: &String| {
        let solid = row.chars().map(|cell| cell == SOLID).chain(std::iter::repeat(false));
        solid.take(columns).collect::<Vec<_>>()
    };
    rows.iter().rev().flat_map(cells).collect()
}

/// Checks that the `rows` at `path` have 1 to `most` cells in all, known characters, and equal lengths. Returns whether the
/// number of cells is valid.
pub(super) fn check(
    path: Arguments<'_>,
    rows: &[String],
    most: usize,
    diagnostics: &mut Diagnostics,
) -> bool {
    let columns = columns(rows);
    let cells = rows.len().saturating_mul(columns);
    if cells == 0 || cells > most {
        diagnostics.push(path, format!("has {cells} cells: write 1 to {most}"));
        return false;
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
    true
}

/// The `solid` cells of a grid, merged into few rectangles of columns and rows: each as wide, then as high as possible.
pub(super) fn merged(mut solid: Vec<bool>, columns: usize) -> Vec<(Range<usize>, Range<usize>)> {
    let rows = solid.len() / columns.max(1);
    let mut rectangles = Vec::new();
    for cell in 0..solid.len() {
        if !solid[cell] {
            continue;
        }
        let (row, column) = (cell / columns, cell % columns);
        let right = (column..columns).find(|&other| !solid[row * columns + other]).unwrap_or(columns);
        let is_solid = |row: usize| (column..right).all(|other| solid[row * columns + other]);
        let top = (row..rows).find(|&other| !is_solid(other)).unwrap_or(rows);
        for row in row..top {
            solid[row * columns + column..row * columns + right].fill(false);
        }
        rectangles.push((column..right, row..top));
    }
    rectangles
}
