//! A table: what its cells are, how they read, and how a script gets them.
//!
//! In: headings with units, cells that know what kind of number they are, notes. Out: the text of each cell, and
//! the table as CSV. `markdown` and `page` write the same table for people.

/// A table, ready to be written in any format.
#[derive(Clone, Debug, PartialEq)]
pub struct Table {
    /// Stem of its files' names, such as `table2`.
    pub name: String,
    /// What the table shows, in a line.
    pub title: String,
    /// The columns, from left to right. The first one names the rows.
    pub columns: Vec<Column>,
    /// The rows from top to bottom, a cell for each column. A row that is too short ends in empty cells.
    pub rows: Vec<Vec<Cell>>,
    /// What a reader must know beside the numbers, a sentence or two each.
    pub notes: Vec<String>,
}

/// A column's head.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// What the column holds.
    pub heading: String,
    /// The unit of its numbers; empty if there is none.
    pub unit: String,
    /// How it is set.
    pub kind: ColumnKind,
}

/// How a column is set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ColumnKind {
    /// Words, to the left.
    Text,
    /// Numbers, to the right, in figures of one width.
    Number,
}

/// What stands in one place of a table. `digits` are decimals. A value that is no finite number reads as a dash,
/// and a half width that is none is left out.
#[derive(Clone, Debug, PartialEq)]
pub enum Cell {
    /// Nothing.
    Empty,
    /// Words.
    Text(String),
    /// A number that is known as it stands: `1,500`.
    Number {
        /// The number.
        value: f64,
        /// Decimals shown.
        digits: usize,
    },
    /// A mean and how far it can be trusted: `99.4 ± 0.8`.
    Estimate {
        /// The mean.
        mean: f64,
        /// Half the width of its 95 % confidence interval, if one can be told.
        half_width: Option<f64>,
        /// Decimals shown.
        digits: usize,
    },
    /// A number of which only a lower bound is known, such as a time to an event that never came: `> 1,000`.
    AtLeast {
        /// The bound.
        value: f64,
        /// Decimals shown.
        digits: usize,
    },
    /// A difference, always with its sign: `+3.4 ± 1.2`.
    Signed {
        /// The difference.
        value: f64,
        /// Half the width of its 95 % confidence interval, if one can be told.
        half_width: Option<f64>,
        /// Decimals shown.
        digits: usize,
    },
    /// What became of a claim.
    ClaimResult(OutcomeCell),
}

/// What became of a claim once it was measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum OutcomeCell {
    /// The data show what was claimed.
    Held,
    /// The data show neither it nor its opposite.
    NotShown,
    /// The data show the opposite.
    Reversed,
}

impl OutcomeCell {
    /// The outcome in words.
    pub fn word(self) -> &'static str {
        match self {
            Self::Held => "held",
            Self::NotShown => "not shown",
            Self::Reversed => "reversed",
        }
    }

    /// A sign for it, of a shape that needs no colour to be told from the others.
    pub fn glyph(self) -> char {
        match self {
            Self::Held => '\u{2713}',
            Self::NotShown => '\u{25cb}',
            Self::Reversed => '\u{2717}',
        }
    }
}

impl Column {
    /// The heading with its unit, in a line.
    pub fn text(&self) -> String {
        if self.unit.is_empty() { self.heading.clone() } else { format!("{} ({})", self.heading, self.unit) }
    }
}

impl Cell {
    /// How the cell reads: true minus, thousands set apart by commas, a half width behind its `±`.
    pub fn text(&self) -> String {
        match self.half_width() {
            Some(half) => format!("{} \u{b1} {half}", self.value_text()),
            None => self.value_text(),
        }
    }

