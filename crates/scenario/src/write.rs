//! A scenario as a file's text, for people: stable in order and form, so that a small change is a small diff.
//!
//! In: a [`Scenario`], and the text it was read from if there is one. Out: RON that reads back to the same scenario to
//! the bit. What has not changed keeps its very bytes, comments and all; what is new is spelled like the shipped files.

mod align;
mod format;
mod merge;
mod rebuild;
mod syntax;
mod tree;

use self::format::Formatter;
use self::merge::Merge;
use self::syntax::SyntaxNode;
use self::tree::Node;
use super::load::{parse_ron, to_ron};
use super::schema::Scenario;

/// `scenario` as the text of a RON file, which [`Scenario::load`] reads back to the same numbers, to the bit.
///
/// `like` is the text that it was read from, or any older one. What is the same in both keeps its very bytes (comments,
/// order, empty lines, defaults that are written out); a field that has changed is rewritten in its place, under the
/// comments above it; an element of a list goes with its comments, and a new one stands where it stands in the list.
/// Without `like`, or if that is no scenario, the text is canonical: the schema's order, four spaces a level, up to
/// 110 columns, and only what differs from the defaults.
#[must_use]
pub fn to_text(scenario: &Scenario, like: Option<&str>) -> String {
    let Ok(tree) = Node::from_value(scenario) else { return to_ron(scenario).unwrap_or_default() };
    let merged = like.and_then(|like| merged(&tree, like));
    merged.filter(|text| read(text).as_ref() == Some(&tree)).unwrap_or_else(|| canonical(&tree, "\n"))
}

fn canonical(tree: &Node, newline: &'static str) -> String {
    tree.record().map(|scenario| Formatter::new(newline).file(scenario)).unwrap_or_default()
}

/// `tree` in the words of `like`; none if that is no scenario.
fn merged(tree: &Node, like: &str) -> Option<String> {
    let old = read(like)?;
    let newline =
        if like.split_once('\n').is_some_and(|(line, _)| line.ends_with('\r')) { "\r\n" } else { "\n" };
    let speller = Formatter::new(newline);
    Some(Merge { text: like, speller: &speller }.file(
        &SyntaxNode::parse(like)?,
        old.record()?,
        tree.record()?,
    ))
}

/// The tree of the scenario that `text` is, whatever its checks say.
fn read(text: &str) -> Option<Node> {
    Node::from_value(&parse_ron::<Scenario>(text, "").ok()?).ok()
}
