//! The assignment of a value to a field of a RON text, by the field's path.

use std::ops::Range;

use crate::source_map::SourceMap;

/// The error of a path that leads to no field of a text, with the fix.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct PathError(String);

/// A part of a path.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Step<'a> {
    /// A field of a struct or of an enum's variant.
    Field(&'a str),
    /// An element of a list or tuple, counted from 0.
    Index(usize),
    /// All elements of a list that have the rest of the path.
    All,
}

/// A change of the text.
pub(crate) struct Edit {
    pub range: Range<usize>,
    pub new: String,
    /// Whether it adds a field that the text lacks.
    pub is_added: bool,
}

/// `text` with the RON text `value` at `path`.
///
/// A path looks like `obstacles[2].motion.speed_rad_s`, as in [`SourceMap`]. `obstacles[*].motion.speed_rad_s` means every
/// element of the list that has the rest of the path. A field that `text` lacks is added to its struct, so that the parser of
/// the result accepts or rejects its name; in a list that `text` lacks, `value` is the only element, whatever the index. `value`
/// is not checked.
///
/// ```
/// use wayfield_ron_patch::set_field;
///
/// let text = "(gamma: 0.99, sampling: Prioritized(alpha: 1.0))";
/// let set = set_field(text, "sampling.alpha", "0.6")?;
/// assert_eq!(set, "(gamma: 0.99, sampling: Prioritized(alpha: 0.6))");
/// # Ok::<(), wayfield_ron_patch::PathError>(())
/// ```
///
/// # Errors
/// `path` is not a path, or leads into a value that has no such part.
pub fn set_field(text: &str, path: &str, value: &str) -> Result<String, PathError> {
    let steps = steps(path)?;
    let map = SourceMap::new(text);
    let mut text = text.to_owned();
    for edit in edits(&map, SourceMap::ROOT, &steps, value)?.into_iter().rev() {
        text.replace_range(edit.range, &edit.new);
    }
    Ok(text)
}

/// The parts of `path`.
fn steps(path: &str) -> Result<Vec<Step<'_>>, PathError> {
    let invalid = || {
        PathError(format!(
            "`{path}` is not the path of a field; help: write names with dots between them, and [0] or [*] for elements of a list"
        ))
    };
    let mut steps = Vec::new();
    for part in path.split('.') {
        let (name, mut brackets) = part.split_at(part.find('[').unwrap_or(part.len()));
        if name.is_empty() || !name.chars().all(|c| c.is_alphanumeric() || c == '_') {
            return Err(invalid());
        }
        steps.push(Step::Field(name));
        while !brackets.is_empty() {
            let inner = brackets.strip_prefix('[').and_then(|rest| rest.split_once(']'));
            let (index, rest) = inner.ok_or_else(invalid)?;
            steps.push(match index {
                "*" => Step::All,
                index => Step::Index(index.parse().map_err(|_| invalid())?),
            });
            brackets = rest;
        }
    }
    Ok(steps)
}

/// The edits that set the value at the path `steps`, relative to `entry`, to `value`; in the order of the text.
fn edits(map: &SourceMap, entry: usize, steps: &[Step], value: &str) -> Result<Vec<Edit>, PathError> {
    let Some((&step, rest)) = steps.split_first() else {
        return Ok(vec![Edit { range: map.value_of(entry), new: value.to_owned(), is_added: false }]);
    };
    match step {
        Step::All => edits_of_all(map, entry, rest, value),
        Step::Field(name) => match map.field_of(entry, name) {
            Some(field) => edits(map, field, rest, value),
            None => Ok(vec![added(map, entry, name, rest, value)?]),
        },
        Step::Index(index) => match map.elements_of(entry).nth(index) {
            Some(element) => edits(map, element, rest, value),
            None => Err(missing_part(map, entry, &format!("[{index}]"))),
        },
    }
}

/// The edits in all elements of `entry` that have the rest of the path. If none has it, the edits that add it to all elements that
/// can have it, or the error of the first element.
fn edits_of_all(map: &SourceMap, entry: usize, rest: &[Step], value: &str) -> Result<Vec<Edit>, PathError> {
    let of_elements: Vec<_> =
        map.elements_of(entry).map(|element| edits(map, element, rest, value)).collect();
    let is_there = |edits: &Result<Vec<Edit>, PathError>| {
        edits.as_ref().is_ok_and(|edits| edits.iter().all(|edit| !edit.is_added))
    };
    if of_elements.iter().any(is_there) {
        return Ok(of_elements.into_iter().filter(is_there).flatten().flatten().collect());
    }
    if of_elements.iter().any(Result::is_ok) {
        return Ok(of_elements.into_iter().flatten().flatten().collect());
    }
    of_elements.into_iter().next().unwrap_or_else(|| Err(missing_part(map, entry, "element")))
}

