//! The messages for ron's errors: the problem, its field, and the fix.
//!
//! In: the text and ron's [`SpannedError`]. Out: a [`Problem`] with a byte offset, a message, and how to go on reading.

use std::ops::Range;

use ron::error::{Error, Position, SpannedError};

use wayfield_ron_patch::SourceMap;

use super::choices::choice_problem;
use super::lookalike::lookalike;
use super::number_text::{comma_problem, cut_number, cut_number_problem, pair_problem, with_unit};

/// A problem that ron found in a text.
pub(super) struct Problem {
    /// Byte offset in the text.
    pub offset: usize,
    /// The problem and its fix.
    pub message: String,
    /// A change of the text after which reading may go on behind the problem.
    pub repair: Option<Repair>,
}

/// A change of a text that removes a problem.
pub(super) enum Repair {
    /// The range gets another text.
    Replace(Range<usize>, &'static str),
    /// The range gets any valid value.
    Value(Range<usize>),
    /// A field is added to the struct that starts at the offset.
    Add { start: usize, owner: String, field: &'static str },
}

/// The position of a problem: a text, ron's cursor before and after the error, and a map of the text.
struct Place<'a> {
    text: &'a str,
    start: usize,
    end: usize,
    map: SourceMap<'a>,
}

/// The problem behind `error`, which ron found in `text`. `parse` returns ron's error for another text.
pub(super) fn explain(
    text: &str,
    error: &SpannedError,
    parse: &dyn Fn(&str) -> Option<SpannedError>,
) -> Problem {
    let (start, end) = (offset(text, error.span.start), offset(text, error.span.end));
    let place = Place { text, start, end, map: SourceMap::new(text) };
    place
        .foreign_character()
        .or_else(|| place.other_format(&error.code))
        .or_else(|| place.number(&error.code))
        .or_else(|| place.name(&error.code))
        .or_else(|| place.choice(&error.code, parse))
        .or_else(|| place.value(&error.code))
        .unwrap_or_else(|| place.syntax(&error.code))
}

impl Place<'_> {
    fn problem(&self, offset: usize, message: impl Into<String>) -> Problem {
        Problem { offset, message: message.into(), repair: None }
    }

    /// The text after ron's cursor.
    fn rest(&self) -> &str {
        &self.text[self.end..]
    }

    /// The name of the field around `offset`, for a message. The only value of a choice, as in `EnvSteps(1)`, has the name
    /// of the choice's field.
    fn field(&self, offset: usize) -> String {
        let path = self.map.path_at(offset);
        let outer = path.strip_suffix("[0]").filter(|outer| {
            let value = self.map.offset_of(outer).map(|at| &self.text[at..]);
            value.is_some_and(|value| value.starts_with(char::is_alphabetic))
        });
        named(outer.unwrap_or(&path))
    }

    /// The name of the struct or list that contains the field around `offset`.
    fn parent(&self, offset: usize) -> String {
        named(&self.map.parent_path_at(offset))
    }

    /// A character that only looks like one of RON.
    fn foreign_character(&self) -> Option<Problem> {
        let before = self.text[..self.end].char_indices().next_back().map(|(at, _)| at);
        [Some(self.end), before].into_iter().flatten().find_map(|offset| {
            let (c, message, instead) = lookalike(self.text, offset)?;
            let repair = (instead != "\"").then(|| Repair::Replace(offset..offset + c.len_utf8(), instead));
            Some(Problem { offset, message, repair })
        })
    }

    /// Another file format than RON, or its signs.
    fn other_format(&self, code: &Error) -> Option<Problem> {
        let root = self.map.start().unwrap_or(0);
        let before = self.text[..self.end].trim_end();
        let is_key = |rest: &str| rest.trim_start().starts_with([':', '=']);
        let here = self.end;
        Some(match code {
            Error::ExpectedAttribute => self.problem(last_of(before), HASH),
            _ if self.rest().starts_with('#') => self.problem(here, HASH),
            _ if self.rest().starts_with(';') => {
                let repair = Some(Repair::Replace(here..here + 1, ","));
                Problem { offset: here, message: "fields are separated by commas, not by `;`".into(), repair }
            }
            _ if here <= root && self.text[root..].starts_with('{') => self.problem(root, JSON),
            Error::ExpectedDifferentStructName { .. } if is_key(self.rest()) => {
                self.problem(root, NO_PARENTHESES)
            }
            Error::ExpectedIdentifier
                if self.rest().starts_with('"') && is_key(after_string(self.rest())) =>
            {
                self.problem(here, "a field's name has no quotes: write `name: value`")
            }
            Error::ExpectedMapColon if self.rest().starts_with('=') => {
                let repair = Some(Repair::Replace(here..here + 1, ":"));
                Problem {
                    offset: here,
                    message: "write `:` between a field's name and its value, not `=`".into(),
                    repair,
                }
            }
            _ => return None,
        })
    }

