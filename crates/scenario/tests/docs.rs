//! The page docs/scenario-format.md, generated from the comments and defaults of the scenario schema.
//!
//! The test fails if the page is out of date; `cargo xtask docs` renews it.

use std::fmt::Write;
use std::path::{Path, PathBuf};

use serde::Serialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use syn::{Attribute, Expr, Field, Fields, GenericArgument, Item, Lit, Meta, PathArguments, Type};
use wayfield_scenario::{
    BenchmarkRoute, Enclosure, Generator, Lidar, Motion, Obstacle, ObstacleMotion, PlacementRule,
    RandomShape, Region, Robot, Scenario, Shape, TaskRules, Wall, parse_ron,
};

const RENEW: &str = "cargo xtask docs";

const HEAD: &str = r#"# The scenario format

A scenario describes an arena, the robot and the task, as a text file in [RON](https://github.com/ron-rs/ron). The
shipped scenarios are in [`scenarios/`](../scenarios). This is a complete file:

```ron
(name: "Mine")
```

Every other field has a default, usually the paper's value: the file above is an empty arena of 4 m x 4 m. Write only the
fields that differ. This file adds two obstacles, one of which moves:

```ron
// Text after two slashes is a comment.
(
    name: "Two obstacles",
    obstacles: [
        (shape: Circle(radius_m: 0.15), position_m: (0.6, 0.6)),
        (
            shape: Rectangle(width_m: 0.4, height_m: 0.2),
            position_m: (-0.8, -1.0),
            motion: BackAndForth(waypoints_m: [(0.8, -1.0)], speed_m_s: 0.1),
        ),
    ],
)
```

**Units.** {units} Names end in the unit: a `radius_m` is in metres, a `speed_rad_s` in radians per second.

**How to read the tables.** A value with fields is written in parentheses, `(field: value, ...)`, in any order. If
there are several forms, such as for a shape, the value names one: `Circle(radius_m: 0.15)`. A list is written `[..., ...]`.
A field without a default is required. The whole file is a [scenario](#scenario).

**Check a file** with `wayfield --check mine.ron`, or all files in a folder with `wayfield --check scenarios/`. Each
problem is printed with line, column, field and fix:

```text
{mistake}
```

**Try it out:** `wayfield --scenario mine.ron` opens it in the app. Save the file in any text editor, and the app
adopts the changed scenario when the next episode ends. If the file is invalid, the app shows the message and continues with
the last valid scenario. The app also has a scenario editor, which saves the same format and keeps your comments.

## Contents

"#;

/// A field of a struct or of an enum's variant.
struct Entry<'a> {
    name: String,
    kind: &'a Type,
    about: String,
    /// Whether the field may be left out.
    optional: bool,
}

/// A struct, or an enum's variant.
struct Group<'a> {
    name: String,
    about: Vec<String>,
    entries: Vec<Entry<'a>>,
}

/// A type of the schema. A struct has a single group without a name.
struct Section<'a> {
    name: String,
    about: Vec<String>,
    /// The description of the type's default.
    default: Vec<String>,
    groups: Vec<Group<'a>>,
}

/// The paragraphs of a doc comment.
fn docs(attributes: &[Attribute]) -> Vec<String> {
    let mut paragraphs = vec![String::new()];
    for attribute in attributes {
        let Meta::NameValue(meta) = &attribute.meta else { continue };
        let Expr::Lit(value) = &meta.value else { continue };
        let Lit::Str(line) = &value.lit else { continue };
        match (meta.path.is_ident("doc"), line.value().trim()) {
            (true, "") => paragraphs.push(String::new()),
            (true, line) => {
                let last = paragraphs.last_mut().expect("one at least");
                *last += if last.is_empty() { "" } else { " " };
                *last += line;
            }
            (false, _) => {}
        }
    }
    paragraphs.retain(|paragraph| !paragraph.is_empty());
    paragraphs
}

