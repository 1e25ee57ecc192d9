//! One RON text, overridden by the fields of another.

use crate::set_field::Edit;
use crate::source_map::SourceMap;

/// `base`, overridden by the fields of `text`. Both are RON texts of the same struct type. A nested struct that `base` writes
/// without a type name is overridden field by field; any other value (an enum, a list, a tuple) is replaced as a whole.
///
/// ```
/// use wayfield_ron_patch::overlay;
///
/// let base = "(gamma: 0.99, net: (units: 64, layers: 2), loss: Huber(delta: 1.0))";
/// let text = "(net: (units: 32), loss: Squared)";
/// assert_eq!(overlay(base, text), "(gamma: 0.99, net: (units: 32\n, layers: 2), loss: Squared\n)");
/// ```
#[must_use]
pub fn overlay(base: &str, text: &str) -> String {
    let mut edits = Vec::new();
    let (maps, roots) = ((&SourceMap::new(base), &SourceMap::new(text)), (SourceMap::ROOT, SourceMap::ROOT));
    collect(maps, roots, &mut edits);
    edits.sort_by_key(|edit| edit.range.start);
    let mut result = base.to_owned();
    for edit in edits.into_iter().rev() {
        result.replace_range(edit.range, &edit.new);
    }
    result
}

/// Adds the edits that override the struct `entries.0` of the base text with the fields of the struct `entries.1`.
fn collect(maps: (&SourceMap, &SourceMap), entries: (usize, usize), edits: &mut Vec<Edit>) {
    let (base, text) = maps;
    for (name, field) in text.fields_of(entries.1) {
        // The line break ends a line comment after the value.
        let value = format!("{}\n", text.text_of(field));
        match base.field_of(entries.0, name) {
            Some(old) if is_struct(base, old) && text.bracket_of(field).is_some() => {
                collect(maps, (old, field), edits);
            }
            Some(old) => edits.push(Edit { range: base.value_of(old), new: value, is_added: false }),
            None => edits.extend(base.bracket_of(entries.0).map(|open| Edit {
                range: open..open,
                new: format!("{name}: {value}, "),
                is_added: true,
            })),
        }
    }
}

/// Whether the value of `entry` is a struct without a type name.
fn is_struct(map: &SourceMap, entry: usize) -> bool {
    map.text_of(entry).starts_with('(') && map.elements_of(entry).next().is_none()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn structs_are_merged_and_everything_else_is_replaced_as_a_whole() {
        let base = "(a: 1, b: (c: 2, d: (e: 3, f: 4)), g: [(h: 5), (h: 6)], i: Kind(j: 7, k: 8), l: (1, 2), m: None)";
        for (text, expected) in [
            ("()", base.to_owned()),
            ("(a: 9 /* why */)", base.replace("a: 1", "a: 9 /* why */\n")),
            ("(a /* why */: 9)", base.replace("a: 1", "a: 9\n")),
            (
                "Named(b: Inner(d: (f: 9)), a: 8 // last\n)",
                base.replace("f: 4", "f: 9\n").replace("a: 1", "a: 8 // last\n"),
            ),
            ("(b: ())", base.to_owned()),
            ("(g: [(h: 9)])", base.replace("[(h: 5), (h: 6)]", "[(h: 9)]\n")),
            ("(i: Kind(j: 9))", base.replace("Kind(j: 7, k: 8)", "Kind(j: 9)\n")),
            ("(l: (3, 4), m: (n: 1))", base.replace("(1, 2)", "(3, 4)\n").replace("None", "(n: 1)\n")),
            ("(b: (new: 9))", base.replace("b: (", "b: (new: 9\n, ")),
        ] {
            assert_eq!(overlay(base, text), expected, "{text}");
        }
    }
}
