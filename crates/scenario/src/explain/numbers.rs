//! Explains errors at numbers that ron reads only in part, or as several numbers.

use std::ops::Range;

use ron::error::Error;

use super::number_text::{comma_problem, cut_number, cut_number_problem, is_unit, pair_problem, with_unit};
use super::{Place, Problem, Repair, is_about_a_name, last_of};

impl Place<'_> {
    /// The problem with a number that ron does not read as a person would.
    pub(super) fn number(&self, code: &Error) -> Option<Problem> {
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

    /// The range of a number and the unit after it, and the problem.
    fn unit(&self) -> Option<(Range<usize>, String)> {
        let is_unit_char = |c: char| c.is_alphanumeric() || "°%/^".contains(c);
        let unit = &self.rest()[..self.rest().find(|c| !is_unit_char(c)).unwrap_or(self.rest().len())];
        let number = self.map.value_at(last_of(&self.text[..self.end]));
        let number = number.start..self.end.min(number.end);
        let digits = self.text.get(number.clone())?.trim();
        digits.parse::<f64>().ok().filter(|_| is_unit(unit))?;
        let message = format!("{} {}", self.field(number.start), with_unit(digits, unit));
        Some((number.start..self.end + unit.len(), message))
    }
}
