//! Brackets, commas, quotes and comments that are missing, superfluous or not closed.

use ron::error::Error;

use super::lookalike::quote_problem;
use super::{Place, Problem, Repair};

impl Place<'_> {
    /// The problem of brackets, commas, quotes or comments; for any other error, ron's message.
    pub(super) fn syntax(&self, code: &Error) -> Problem {
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
                self.problem(end, format!("`{word}` is not a valid field name: write `name: value`"))
            }
            E::ExpectedIdentifier => self.problem(end, "a field's name is missing here: write `name: value`"),
            E::TrailingCharacters => {
                self.problem(end, "the file's value ends before this: remove what follows")
            }
            E::UnclosedBlockComment => self.problem(start, "this comment has no end: close it with `*/`"),
            E::ExpectedStringEnd if self.line_from(start).contains(['“', '”']) => {
                let quote = self.line_from(start).find(['“', '”']).map_or(start, |at| start + at);
                self.problem(quote, self.text[quote..].chars().next().map(quote_problem).unwrap_or_default())
            }
            E::ExpectedStringEnd => self.problem(start, "this text has no closing quote: add one"),
            E::InvalidEscape(_) => {
                let backslash = self.text[..end].rfind('\\').unwrap_or(end);
                self.problem(
                    backslash,
                    "a backslash begins an escape: for the backslash itself, write two of them",
                )
            }
            E::UnexpectedChar(_) => self.problem(
                end,
                "this is not a comment: write `//` or `/* */`, or the result of a division as one number",
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
