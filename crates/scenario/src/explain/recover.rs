//! All problems of a text: after each problem that ron finds, the text is repaired and read again.

use std::ops::Range;

use ron::error::SpannedError;
use serde::de::DeserializeOwned;
use wayfield_ron_patch::{SourceMap, tokens};

use super::choices::{choices, is_read, lacks_fields, replaced};
use super::names::missing_fields;
use super::{Problem, Repair, explain};

/// The longest text, in bytes, that is read again to find more problems; in a longer one, only the first is reported.
pub(super) const MAX_BYTES: usize = 1 << 15;
/// The number of repairs after which reading stops.
const MAX_REPAIRS: usize = 64;
/// Values of different types, tried in this order in place of an unreadable value. The choices of an enum are tried after them.
const VALUES: [&str; 6] = ["0", "0.0", "\"\"", "true", "[]", "(0, 0)"];

/// The problems of a text, each with its byte offset, and what could be read without them.
pub struct Recovered<T> {
    pub problems: Vec<(usize, String)>,
    pub value: Option<T>,
    /// The paths of the fields in `value` whose values are not known: an arbitrary one replaces what could not be read, or the
    /// numbers were given under another name.
    pub unknown: Vec<String>,
    /// The repaired text.
    draft: Draft,
}

impl<T> Recovered<T> {
    /// The offset in the original text of the field at `path`, or of the innermost field around it, or else of the whole value.
    /// `None` if it begins in a repair.
    pub fn offset_of(&self, path: &str) -> Option<usize> {
        let map = SourceMap::new(&self.draft.text);
        let at = map.offset_of(path).or_else(|| map.start())?;
        self.draft.origin(at)
    }
}

/// The problems of `text`. `error` is the first one, found by ron; `read` reads a text with ron.
pub fn recover<T: DeserializeOwned>(
    text: &str,
    mut error: SpannedError,
    read: impl Fn(&str) -> Result<T, SpannedError>,
) -> Recovered<T> {
    let draft = Draft { text: text.to_owned(), edits: Vec::new(), unknown: Vec::new() };
    let mut found = Recovered { problems: Vec::new(), value: None, unknown: Vec::new(), draft };
    let parse = |text: &str| if text.len() > MAX_BYTES { None } else { read(text).err() };
    // The fields that the struct of the last problem lacks.
    let mut missing: Vec<&'static str> = Vec::new();
    for _ in 0..MAX_REPAIRS {
        let Problem { offset, message, repair } = explain(&found.draft.text, &error, &parse);
        // Problems inside a repair are not the user's.
        if let Some(at) = found.draft.origin(offset) {
            match (&repair, found.problems.last_mut()) {
                (Some(Repair::Add { owner, field, .. }), Some(last))
                    if last.0 == at && !missing.is_empty() =>
                {
                    missing.push(field);
                    last.1 = missing_fields(owner, &missing);
                }
                (_, Some(last)) if *last == (at, message.clone()) => break,
                _ => {
                    missing.clear();
                    if let Some(Repair::Add { field, .. }) = &repair {
                        missing.push(field);
                    }
                    found.problems.push((at, message));
                }
            }
        }
        let is_repaired =
            text.len() <= MAX_BYTES && repair.is_some_and(|repair| found.draft.apply(repair, &parse));
        if !is_repaired {
            break;
        }
        match read(&found.draft.text) {
            Ok(value) => {
                found.value = Some(value);
                break;
            }
            Err(next) => error = next,
        }
    }
    found.unknown = std::mem::take(&mut found.draft.unknown);
    found
}

/// A text with repairs.
struct Draft {
    text: String,
    edits: Vec<Edit>,
    /// As in [`Recovered::unknown`].
    unknown: Vec<String>,
}

/// A range of a draft that was replaced.
struct Edit {
    /// The offset in the draft.
    at: usize,
    /// The length before.
    old: usize,
    /// The length after.
    new: usize,
}

impl Draft {
    /// The offset in the original text of the byte at `offset`; `None` inside a repair.
    fn origin(&self, mut offset: usize) -> Option<usize> {
        for edit in self.edits.iter().rev() {
            if offset >= edit.at + edit.new {
                offset = offset - edit.new + edit.old;
            } else if offset >= edit.at {
                return None;
            }
        }
        Some(offset)
    }

    fn replace(&mut self, range: Range<usize>, new: &str) {
        self.text = replaced(&self.text, &range, new);
        self.edits.push(Edit { at: range.start, old: range.len(), new: new.len() });
    }

    /// Applies a repair. Returns whether the draft has changed.
    fn apply(&mut self, repair: Repair, parse: &dyn Fn(&str) -> Option<SpannedError>) -> bool {
        match repair {
            Repair::Replace(range, new) => {
                self.replace(range, new);
                true
            }
            Repair::Rename(range, name) => {
                self.replace(range.clone(), name);
                let map = SourceMap::new(&self.text);
                // Numbers under another name may have another unit.
                if has_only_numbers(&self.text[map.value_at(range.start)]) {
                    self.unknown.push(map.path_at(range.start));
                }
                true
            }
            Repair::Value(range) => {
                let Some(value) = self.any_value(&range, parse) else { return false };
                self.unknown.push(SourceMap::new(&self.text).path_at(range.start));
                self.replace(range, &value);
                true
            }
            Repair::Add { start, field, .. } => self.add(start, field, parse),
        }
    }

    /// Adds a field to the struct that starts at or after `start`.
    fn add(&mut self, start: usize, field: &str, parse: &dyn Fn(&str) -> Option<SpannedError>) -> bool {
        let Some(open) = self.text[start..].find('(').map(|at| start + at + 1) else { return false };
        let name = format!("{field}: ");
        let with_name = replaced(&self.text, &(open..open), &(name.clone() + ", "));
        let value = open + name.len()..open + name.len();
        let draft = Draft { text: with_name, edits: Vec::new(), unknown: Vec::new() };
        let Some(value) = draft.any_value(&value, parse) else { return false };
        self.replace(open..open, &format!("{name}{value}, "));
        self.unknown.push(SourceMap::new(&self.text).path_at(open));
        true
    }

    /// A value that ron reads in place of `range`; for a struct, empty brackets such as `Circle()`: its fields are still missing.
    fn any_value(
        &self,
        range: &Range<usize>,
        parse: &dyn Fn(&str) -> Option<SpannedError>,
    ) -> Option<String> {
        let fits = |candidate: &String| is_read(&self.text, range, candidate, parse);
        let simple = VALUES.iter().map(ToString::to_string).find(fits);
        simple.or_else(|| {
            let choices = choices(&self.text, range, parse);
            let plain = choices.iter().flat_map(|name| [name.to_string(), format!("{name}(0)")]).find(fits);
            let mut brackets = choices.iter().copied().chain([""]).map(|name| format!("{name}()"));
            plain.or_else(|| brackets.find(|brackets| lacks_fields(&self.text, range, brackets, parse)))
        })
    }
}

/// Whether a value is a number, or a point or list of numbers.
fn has_only_numbers(value: &str) -> bool {
    let words = tokens(value).map(|token| &value[token]);
    let mut words = words.filter(|word| !matches!(*word, "(" | ")" | "[" | "]" | ",")).peekable();
    words.peek().is_some() && words.all(|word| word.parse::<f64>().is_ok())
}