    /// How the cell reads up to a half width.
    pub(super) fn value_text(&self) -> String {
        match self {
            Self::Empty => String::new(),
            Self::Text(text) => text.clone(),
            Self::Number { value, digits } | Self::Estimate { mean: value, digits, .. } => {
                number(*value, *digits)
            }
            Self::AtLeast { value, digits } => format!("> {}", number(*value, *digits)),
            Self::Signed { value, digits, .. } => {
                let text = number(*value, *digits);
                let positive = *value > 0.0 && text.bytes().any(|b| (b'1'..=b'9').contains(&b));
                if positive { format!("+{text}") } else { text }
            }
            Self::ClaimResult(outcome) => format!("{} {}", outcome.glyph(), outcome.word()),
        }
    }

    /// How the half width reads, if the cell has one.
    pub(super) fn half_width(&self) -> Option<String> {
        self.half().map(|(half, digits)| number(half, digits))
    }

    /// The half width and its decimals, if both it and what it belongs to are known.
    fn half(&self) -> Option<(f64, usize)> {
        match *self {
            Self::Estimate { mean: value, half_width: Some(half), digits }
            | Self::Signed { value, half_width: Some(half), digits } => {
                (value.is_finite() && half.is_finite()).then_some((half.abs(), digits))
            }
            _ => None,
        }
    }
}

impl Table {
    /// The cell of a row in a column; empty where the row is too short.
    pub(super) fn cell(row: &[Cell], column: usize) -> &Cell {
        row.get(column).unwrap_or(&Cell::Empty)
    }

    /// The table as CSV: a line of headings, and a line for each row.
    ///
    /// Numbers are plain (`-1234.5678`), with two decimals more than are shown. A column that holds estimates or
    /// differences is followed by `<heading>, 95 % half width`; one that holds a censored value by
    /// `<heading>, censored`, which is `true` where the number is a lower bound only and `false` where it is
    /// the value itself. What is not known is left empty. Notes and title are not in it.
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
            writer.write_record(line).expect("all lines are of one length, and memory takes them");
        }
        let bytes = writer.into_inner().expect("memory takes all that was written");
        String::from_utf8_lossy(&bytes).into_owned()
    }
}

/// A cell's value as a script reads it.
fn value_field(cell: &Cell) -> String {
    match cell {
        Cell::Empty => String::new(),
        Cell::Text(text) => text.clone(),
        Cell::Number { value, digits }
        | Cell::Estimate { mean: value, digits, .. }
        | Cell::AtLeast { value, digits }
        | Cell::Signed { value, digits, .. } => plain(*value, *digits),
        Cell::ClaimResult(outcome) => outcome.word().to_owned(),
    }
}

/// A cell's half width as a script reads it.
fn half_width_field(cell: &Cell) -> String {
    cell.half().map_or(String::new(), |(half, digits)| plain(half, digits))
}

/// Whether a cell's value is a lower bound only, as a script reads it.
fn censored_field(cell: &Cell) -> String {
    match cell {
        Cell::Empty | Cell::Text(_) | Cell::ClaimResult(_) => String::new(),
        _ => matches!(cell, Cell::AtLeast { .. }).to_string(),
    }
}

/// More decimals than these say nothing about an `f64`.
const MAX_DIGITS: usize = 15;

/// A number for a script, two decimals finer than `digits`; nothing if it is not finite.
fn plain(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return String::new();
    }
    let text = format!("{value:.*}", (digits.min(MAX_DIGITS) + 2).min(MAX_DIGITS));
    let zero = text.bytes().all(|b| matches!(b, b'-' | b'0' | b'.'));
    if zero { text.trim_start_matches('-').to_owned() } else { text }
}

