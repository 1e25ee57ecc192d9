//! Characters that only look like those of RON, and the syntax of other formats: JSON, YAML, TOML.

use ron::error::Error;

use super::lookalike::lookalike;
use super::{Place, Problem, Repair};

impl Place<'_> {
    /// The problem of a character that only looks like one of RON.
    pub(super) fn foreign_character(&self) -> Option<Problem> {
        let before = self.text[..self.end].char_indices().next_back().map(|(at, _)| at);
        [Some(self.end), before].into_iter().flatten().find_map(|offset| {
            let (c, message, instead) = lookalike(self.text, offset)?;
            let repair = (instead != "\"").then(|| Repair::Replace(offset..offset + c.len_utf8(), instead));
            Some(Problem { offset, message, repair })
        })
    }

    /// The problem of a file in a format other than RON, or with parts of another format's syntax.
    pub(super) fn other_format(&self, code: &Error) -> Option<Problem> {
        let root = self.map.start().unwrap_or(0);
        let before = &self.text[..self.end];
        let is_key = |rest: &str| rest.trim_start().starts_with([':', '=']);
        let here = self.end;
        let hash =
            |at: usize| Problem { repair: Some(Repair::Replace(at..at + 1, "//")), ..self.problem(at, HASH) };
        Some(match code {
            Error::ExpectedAttribute => hash(before.rfind('#')?),
            _ if self.rest().starts_with('#') => hash(here),
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
}

const HASH: &str = "a comment starts with `//`, not with `#`";
const JSON: &str = "this looks like JSON: RON has parentheses instead of braces, and field names without quotes: (name: ...)";
const NO_PARENTHESES: &str = "the file must be written in parentheses: (name: ..., ...)";

/// The text after the string in double quotes at the start of `text`.
fn after_string(text: &str) -> &str {
    text[1..].split_once('"').map_or("", |(_, rest)| rest)
}
