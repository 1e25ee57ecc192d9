//! The messages for ron's errors: the problem, its field, and the fix.
//!
//! In: the text and ron's [`SpannedError`]. Out: a byte offset and a message.

use ron::error::{Error, Position, SpannedError};

use wayfield_ron_patch::SourceMap;

/// Byte offset in `text` and message for `error`.
pub(super) fn explain(text: &str, error: &SpannedError) -> (usize, String) {
    use Error as E;
    let (start, end) = (offset(text, error.span.start), offset(text, error.span.end));
    let source_map = SourceMap::new(text);
    let here = || field(&source_map.path_at(end));
    // If there is a bracket or comma instead of a value, the message is about the value before it.
    let at_value = if text[end..].starts_with(value_start) { end } else { last_of(&text[..end]) };
    let must = |what: &str| (end, format!("{} must be {what}", field(&source_map.path_at(at_value))));
    match &error.code {
        E::NoSuchStructField { expected, found, .. } => {
            let inside = field(&source_map.parent_path_at(start));
            (
                start,
                format!("unknown field `{found}` in {inside}: {}", choice(found, expected, "the fields are")),
            )
        }
        E::NoSuchEnumVariant { expected, found, .. } => {
            let of = field(&source_map.path_at(start));
            (
                start,
                format!("unknown choice `{found}` for {of}: {}", choice(found, expected, "the choices are")),
            )
        }
        E::DuplicateStructField { field: name, .. } => (
            start,
            format!("`{name}` appears twice in {}: remove one", field(&source_map.parent_path_at(start))),
        ),
        E::MissingStructField { field: name, .. } => (
            source_map.value_start_at(end),
            format!("{} lacks the field `{name}`: add `{name}: ...`", here()),
        ),
        E::ExpectedInteger => must("a whole number"),
        E::ExpectedFloat => must("a number"),
        E::ExpectedBoolean => must("true or false"),
        E::ExpectedString => must("text in double quotes: \"...\""),
        E::ExpectedArray => must("a list in square brackets: [...]"),
        E::ExpectedStructLike => must("written with parentheses: (...)"),
        E::ExpectedDifferentLength { expected, .. } if expected.ends_with("2 f32 values") => {
            (end, format!("{} must be a point: (x, y)", here()))
        }
        E::ExpectedDifferentLength { expected, .. } => (end, format!("{} must be {expected}", here())),
        E::InvalidValueForType { expected, found } => must(&format!("{expected}, not {found}")),
        E::IntegerOutOfBounds => {
            let path = field(&source_map.path_at(start));
            (start, format!("{path} must be a whole number in range: this one is negative or too large"))
        }
        E::ExpectedComma if fraction(text, end) => {
            let start = source_map.value_start_at(end);
            (start, format!("{} must be a whole number, without a fraction", here()))
        }
        E::ExpectedComma => (end, "a comma or a closing bracket is missing before this".into()),
        E::ExpectedStructLikeEnd => (
            end,
            format!(
                "{} must end before this: a `)` is missing, or it has too many parts",
                field(&source_map.parent_path_at(end))
            ),
        ),
        E::ExpectedMapColon => {
            (end, "a `:` between a field's name and its value is missing before this".into())
        }
        E::ExpectedNamedStructLike(_) if text[end..].starts_with([')', ']', '}']) => {
            (end, "this closes no open bracket, or a value is missing before it".into())
        }
        E::ExpectedNamedStructLike("Vec2") => (end, format!("{} must be a point: (x, y)", here())),
        E::ExpectedNamedStructLike(_) => (end, format!("{} must be written in parentheses: (...)", here())),
        E::ExpectedDifferentStructName { expected, .. } if *expected == "Vec2" => {
            (start, format!("{} must be a point: (x, y)", here()))
        }
        E::ExpectedDifferentStructName { expected, found } => {
            (start, format!("expected `{expected}(...)` or `(...)`, found `{found}`"))
        }
        E::ExpectedIdentifier if text[end..].starts_with([']', '}']) => {
            (end, format!("{} is not closed: a `)` is missing before this", here()))
        }
        E::ExpectedIdentifier | E::SuggestRawIdentifier(_) | E::InvalidIdentifier(_) => {
            (end, "a field's name is missing here: write `name: value`".into())
        }
        E::TrailingCharacters => (end, "the file's value ends before this: remove what follows".into()),
        E::UnclosedBlockComment => (start, "this comment has no end: close it with `*/`".into()),
        E::ExpectedStringEnd => (start, "this text has no closing quote: add one".into()),
        E::Eof => (end, "the file ends too early: a closing bracket is missing".into()),
        E::ExceededRecursionLimit => {
            (end, "brackets are nested too deeply here: no value in this kind of file needs that many".into())
        }
        other => (end, format!("this is not RON: {other}")),
    }
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

fn field(path: &str) -> String {
    if path.is_empty() { "the file".into() } else { format!("`{path}`") }
}

/// Whether a value may start with `c`.
fn value_start(c: char) -> bool {
    !matches!(c, ')' | ']' | '}' | ',') && !c.is_whitespace()
}

/// Offset of the last character of `text` that is not whitespace.
fn last_of(text: &str) -> usize {
    text.trim_end().char_indices().next_back().map_or(0, |(at, _)| at)
}

/// Whether the fractional part of a number starts at `offset`.
fn fraction(text: &str, offset: usize) -> bool {
    text[..offset].ends_with(|c: char| c.is_ascii_digit()) && text[offset..].starts_with('.')
}

/// Byte offset of ron's line and column (in characters).
fn offset(text: &str, position: Position) -> usize {
    let line_start: usize =
        text.split_inclusive('\n').take(position.line.saturating_sub(1)).map(str::len).sum();
    let line = &text[line_start..];
    line_start + line.char_indices().nth(position.col.saturating_sub(1)).map_or(line.len(), |(at, _)| at)
}