    /// A number that ron reads differently.
    fn number(&self, code: &Error) -> Option<Problem> {
        use Error as E;
        let is_cut = matches!(
            code,
            E::InvalidIntegerDigit { .. }
                | E::ExpectedComma
                | E::ExpectedStructLikeEnd
                | E::TrailingCharacters
        );
        if is_cut && let Some(word) = cut_number(self.text, self.end) {
            let message =
                format!("{} {}", self.field(word.start), cut_number_problem(&self.text[word.clone()]));
            return Some(Problem { offset: word.start, message, repair: Some(Repair::Value(word)) });
        }
        let (range, message) = match code {
            E::ExpectedStructLikeEnd => {
                let brackets = self.map.value_at(self.map.field_at(self.end).start.saturating_sub(1));
                let inside = &self.text[brackets.clone()];
                if inside.starts_with('(') {
                    (brackets, pair_problem(inside)?)
                } else {
                    comma_problem(self.text, self.end)?
                }
            }
            E::ExpectedComma => self.unit()?,
            code if is_about_a_name(code) => comma_problem(self.text, self.end)?,
            _ => return None,
        };
        Some(Problem { offset: range.start, message, repair: Some(Repair::Value(range)) })
    }

    /// The range of a number and of the unit behind it, and the problem.
    fn unit(&self) -> Option<(Range<usize>, String)> {
        let is_unit_char = |c: char| c.is_alphabetic() || "°%/".contains(c);
        let unit = &self.rest()[..self.rest().find(|c| !is_unit_char(c)).unwrap_or(self.rest().len())];
        let number = self.map.value_at(last_of(&self.text[..self.end]));
        let number = number.start..self.end.min(number.end);
        let digits = self.text.get(number.clone())?.trim();
        digits.parse::<f64>().ok().filter(|_| UNITS.contains(&unit))?;
        let message = format!("{} {}", self.field(number.start), with_unit(digits, unit));
        Some((number.start..self.end + unit.len(), message))
    }

    /// A field or choice of an unknown name, or a field that is missing or appears twice.
    fn name(&self, code: &Error) -> Option<Problem> {
        let Self { start, end, .. } = *self;
        Some(match code {
            Error::NoSuchStructField { expected, found, .. } => {
                let fields = choice(found, expected, "the fields are");
                let message = format!("unknown field `{found}` in {}: {fields}", self.parent(start));
                let repair = self.renaming(found, expected).unwrap_or_else(|| self.removal());
                Problem { offset: start, message, repair: Some(repair) }
            }
            Error::NoSuchEnumVariant { expected, found, .. } => {
                let choices = choice(found, expected, "the choices are");
                let message = format!("unknown choice `{found}` for {}: {choices}", self.field(start));
                let repair = self.renaming(found, expected);
                let repair = repair.unwrap_or_else(|| Repair::Value(self.map.value_at(start)));
                Problem { offset: start, message, repair: Some(repair) }
            }
            Error::DuplicateStructField { field, .. } => {
                let message = format!("`{field}` appears twice in {}: remove one", self.parent(start));
                Problem { offset: start, message, repair: Some(self.removal()) }
            }
            Error::MissingStructField { field, .. } => {
                let offset = self.map.value_start_at(end);
                let owner = self.field(end);
                let message = missing_fields(&owner, &[field]);
                Problem { offset, message, repair: Some(Repair::Add { start: offset, owner, field }) }
            }
            _ => return None,
        })
    }

