//! The canonical text of a value.
//!
//! Each level is indented by four spaces. A value that fits into a line of 110 columns is written on one line; only the
//! top-level struct, lists of structs and lists of several strings always have one line per field or element. Fields that
//! equal their defaults are left out, unless all do.

use crate::literal::{columns, quoted, wrapped};
use crate::style::Style;
use crate::value::{Record, Value};

/// The maximum number of columns of a line.
const WIDTH: usize = 110;
/// The indentation of one level.
pub(crate) const INDENT: &str = "    ";

/// Writes values in the canonical form.
pub(crate) struct Formatter<'a> {
    /// The line ending.
    pub newline: &'static str,
    pub style: &'a Style,
}

/// The position in the text at which a value is written.
#[derive(Clone, Copy)]
pub(crate) struct Cursor<'a> {
    /// The indentation of its line.
    pub indent: &'a str,
    /// Its column, from 0.
    pub column: usize,
}

impl<'a> Formatter<'a> {
    pub fn new(newline: &'static str, style: &'a Style) -> Self {
        Self { newline, style }
    }

    /// The text of a whole file.
    pub fn file(&self, value: &Value) -> String {
        self.top_level(value) + self.newline
    }

    /// The text of the top-level value. A struct has one line per field, even if it would fit on one line.
    pub fn top_level(&self, value: &Value) -> String {
        let Some(record) = value.record().filter(|record| !record.fields.is_empty()) else {
            return self.value(value, Cursor { indent: "", column: 0 });
        };
        let mut text = format!("{}({}", record.variant, self.newline);
        let mut before = None;
        for (name, value) in self.written_fields(record) {
            if before.is_some_and(|before| self.style.blank_line_between(before, name)) {
                text += self.newline;
            }
            text += &(self.field(name, value, INDENT) + "," + self.newline);
            before = Some(*name);
        }
        text + ")"
    }

    /// The fields of a record that are written: those that differ from their defaults, or all if all equal their defaults.
    fn written_fields<'v>(&self, record: &'v Record) -> Vec<&'v (&'static str, Value)> {
        let all = self.style.is_all_default(record);
        record
            .fields
            .iter()
            .filter(|(name, value)| all || !self.style.is_default(record, name, value))
            .collect()
    }

    /// The text `name: value` of a field that starts a line.
    fn field(&self, name: &str, value: &Value, indent: &str) -> String {
        let column = columns(indent) + name.len() + 2;
        format!("{indent}{name}: {}", self.value(value, Cursor { indent, column }))
    }

    /// The text of `value` at `cursor`. It leaves space for a comma.
    pub fn value(&self, value: &Value, cursor: Cursor) -> String {
        if let Some(line) = self.line(value).filter(|line| cursor.column + columns(line) < WIDTH) {
            return line;
        }
        let indent = format!("{}{INDENT}", cursor.indent);
        let on_lines = |open, parts: &[Value], close| {
            let inner = Cursor { indent: &indent, column: columns(&indent) };
            let lines = parts.iter().map(|part| indent.clone() + &self.value(part, inner));
            self.lines(open, lines, cursor.indent, close)
        };
        match value {
            Value::Text(value) => wrapped(value, cursor.column, WIDTH, self.newline),
            Value::List(parts) => on_lines("[", parts, "]"),
            // A tuple takes several lines only if it contains a list that has to.
            Value::Tuple(parts) => self.line(value).unwrap_or_else(|| on_lines("(", parts, ")")),
            Value::Record(record) => {
                let fields = self.written_fields(record);
                let lines = fields.iter().map(|(name, value)| self.field(name, value, &indent));
                self.lines(&format!("{}(", record.variant), lines, cursor.indent, ")")
            }
            Value::Scalar(_) | Value::Null => self.line(value).unwrap_or_default(),
        }
    }

    /// A pair of brackets with one line per part. `indent` is the indentation of the closing bracket.
    fn lines(&self, open: &str, parts: impl Iterator<Item = String>, indent: &str, close: &str) -> String {
        let mut text = open.to_string() + self.newline;
        for part in parts {
            text += &(part + "," + self.newline);
        }
        text + indent + close
    }

    /// The text of `value` on one line; `None` if it contains a list of structs, or of several strings.
    fn line(&self, value: &Value) -> Option<String> {
        Some(match value {
            Value::Scalar(literal) => literal.clone(),
            Value::Text(text) => quoted(text),
            Value::Null => "None".into(),
            Value::Tuple(parts) => format!("({})", self.comma_separated(parts)?),
            Value::List(parts) if parts.iter().any(|part| part.record().is_some()) => return None,
            Value::List(parts) if parts.len() > 1 && matches!(parts[0], Value::Text(_)) => return None,
            Value::List(parts) => format!("[{}]", self.comma_separated(parts)?),
            Value::Record(record) if record.fields.is_empty() => record.variant.into(),
            Value::Record(record) => {
                let mut parts = Vec::new();
                for (name, value) in self.written_fields(record) {
                    parts.push(format!("{name}: {}", self.line(value)?));
                }
                format!("{}({})", record.variant, parts.join(", "))
            }
        })
    }

    fn comma_separated(&self, parts: &[Value]) -> Option<String> {
        let parts: Option<Vec<_>> = parts.iter().map(|part| self.line(part)).collect();
        Some(parts?.join(", "))
    }
}
