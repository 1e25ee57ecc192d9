//! Values of the wrong type.

use ron::error::{Error, SpannedError};

use super::choices::{choice_problem, is_read};
use super::number_text::OUT_OF_RANGE;
use super::{Place, Problem, Repair, is_about_a_name, last_of};

impl Place<'_> {
    /// The problem of a value of another type where a choice is expected.
    pub(super) fn choice(
        &self,
        code: &Error,
        parse: &dyn Fn(&str) -> Option<SpannedError>,
    ) -> Option<Problem> {
        let value = self.map.value_at(self.end);
        if !is_about_a_name(code) || value.start != self.end {
            return None;
        }
        let problem = choice_problem(self.text, &value, parse)?;
        let message = format!("{} {problem}", self.field(self.end));
        Some(Problem { offset: value.start, message, repair: Some(Repair::Value(value)) })
    }

    /// The problem of a value of the wrong type.
    pub(super) fn value(
        &self,
        code: &Error,
        parse: &dyn Fn(&str) -> Option<SpannedError>,
    ) -> Option<Problem> {
        let Self { text, start, end, .. } = *self;
        // If there is a bracket or comma instead of a value, the message is about the value before it.
        let at_value = if self.rest().starts_with(value_start) { end } else { last_of(&text[..end]) };
        let must = |what: &str| {
            // If the whole text is one value of the wrong type, a repair would leave nothing to read.
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
            Error::ExpectedStructLike => {
                let value = self.map.value_at(at_value);
                let brackets = format!("{}()", &text[value.clone()]);
                let is_enough = is_read(text, &value, &brackets, parse);
                must(&format!(
                    "written with parentheses: {}",
                    if is_enough { brackets.as_str() } else { "(...)" }
                ))
            }
            Error::ExpectedDifferentLength { expected, .. } if expected.ends_with("2 f32 values") => {
                here(POINT)
            }
            Error::ExpectedDifferentLength { expected, .. } => here(expected),
            Error::InvalidValueForType { expected, .. } if expected.ends_with(RANGE) => {
                let value = self.map.value_at(at_value);
                let quotes = if text[value.clone()].starts_with('"') { ", without quotes" } else { "" };
                Problem { offset: value.start, ..must(&format!("{expected}{quotes}")) }
            }
            Error::InvalidValueForType { expected, found } => must(&format!("{expected}, not {found}")),
            Error::IntegerOutOfBounds => {
                let message = format!("{} must be {OUT_OF_RANGE}", self.field(start));
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
}

/// How ron's `expected` text ends for a field that may be a range ([`Ranged`](crate::Ranged)).
const RANGE: &str = "or a range (lowest, highest)";
const POINT: &str = "a point: (x, y)";

/// Whether a value may start with `c`.
fn value_start(c: char) -> bool {
    !matches!(c, ')' | ']' | '}' | ',') && !c.is_whitespace()
}
