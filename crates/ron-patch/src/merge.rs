//! The merge of a changed value into the text of the old value.
//!
//! In: the text, the old value, the new value. Out: a text in which all unchanged parts have the same bytes. A part in the
//! canonical form stays canonical. A part in another form, or with comments inside, is changed only where the values
//! differ: field by field, element by element.

use crate::align::align;
use crate::format::{Cursor, Formatter};
use crate::rebuild::ChildrenRebuilder;
use crate::syntax::SyntaxNode;
use crate::trivia::line_start;
use crate::value::{Record, Value};

/// A text and the formatter for the new values in it.
pub(crate) struct Merge<'a> {
    /// The old text.
    pub text: &'a str,
    /// The formatter of the parts that cannot be taken from the text.
    pub formatter: &'a Formatter<'a>,
}

impl Merge<'_> {
    /// The new text of the whole file.
    pub fn file(&self, root: &SyntaxNode, old: &Value, new: &Value) -> String {
        let root_text = match (root.open, old, new) {
            _ if self.text[root.value.clone()] == self.formatter.top_level(old) => {
                self.formatter.top_level(new)
            }
            (Some(open), Value::Record(old), Value::Record(new)) if old.is_same_type(new) => {
                self.record(root, open, true, old, new)
            }
            (_, _, Value::Record(_)) => self.formatter.top_level(new),
            _ => self.value(root, old, new),
        };
        format!("{}{root_text}{}", &self.text[..root.value.start], &self.text[root.value.end..])
    }

    /// The text of `new`, which replaces `old` at `node`.
    fn value(&self, node: &SyntaxNode, old: &Value, new: &Value) -> String {
        let text = &self.text[node.value.clone()];
        if old == new {
            return text.into();
        }
        let (indent, column) = line_start(self.text, node.value.start);
        let cursor = Cursor { indent, column };
        let canonical = || self.formatter.value(new, cursor);
        // With only defaults, the canonical form writes all fields. A change field by field then changes less of the text.
        let has_only_defaults =
            |value: &Value| value.record().is_some_and(|record| self.formatter.style.is_all_default(record));
        if !has_only_defaults(old) && !has_only_defaults(new) && text == self.formatter.value(old, cursor) {
            return canonical();
        }
        let Some(open) = node.open else { return canonical() };
        if self.text[node.value.start..open].trim() == "Some" && *new != Value::Null {
            return match &node.children[..] {
                [inner] => self.replace_values(node, &[self.value(inner, old, new)]),
                _ => canonical(),
            };
        }
        match (old, new) {
            (Value::Record(old), Value::Record(new)) if old.is_same_type(new) => {
                self.record(node, open, false, old, new)
            }
            (Value::List(old), Value::List(new)) if old.len() == node.children.len() => {
                self.list(node, open, old, new)
            }
            (Value::Tuple(old), Value::Tuple(new)) if old.len() == node.children.len() => {
                let parts = node.children.iter().zip(old.iter().zip(new));
                let parts: Vec<_> = parts.map(|(child, (old, new))| self.value(child, old, new)).collect();
                self.replace_values(node, &parts)
            }
            _ => canonical(),
        }
    }

    /// The text of `node` with new values for its children.
    fn replace_values(&self, node: &SyntaxNode, values: &[String]) -> String {
        let (mut out, mut at) = (String::new(), node.value.start);
        for (child, value) in node.children.iter().zip(values) {
            out += &self.text[at..child.value.start];
            out += value;
            at = child.value.end;
        }
        out + &self.text[at..node.value.end]
    }

    /// The text of the record `new`, field by field.
    fn record(&self, node: &SyntaxNode, open: usize, top_level: bool, old: &Record, new: &Record) -> String {
        let added = self.added_fields(node, old, new);
        let mut rebuilder = ChildrenRebuilder::new(self.text, self.formatter, node, open, top_level);
        for k in 0..=node.children.len() {
            for (_, key, value) in added.iter().filter(|(before, ..)| *before == k) {
                rebuilder.insert(key, value);
            }
            let Some(child) = node.children.get(k) else { break };
            let fields =
                self.rank(child, old).and_then(|rank| Some((old.fields.get(rank)?, new.fields.get(rank)?)));
            match fields {
                Some(((_, old), (field, value))) if old != value => {
                    // A field that is now empty is removed if that is its default.
                    if value.is_empty()
                        && self.formatter.style.is_default(new, field, value)
                        && rebuilder.has_no_comments(k)
                    {
                        rebuilder.remove(k);
                    } else {
                        rebuilder.keep(k, &self.value(child, old, value));
                    }
                }
                _ => rebuilder.keep(k, &self.text[child.value.clone()]),
            }
        }
        rebuilder.finish()
    }

    /// The changed fields that the text lacks, each with the index of the child before which it is inserted: directly after
    /// the last child that precedes it in the type's order.
    fn added_fields<'v>(
        &self,
        node: &SyntaxNode,
        old: &Record,
        new: &'v Record,
    ) -> Vec<(usize, &'static str, &'v Value)> {
        let mut added = Vec::new();
        for (k, ((field, old_value), (_, value))) in old.fields.iter().zip(&new.fields).enumerate() {
            let is_written = || node.children.iter().any(|child| self.key(child) == *field);
            if old_value != value && !is_written() {
                let precedes = |child: &SyntaxNode| self.rank(child, old).is_some_and(|rank| rank < k);
                let before = node.children.iter().rposition(precedes).map_or(0, |k| k + 1);
                added.push((before, *field, value));
            }
        }
        added
    }

    /// The key of `child`; empty if it has no key.
    fn key(&self, child: &SyntaxNode) -> &str {
        child.key.clone().map_or("", |key| &self.text[key])
    }

    /// The index of the field `child` in the type's order.
    fn rank(&self, child: &SyntaxNode, record: &Record) -> Option<usize> {
        record.fields.iter().position(|(field, _)| *field == self.key(child))
    }

    /// The text of the list `new`, element by element.
    fn list(&self, node: &SyntaxNode, open: usize, old: &[Value], new: &[Value]) -> String {
        let mut rebuilder = ChildrenRebuilder::new(self.text, self.formatter, node, open, false);
        let mut next = 0;
        for (value, old_index) in new.iter().zip(align(old, new)) {
            let Some(k) = old_index else {
                rebuilder.insert("", value);
                continue;
            };
            (next..k).for_each(|k| rebuilder.remove(k));
            rebuilder.keep(k, &self.value(&node.children[k], &old[k], value));
            next = k + 1;
        }
        (next..old.len()).for_each(|k| rebuilder.remove(k));
        rebuilder.finish()
    }
}
