//! The HTML format of tables.

use maud::{Markup, html};

use super::parts::{claim_list, files, outcome, unbroken};
use crate::claim::ClaimResult;
use crate::table::{Cell, Column, ColumnKind, Table};

pub(super) fn table_block(table: &Table, claim_results: &[ClaimResult]) -> Markup {
    let label = format!("caption-{}", table.name);
    let intervals: Vec<_> = (0..table.columns.len()).map(|i| interval_length(table, i)).collect();
    html! {
        div.table id={ "table-" (table.name) } {
            div.scroll role="region" tabindex="0" aria-labelledby=(label) {
                table {
                    caption id=(label) { span { (table.title) } }
                    thead { tr { @for column in &table.columns { (heading(column)) } } }
                    tbody {
                        @for row in &table.rows {
                            tr {
                                @for (i, (column, length)) in table.columns.iter().zip(&intervals).enumerate() {
                                    (cell(Table::cell(row, i), column.kind, *length, i == 0))
                                }
                            }
                        }
                    }
                }
            }
            @if !table.notes.is_empty() {
                ul.notes { @for note in &table.notes { li { (unbroken(note)) } } }
            }
            (files("tables", &table.name, &[("CSV", "csv"), ("Markdown", "md")]))
            (claim_list(claim_results))
        }
    }
}

/// The number of characters in a column's longest interval.
fn interval_length(table: &Table, column: usize) -> usize {
    let intervals = table.rows.iter().map(|row| Table::cell(row, column).interval_text());
    intervals.map(|interval| interval.trim_start().chars().count()).max().unwrap_or(0)
}

fn class(kind: ColumnKind) -> &'static str {
    match kind {
        ColumnKind::Text => "words",
        ColumnKind::Number => "number",
    }
}

fn heading(column: &Column) -> Markup {
    html! {
        th scope="col" class=(class(column.kind)) {
            (column.heading)
            @if !column.unit.is_empty() { " " span.unit { "(" (column.unit) ")" } }
        }
    }
}

/// A cell of a table. In a column with intervals, all cells reserve the same width for them, so that the means align.
fn cell(cell: &Cell, kind: ColumnKind, interval_length: usize, first: bool) -> Markup {
    let content = html! {
        @if let Cell::Outcome(what) = cell { (outcome(*what)) } @else { (cell.value_text()) }
        @if interval_length > 0 && kind == ColumnKind::Number {
            span.half style={ "min-width:" (interval_length) "ch" } { (cell.interval_text()) }
        } @else {
            (cell.interval_text())
        }
    };
    html! {
        @if first {
            th scope="row" class=(class(kind)) { (content) }
        } @else {
            td class=(class(kind)) { (content) }
        }
    }
}
