//! The reference of a format in Markdown: its types, each with a table of its fields.

use std::fmt::Write as _;

use syn::Type;

use super::defaults::{Read, defaults};
use super::schema::{Entry, Group, Section, inner, name};

/// The longest default in a table, in characters.
const MAX_DEFAULT: usize = 40;

/// The reference of a format. `sections` are its types, beginning with that of the whole file; `last` is the label of a section
/// that follows.
pub fn reference(sections: &[Section], read: Read, last: Option<&str>) -> String {
    let mut page = String::from("\n## Contents\n\n");
    for section in sections {
        let about = section.about.first().map_or("", String::as_str);
        let about = about.split(['.', ':', ';']).next().unwrap_or_default();
        let _ = writeln!(page, "- {}: {}", link(&words(&section.name)), lower(about));
    }
    if let Some(label) = last {
        let _ = writeln!(page, "- {}", link(label));
    }
    for section in sections {
        let _ = write!(page, "\n## {}\n\n", words(&section.name));
        for paragraph in &section.about {
            let _ = write!(page, "{paragraph}\n\n");
        }
        if !section.default.is_empty() {
            let _ = write!(page, "*Default:* {}\n\n", section.default.join(" "));
        }
        groups(&mut page, section, sections, read);
        page.truncate(page.trim_end().len());
        page.push('\n');
    }
    page
}

fn groups(page: &mut String, section: &Section, sections: &[Section], read: Read) {
    if section.groups.iter().all(|group| !group.name.is_empty() && group.entries.is_empty()) {
        page.push_str("| choice | meaning |\n|---|---|\n");
        for group in &section.groups {
            let _ = writeln!(page, "| `{}` | {} |", group.name, cell(&group.about.join(" ")));
        }
        return;
    }
    for group in &section.groups {
        if !group.name.is_empty() {
            let parts: Vec<_> = group.entries.iter().map(|entry| written(&entry.kind)).collect();
            let parts = if group.is_tuple() { format!("({})", parts.join(", ")) } else { String::new() };
            let _ = write!(page, "### `{}{parts}`\n\n{}\n\n", group.name, group.about.join("\n\n"));
        }
        if !group.entries.is_empty() && !group.is_tuple() {
            table(page, section, group, sections, read);
        }
    }
}

fn table(page: &mut String, section: &Section, group: &Group, sections: &[Section], read: Read) {
    let with_defaults = group.entries.iter().any(|entry| entry.optional);
    page.push_str(match with_defaults {
        true => "| field | written | default | meaning |\n|---|---|---|---|\n",
        false => "| field | written | meaning |\n|---|---|---|\n",
    });
    let mut below = String::new();
    for (entry, value) in group.entries.iter().zip(defaults(sections, read, section, group)) {
        let (short, long) = default(entry, value, sections);
        let short = if with_defaults { format!("{short} | ") } else { String::new() };
        let written = written(&entry.kind);
        let _ = writeln!(page, "| `{}` | {written} | {short}{} |", entry.name, cell(&entry.about));
        if let Some(long) = long {
            // A list has one element per line.
            let is_list = long.starts_with('[');
            let lines = || long.replace("), ", "),\n    ").replace('[', "[\n    ").replace(")]", "),\n]");
            let long = if is_list { lines() } else { long };
            let _ = write!(below, "The default of `{0}`:\n\n```ron\n{0}: {long}\n```\n\n", entry.name);
        }
    }
    page.push('\n');
    page.push_str(&below);
}

/// The text of the default column for `entry`, whose default is `value`; and the default itself, if it is too long for a table.
fn default(entry: &Entry, value: Option<String>, sections: &[Section]) -> (String, Option<String>) {
    let kind = name(&entry.kind);
    let is_struct = sections.iter().any(|section| section.name == kind && section.is_struct());
    match value.as_deref() {
        _ if !entry.optional => ("must be given".into(), None),
        _ if is_struct => ("its own defaults".into(), None),
        None | Some("None") => ("none".into(), None),
        Some(text) if text.len() > MAX_DEFAULT => ("see below".into(), value),
        Some(text) => (format!("`{text}`"), None),
    }
}

/// How a value of the type is written. Points are `Vec2`, ranges are pairs.
fn written(kind: &Type) -> String {
    match (name(kind).as_str(), inner(kind)) {
        ("", _) => match kind {
            Type::Tuple(tuple) if tuple.elems.iter().any(|part| name(part) != "f32") => {
                let parts: Vec<_> = tuple.elems.iter().map(written).collect();
                format!("({})", parts.join(", "))
            }
            _ => "`(lowest, highest)`".into(),
        },
        ("Vec2", _) => "`(x, y)`".into(),
        ("String", _) => "text".into(),
        ("bool", _) => "`true` or `false`".into(),
        ("f32" | "f64", _) => "number".into(),
        ("u8" | "u16" | "u32" | "u64" | "usize", _) => "whole number".into(),
        ("Seeds", _) => "whole number, or list of whole numbers".into(),
        ("Settings", _) => "`{\"path\": value, ...}`".into(),
        ("Option", Some(inner)) => written(inner),
        ("Ranged", Some(inner)) => format!("{}, or `(lowest, highest)`", written(inner)),
        ("Vec", Some(inner)) if ["Vec2", ""].contains(&name(inner).as_str()) => {
            format!("list of {}", written(inner))
        }
        ("Vec", Some(inner)) if name(inner) == "String" => "list of texts".into(),
        ("Vec", Some(inner)) => format!("list of {}s", written(inner)),
        (name, _) => link(&words(name).to_lowercase()),
    }
}

/// `Obstacle motion` for `ObstacleMotion`.
fn words(name: &str) -> String {
    let mut words = String::new();
    for (k, c) in name.chars().enumerate() {
        if k > 0 && c.is_uppercase() {
            words.push(' ');
        }
        if k > 0 { words.extend(c.to_lowercase()) } else { words.push(c) }
    }
    words
}

/// A link to the section `label`.
fn link(label: &str) -> String {
    format!("[{label}](#{})", label.to_lowercase().replace(' ', "-"))
}

/// Escapes `text` for a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

fn lower(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or(String::new(), |first| first.to_lowercase().chain(chars).collect())
}
