//! A RON writer that keeps comments.
//!
//! A program that reads a hand-written RON file, changes one number and writes the file back usually loses its comments
//! and its layout. [`patch`] writes the change into the old text instead: all bytes outside the change stay the same.
//! [`to_text`] writes a value that has no old text.
//!
//! ```
//! use serde::{Deserialize, Serialize};
//! use wayfield_ron_patch::{Style, patch};
//!
//! #[derive(Serialize, Deserialize)]
//! struct Lidar {
//!     beams: u32,
//!     max_range_m: f32,
//! }
//!
//! let text = "(\n    beams: 24, // one every 15 degrees\n    max_range_m: 3.50,\n)\n";
//! let mut lidar: Lidar = ron::from_str(text)?;
//! lidar.beams = 36;
//!
//! let patched = patch(text, &lidar, &Style::default(), |text| ron::from_str(text).ok())?;
//! assert_eq!(patched, "(\n    beams: 36, // one every 15 degrees\n    max_range_m: 3.50,\n)\n");
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! | module | purpose |
//! |---|---|
//! | [`Style`] | fields that may be left out, blank lines between the top-level fields |
//! | `value`, `serializer` | any supported serde value as a tree of names, numbers and strings |
//! | `format`, `literal` | the canonical text of a tree |
//! | [`tokens`], `syntax`, `trivia` | the old text as a tree of byte ranges, with comments and spaces between them |
//! | `merge`, `align`, `rebuild` | the old text with the changed values in it |
//! | [`set_field`] | a new value for the field at a path |
//! | [`overlay`] | one text, overridden by the fields of another |
//! | [`SourceMap`] | from a byte offset to a field's path and back, for error messages |
//!
//! Supported types are structs with named fields, enums whose variants have named fields or no fields, options, lists,
//! tuples, tuple structs, strings, booleans and numbers. Other types (maps, characters, bytes, units, newtypes and tuple
//! variants) return [`Unsupported`].

mod align;
mod format;
mod literal;
mod merge;
mod overlay;
mod rebuild;
mod serializer;
mod set_field;
mod source_map;
mod style;
mod syntax;
mod tokens;
mod trivia;
mod value;

use serde::Serialize;

pub use self::overlay::overlay;
pub use self::serializer::Unsupported;
pub use self::set_field::{PathError, set_field};
pub use self::source_map::SourceMap;
pub use self::style::Style;
pub use self::tokens::tokens;

use self::format::Formatter;
use self::merge::Merge;
use self::syntax::SyntaxNode;
use self::value::Value;

/// The canonical text of `value`: fields in the type's order, four spaces per level, lines of up to 110 columns, and
/// only the fields that differ from the defaults in `style`, or all if none does. It ends with a newline.
///
/// # Errors
/// [`Unsupported`] if `value` contains a type that this crate cannot write.
pub fn to_text<T: Serialize>(value: &T, style: &Style) -> Result<String, Unsupported> {
    Ok(Formatter::new("\n", style).file(&Value::from_serde(value)?))
}

/// A new version of `text` that contains `value`. `text` contains the old value, which `read` parses.
///
/// - Unchanged parts keep their bytes: comments, order, blank lines, and defaults that are written out.
/// - A changed field is rewritten in place; the comments above it stay. A field without comments is removed if its new value is
///   empty and equals its default.
/// - A new list element is inserted at its position in the list. A removed element is removed with its comments.
/// - Line endings follow the first line of `text`.
///
/// The result is checked: `read` parses it back to `value`, bit for bit. If that fails, or if `read` rejects `text`, the
/// result is [`to_text`] instead.
///
/// # Errors
/// [`Unsupported`] if `value` contains a type that this crate cannot write.
pub fn patch<T: Serialize>(
    text: &str,
    value: &T,
    style: &Style,
    read: impl Fn(&str) -> Option<T>,
) -> Result<String, Unsupported> {
    let new = Value::from_serde(value)?;
    let read = |text: &str| Value::from_serde(&read(text)?).ok();
    let patched = read(text).and_then(|old| merge(text, &old, &new, style));
    match patched.filter(|text| read(text).as_ref() == Some(&new)) {
        Some(patched) => Ok(patched),
        None => to_text(value, style),
    }
}

/// A new version of `text` that contains `new` instead of `old`; `None` if the brackets of `text` do not match.
fn merge(text: &str, old: &Value, new: &Value, style: &Style) -> Option<String> {
    let first_line = text.split_once('\n').map_or("", |(line, _)| line);
    let formatter = Formatter::new(if first_line.ends_with('\r') { "\r\n" } else { "\n" }, style);
    Some(Merge { text, formatter: &formatter }.file(&SyntaxNode::parse(text)?, old, new))
}
