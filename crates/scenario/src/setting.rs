//! The change of one field of a value, given as text: the field's path and its new value in RON.

use ron::value::RawValue;
use serde::Serialize;
use serde::de::DeserializeOwned;
use wayfield_ron_patch::{set_field, tokens};

use super::explain::with_plain_numbers;
use super::load::{parse_ron, to_ron};

/// `old` with the RON `text` as the value of the field at `path`, unchecked otherwise.
///
/// A path looks like `obstacles[2].motion.speed_rad_s`, or `obstacles[*].motion.speed_rad_s` for all obstacles that have this
/// field; the name of a choice, such as `Orbit`, is not part of it. Whole numbers may also be written 6e5 or 600k.
///
/// # Errors
/// All problems: there is no such field, or it does not take the value. Each is explained as for a file, with the fix.
pub fn with_setting<T: Serialize + DeserializeOwned>(
    old: &T,
    path: &str,
    text: &str,
) -> Result<T, Vec<String>> {
    let one = |problem: String| vec![problem];
    let value = with_plain_numbers(text.trim());
    if !is_closed(&value) {
        return Err(one(format!("`{value}` has brackets that do not match; help: close each that is open")));
    }
    let before = to_ron(old).map_err(|error| one(error.to_string()))?;
    // The line break ends a comment.
    let after = set_field(&before, path, &format!("{value}\n")).map_err(|error| one(error.to_string()))?;
    let set = parse_ron(&after, path).map_err(|error| {
        error.problems().iter().map(|problem| problem.message.clone()).collect::<Vec<_>>()
    })?;
    match RawValue::from_ron(&format!("{value}\n")) {
        Ok(_) => Ok(set),
        Err(_) => Err(one(format!("`{value}` is not one value; help: give one value as in a file"))),
    }
}

/// Whether no bracket of the RON `text` closes one outside of it, and all are closed.
fn is_closed(text: &str) -> bool {
    let mut depth = 0_i32;
    let never_closes_more = tokens(text).all(|token| {
        depth += match &text[token] {
            "(" | "[" | "{" => 1,
            ")" | "]" | "}" => -1,
            _ => 0,
        };
        depth >= 0
    });
    never_closes_more && depth == 0
}
