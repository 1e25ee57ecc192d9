//! ron's errors in words for someone who edits the file: what is wrong, in which field, how to mend it.
//!
//! In: the text and ron's [`SpannedError`]. Out: a byte offset and a message.

use ron::error::{Error, Position, SpannedError};

use wayfield_ron_patch::SourceMap;

/// Where in `text` to point for `error`, and what to say there.
pub(super) fn explain(text: &str, error: &SpannedError) -> (usize, String) {
    use Error as E;
    let (start, end) = (offset(text, error.span.start), offset(text, error.span.end));
    let outline = SourceMap::new(text);
    let here = || field(&outline.path_at(end));
    // Where a bracket or comma stands instead of a value, the value is what comes before.
    let at_value = if text[end..].starts_with(value_start) { end } else { last_of(&text[..end]) };
    let must = |what: &str| (end, format!("{} must be {what}", field(&outline.path_at(at_value))));
    match &error.code {
        E::NoSuchStructField { expected, found, .. } => {
            let inside = field(&outline.parent_path_at(start));
            (
                start,
                format!("unknown field `{found}` in {inside}: {}", choice(found, expected, "the fields are")),
            )
        }
        E::NoSuchEnumVariant { expected, found, .. } => {
            let of = field(&outline.path_at(start));
            (
                start,
                format!("unknown choice `{found}` for {of}: {}", choice(found, expected, "the choices are")),
            )
        }
        E::DuplicateStructField { field: name, .. } => (
            start,
            format!("`{name}` is written twice in {}: keep one", field(&outline.parent_path_at(start))),
        ),
        E::MissingStructField { field: name, .. } => {
            (outline.value_start_at(end), format!("{} lacks the field `{name}`: add `{name}: ...`", here()))
        }
        E::ExpectedInteger => must("a whole number"),
        E::ExpectedFloat => must("a number"),
        E::ExpectedBoolean => must("true or false"),
        E::ExpectedString => must("text in double quotes: \"...\""),
        E::ExpectedArray => must("a list in square brackets: [...]"),
        E::ExpectedStructLike => must("written with parentheses: (...)"),
        E::ExpectedDifferentLength { expected, .. } => (end, format!("{} must be {expected}", here())),
        E::InvalidValueForType { expected, found } => must(&format!("{expected}, not {found}")),
        E::IntegerOutOfBounds => {
            let path = field(&outline.path_at(start));
            (start, format!("{path} must be a whole number in range: this one is negative or too large"))
        }
        E::ExpectedComma if fraction(text, end) => {
            let start = outline.value_start_at(end);
            (start, format!("{} must be a whole number, without a fraction", here()))
        }
        E::ExpectedComma => (end, "a comma or a closing bracket is missing before this".into()),
        E::ExpectedStructLikeEnd => (
            end,
            format!(
                "{} must end before this: a `)` is missing, or it has too many parts",
                field(&outline.parent_path_at(end))
            ),
        ),
        E::ExpectedMapColon => {
            (end, "a `:` between a field's name and its value is missing before this".into())
        }
        E::ExpectedNamedStructLike(_) if text[end..].starts_with([')', ']', '}']) => {
            (end, "this closes no open bracket, or a value is missing before it".into())
        }
        E::ExpectedNamedStructLike(_) => (end, format!("{} must be written in parentheses: (...)", here())),
        E::ExpectedDifferentStructName { expected, found } => {
            (start, format!("expected `{expected}(...)` or `(...)`, found `{found}`"))
        }
        E::ExpectedIdentifier if text[end..].starts_with([']', '}']) => {
            (end, format!("{} is still open: a `)` is missing before this", here()))
        }
        E::ExpectedIdentifier | E::SuggestRawIdentifier(_) | E::InvalidIdentifier(_) => {
            (end, "a field's name is missing here: write `name: value`".into())
        }
        E::TrailingCharacters => (end, "the file's value ends before this: remove what follows".into()),
        E::UnclosedBlockComment => (start, "this comment has no end: close it with `*/`".into()),
        E::ExpectedStringEnd => (start, "this text has no closing quote: add one".into()),
        E::Eof => (end, "the file ends in the middle: a closing bracket is missing".into()),
        E::ExceededRecursionLimit => {
            (end, "brackets are nested too deep here: nothing in this file needs so many".into())
        }
        other => (end, format!("this is not RON: {other}")),
    }
}

/// "did you mean `x`? the fields are `x`, `y`": the nearest of `known` to `word`, if one is near, and all of
/// them.
fn choice(word: &str, known: &[&str], lead: &str) -> String {
    let hint = closest_name(word, known.iter().copied())
        .map(|near| format!("did you mean `{near}`? "))
        .unwrap_or_default();
    let all: Vec<_> = known.iter().map(|name| format!("`{name}`")).collect();
    if all.is_empty() { "there are none here".into() } else { format!("{hint}{lead} {}", all.join(", ")) }
}

/// Which of `known` may have been meant by `word`, if any is near: the "did you mean" of every message.
#[must_use]
pub fn closest_name<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_lowercase();
    known
        .map(|name| (strsim::jaro_winkler(&word, &name.to_lowercase()), name))
        .filter(|&(score, _)| score > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}

fn field(path: &str) -> String {
    if path.is_empty() { "the file".into() } else { format!("`{path}`") }
}

/// Whether a value may start with this character.
fn value_start(c: char) -> bool {
    !matches!(c, ')' | ']' | '}' | ',') && !c.is_whitespace()
}

/// The offset of the last character of `text` that is no space.
fn last_of(text: &str) -> usize {
    text.trim_end().char_indices().next_back().map_or(0, |(at, _)| at)
}

/// Whether a number's fractional part starts at `offset`.
fn fraction(text: &str, offset: usize) -> bool {
    text[..offset].ends_with(|c: char| c.is_ascii_digit()) && text[offset..].starts_with('.')
}

/// ron's line and column (in characters) as a byte offset.
fn offset(text: &str, position: Position) -> usize {
    let line_start: usize =
        text.split_inclusive('\n').take(position.line.saturating_sub(1)).map(str::len).sum();
    let line = &text[line_start..];
    line_start + line.char_indices().nth(position.col.saturating_sub(1)).map_or(line.len(), |(at, _)| at)
}
