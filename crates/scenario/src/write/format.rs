//! The canonical text of a tree, in the style of the shipped files.
//!
//! Four spaces a level; what fits a line of 110 columns stands in one, but a list of structs has each in a line of its
//! own; fields that have their default are left out.

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::tree::{Node, Record};
use crate::load::parse_ron;
use crate::schema::{
    BenchmarkRoute, Generator, Lidar, Obstacle, ObstacleMotion, PlacementRule, Robot, Scenario, TaskRules,
    Wall,
};

/// The most columns of a line.
const WIDTH: usize = 110;
/// One level.
pub(super) const INDENT: &str = "    ";

/// How to spell trees.
pub(super) struct Formatter {
    /// What ends a line.
    pub newline: &'static str,
    /// The records that can do without some field, as the shortest text for them is read, with the fields it lacks.
    shortest: Vec<Record>,
}

/// Where a value is to stand.
#[derive(Clone, Copy)]
pub(super) struct Cursor<'a> {
    /// What its line starts with.
    pub indent: &'a str,
    /// In which column it starts, from 0.
    pub column: usize,
}

impl Formatter {
    /// One that ends lines with `newline`.
    pub fn new(newline: &'static str) -> Self {
        let shortest = [
            shortest::<Scenario>("(name: \"\")", &["name"]),
            shortest::<Wall>("(corners_m: [])", &["corners_m"]),
            shortest::<Obstacle>(
                "(shape: Circle(radius_m: 1.0), position_m: (0.0, 0.0))",
                &["shape", "position_m"],
            ),
            shortest::<ObstacleMotion>(
                "RandomWalk(radius_m: 1.0, speed_m_s: 1.0)",
                &["radius_m", "speed_m_s"],
            ),
            shortest::<Generator>("(count: 1, shape: Circle(radius_m: (1.0, 1.0)))", &["count", "shape"]),
            shortest::<Robot>("()", &[]),
            shortest::<Lidar>("()", &[]),
            shortest::<TaskRules>("()", &[]),
            shortest::<BenchmarkRoute>("()", &[]),
            shortest::<PlacementRule>("Random()", &[]),
            shortest::<PlacementRule>("Within(min_m: (0.0, 0.0), max_m: (0.0, 0.0))", &["min_m", "max_m"]),
            shortest::<PlacementRule>("Fixed(position_m: (0.0, 0.0))", &["position_m"]),
        ];
        Self { newline, shortest: shortest.into_iter().flatten().collect() }
    }

    /// Whether `value` is what a file that lacks the field means.
    pub fn is_default(&self, record: &Record, field: &str, value: &Node) -> bool {
        let same = |other: &&Record| other.kind == record.kind && other.variant == record.variant;
        let fields = self.shortest.iter().find(same).map_or(&[][..], |shortest| &shortest.fields);
        fields.iter().any(|(name, default)| *name == field && default == value)
    }

    /// Whether all fields of `record` have their defaults.
    pub fn is_all_default(&self, record: &Record) -> bool {
        record.fields.iter().all(|(name, value)| self.is_default(record, name, value))
    }