/// The edit that adds the field `name` to the struct or variant `entry`, with `value` at the path `rest` in it.
fn added(map: &SourceMap, entry: usize, name: &str, rest: &[Step], value: &str) -> Result<Edit, PathError> {
    let open = map.bracket_of(entry).filter(|_| map.elements_of(entry).next().is_none());
    let open = open.ok_or_else(|| missing_part(map, entry, &format!("`{name}`")))?;
    let value = rest.iter().rev().fold(value.to_owned(), |value, step| match step {
        Step::Field(name) => format!("({name}: {value})"),
        Step::Index(_) | Step::All => format!("[{value}]"),
    });
    Ok(Edit { range: open..open, new: format!("{name}: {value}, "), is_added: true })
}

/// The error for a value that lacks `part`, a field or an element.
fn missing_part(map: &SourceMap, entry: usize, part: &str) -> PathError {
    let path = map.path_of(entry);
    let text = map.text_of(entry).split_whitespace().collect::<Vec<_>>().join(" ");
    let long = text.char_indices().nth(40).map(|(end, _)| &text[..end]);
    let (start, dots) = long.map_or((text.as_str(), ""), |start| (start, "..."));
    let (value, help) = if path.is_empty() {
        ("the text".to_owned(), "give the text of a struct".to_owned())
    } else {
        (format!("`{path}`"), format!("set `{path}` as a whole"))
    };
    PathError(format!("{value} is `{start}{dots}`, which has no {part}; help: {help}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "(gamma: 0.99, rate: Constant(0.1), loss: Squared, sampling: Prioritized(alpha: 1.0), \
                        parts: [(motion: Orbit(speed: 1.0)), (motion: Static), (motion: Orbit(speed: 2.0))], at: (1.0, 2.0))";

    fn set(path: &str, value: &str) -> String {
        set_field(TEXT, path, value).unwrap_or_else(|error| panic!("{path}: {error}"))
    }

    #[test]
    fn a_path_leads_through_structs_variants_lists_and_tuples() {
        for (path, old) in [
            ("gamma", "0.99"),
            ("rate", "Constant(0.1)"),
            ("loss", "Squared"),
            ("sampling", "Prioritized(alpha: 1.0)"),
            ("parts[1].motion", "Static"),
            ("parts[2].motion.speed", "2.0"),
        ] {
            assert_eq!(set(path, "new"), TEXT.replacen(old, "new", 1), "{path}");
        }
        assert_eq!(set("at[1]", "new"), TEXT.replace("at: (1.0, 2.0)", "at: (1.0, new)"));
    }

    #[test]
    fn a_star_means_the_elements_that_have_the_field() {
        let expected = TEXT.replace("speed: 1.0", "speed: 3.0").replace("speed: 2.0", "speed: 3.0");
        assert_eq!(set("parts[*].motion.speed", "3.0"), expected);
    }

    #[test]
    fn a_missing_field_is_added_so_that_the_parser_accepts_or_rejects_its_name() {
        assert_eq!(set("gama", "1"), TEXT.replacen('(', "(gama: 1, ", 1));
        assert_eq!(set("new.list[0]", "1"), TEXT.replacen('(', "(new: (list: [1]), ", 1));
        assert_eq!(set("sampling.beta", "1"), TEXT.replace("(alpha", "(beta: 1, alpha"));
        assert_eq!(set("parts[*].mass", "1"), TEXT.replace("(motion", "(mass: 1, motion"));
        let lacking = "parts[*].motion.phase";
        assert_eq!(set(lacking, "1"), TEXT.replace("Orbit(", "Orbit(phase: 1, "), "not in `Static`");
    }

    #[test]
    fn the_error_of_a_path_that_leads_nowhere_names_what_is_there() {
        for (path, message) in [
            ("loss.delta", "`loss` is `Squared`, which has no `delta`; help: set `loss` as a whole"),
            ("rate.from", "`rate` is `Constant(0.1)`, which has no `from`; help: set `rate` as a whole"),
            ("gamma[0]", "`gamma` is `0.99`, which has no [0]; help: set `gamma` as a whole"),
            (
                "parts[3].motion",
                "`parts` is `[(motion: Orbit(speed: 1.0)), (motion: S...`, which has no [3]; help: set `parts` as a whole",
            ),
        ] {
            assert_eq!(set_field(TEXT, path, "1").expect_err(path).to_string(), message);
        }
        let error = set_field("0.5", "gamma", "1").expect_err("a number has no fields").to_string();
        assert_eq!(error, "the text is `0.5`, which has no `gamma`; help: give the text of a struct");
        for path in ["", ".", "a..b", "a[", "a[x]", "a[0", "a]", "[0]", "a b", "a[-1]", "a.[0]"] {
            let error = set_field(TEXT, path, "1").expect_err(path).to_string();
            assert!(error.starts_with(&format!("`{path}` is not the path of a field; help: ")), "{error}");
        }
    }
}
