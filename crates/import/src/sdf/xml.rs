//! XML files: their elements, and errors with line and column.

use std::path::Path;

use roxmltree::{Document, Error, Node, ParsingOptions};
use wayfield_scenario::FileError;

use crate::findings::shown;
use crate::limits::MAX_XML_NODES;

/// An XML file, for messages.
pub struct XmlFile<'a> {
    /// Its path.
    pub path: &'a Path,
    /// Its text.
    pub text: &'a str,
}

impl XmlFile<'_> {
    /// The error at an element.
    pub fn error(&self, node: Node<'_, '_>, message: impl Into<String>) -> FileError {
        FileError::at_offset(self.path, self.text, node.range().start, message)
    }
}

/// The elements of `text`. A DTD is refused, because the entities that it defines could make a small file large.
///
/// # Errors
/// It is not XML, has a DTD, or has too many nodes.
pub fn parse<'a>(text: &'a str, path: &Path) -> Result<Document<'a>, FileError> {
    let options =
        ParsingOptions { allow_dtd: false, nodes_limit: MAX_XML_NODES, ..ParsingOptions::default() };
    Document::parse_with_options(text, options).map_err(|error| {
        let place = error.pos();
        let start: usize = text.split_inclusive('\n').take(place.row.max(1) as usize - 1).map(str::len).sum();
        let line = text.get(start..).unwrap_or_default();
        let inside: usize = line.chars().take(place.col.max(1) as usize - 1).map(char::len_utf8).sum();
        let help = match error {
            Error::DtdDetected => "remove the DTD".to_owned(),
            Error::NodesLimitReached => {
                format!("give a file with at most {MAX_XML_NODES} elements, texts and comments")
            }
            _ => "give a Gazebo world or model".to_owned(),
        };
        let message = format!("not readable XML: {error}; help: {help}");
        FileError::at_offset(path, text, start + inside, message)
    })
}

/// The elements in `parent` with this name.
pub fn children<'a, 'input>(
    parent: Node<'a, 'input>,
    tag: &'a str,
) -> impl Iterator<Item = Node<'a, 'input>> {
    parent.children().filter(move |child| child.is_element() && child.tag_name().name() == tag)
}

/// The attribute `name` of an element; `unnamed` if it has none.
pub fn name<'a>(node: Node<'a, '_>) -> &'a str {
    node.attribute("name").unwrap_or("unnamed")
}

/// The first text in an element, without spaces around it. Comments are skipped.
pub fn text<'a>(node: Node<'a, '_>) -> &'a str {
    let texts = node.children().filter(Node::is_text).filter_map(|child| child.text());
    texts.map(str::trim).find(|text| !text.is_empty()).unwrap_or("")
}

/// Whether a boolean is true: `1`, or `true` in any case, as in sdformat.
pub fn is_true(text: &str) -> bool {
    text == "1" || text.eq_ignore_ascii_case("true")
}

/// The numbers in an element. All are in the range of coordinates, and so finite.
///
/// # Errors
/// It does not hold exactly `N` such numbers.
pub fn numbers<const N: usize>(file: &XmlFile<'_>, node: Node<'_, '_>) -> Result<[f64; N], FileError> {
    let inside = |value: &f64| crate::limits::COORDINATE_M.contains(value);
    let values: Option<Vec<f64>> =
        text(node).split_whitespace().map(|word| word.parse().ok().filter(inside)).collect();
    values.and_then(|values| values.try_into().ok()).ok_or_else(|| {
        let tag = node.tag_name().name();
        file.error(
            node,
            format!(
                "<{tag}> is `{}`; help: write {N} finite numbers of at most a million",
                shown(text(node))
            ),
        )
    })
}