    /// The change of the name `found` at `start` to the closest of the `expected` names, if one is close.
    fn renaming(&self, found: &str, expected: &'static [&'static str]) -> Option<Repair> {
        let near = closest_name(found, expected.iter().copied())?;
        let is_there = self.text[self.start..].starts_with(found);
        is_there.then(|| Repair::Replace(self.start..self.start + found.len(), near))
    }

    /// The removal of the field at `start`, with the comma after it.
    fn removal(&self) -> Repair {
        let field = self.map.field_at(self.start);
        let comma = usize::from(self.text[field.end..].starts_with(','));
        Repair::Replace(field.start..field.end + comma, "")
    }

    /// A value of another type where a choice is wanted.
    fn choice(&self, code: &Error, parse: &dyn Fn(&str) -> Option<SpannedError>) -> Option<Problem> {
        let value = self.map.value_at(self.end);
        if !is_about_a_name(code) || value.start != self.end {
            return None;
        }
        let problem = choice_problem(self.text, &value, parse)?;
        let message = format!("{} {problem}", self.field(self.end));
        Some(Problem { offset: value.start, message, repair: Some(Repair::Value(value)) })
    }

    /// A value of the wrong type.
    fn value(&self, code: &Error) -> Option<Problem> {
        let Self { text, start, end, .. } = *self;
        // If there is a bracket or comma instead of a value, the message is about the value before it.
        let at_value = if self.rest().starts_with(value_start) { end } else { last_of(&text[..end]) };
        let must = |what: &str| {
            // A text that is wrong as a whole has no other problems.
            let is_part = !self.map.path_at(at_value).is_empty();
            let repair = is_part.then(|| Repair::Value(self.map.value_at(at_value)));
            Problem { offset: end, message: format!("{} must be {what}", self.field(at_value)), repair }
        };
        let here =
            |what: &str| Problem { message: format!("{} must be {what}", self.field(end)), ..must(what) };
        Some(match code {
            Error::ExpectedInteger if self.rest().starts_with('"') => must("a whole number, without quotes"),
            Error::ExpectedInteger => must("a whole number"),
            Error::ExpectedFloat if self.rest().starts_with('"') => must("a number, without quotes"),
            Error::ExpectedFloat => must("a number"),
            Error::ExpectedBoolean => must("true or false"),
            Error::ExpectedString => must("text in double quotes: \"...\""),
            Error::ExpectedArray => must("a list in square brackets: [...]"),
            Error::ExpectedStructLike => must("written with parentheses: (...)"),
            Error::ExpectedDifferentLength { expected, .. } if expected.ends_with("2 f32 values") => {
                here(POINT)
            }
            Error::ExpectedDifferentLength { expected, .. } => here(expected),
            Error::InvalidValueForType { expected, found } => must(&format!("{expected}, not {found}")),
            Error::IntegerOutOfBounds => {
                let what = "a whole number in range: this one is negative or too large";
                let message = format!("{} must be {what}", self.field(start));
                Problem { offset: start, message, repair: Some(Repair::Value(self.map.value_at(start))) }
            }
            Error::ExpectedNamedStructLike(_) if self.rest().starts_with([')', ']', '}']) => return None,
            Error::ExpectedNamedStructLike("Vec2") => here(POINT),
            Error::ExpectedNamedStructLike(_) => here("written in parentheses: (...)"),
            Error::ExpectedDifferentStructName { expected, .. } if *expected == "Vec2" => {
                Problem { offset: start, ..here(POINT) }
            }
            _ => return None,
        })
    }

    /// Brackets, commas, quotes and comments that are missing or too many.
    fn syntax(&self, code: &Error) -> Problem {
        use Error as E;
        let Self { start, end, .. } = *self;
        match code {
            E::ExpectedComma
                if self.rest().starts_with('(') && self.text[..end].ends_with(char::is_alphanumeric) =>
            {
                let repair = Some(Repair::Value(self.map.value_at(end)));
                let message = format!("{} must be written without parentheses", self.field(end));
                Problem { offset: end, message, repair }
            }
            E::ExpectedComma => {
                let after_word = self.rest().trim_start_matches(|c: char| c.is_alphanumeric() || c == '_');
                let is_field =
                    after_word.len() < self.rest().len() && after_word.trim_start().starts_with(':');
                let repair = is_field.then_some(Repair::Replace(end..end, ","));
                Problem {
                    offset: end,
                    message: "a comma or a closing bracket is missing before this".into(),
                    repair,
                }
            }
            E::ExpectedStructLikeEnd => self.problem(
                end,
                format!(
                    "{} must end before this: a `)` is missing, or it has too many parts",
                    self.parent(end)
                ),
            ),
            E::ExpectedMapColon => {
                self.problem(end, "a `:` between a field's name and its value is missing before this")
            }
            E::ExpectedNamedStructLike(_) => {
                self.problem(end, "this closes no open bracket, or a value is missing before it")
            }
            E::ExpectedDifferentStructName { expected, found } => {
                self.problem(start, format!("expected `{expected}(...)` or `(...)`, found `{found}`"))
            }
            E::ExpectedIdentifier if self.rest().starts_with([']', '}']) => {
                self.problem(end, format!("{} is not closed: a `)` is missing before this", self.field(end)))
            }
            E::SuggestRawIdentifier(word) | E::InvalidIdentifier(word) => {
                self.problem(end, format!("`{word}` is no field's name: write `name: value`"))
            }
            E::ExpectedIdentifier => self.problem(end, "a field's name is missing here: write `name: value`"),
            E::TrailingCharacters => {
                self.problem(end, "the file's value ends before this: remove what follows")
            }
            E::UnclosedBlockComment => self.problem(start, "this comment has no end: close it with `*/`"),
            E::ExpectedStringEnd if self.text[start..].contains(['“', '”']) => {
                let curly = self.text[start..].find(['“', '”']).map_or(start, |at| start + at);
                self.problem(curly, "curly quotes: write \"...\"")
            }
            E::ExpectedStringEnd => self.problem(start, "this text has no closing quote: add one"),
            E::InvalidEscape(_) => {
                self.problem(end, "a backslash begins an escape: for the backslash itself, write two of them")
            }
            E::UnexpectedChar(_) => self.problem(
                end,
                "this starts no comment: write `//` or `/* */`, or the result of a division as one number",
            ),
            E::Eof => self.problem(end, "the file ends too early: a closing bracket is missing"),
            E::ExceededRecursionLimit => self.problem(
                end,
                "brackets are nested too deeply here: no value in this kind of file needs that many",
            ),
            other => self.problem(end, format!("this is not RON: {other}")),
        }
    }
}

