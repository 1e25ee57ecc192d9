//! The defaults of a format's fields, as the program reads them: from the shortest file that has the type in it.

use std::collections::VecDeque;

use wayfield_ron_patch::SourceMap;

use super::schema::{Entry, Group, Section, inner, name};

/// Reads a file of the format, and writes it with all fields.
pub type Read = fn(&str) -> String;

/// A way into a file: fields of groups, each with the type that it leads to.
#[derive(Clone, Default)]
struct Way<'a>(Vec<(&'a Group, &'a Entry)>);

/// The text of each field of `group`, which belongs to `section`, if the fields without defaults have any values. `None` for a
/// field that is not written at all.
pub fn defaults(sections: &[Section], read: Read, section: &Section, group: &Group) -> Vec<Option<String>> {
    let way = way_to(sections, &section.name);
    let text = read(&way.text(&shortest(group, sections), sections));
    let map = SourceMap::new(&text);
    let path = way.path();
    let value = |entry: &Entry| {
        let path = [path.as_str(), &entry.name].join(if path.is_empty() { "" } else { "." });
        let offset = map.offset_of(&path).filter(|offset| map.path_at(*offset) == path)?;
        Some(squeezed(&text[map.value_at(offset)]))
    };
    group.entries.iter().map(value).collect()
}

/// The shortest way from the first of `sections` to the one called `target`.
fn way_to<'a>(sections: &'a [Section], target: &str) -> Way<'a> {
    let mut open = VecDeque::from([(&sections[0], Way::default())]);
    let mut seen = vec![&sections[0].name];
    while let Some((section, way)) = open.pop_front() {
        if section.name == target {
            return way;
        }
        for (group, entry) in
            section.groups.iter().flat_map(|group| group.entries.iter().map(move |e| (group, e)))
        {
            let kind = name(inner(&entry.kind).unwrap_or(&entry.kind));
            if let Some(next) = sections.iter().find(|next| next.name == kind && !seen.contains(&&next.name))
            {
                seen.push(&next.name);
                open.push_back((next, Way([way.0.as_slice(), &[(group, entry)]].concat())));
            }
        }
    }
    panic!("no field leads to {target}")
}

impl Way<'_> {
    /// A file with `value` at the end of this way.
    fn text(&self, value: &str, sections: &[Section]) -> String {
        self.0.iter().rev().fold(value.to_owned(), |value, (group, entry)| {
            let value = if name(&entry.kind) == "Vec" { format!("[{value}]") } else { value };
            let others = group.entries.iter().filter(|other| !other.optional && other.name != entry.name);
            let others = others.map(|other| format!(", {}: {}", other.name, sample(other, sections)));
            let colon = if entry.name.is_empty() { "" } else { ": " };
            format!("{}({}{colon}{value}{})", group.name, entry.name, others.collect::<String>())
        })
    }

    /// The path of its end in the file.
    fn path(&self) -> String {
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
        // A whole number is a number, too.
        "Ranged" => "1".into(),
        name => {
            let section = sections.iter().find(|section| section.name == name);
            shortest(&section.unwrap_or_else(|| panic!("{name} is not in the sources")).groups[0], sections)
        }
    }
}

/// RON on several lines, on one.
fn squeezed(text: &str) -> String {
    let line = text.lines().map(str::trim).collect::<Vec<_>>().join(" ");
    line.replace("( ", "(").replace("[ ", "[").replace(", )", ")").replace(", ]", "]")
}