/// A number for a reader: so many decimals, a true minus, thousands set apart by commas; a dash if it is not finite.
pub fn number(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return "\u{2013}".to_owned();
    }
    let plain = format!("{:.*}", digits.min(MAX_DIGITS), value.abs());
    let whole = plain.find('.').unwrap_or(plain.len());
    let mut text = String::new();
    if value < 0.0 && plain.bytes().any(|b| (b'1'..=b'9').contains(&b)) {
        text.push('\u{2212}');
    }
    for (i, c) in plain.chars().enumerate() {
        if i > 0 && i < whole && (whole - i) % 3 == 0 {
            text.push(',');
        }
        text.push(c);
    }
    text
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    fn column(heading: &str, unit: &str, kind: ColumnKind) -> Column {
        Column { heading: heading.into(), unit: unit.into(), kind }
    }

    /// A table with a cell of each kind, and with markup in its words.
    pub fn sample() -> Table {
        Table {
            name: "table2".into(),
            title: "Success & time".into(),
            columns: vec![
                column("Agent", "", ColumnKind::Text),
                column("Success", "%", ColumnKind::Number),
                column("Episodes", "", ColumnKind::Number),
                column("Difference", "s", ColumnKind::Number),
                column("Claim", "", ColumnKind::Text),
            ],
            rows: vec![
                vec![
                    Cell::Text("a | b, <i>\"c\"</i>".into()),
                    Cell::Estimate { mean: 99.44, half_width: Some(0.81), digits: 1 },
                    Cell::Number { value: 1500.0, digits: 0 },
                    Cell::Signed { value: -3.4, half_width: Some(1.2), digits: 1 },
                    Cell::ClaimResult(OutcomeCell::Held),
                ],
                vec![
                    Cell::Text("DQN".into()),
                    Cell::Estimate { mean: f64::NAN, half_width: Some(1.0), digits: 1 },
                    Cell::AtLeast { value: 1800.0, digits: 0 },
                    Cell::Signed { value: 3.4, half_width: None, digits: 1 },
                ],
            ],
            notes: vec!["Mean of 5 seeds <each>.".into()],
        }
    }

    #[test]
    fn numbers_read_well() {
        for (value, digits, text) in [
            (0.0, 0, "0"),
            (-0.04, 1, "0.0"),
            (-0.05, 2, "\u{2212}0.05"),
            (999.9, 0, "1,000"),
            (-1_234_567.891, 2, "\u{2212}1,234,567.89"),
            (123.0, 1, "123.0"),
            (f64::NAN, 1, "\u{2013}"),
            (f64::NEG_INFINITY, 1, "\u{2013}"),
        ] {
            assert_eq!(number(value, digits), text);
        }
        assert!(number(1.0, usize::MAX).starts_with("1.0") && plain(1.0, usize::MAX).starts_with("1.0"));
    }

    #[test]
    fn cells_read_well() {
        let signed = |value, half_width| Cell::Signed { value, half_width, digits: 1 }.text();
        assert_eq!(signed(3.4, Some(1.2)), "+3.4 \u{b1} 1.2");
        assert_eq!(signed(-3.4, None), "\u{2212}3.4");
        assert_eq!(signed(0.01, None), "0.0", "what rounds to nothing has no sign");
        assert_eq!(signed(1.0, Some(f64::NAN)), "+1.0");
        let estimate = Cell::Estimate { mean: 99.44, half_width: Some(0.81), digits: 1 };
        assert_eq!(estimate.text(), "99.4 \u{b1} 0.8");
        assert_eq!(Cell::AtLeast { value: 1000.0, digits: 0 }.text(), "> 1,000");
        assert_eq!(Cell::ClaimResult(OutcomeCell::NotShown).text(), "\u{25cb} not shown");
        assert_eq!(Cell::Empty.text(), "");
    }

    #[test]
    fn a_script_reads_the_csv_back() {
        let csv = sample().to_csv();
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
    }

    #[test]
    fn a_table_without_columns_or_rows_is_no_error() {
        let bare = Table { columns: vec![], rows: vec![vec![Cell::Empty]], ..sample() };
        assert_eq!(bare.to_csv(), "");
        let empty = Table { rows: vec![], ..sample() };
        assert_eq!(empty.to_csv().lines().count(), 1);
    }
}
