//! A changed scenario in the words of the text it was read from.
//!
//! In: that text, the tree that it was read as, the tree to write. Out: a text in which all that is the same has its
//! very bytes. A value that was written canonically stays canonical; one written otherwise, or with comments inside, is
//! changed where it differs: field by field, element by element.

use super::align::align;
use super::format::{Cursor, Formatter};
use super::rebuild::{ChildrenRebuilder, line_start};
use super::syntax::SyntaxNode;
use super::tree::{Node, Record};

/// Writes in the words of `text`.
pub(super) struct Merge<'a> {
    /// What was read.
    pub text: &'a str,
    /// For what must be spelled anew.
    pub speller: &'a Formatter,
}

impl Merge<'_> {
    /// The whole file.
    pub fn file(&self, root: &SyntaxNode, old: &Record, new: &Record) -> String {
        let inside = match root.open {
            Some(open) if self.text[root.value.clone()] != self.speller.root(old) => {
                self.record(root, open, old, new)
            }
            _ => self.speller.root(new),
        };
        format!("{}{inside}{}", &self.text[..root.value.start], &self.text[root.value.end..])
    }

    /// The value that stands at `piece` and was `old`, as `new`.
    fn value(&self, piece: &SyntaxNode, old: &Node, new: &Node) -> String {
        let text = &self.text[piece.value.clone()];
        if old == new {
            return text.into();
        }
        let (indent, column) = line_start(self.text, piece.value.start);
        let place = Cursor { indent, column };
        let anew = || self.speller.value(new, place);
        let spelled_out =
            |node: &Node| node.record().is_some_and(|record| self.speller.is_all_default(record));
        if !spelled_out(old) && !spelled_out(new) && text == self.speller.value(old, place) {
            return anew();
        }
        let Some(open) = piece.open else { return anew() };
        if self.text[piece.value.start..open].trim() == "Some" && *new != Node::Null {
            return match &piece.children[..] {
                [inner] => self.around(piece, &[inner], &[self.value(inner, old, new)]),
                _ => anew(),
            };
        }
        match (old, new) {
            (Node::Record(old), Node::Record(new)) if old.kind == new.kind && old.variant == new.variant => {
                self.record(piece, open, old, new)
            }
            (Node::List(old), Node::List(new)) if old.len() == piece.children.len() => {
                self.list(piece, open, old, new)
            }
            (Node::Tuple(old), Node::Tuple(new)) if old.len() == piece.children.len() => {
                let values = piece.children.iter().zip(old.iter().zip(new));
                let values: Vec<_> = values.map(|(piece, (old, new))| self.value(piece, old, new)).collect();
                self.around(piece, &piece.children.iter().collect::<Vec<_>>(), &values)
            }
            _ => anew(),
        }
    }

    /// The text of `piece` with other values in place of those of `children`.
    fn around(&self, piece: &SyntaxNode, children: &[&SyntaxNode], values: &[String]) -> String {
        let (mut out, mut at) = (String::new(), piece.value.start);
        for (child, value) in children.iter().zip(values) {
            out += &self.text[at..child.value.start];
            out += value;
            at = child.value.end;
        }
        out + &self.text[at..piece.value.end]
    }

    /// Field by field.
    fn record(&self, piece: &SyntaxNode, open: usize, old: &Record, new: &Record) -> String {
        let name = |child: &SyntaxNode| child.key.clone().map_or("", |key| &self.text[key]);
        let rank = |child: &SyntaxNode| old.fields.iter().position(|(field, _)| *field == name(child));
        // Fields that the text lacks and now needs, with the child before which each goes: behind the last of those
        // that precede it in the schema.
        let mut missing = Vec::new();
        for (k, ((field, old), (_, new))) in old.fields.iter().zip(&new.fields).enumerate() {
            if old != new && !piece.children.iter().any(|child| name(child) == *field) {
                let precedes = |child: &SyntaxNode| rank(child).is_some_and(|rank| rank < k);
                missing.push((piece.children.iter().rposition(precedes).map_or(0, |k| k + 1), *field, new));
            }
        }
        let mut join = ChildrenRebuilder::new(self.text, self.speller, piece, open, old.kind == "Scenario");
        for k in 0..=piece.children.len() {
            for (_, key, value) in missing.iter().filter(|(before, ..)| *before == k) {
                join.insert(key, value);
            }
            let Some(child) = piece.children.get(k) else { break };
            let fields = rank(child).and_then(|rank| Some((old.fields.get(rank)?, new.fields.get(rank)?)));
            match fields {
                Some(((_, old), (_, value))) if old == value => join.keep(k, &self.text[child.value.clone()]),
                Some((_, (field, value)))
                    if is_none(value) && self.speller.is_default(new, field, value) && join.is_plain(k) =>
                {
                    join.remove(k);
                }
                Some(((_, old), (_, value))) => join.keep(k, &self.value(child, old, value)),
                None => join.keep(k, &self.text[child.value.clone()]),
            }
        }
        join.finish()
    }

    /// Element by element.
    fn list(&self, piece: &SyntaxNode, open: usize, old: &[Node], new: &[Node]) -> String {
        let mut join = ChildrenRebuilder::new(self.text, self.speller, piece, open, false);
        let mut next = 0;
        for (value, was) in new.iter().zip(align(old, new)) {
            let Some(was) = was else {
                join.insert("", value);
                continue;
            };
            (next..was).for_each(|k| join.remove(k));
            join.keep(was, &self.value(&piece.children[was], &old[was], value));
            next = was + 1;
        }
        (next..old.len()).for_each(|k| join.remove(k));
        join.finish()
    }
}

/// Whether a value says that there is nothing, as an empty list or `Static` do.
fn is_none(value: &Node) -> bool {
    match value {
        Node::Null => true,
        Node::Text(text) => text.is_empty(),
        Node::List(parts) => parts.is_empty(),
        Node::Record(record) => record.fields.is_empty(),
        Node::Scalar(_) | Node::Tuple(_) => false,
    }
}
