//! The defaults of a format's fields, as the program reads them from the shortest file that contains the type.

use std::collections::VecDeque;

use wayfield_ron_patch::SourceMap;

use super::schema::{Entry, Group, Section, inner, name};

/// Reads the text of a file of the format, and returns it with all fields written out.
pub type Read = fn(&str) -> String;

/// A path into a file: the fields that lead from the whole file to a type in it, each with the group that it belongs to.
#[derive(Clone, Default)]
struct FieldPath<'a>(Vec<(&'a Group, &'a Entry)>);

/// The value of each field of `group` in `section`, as text, in a file that gives only the fields without a default. `None` for a
/// field that is not written when it has its default.
pub fn defaults(sections: &[Section], read: Read, section: &Section, group: &Group) -> Vec<Option<String>> {
    let fields = path_to(sections, &section.name);
    let text = read(&fields.file(&shortest(group, sections), sections));
    let map = SourceMap::new(&text);
    let prefix = fields.notation();
    let value = |entry: &Entry| {
        let path = [prefix.as_str(), &entry.name].join(if prefix.is_empty() { "" } else { "." });
        let offset = map.offset_of(&path).filter(|offset| map.path_at(*offset) == path)?;
        Some(squeezed(&text[map.value_at(offset)]))
    };
    group.entries.iter().map(value).collect()
}

/// The shortest path from the first of `sections` to the one called `target`.
fn path_to<'a>(sections: &'a [Section], target: &str) -> FieldPath<'a> {
    let mut open = VecDeque::from([(&sections[0], FieldPath::default())]);
    let mut seen = vec![&sections[0].name];
    while let Some((section, path)) = open.pop_front() {
        if section.name == target {
            return path;
        }
        for (group, entry) in
            section.groups.iter().flat_map(|group| group.entries.iter().map(move |e| (group, e)))
        {
            let kind = name(inner(&entry.kind).unwrap_or(&entry.kind));
            if let Some(next) = sections.iter().find(|next| next.name == kind && !seen.contains(&&next.name))
            {
                seen.push(&next.name);
                open.push_back((next, FieldPath([path.0.as_slice(), &[(group, entry)]].concat())));
            }
        }
    }
    panic!("no field leads to {target}")
}

impl FieldPath<'_> {
    /// The text of a file with `value` at the end of this path.
    fn file(&self, value: &str, sections: &[Section]) -> String {
        self.0.iter().rev().fold(value.to_owned(), |value, (group, entry)| {
            let value = if name(&entry.kind) == "Vec" { format!("[{value}]") } else { value };
            let others = group.entries.iter().filter(|other| !other.optional && other.name != entry.name);
            let others = others.map(|other| format!(", {}: {}", other.name, sample(other, sections)));
            let colon = if entry.name.is_empty() { "" } else { ": " };
            format!("{}({}{colon}{value}{})", group.name, entry.name, others.collect::<String>())
        })
    }

    /// The path as a [`SourceMap`] writes it.
    fn notation(&self) -> String {
        let mut path = String::new();
        for (_, entry) in &self.0 {
            path += if path.is_empty() || entry.name.is_empty() { "" } else { "." };
            path += &entry.name;
            path += if entry.name.is_empty() { "[0]" } else { "" };
            path += if name(&entry.kind) == "Vec" { "[0]" } else { "" };
        }
        path
    }
}

/// The shortest text for a struct or variant: only the fields without a default.
fn shortest(group: &Group, sections: &[Section]) -> String {
    let required = group.entries.iter().filter(|entry| !entry.optional);
    let colon = if group.is_tuple() { "" } else { ": " };
    let fields: Vec<_> =
        required.map(|entry| format!("{}{colon}{}", entry.name, sample(entry, sections))).collect();
    let is_unit = group.entries.is_empty() && !group.name.is_empty();
    if is_unit { group.name.clone() } else { format!("{}({})", group.name, fields.join(", ")) }
}

/// An example value for the field `entry`.
fn sample(entry: &Entry, sections: &[Section]) -> String {
    match name(&entry.kind).as_str() {
        "" | "Vec2" => "(1.0, 1.0)".into(),
        "String" => "\"\"".into(),
        "bool" => "true".into(),
        "f32" | "f64" => "1.0".into(),
        "u8" | "u16" | "u32" | "u64" | "usize" => "1".into(),
        "Vec" => "[]".into(),
        // A whole number is also read as a float.
        "Ranged" => "1".into(),
        name => {
            let section = sections.iter().find(|section| section.name == name);
            shortest(&section.unwrap_or_else(|| panic!("{name} is not in the sources")).groups[0], sections)
        }
    }
}

/// Joins the lines of a RON text into one.
fn squeezed(text: &str) -> String {
    let line = text.lines().map(str::trim).collect::<Vec<_>>().join(" ");
    line.replace("( ", "(").replace("[ ", "[").replace(", )", ")").replace(", ]", "]")
}
