//! The tree of a serde value: type and field names, fields in the type's order, numbers as RON text.

/// A value. Equality compares the RON text of numbers: 0.0 and -0.0 differ, and NaNs are equal.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Value {
    /// A number or boolean, as RON text.
    Scalar(String),
    /// A string, without quotes and escapes.
    Text(String),
    /// `None`.
    Null,
    /// `(a, b)`.
    Tuple(Vec<Value>),
    /// `[a, b]`.
    List(Vec<Value>),
    /// `(field: a)`, `Variant(field: a)` or `Variant`.
    Record(Record),
}

/// A struct, or a variant of an enum.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct Record {
    /// The name of the struct or enum.
    pub kind: &'static str,
    /// The name of the enum's variant; empty for a struct.
    pub variant: &'static str,
    /// Names and values of the fields, in the type's order.
    pub fields: Vec<(&'static str, Value)>,
}

impl Value {
    /// The record, if this is one.
    pub fn record(&self) -> Option<&Record> {
        if let Self::Record(record) = self { Some(record) } else { None }
    }

    /// Whether this is `None`, an empty string or list, or a struct or variant without fields.
    pub fn is_empty(&self) -> bool {
        match self {
            Self::Null => true,
            Self::Text(text) => text.is_empty(),
            Self::List(parts) => parts.is_empty(),
            Self::Record(record) => record.fields.is_empty(),
            Self::Scalar(_) | Self::Tuple(_) => false,
        }
    }
}

impl Record {
    /// Whether both are of the same struct, or of the same variant of the same enum.
    pub fn is_same_type(&self, other: &Self) -> bool {
        self.kind == other.kind && self.variant == other.variant
    }
}
