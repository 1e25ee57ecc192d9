//! Names of fields and choices that are unknown, missing or used twice.

use ron::error::Error;

use super::synonyms::synonym;
use super::{Place, Problem, Repair};

impl Place<'_> {
    /// The problem if a field or choice has an unknown name, or a field is missing or appears twice; `None` for other errors.
    pub(super) fn name(&self, code: &Error) -> Option<Problem> {
        let Self { start, end, .. } = *self;
        Some(match code {
            Error::NoSuchStructField { expected, found, .. } => {
                let fields = choose(found, expected, "the fields are");
                let message = format!("unknown field `{found}` in {}: {fields}", self.parent(start));
                let repair = self.renaming(found, expected).unwrap_or_else(|| self.removal());
                Problem { offset: start, message, repair: Some(repair) }
            }
            Error::NoSuchEnumVariant { expected, found, .. } => {
                let choices = choose(found, expected, "the choices are");
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

    /// The repair that replaces the name `found` at `start` with the `expected` name that was probably meant, if there is one.
    fn renaming(&self, found: &str, expected: &'static [&'static str]) -> Option<Repair> {
        let near = match synonym(found, expected) {
            Some(path) => expected.iter().copied().find(|name| *name == path)?,
            None => closest_name(found, expected.iter().copied())?,
        };
        let is_there = self.text[self.start..].starts_with(found);
        is_there.then(|| Repair::Rename(self.start..self.start + found.len(), near))
    }

    /// The removal of the field at `start`, with the comma after it.
    fn removal(&self) -> Repair {
        let field = self.map.field_at(self.start);
        let after = &self.text[field.end..];
        let kept = after.trim_start().strip_prefix(',').unwrap_or(after);
        Repair::Replace(field.start..self.text.len() - kept.len(), "")
    }
}

/// The message about the `fields` that `owner` lacks.
pub(super) fn missing_fields(owner: &str, fields: &[&str]) -> String {
    let names: Vec<_> = fields.iter().map(|name| format!("`{name}`")).collect();
    match fields {
        [field] => format!("{owner} lacks the field `{field}`: add `{field}: ...`"),
        _ => format!("{owner} lacks the fields {}: add them", names.join(", ")),
    }
}

/// A hint such as "did you mean `x`? the fields are `x`, `y`". It suggests the path of the field that `word` is a synonym of, or
/// else a similar name in `known`, if there is one. Then it lists `known` after `lead` ("the fields are"). If `known` is empty,
/// the hint is "there are none here".
#[must_use]
pub fn choose(word: &str, known: &[&str], lead: &str) -> String {
    let hint = synonym(word, known)
        .or_else(|| closest_name(word, known.iter().copied()))
        .map(|near| format!("did you mean `{near}`? "))
        .unwrap_or_default();
    let all: Vec<_> = known.iter().map(|name| format!("`{name}`")).collect();
    if all.is_empty() { "there are none here".into() } else { format!("{hint}{lead} {}", all.join(", ")) }
}

/// The name in `known` that is most similar to `word`, if one is similar enough for a "did you mean" hint.
#[must_use]
pub fn closest_name<'a>(word: &str, known: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let word = word.to_lowercase();
    known
        .map(|name| (strsim::jaro_winkler(&word, &name.to_lowercase()), name))
        .filter(|&(score, _)| score > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, name)| name)
}
