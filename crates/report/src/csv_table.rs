//! The CSV format of tables.

use crate::format::{MAX_DECIMALS, is_zero};
use crate::table::{Cell, Table};

impl Table {
    /// The table as CSV: a line of headings, then a line for each row. Title and notes are left out.
    ///
    /// Numbers are plain (`-1234.5678`), with two more decimals than in the report. A column of estimates or differences is
    /// followed by a column `<heading>, 95 % half width`. A column with a censored value is followed by a column
    /// `<heading>, censored`: `true` where the number is only a lower bound. Unknown values are empty.
    #[must_use]
    pub fn to_csv(&self) -> String {
        let mut lines = vec![Vec::new(); self.rows.len() + 1];
        for (i, column) in self.columns.iter().enumerate() {
            let heading = column.text();
            let cells: Vec<_> = self.rows.iter().map(|row| Self::cell(row, i)).collect();
            let mut add = |heading: String, field: fn(&Cell) -> String| {
                let fields = cells.iter().map(|cell| field(cell));
                for (line, text) in lines.iter_mut().zip(std::iter::once(heading).chain(fields)) {
                    line.push(text);
                }
            };
            add(heading.clone(), value_field);
            if cells.iter().any(|cell| matches!(cell, Cell::Estimate { .. } | Cell::Signed { .. })) {
                add(format!("{heading}, 95 % half width"), half_width_field);
            }
            if cells.iter().any(|cell| matches!(cell, Cell::AtLeast { .. })) {
                add(format!("{heading}, censored"), censored_field);
            }
        }
        let mut writer = csv::Writer::from_writer(Vec::new());
        for line in lines.iter().filter(|line| !line.is_empty()) {
            writer.write_record(line).expect("lines of equal length can be written to memory");
        }
        let bytes = writer.into_inner().expect("memory can be flushed");
        String::from_utf8_lossy(&bytes).into_owned()
    }
}

fn value_field(cell: &Cell) -> String {
    match cell {
        Cell::Empty => String::new(),
        Cell::Text(text) => text.clone(),
        Cell::Number { value, digits }
        | Cell::Estimate { mean: value, digits, .. }
        | Cell::AtLeast { value, digits }
        | Cell::Signed { value, digits, .. } => plain(*value, *digits),
        Cell::Outcome(outcome) => outcome.word().to_owned(),
    }
}

fn half_width_field(cell: &Cell) -> String {
    cell.half_width().map_or(String::new(), |(half, digits)| plain(half, digits))
}

fn censored_field(cell: &Cell) -> String {
    match cell {
        Cell::Empty | Cell::Text(_) | Cell::Outcome(_) => String::new(),
        _ => matches!(cell, Cell::AtLeast { .. }).to_string(),
    }
}

/// `value` as a plain number with two decimals more than `digits`; empty if it is not finite.
fn plain(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return String::new();
    }
    let text = format!("{value:.*}", (digits.min(MAX_DECIMALS) + 2).min(MAX_DECIMALS));
    if is_zero(&text) { text.trim_start_matches('-').to_owned() } else { text }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::samples;

    #[test]
    fn a_csv_reader_reads_all_values_back() {
        let csv = samples::table().to_csv();
        let mut reader = csv::Reader::from_reader(csv.as_bytes());
        let headings: Vec<_> = reader.headers().expect("headings").iter().map(str::to_owned).collect();
        assert_eq!(
            headings,
            [
                "Agent",
                "Success (%)",
                "Success (%), 95 % half width",
                "Episodes",
                "Episodes, censored",
                "Difference (s)",
                "Difference (s), 95 % half width",
                "Claim"
            ]
        );
        let rows: Vec<Vec<String>> = reader.deserialize().map(|row| row.expect("a row")).collect();
        assert_eq!(
            rows,
            [
                ["a | b, <i>\"c\"</i>", "99.440", "0.810", "1500.00", "false", "-3.400", "1.200", "held"],
                ["DQN", "", "", "1800.00", "true", "3.400", "", ""],
            ]
        );
        assert_eq!(plain(-0.0001, 1), "0.000");
        assert!(plain(1.0, usize::MAX).starts_with("1.0"));
    }

    #[test]
    fn a_table_without_columns_or_rows_has_a_csv() {
        let bare = Table { columns: vec![], rows: vec![vec![Cell::Empty]], ..samples::table() };
        assert_eq!(bare.to_csv(), "");
        let empty = Table { rows: vec![], ..samples::table() };
        assert_eq!(empty.to_csv().lines().count(), 1);
    }
}
