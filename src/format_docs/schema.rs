//! The types of a file format, parsed from Rust: their names, fields, doc comments, and which fields may be left out.

use syn::{Attribute, Expr, Field, Fields, GenericArgument, Item, Lit, Meta, PathArguments, Type};

/// A field of a struct or of an enum's variant. The fields of a tuple variant have no names.
pub struct Entry {
    pub name: String,
    pub kind: Type,
    pub about: String,
    /// Whether the field may be left out.
    pub optional: bool,
}

/// A struct, or an enum's variant.
pub struct Group {
    pub name: String,
    pub about: Vec<String>,
    pub entries: Vec<Entry>,
}

/// A type of the format. A struct has a single group without a name.
pub struct Section {
    pub name: String,
    pub about: Vec<String>,
    /// The description of the type's default.
    pub default: Vec<String>,
    pub groups: Vec<Group>,
}

impl Section {
    pub fn is_struct(&self) -> bool {
        self.groups[0].name.is_empty()
    }
}

impl Group {
    pub fn is_tuple(&self) -> bool {
        self.entries.first().is_some_and(|entry| entry.name.is_empty())
    }
}

/// The types in Rust `sources`, in their order.
pub fn sections(sources: &[String]) -> Vec<Section> {
    let mut sections = Vec::new();
    for source in sources {
        for item in syn::parse_file(source).expect("the source is Rust").items {
            add(&mut sections, item);
        }
    }
    sections
}

fn add(sections: &mut Vec<Section>, item: Item) {
    match item {
        Item::Struct(item) => {
            let all_optional = has_word(&item.attrs, "default");
            let entries = entries(item.fields, all_optional);
            let groups = vec![Group { name: String::new(), about: Vec::new(), entries }];
            sections.push(section(&item.ident, &item.attrs, groups));
        }
        Item::Enum(item) => {
            let groups = item.variants.into_iter().map(|variant| Group {
                name: variant.ident.to_string(),
                about: docs(&variant.attrs),
                entries: entries(variant.fields, false),
            });
            let groups = groups.collect();
            sections.push(section(&item.ident, &item.attrs, groups));
        }
        Item::Impl(item) => {
            let is_default = item.trait_.as_ref().is_some_and(|(_, path, _)| path.is_ident("Default"));
            let name = name(&item.self_ty);
            if let Some(section) = sections.iter_mut().find(|section| is_default && section.name == name) {
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

fn section(name: &syn::Ident, attributes: &[Attribute], groups: Vec<Group>) -> Section {
    Section { name: name.to_string(), about: docs(attributes), default: Vec::new(), groups }
}

fn entries(fields: Fields, all_optional: bool) -> Vec<Entry> {
    let entry = |field: Field| Entry {
        name: field.ident.as_ref().map_or(String::new(), ToString::to_string),
        about: docs(&field.attrs).join(" "),
        optional: all_optional || has_word(&field.attrs, "default") || name(&field.ty) == "Option",
        kind: field.ty,
    };
    fields.into_iter().filter(|field| !has_word(&field.attrs, "skip")).map(entry).collect()
}

/// Whether a serde attribute contains the word `word`.
fn has_word(attributes: &[Attribute], word: &str) -> bool {
    attributes.iter().any(|attribute| match &attribute.meta {
        Meta::List(list) if list.path.is_ident("serde") => {
            let tokens = list.tokens.to_string();
            tokens.split(|c: char| !(c.is_alphanumeric() || c == '_')).any(|token| token == word)
        }
        _ => false,
    })
}

/// The paragraphs of a doc comment, without links to Rust items.
fn docs(attributes: &[Attribute]) -> Vec<String> {
    let mut paragraphs = vec![String::new()];
    for attribute in attributes {
        let Meta::NameValue(meta) = &attribute.meta else { continue };
        let Expr::Lit(value) = &meta.value else { continue };
        let Lit::Str(line) = &value.lit else { continue };
        match (meta.path.is_ident("doc"), line.value().trim()) {
            (true, "") => paragraphs.push(String::new()),
            (true, line) => {
                let last = paragraphs.last_mut().expect("at least one");
                *last += if last.is_empty() { "" } else { " " };
                *last += line;
            }
            (false, _) => {}
        }
    }
    paragraphs.retain(|paragraph| !paragraph.is_empty());
    paragraphs.iter().map(|paragraph| without_links(paragraph)).collect()
}

/// `text` with `` `Name` `` for the links `` [`Name`] `` and `` [`Name`](path) ``.
fn without_links(text: &str) -> String {
    let mut plain = String::new();
    let mut rest = text;
    while let Some((before, link)) = rest.split_once("[`") {
        let Some((name, after)) = link.split_once("`]") else { break };
        plain += &format!("{before}`{name}`");
        let target = after.strip_prefix('(').and_then(|target| target.split_once(')'));
        rest = target.map_or(after, |(_, after)| after);
    }
    plain + rest
}

/// The name of a type without its arguments: `Vec` for `Vec<f32>`. Empty for a tuple.
pub fn name(kind: &Type) -> String {
    match kind {
        Type::Path(path) => path.path.segments.last().expect("a name").ident.to_string(),
        _ => String::new(),
    }
}

/// The first type argument: `f32` for `Vec<f32>` and `Option<f32>`.
pub fn inner(kind: &Type) -> Option<&Type> {
    let Type::Path(path) = kind else { return None };
    let PathArguments::AngleBracketed(arguments) = &path.path.segments.last()?.arguments else { return None };
    match arguments.args.first()? {
        GenericArgument::Type(inner) => Some(inner),
        _ => None,
    }
}

/// The type named `root` and the types in it, each followed by those of its fields.
pub fn reachable(root: &str, mut all: Vec<Section>) -> Vec<Section> {
    let mut names = Vec::new();
    visit(root, &all, &mut names);
    let position = |section: &Section| names.iter().position(|name| *name == section.name);
    all.retain(|section| position(section).is_some());
    all.sort_by_key(position);
    all
}

fn visit(name: &str, all: &[Section], names: &mut Vec<String>) {
    let section = all.iter().find(|section| section.name == name);
    let Some(section) = section.filter(|_| !names.iter().any(|seen| seen == name)) else { return };
    names.push(name.to_owned());
    for entry in section.groups.iter().flat_map(|group| &group.entries) {
        for part in parts(&entry.kind) {
            visit(&part, all, names);
        }
    }
}

/// The names in a type: `Vec` and `Wall` for `Vec<Wall>`.
fn parts(kind: &Type) -> Vec<String> {
    let below = match kind {
        Type::Tuple(tuple) => tuple.elems.iter().flat_map(parts).collect(),
        _ => inner(kind).map(parts).unwrap_or_default(),
    };
    [vec![name(kind)], below].concat()
}
