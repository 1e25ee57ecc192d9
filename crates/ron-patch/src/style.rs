//! The style of a type's text: the fields that a file may leave out, and the blank lines.

use serde::Serialize;

use crate::value::{Record, Value};

/// Fields that may be left out of a file, and blank lines between its top-level fields.
///
/// The default style writes every field, without blank lines.
#[derive(Clone, Debug, Default)]
pub struct Style {
    /// The structs and variants with optional fields. Each record holds those fields with their defaults.
    optional: Vec<Record>,
    /// The pairs of neighbouring top-level fields without a blank line between them; `None` if there are no blank lines at all.
    joined: Option<&'static [(&'static str, &'static str)]>,
}

impl Style {
    /// Makes the fields of a type optional, except the `required` ones: a field equal to that of `value` is left out.
    ///
    /// `value` holds the defaults of a struct or of an enum variant, as read from the shortest valid text. Call this once
    /// for each struct and each variant with defaults. Values of unsupported types are ignored.
    #[must_use]
    pub fn with_defaults<T: Serialize>(mut self, value: &T, required: &[&str]) -> Self {
        if let Ok(Value::Record(mut record)) = Value::from_serde(value) {
            record.fields.retain(|(name, _)| !required.contains(name));
            self.optional.push(record);
        }
        self
    }

    /// Puts a blank line between neighbouring top-level fields, except between the given (field, next field) pairs.
    #[must_use]
    pub fn with_blank_lines_except(mut self, pairs: &'static [(&'static str, &'static str)]) -> Self {
        self.joined = Some(pairs);
        self
    }

    /// Whether `value` is the default of `field` of `record`.
    pub(crate) fn is_default(&self, record: &Record, field: &str, value: &Value) -> bool {
        let optional = self.optional.iter().find(|other| other.is_same_type(record));
        let fields = optional.map_or(&[][..], |optional| &optional.fields);
        fields.iter().any(|(name, default)| *name == field && default == value)
    }

    /// Whether all fields of `record` have their defaults.
    pub(crate) fn is_all_default(&self, record: &Record) -> bool {
        record.fields.iter().all(|(name, value)| self.is_default(record, name, value))
    }

    /// Whether a blank line goes between two neighbouring top-level fields.
    pub(crate) fn blank_line_between(&self, before: &str, after: &str) -> bool {
        self.joined.is_some_and(|joined| !joined.contains(&(before, after)))
    }
}
