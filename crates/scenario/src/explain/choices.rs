//! The choices of an enum (its variants), found by trial: ron's errors do not say that a choice was expected.

use std::ops::Range;

use ron::error::{Error, SpannedError};

use super::offset;
use super::recover::MAX_BYTES;

/// A word that no enum of the project has as a choice.
const UNKNOWN: &str = "UnknownChoice";

/// The choices that ron knows for the `value` in `text`; empty if no choice is expected there. `parse` returns ron's error for
/// a changed text.
pub(super) fn choices(
    text: &str,
    value: &Range<usize>,
    parse: &dyn Fn(&str) -> Option<SpannedError>,
) -> &'static [&'static str] {
    match parse(&replaced(text, value, UNKNOWN)).map(|error| error.code) {
        Some(Error::NoSuchEnumVariant { expected, found, .. }) if found == UNKNOWN => expected,
        _ => &[],
    }
}

/// The problem with a `value` where a choice is expected, as the rest of a sentence that starts with the field; `None` if no
/// choice is expected. The message suggests a choice that takes the value, if there is one: `Constant(3e-4)` for `3e-4`.
pub(super) fn choice_problem(
    text: &str,
    value: &Range<usize>,
    parse: &dyn Fn(&str) -> Option<SpannedError>,
) -> Option<String> {
    let choices = choices(text, value, parse);
    let names: Vec<_> = choices.iter().map(|choice| format!("`{choice}`")).collect();
    let word = text[value.clone()].trim_matches(['"', '\'']);
    let with_value = choices.iter().map(|choice| format!("{choice}({word})"));
    let same_name =
        choices.iter().filter(|choice| choice.eq_ignore_ascii_case(word)).map(ToString::to_string);
    let fits = |candidate: &String| is_read(text, value, candidate, parse);
    let hint = same_name.chain(with_value).find(fits).map_or(String::new(), |fix| format!(": write `{fix}`"));
    let quotes = if word.len() < value.len() { ", without quotes" } else { "" };
    (!choices.is_empty()).then(|| format!("must be one of the choices {}{quotes}{hint}", names.join(", ")))
}

/// Whether ron reads `candidate` in place of the `value` in `text` without an error before the end of `candidate`. False for a
/// text that is too long to be read again.
pub(super) fn is_read(
    text: &str,
    value: &Range<usize>,
    candidate: &str,
    parse: &dyn Fn(&str) -> Option<SpannedError>,
) -> bool {
    let changed = replaced(text, value, candidate);
    let value = value.start..value.start + candidate.len();
    changed.len() <= MAX_BYTES
        && parse(&changed).is_none_or(|error| {
            offset(&changed, error.span.end) >= value.end && !is_about(&error, &changed, &value)
        })
}

/// Whether ron reads `brackets`, such as `Circle()`, in place of the `value` in `text`, but reports a missing field in them.
pub(super) fn lacks_fields(
    text: &str,
    value: &Range<usize>,
    brackets: &str,
    parse: &dyn Fn(&str) -> Option<SpannedError>,
) -> bool {
    let changed = replaced(text, value, brackets);
    let inside = value.start + 1..value.start + brackets.len();
    parse(&changed).is_some_and(|error| {
        matches!(error.code, Error::MissingStructField { .. })
            && inside.contains(&offset(&changed, error.span.end))
    })
}

/// Whether `error` is about the `value` in `text`, although ron's cursor is past it.
fn is_about(error: &SpannedError, text: &str, value: &Range<usize>) -> bool {
    use Error as E;
    match error.code {
        // The brackets of a choice are missing.
        E::ExpectedStructLike => text[value.end..offset(text, error.span.end)].trim().is_empty(),
        E::InvalidValueForType { .. }
        | E::IntegerOutOfBounds
        | E::NoSuchEnumVariant { .. }
        | E::ExpectedDifferentStructName { .. } => offset(text, error.span.start) <= value.start,
        _ => false,
    }
}

/// `text` with `new` in the range `old`.
pub(super) fn replaced(text: &str, old: &Range<usize>, new: &str) -> String {
    [&text[..old.start], new, &text[old.end..]].concat()
}
