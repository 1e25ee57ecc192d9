//! The messages for ron's errors: the problem, its field, and the fix.
//!
//! In: the text and ron's [`SpannedError`]. Out: a [`Problem`] with a byte offset, a message, and how to continue reading;
//! from [`recover`], all problems of the text.
//!
//! | file | problems |
//! |---|---|
//! | `formats.rs`, `lookalike.rs` | characters that look like those of RON, syntax of other formats |
//! | `numbers.rs`, `number_text.rs` | numbers as people write them |
//! | `names.rs`, `synonyms.rs` | names of fields and choices |
//! | `values.rs`, `choices.rs` | values of the wrong type |
//! | `syntax.rs` | brackets, commas, quotes, comments |

mod choices;
mod formats;
mod lookalike;
mod names;
mod number_text;
mod numbers;
mod recover;
mod synonyms;
mod syntax;
mod values;

use std::ops::Range;

use ron::error::{Error, Position, SpannedError};

use wayfield_ron_patch::SourceMap;

pub use self::names::{choose, closest_name};
pub use self::number_text::whole_number;
pub use self::number_text::with_plain_numbers;
pub(super) use self::recover::recover;

/// A problem that ron found in a text.
struct Problem {
    /// Byte offset in the text.
    pub offset: usize,
    /// The problem and its fix.
    pub message: String,
    /// A change of the text with which reading can continue past the problem.
    pub repair: Option<Repair>,
}

/// A change of a text that removes a problem.
enum Repair {
    /// The range is replaced by this text.
    Replace(Range<usize>, &'static str),
    /// The name of a field or a choice is replaced by this one.
    Rename(Range<usize>, &'static str),
    /// The range is replaced by an arbitrary valid value.
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

/// The problem behind `error`, which ron found in `text`. `parse` returns ron's error for a changed text.
fn explain(text: &str, error: &SpannedError, parse: &dyn Fn(&str) -> Option<SpannedError>) -> Problem {
    let (start, end) = (offset(text, error.span.start), offset(text, error.span.end));
    let place = Place { text, start, end, map: SourceMap::new(text) };
    place
        .foreign_character()
        .or_else(|| place.other_format(&error.code))
        .or_else(|| place.number(&error.code))
        .or_else(|| place.name(&error.code))
        .or_else(|| place.choice(&error.code, parse))
        .or_else(|| place.value(&error.code, parse))
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

    /// The text from `offset` to the end of its line.
    fn line_from(&self, offset: usize) -> &str {
        self.text[offset..].lines().next().unwrap_or_default()
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
}

fn named(path: &str) -> String {
    if path.is_empty() { "the file".into() } else { format!("`{path}`") }
}

/// Whether ron expected the name of a field or of a choice.
fn is_about_a_name(code: &Error) -> bool {
    matches!(code, Error::ExpectedIdentifier | Error::SuggestRawIdentifier(_) | Error::InvalidIdentifier(_))
}

/// Offset of the last character of `text` that is not whitespace.
fn last_of(text: &str) -> usize {
    text.trim_end().char_indices().next_back().map_or(0, |(at, _)| at)
}

/// Byte offset of ron's line and column (in characters).
fn offset(text: &str, position: Position) -> usize {
    let line_start: usize =
        text.split_inclusive('\n').take(position.line.saturating_sub(1)).map(str::len).sum();
    let line = &text[line_start..];
    line_start + line.char_indices().nth(position.col.saturating_sub(1)).map_or(line.len(), |(at, _)| at)
}