/// Whether serde has a default for the field.
fn has_default(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| match &attribute.meta {
        Meta::List(list) => list.path.is_ident("serde") && list.tokens.to_string().contains("default"),
        _ => false,
    })
}

fn entries<'a>(fields: &'a Fields, all_optional: bool) -> Vec<Entry<'a>> {
    let entry = |field: &'a Field| Entry {
        name: field.ident.as_ref().expect("fields of a scenario have names").to_string(),
        kind: &field.ty,
        about: docs(&field.attrs).join(" "),
        optional: all_optional || has_default(&field.attrs),
    };
    fields.iter().map(entry).collect()
}

/// The schema's types, in the order of the schema.
fn sections(file: &syn::File) -> Vec<Section<'_>> {
    let mut sections: Vec<Section> = Vec::new();
    for item in &file.items {
        match item {
            Item::Struct(item) => sections.push(Section {
                name: item.ident.to_string(),
                about: docs(&item.attrs),
                default: Vec::new(),
                groups: vec![Group {
                    name: String::new(),
                    about: Vec::new(),
                    entries: entries(&item.fields, has_default(&item.attrs)),
                }],
            }),
            Item::Enum(item) => {
                let groups = item.variants.iter().map(|variant| Group {
                    name: variant.ident.to_string(),
                    about: docs(&variant.attrs),
                    entries: entries(&variant.fields, false),
                });
                sections.push(Section {
                    name: item.ident.to_string(),
                    about: docs(&item.attrs),
                    default: Vec::new(),
                    groups: groups.collect(),
                });
            }
            Item::Impl(item) => {
                let of_default = item.trait_.as_ref().is_some_and(|(_, path, _)| path.is_ident("Default"));
                let name = name(&item.self_ty);
                if let Some(section) = sections.iter_mut().find(|s| of_default && s.name == name) {
                    let functions = item.items.iter().filter_map(|item| match item {
                        syn::ImplItem::Fn(function) => Some(docs(&function.attrs)),
                        _ => None,
                    });
                    section.default = functions.flatten().collect();
                }
            }
            _ => {}
        }
    }
    sections
}

/// `Vec` for `Vec<f32>`.
fn name(kind: &Type) -> String {
    match kind {
        Type::Path(path) => path.path.segments.last().expect("a name").ident.to_string(),
        _ => String::new(),
    }
}