    /// The fields of a record that are written: those without their default, but all if that would be none.
    fn written<'a>(&self, record: &'a Record) -> Vec<&'a (&'static str, Node)> {
        let all = self.is_all_default(record);
        record.fields.iter().filter(|(name, value)| all || !self.is_default(record, name, value)).collect()
    }

    /// The whole file.
    pub fn file(&self, scenario: &Record) -> String {
        self.root(scenario) + self.newline
    }

    /// The scenario, from bracket to bracket.
    pub fn root(&self, scenario: &Record) -> String {
        let mut text = String::from("(") + self.newline;
        let mut before = None;
        for (name, value) in self.written(scenario) {
            if before.is_some_and(|before| blank_line_between(before, name)) {
                text += self.newline;
            }
            text += &(self.field(name, value, INDENT) + "," + self.newline);
            before = Some(*name);
        }
        text + ")"
    }

    /// `key: value` at the start of a line that `indent` begins.
    pub fn field(&self, name: &str, value: &Node, indent: &str) -> String {
        let column = columns(indent) + name.len() + 2;
        format!("{indent}{name}: {}", self.value(value, Cursor { indent, column }))
    }

    /// `value` at `place`, with room for a comma after it.
    pub fn value(&self, value: &Node, place: Cursor) -> String {
        if let Some(line) = self.line(value).filter(|line| place.column + columns(line) < WIDTH) {
            return line;
        }
        let inner = format!("{}{INDENT}", place.indent);
        let broken = |open: &str, parts: &mut dyn Iterator<Item = String>, close: &str| {
            let mut text = open.to_string() + self.newline;
            for part in parts {
                text += &(part + "," + self.newline);
            }
            text + place.indent + close
        };
        match value {
            Node::Text(value) => self.broken_text(value, place.column),
            Node::List(parts) => {
                let column = columns(&inner);
                let mut parts = parts
                    .iter()
                    .map(|part| inner.clone() + &self.value(part, Cursor { indent: &inner, column }));
                broken("[", &mut parts, "]")
            }
            Node::Record(record) => {
                let fields = self.written(record);
                let mut parts = fields.iter().map(|(name, value)| self.field(name, value, &inner));
                broken(&format!("{}(", record.variant), &mut parts, ")")
            }
            Node::Tuple(_) | Node::Scalar(_) | Node::Null => self.line(value).unwrap_or_default(),
        }
    }

    /// `value` in one line; none if it wants several.
    pub fn line(&self, value: &Node) -> Option<String> {
        let joined = |parts: &[Node]| -> Option<String> {
            let parts: Option<Vec<_>> = parts.iter().map(|part| self.line(part)).collect();
            Some(parts?.join(", "))
        };
        Some(match value {
            Node::Scalar(word) => word.clone(),
            Node::Text(text) => quoted(text),
            Node::Null => "None".into(),
            Node::Tuple(parts) => format!("({})", joined(parts)?),
            Node::List(parts) if parts.iter().any(|part| part.record().is_some()) => return None,
            Node::List(parts) => format!("[{}]", joined(parts)?),
            Node::Record(record) if record.fields.is_empty() => record.variant.into(),
            Node::Record(record) => {
                let mut parts = Vec::new();
                for (name, value) in self.written(record) {
                    parts.push(format!("{name}: {}", self.line(value)?));
                }
                format!("{}({})", record.variant, parts.join(", "))
            }
        })
    }

    /// A text in quotes over several lines, each but the last ending in a space and `\`, which RON reads as nothing
    /// (with the spaces that the next line starts with).
    fn broken_text(&self, text: &str, column: usize) -> String {
        let mut spelled = String::new();
        let mut width = column + 1;
        let mut words = text.split_inclusive(' ').peekable();
        while let Some(word) = words.next() {
            let word = escaped(word);
            spelled += &word;
            width += columns(&word);
            // Room for this word's follower and its comma or backslash; a follower of spaces only would be lost.
            let follower = words.peek().map_or(0, |next| columns(&escaped(next)) + 3);
            if follower > 0
                && width + follower > WIDTH
                && words.peek().is_some_and(|next| !next.starts_with(char::is_whitespace))
            {
                spelled += &(String::from("\\") + self.newline);
                width = 0;
            }
        }
        format!("\"{spelled}\"")
    }
}

/// Whether an empty line stands between two neighbouring fields of the whole.
pub(super) fn blank_line_between(before: &str, after: &str) -> bool {
    !matches!((before, after), ("name", "about") | ("starts", "goals"))
}

/// How many columns `text` takes, if it is one line.
pub(super) fn columns(text: &str) -> usize {
    text.chars().count()
}

/// The record that `text` is read as, without the fields that it `has`.
fn shortest<T: Serialize + DeserializeOwned>(text: &str, has: &[&str]) -> Option<Record> {
    let value: T = parse_ron(text, "").ok()?;
    let mut record = Node::from_value(&value).ok()?.record()?.clone();
    record.fields.retain(|(name, _)| !has.contains(name));
    Some(record)
}

fn quoted(text: &str) -> String {
    format!("\"{}\"", escaped(text))
}

fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for c in text.chars() {
        match c {
            '"' => escaped += "\\\"",
            '\\' => escaped += "\\\\",
            '\n' => escaped += "\\n",
            '\r' => escaped += "\\r",
            '\t' => escaped += "\\t",
            c if c.is_control() => escaped += &format!("\\u{{{:x}}}", u32::from(c)),
            c => escaped.push(c),
        }
    }
    escaped
}