/// Units that people write behind numbers.
const UNITS: [&str; 14] =
    ["m", "cm", "mm", "s", "ms", "rad", "deg", "m/s", "rad/s", "Hz", "%", "°", "px", "steps"];
const POINT: &str = "a point: (x, y)";
const HASH: &str = "a comment starts with `//`, not with `#`";
const JSON: &str =
    "this looks like JSON: RON has parentheses for braces, and field names without quotes: (name: ...)";
const NO_PARENTHESES: &str = "the file must be written in parentheses: (name: ..., ...)";

/// The message about the `fields` that `owner` lacks.
pub(super) fn missing_fields(owner: &str, fields: &[&str]) -> String {
    let names: Vec<_> = fields.iter().map(|name| format!("`{name}`")).collect();
    let lines: Vec<_> = fields.iter().map(|name| format!("`{name}: ...`")).collect();
    let plural = if fields.len() > 1 { "s" } else { "" };
    format!("{owner} lacks the field{plural} {}: add {}", names.join(", "), lines.join(", "))
}

/// The text "did you mean `x`? the fields are `x`, `y`": the closest of `known` to `word`, if one is close, then all.
fn choice(word: &str, known: &[&str], lead: &str) -> String {
    let hint = closest_name(word, known.iter().copied())
        .map(|near| format!("did you mean `{near}`? "))
        .unwrap_or_default();
    let all: Vec<_> = known.iter().map(|name| format!("`{name}`")).collect();
    if all.is_empty() { "there are none here".into() } else { format!("{hint}{lead} {}", all.join(", ")) }
}

/// The name in `known` that is most similar to `word`, if any is similar; for "did you mean" hints.
#[must_use]
pub fn closest_name<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_lowercase();
    known
        .map(|name| (strsim::jaro_winkler(&word, &name.to_lowercase()), name))
        .filter(|&(score, _)| score > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

fn named(path: &str) -> String {
    if path.is_empty() { "the file".into() } else { format!("`{path}`") }
}

/// Whether ron expected the name of a field or of a choice.
fn is_about_a_name(code: &Error) -> bool {
    matches!(code, Error::ExpectedIdentifier | Error::SuggestRawIdentifier(_) | Error::InvalidIdentifier(_))
}

/// Whether a value may start with `c`.
fn value_start(c: char) -> bool {
    !matches!(c, ')' | ']' | '}' | ',') && !c.is_whitespace()
}

/// The text after the string in double quotes at the start of `text`.
fn after_string(text: &str) -> &str {
    text[1..].split_once('"').map_or("", |(_, rest)| rest)
}

/// Offset of the last character of `text` that is not whitespace.
fn last_of(text: &str) -> usize {
    text.trim_end().char_indices().next_back().map_or(0, |(at, _)| at)
}

/// Byte offset of ron's line and column (in characters).
pub(super) fn offset(text: &str, position: Position) -> usize {
    let line_start: usize =
        text.split_inclusive('\n').take(position.line.saturating_sub(1)).map(str::len).sum();
    let line = &text[line_start..];
    line_start + line.char_indices().nth(position.col.saturating_sub(1)).map_or(line.len(), |(at, _)| at)
}
