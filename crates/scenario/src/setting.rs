//! The change of one field of a value, given as text: the field's path and its new value in RON.

use ron::value::RawValue;
use serde::Serialize;
use serde::de::DeserializeOwned;
use wayfield_ron_patch::{set_field, tokens};

use super::explain::with_plain_numbers;
use super::load::{parse_ron, to_ron};

/// Returns `old` with the RON `text` as the value of the field at `path`. Only the type of the value is checked.
///
/// A path looks like `obstacles[2].motion.speed_rad_s`, or `obstacles[*].motion.speed_rad_s` for all obstacles that have this
/// field; the name of an enum variant, such as `Orbit`, is not part of it. Whole numbers may also be written 6e5 or 600k.
///
/// # Errors
/// There is no such field, or it does not take the value. The problem is explained as for a file, with the fix.
pub fn with_setting<T: Serialize + DeserializeOwned>(old: &T, path: &str, text: &str) -> Result<T, String> {
    let value = with_plain_numbers(text.trim());
    if !is_closed(&value) {
        let help = "add the missing bracket, or remove the extra one";
        return Err(format!("`{value}` has brackets that do not match; help: {help}"));
    }
    let before = to_ron(old).map_err(|error| error.to_string())?;
    // The line break ends a comment at the end of the value.
    let line = format!("{value}\n");
    let after = set_field(&before, path, &line).map_err(|error| error.to_string())?;
    // Only the first problem is reported; any others are its consequences.
    let set = parse_ron(&after, path).map_err(|error| error.problems()[0].message.clone())?;
    if RawValue::from_ron(&line).is_err() {
        return Err(format!("`{value}` is not one value; help: give one value as in a file"));
    }
    // A list that was missing now has the value as its only element, so setting an element other than the first fails here.
    // This check comes last, so that an unknown name is reported first.
    if set_field(&after, path, &line).is_err() {
        return Err("the list is not given, so it has no such element; help: set it as a whole".into());
    }
    Ok(set)
}

/// Whether the RON `text` closes all brackets that it opens, and no others.
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

#[cfg(test)]
mod tests {
    use serde::Deserialize;

    use super::*;
    use crate::Scenario;

    #[test]
    fn a_number_that_starts_with_a_dot_keeps_its_exponent() {
        let set = with_setting(&Scenario::default(), "lidar.max_range_m", ".25e1").expect("a number");
        assert_eq!(set.lidar.max_range_m, 2.5);
    }

    #[test]
    fn a_missing_list_has_only_a_first_element() {
        #[derive(Debug, Default, PartialEq, Serialize, Deserialize)]
        #[serde(deny_unknown_fields, default)]
        struct Route {
            #[serde(skip_serializing_if = "Vec::is_empty")]
            stops: Vec<u32>,
        }
        let set = |path: &str| with_setting(&Route::default(), path, "7");
        assert_eq!(set("stops[0]"), Ok(Route { stops: vec![7] }));
        let error = "the list is not given, so it has no such element; help: set it as a whole";
        assert_eq!(set("stops[2]"), Err(error.into()));
        let error = set("stop[2]").expect_err("an unknown name");
        assert!(error.contains("did you mean `stops`?"), "{error}");
    }
}