/// `f32` for `Vec<f32>` and `Option<f32>`.
fn inner(kind: &Type) -> Option<&Type> {
    let Type::Path(path) = kind else { return None };
    let PathArguments::AngleBracketed(arguments) = &path.path.segments.last()?.arguments else { return None };
    match arguments.args.first()? {
        GenericArgument::Type(inner) => Some(inner),
        _ => None,
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

fn link(name: &str) -> String {
    let label = words(name).to_lowercase();
    format!("[{label}](#{})", label.replace(' ', "-"))
}

/// The notation of a value of the type. Points are `Vec2`, ranges are pairs.
fn written(kind: &Type) -> String {
    match (name(kind).as_str(), inner(kind)) {
        ("", _) => "`(lowest, highest)`".into(),
        ("Vec2", _) => "`(x, y)`".into(),
        ("String", _) => "text".into(),
        ("f32", _) => "number".into(),
        ("u32" | "usize", _) => "whole number".into(),
        ("Option", Some(inner)) => written(inner),
        ("Vec", Some(inner)) if name(inner) == "Vec2" => format!("list of {}", written(inner)),
        ("Vec", Some(inner)) => format!("list of {}s", written(inner)),
        (name, _) => link(name),
    }
}

/// An example value of the type, as RON.
fn sample(kind: &Type, sections: &[Section<'_>]) -> String {
    match name(kind).as_str() {
        "" | "Vec2" => "(1.0, 1.0)".into(),
        "String" => "\"\"".into(),
        "f32" => "1.0".into(),
        "u32" | "usize" => "1".into(),
        "Vec" => "[]".into(),
        name => {
            let section = sections.iter().find(|section| section.name == name).expect(name);
            shortest(&section.groups[0], sections)
        }
    }
}

/// The shortest text for a struct or variant: only the fields without a default.
fn shortest(group: &Group<'_>, sections: &[Section<'_>]) -> String {
    let required = group.entries.iter().filter(|entry| !entry.optional);
    let fields: Vec<_> =
        required.map(|entry| format!("{}: {}", entry.name, sample(entry.kind, sections))).collect();
    format!("{}({})", group.name, fields.join(", "))
}

fn read<T: Serialize + DeserializeOwned>(text: &str) -> Value {
    let value: T = parse_ron(text, text).unwrap_or_else(|error| panic!("{error}"));
    // The detour through text gives an f32 its shortest decimal form.
    serde_json::from_str(&serde_json::to_string(&value).expect("JSON")).expect("JSON")
}

/// The fields of `text`, parsed as a `kind`, so that defaults come from the program.
fn filled_in(kind: &str, text: &str) -> Value {
    macro_rules! one_of {
        ($($kind:ident),*) => {
            match kind {
                $(stringify!($kind) => read::<$kind>(text),)*
                other => panic!("name `{other}` in tests/scenario_docs.rs"),
            }
        };
    }
    one_of!(
        BenchmarkRoute,
        Enclosure,
        Generator,
        Lidar,
        Motion,
        Obstacle,
        ObstacleMotion,
        PlacementRule,
        RandomShape,
        Region,
        Robot,
        Scenario,
        Shape,
        TaskRules,
        Wall
    )
}

/// `value` as RON, with the fields in the order of the schema.
fn ron(value: &Value, sections: &[Section<'_>]) -> String {
    let ron = |value: &Value| ron(value, sections);
    let entries = || sections.iter().flat_map(|section| &section.groups).flat_map(|group| &group.entries);
    let fields = |fields: &serde_json::Map<String, Value>| {
        let mut fields: Vec<_> = fields.iter().collect();
        fields.sort_by_key(|(name, _)| entries().position(|entry| entry.name == **name));
        let fields: Vec<_> = fields.iter().map(|(name, value)| format!("{name}: {}", ron(value))).collect();
        fields.join(", ")
    };
    match value {
        Value::Null => "none".into(),
        Value::String(text) => text.clone(),
        Value::Array(parts) => {
            let spelled = parts.iter().map(&ron).collect::<Vec<_>>().join(", ");
            let pair = parts.len() == 2 && parts[0].is_number();
            if pair { format!("({spelled})") } else { format!("[{spelled}]") }
        }
        Value::Object(object) => match object.iter().next() {
            Some((variant, Value::Object(inner))) => format!("{variant}({})", fields(inner)),
            _ => format!("({})", fields(object)),
        },
        number => number.to_string(),
    }
}

/// The text of the default column for `entry` with the default `value`; and the default itself, if it is too long for a table.
fn default(entry: &Entry<'_>, value: &Value, sections: &[Section<'_>]) -> (String, Option<String>) {
    let kind = name(entry.kind);
    let is_struct = sections.iter().any(|section| section.name == kind && section.groups[0].name.is_empty());
    match ron(value, sections) {
        _ if !entry.optional => ("must be given".into(), None),
        _ if is_struct => ("see there".into(), None),
        _ if value.is_null() => ("none".into(), None),
        text if kind == "String" => (format!("`\"{text}\"`"), None),
        text if text.len() > 40 => ("see below".into(), Some(text)),
        text => (format!("`{text}`"), None),
    }
}

fn table(page: &mut String, section: &Section<'_>, group: &Group<'_>, sections: &[Section<'_>]) {
    if group.entries.is_empty() {
        return;
    }
    let mut values = filled_in(&section.name, &shortest(group, sections));
    if !group.name.is_empty() {
        values = values[&group.name].take();
    }
    let with_defaults = group.entries.iter().any(|entry| entry.optional);
    page.push_str(match with_defaults {
        true => "| field | written | default | meaning |\n|---|---|---|---|\n",
        false => "| field | written | meaning |\n|---|---|---|\n",
    });
    let mut below = String::new();
    for entry in &group.entries {
        let (short, long) = default(entry, &values[&entry.name], sections);
        let written = written(entry.kind);
        let about = entry.about.replace('|', "\\|");
        let short = if with_defaults { format!("{short} | ") } else { String::new() };
        let _ = writeln!(page, "| `{}` | {written} | {short}{about} |", entry.name);
        if let Some(long) = long {
            let long = long.replace("), ", "),\n    ").replace("[", "[\n    ").replace(")]", "),\n]");
            let _ = write!(below, "The default of `{0}`:\n\n```ron\n{0}: {long}\n```\n\n", entry.name);
        }
    }
    page.push('\n');
    page.push_str(&below);
}

/// The whole page.
fn page(source: &str, example: &str) -> String {
    let file = syn::parse_file(source).expect("the schema is Rust");
    let (sections, about) = (sections(&file), docs(&file.attrs));
    let mistake =
        parse_ron::<Scenario>("(\n    name: \"Mine\",\n    robot: (radius_cm: 10.0),\n)", "mine.ron")
            .expect_err("there is no such field");
    let mut page = format!(
        "<!-- Written by tests/scenario_docs.rs from the comments in crates/scenario/src/schema.rs: change those, then\n     \
         {RENEW} -->\n\n{}",
        HEAD.replace("{units}", about.last().expect("the schema's comment"))
            .replace("{mistake}", &mistake.to_string())
    );
    for section in &sections {
        let about = section.about[0].split(['.', ':', ';']).next().unwrap_or_default();
        let label = words(&section.name);
        let _ = writeln!(page, "- [{label}](#{}): {}", label.to_lowercase().replace(' ', "-"), lower(about));
    }
    page.push_str("- [Everything in one file](#everything-in-one-file)\n");
    for section in &sections {
        let _ = write!(page, "\n## {}\n\n", words(&section.name));
        for paragraph in &section.about {
            let _ = write!(page, "{paragraph}\n\n");
        }
        if !section.default.is_empty() {
            let _ = write!(page, "*Default:* {}\n\n", section.default.join(" "));
        }
        for group in &section.groups {
            if !group.name.is_empty() {
                let _ = write!(page, "### `{}`\n\n{}\n\n", group.name, group.about.join("\n\n"));
            }
            table(&mut page, section, group, &sections);
        }
        page.truncate(page.trim_end().len());
        page.push('\n');
    }
    let _ = write!(
        page,
        "\n## Everything in one file\n\n[`scenarios/empty.ron`](../scenarios/empty.ron), which spells every field of the \
         whole with its default:\n\n```ron\n{example}```\n"
    );
    page
}

fn lower(text: &str) -> String {
    let mut chars = text.chars();
    chars.next().map_or(String::new(), |first| first.to_lowercase().chain(chars).collect())
}

fn at(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join(path)
}

fn text(path: &str) -> String {
    std::fs::read_to_string(at(path)).unwrap_or_else(|error| panic!("{path}: {error}"))
}

#[test]
fn the_page_matches_the_schema() {
    let page = page(&text("crates/scenario/src/schema.rs"), &text("scenarios/empty.ron"));
    if std::env::var_os("WAYFIELD_RENEW").is_some() {
        std::fs::write(at("docs/scenario-format.md"), &page).expect("the page can be written");
    }
    assert!(
        page == text("docs/scenario-format.md"),
        "docs/scenario-format.md is out of date. To renew it: {RENEW}"
    );
}

#[test]
fn a_small_schema_gives_the_page_written_by_hand() {
    let source = "//! What.\n//!\n//! Metres.\n/// A robot.\n/// Ours.\n#[serde(default)]\npub struct Robot {\n\
        /// Its radius | half\n/// across.\npub radius_m: f32,\n}\n\
        impl Default for Robot {\n/// By rule.\nfn default() -> Self { todo!() }\n}\n\
        /// A wall.\npub struct Wall {\n/// Along.\npub corners_m: Vec<Vec2>,\n\
        /// Across.\n#[serde(default = \"x\")]\npub thickness_m: f32,\n}\n\
        /// A motion.\npub enum ObstacleMotion {\n/// None.\nStatic,\n/// Some.\nRandomWalk {\n/// How far.\nradius_m: f32,\n\
        /// How fast.\nspeed_m_s: f32,\n/// Which.\n#[serde(default)]\nseed: u32,\n},\n}\n\
        /// A box.\npub struct Region {\n/// One.\npub min_m: Vec2,\n/// Other.\npub max_m: Vec2,\n}\n";
    let page = page(source, "()\n");
    let (_, tables) = page.split_once("## Contents\n\n").expect("contents");
    assert_eq!(
        tables,
        "- [Robot](#robot): a robot\n- [Wall](#wall): a wall\n- [Obstacle motion](#obstacle-motion): a motion\n- [Region](#region): a box\n\
         - [Everything in one file](#everything-in-one-file)\n\
         \n## Robot\n\nA robot. Ours.\n\n*Default:* By rule.\n\n\
         | field | written | default | meaning |\n|---|---|---|---|\n\
         | `radius_m` | number | `0.1` | Its radius \\| half across. |\n\
         \n## Wall\n\nA wall.\n\n\
         | field | written | default | meaning |\n|---|---|---|---|\n\
         | `corners_m` | list of `(x, y)` | must be given | Along. |\n\
         | `thickness_m` | number | `0.1` | Across. |\n\
         \n## Obstacle motion\n\nA motion.\n\n### `Static`\n\nNone.\n\n### `RandomWalk`\n\nSome.\n\n\
         | field | written | default | meaning |\n|---|---|---|---|\n\
         | `radius_m` | number | must be given | How far. |\n\
         | `speed_m_s` | number | must be given | How fast. |\n\
         | `seed` | whole number | `0` | Which. |\n\
         \n## Region\n\nA box.\n\n\
         | field | written | meaning |\n|---|---|---|\n\
         | `min_m` | `(x, y)` | One. |\n\
         | `max_m` | `(x, y)` | Other. |\n\
         \n## Everything in one file\n\n[`scenarios/empty.ron`](../scenarios/empty.ron), which spells every field of the \
         whole with its default:\n\n```ron\n()\n```\n"
    );
}

#[test]
fn empty_ron_contains_every_field_with_a_default() {
    let source = text("crates/scenario/src/schema.rs");
    let file = syn::parse_file(&source).expect("the schema is Rust");
    let example = text("scenarios/empty.ron");
    let mut named = 0;
    // Types whose fields all have defaults: the parts that every scenario has.
    for section in sections(&file).iter().filter(|section| section.groups[0].name.is_empty()) {
        let entries = &section.groups[0].entries;
        if section.name == "Scenario" || entries.iter().all(|entry| entry.optional) {
            for entry in entries {
                let spelled = format!("{}: ", entry.name);
                let line = |line: &str| line.split("//").next().is_some_and(|code| code.contains(&spelled));
                assert!(
                    example.lines().any(line),
                    "scenarios/empty.ron lacks `{}` of {}",
                    entry.name,
                    section.name
                );
                named += 1;
            }
        }
    }
    assert!(named >= 12 + 3 + 6 + 5 + 3, "only {named} fields were found");
}

#[test]
fn the_examples_on_the_page_are_valid_scenarios() {
    let page = text("docs/scenario-format.md");
    let blocks = page.split("```ron\n").skip(1).filter_map(|rest| Some(rest.split_once("```")?.0));
    let whole: Vec<_> = blocks.filter(|block| block.starts_with(['(', '/'])).collect();
    assert_eq!(whole.len(), 3, "two of the introduction, and everything in one file");
    for block in whole {
        Scenario::parse(block, "docs/scenario-format.md").unwrap_or_else(|error| panic!("{error}\n{block}"));
    }
}
