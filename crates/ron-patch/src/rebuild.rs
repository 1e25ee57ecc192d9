//! The new text between a pair of brackets when children are kept, removed or inserted.
//!
//! In: a [`SyntaxNode`], and the operations on its children in their order ([`ChildrenRebuilder::keep`],
//! [`ChildrenRebuilder::remove`], [`ChildrenRebuilder::insert`]). Out: the new text of the node, with correct commas, line
//! breaks, blank lines and comments.

use std::collections::BTreeSet;

use crate::format::{Cursor, Formatter, INDENT};
use crate::literal::columns;
use crate::syntax::{BracketContents, SyntaxNode};
use crate::trivia::{
    has_comment, last_line, line_comment, line_start, own_comments_start, stacked, starts_with_blank_line,
    without_first_line,
};
use crate::value::Value;

/// The new text between two brackets, child by child.
pub(crate) struct ChildrenRebuilder<'a> {
    text: &'a str,
    formatter: &'a Formatter<'a>,
    node: &'a SyntaxNode,
    contents: BracketContents,
    /// The indentation of the line of the opening bracket.
    outer_indent: &'a str,
    /// The indentation of a child that starts a line.
    child_indent: String,
    /// Whether inserted children are separated by the style's blank lines: only at the top level, and only if the text has
    /// blank lines or fewer than three children.
    blank_lines: bool,
    /// The columns in which the line comments of two or more children start.
    comment_columns: BTreeSet<usize>,
    out: String,
    /// Comments above removed children, separated from them by a blank line: they stay.
    orphaned: String,
    /// The last child written so far.
    last: Option<LastChild<'a>>,
}

/// The last child written so far.
struct LastChild<'a> {
    /// Its key; empty for a list element.
    key: &'a str,
    /// Whether it has been inserted.
    is_new: bool,
    /// The offset at which a comma must be added if another child follows; `None` if it has a comma.
    missing_comma: Option<usize>,
    /// The offset of its comma, if the comma can be removed when no other child follows.
    optional_comma: Option<usize>,
}

impl<'a> ChildrenRebuilder<'a> {
    /// A rebuilder for the children of `node`, whose bracket opens at `open`. `top_level`: whether they are the top-level
    /// fields of the file.
    pub fn new(
        text: &'a str,
        formatter: &'a Formatter<'a>,
        node: &'a SyntaxNode,
        open: usize,
        top_level: bool,
    ) -> Self {
        let contents = BracketContents::new(text, node, open);
        let (outer_indent, _) = line_start(text, open);
        let mut starts = node.children.iter().map(SyntaxNode::start);
        let own_line = starts.find(|&at| text[..at].trim_end_matches([' ', '\t']).ends_with('\n'));
        let child_indent =
            own_line.map_or(format!("{outer_indent}{INDENT}"), |at| line_start(text, at).0.to_string());
        let mut heads = contents.segments.iter().skip(1).map(|segment| &text[segment.head.clone()]);
        let blank_lines = top_level && (contents.segments.len() < 3 || heads.any(starts_with_blank_line));
        Self {
            text,
            formatter,
            node,
            outer_indent,
            child_indent,
            blank_lines,
            comment_columns: shared_comment_columns(text, &contents),
            out: text[node.value.start..contents.front.end].into(),
            contents,
            orphaned: String::new(),
            last: None,
        }
    }

    /// Keeps child `k`, and replaces its value by the text `value`.
    pub fn keep(&mut self, k: usize, value: &str) {
        let child = &self.node.children[k];
        let key = child.key.clone().map_or("", |key| &self.text[key]);
        let head = self.kept_head(k);
        if self.last_is_new() && !starts_with_blank_line(&head) {
            self.push_blank_line_before(key);
        }
        self.add_missing_comma();
        self.out += &head;
        self.out += &self.text[child.start()..child.value.start];
        self.out += value;
        let ends_line = self.text[self.contents.segments[k].after.clone()].contains('\n');
        let end = self.out.len();
        self.last = Some(LastChild {
            key,
            is_new: false,
            missing_comma: child.comma.is_none().then_some(end),
            optional_comma: child.comma.filter(|_| !ends_line).map(|comma| end + comma - child.value.end),
        });
        self.push_after(k, value);
    }

    /// The trivia above the kept child `k`, adapted to the child that now precedes it.
    fn kept_head(&mut self, k: usize) -> String {
        let first_head = self.head(0);
        let mut head = stacked(std::mem::take(&mut self.orphaned), self.head(k));
        let is_first = self.last.is_none();
        while is_first && k > 0 && starts_with_blank_line(&head) {
            head = without_first_line(&head).into();
        }
        if self.out.ends_with('\n') {
            // The child now starts a line, even if it followed another child on the same line before.
            if head.trim().is_empty() && !head.contains('\n') {
                head.clone_from(&self.child_indent);
            }
        } else if is_first && k > 0 {
            let spaces = first_head.len() - first_head.trim_start().len();
            head = first_head[..spaces].to_string() + head.trim_start();
        } else if self.last_is_new() && head.is_empty() {
            head = " ".into();
        }
        head
    }

    /// Writes the text after child `k`, up to the end of its line. A comment after a changed value stays aligned with the
    /// comments of other children.
    fn push_after(&mut self, k: usize, value: &str) {
        let (child, after) = (&self.node.children[k], self.contents.segments[k].after.clone());
        let changed = value != &self.text[child.value.clone()];
        match line_comment(self.text, after.clone()) {
            Some((at, column)) if changed && self.comment_columns.contains(&column) => {
                self.out += self.text[child.value.end..at].trim_end();
                let spaces = column.saturating_sub(columns(last_line(&self.out))).max(1);
                self.out += &" ".repeat(spaces);
                self.out += &self.text[at..after.end];
            }
            _ => self.out += &self.text[after],
        }
    }

    /// Removes child `k`, with the comments directly above it and after it.
    pub fn remove(&mut self, k: usize) {
        let head = self.head(k);
        self.orphaned = stacked(std::mem::take(&mut self.orphaned), &head[..own_comments_start(head)]);
        if self.text[self.contents.segments[k].after.clone()].ends_with('\n') && !self.out.ends_with('\n') {
            self.out += self.formatter.newline;
        }
    }

    /// Inserts a child; `key` is empty for a list element. The child starts a new line if the previous one ended its line.
    pub fn insert(&mut self, key: &'a str, value: &Value) {
        let own_line = self.out.ends_with('\n');
        if own_line {
            self.push_blank_line_before(key);
        }
        self.add_missing_comma();
        let indent = if own_line { self.child_indent.as_str() } else { self.outer_indent };
        self.out += match (own_line, &self.last) {
            (true, _) => indent,
            (false, None) => "",
            (false, Some(_)) => " ",
        };
        if !key.is_empty() {
            self.out += &format!("{key}: ");
        }
        let column = columns(last_line(&self.out));
        self.out += &self.formatter.value(value, Cursor { indent, column });
        let missing_comma = (!own_line).then_some(self.out.len());
        if own_line {
            self.out += &format!(",{}", self.formatter.newline);
        }
        self.last = Some(LastChild { key, is_new: true, missing_comma, optional_comma: None });
    }

    /// The new text of the node.
    pub fn finish(mut self) -> String {
        let tail = &self.text[self.contents.tail.clone()];
        let bracket = self.contents.front.start + 1 - self.node.value.start;
        let is_empty = self.last.is_none() && self.out[bracket..].trim().is_empty();
        if is_empty && !has_comment(&self.orphaned) && tail.trim().len() == 1 {
            self.out.truncate(bracket);
            return self.out + tail.trim();
        }
        self.fix_last_comma();
        if has_comment(&self.orphaned) {
            self.out += &self.orphaned;
        }
        self.out + tail
    }

    /// Adds a comma after the last child if the last child of the old text had one; otherwise removes an optional one.
    fn fix_last_comma(&mut self) {
        let had_comma = self.node.children.last().is_none_or(|last| last.comma.is_some());
        let Some(last) = &self.last else { return };
        match (had_comma, last.missing_comma, last.optional_comma) {
            (true, Some(at), _) => self.out.insert(at, ','),
            (false, _, Some(at)) => drop(self.out.remove(at)),
            _ => {}
        }
    }

    /// Whether child `k` has no comments: neither inside nor directly around it.
    pub fn has_no_comments(&self, k: usize) -> bool {
        let (child, segment) = (&self.node.children[k], &self.contents.segments[k]);
        let own = segment.head.start + own_comments_start(self.head(k));
        !has_comment(&self.text[own..child.start()])
            && !has_comment(&self.text[child.start()..child.value.end])
            && !has_comment(&self.text[segment.after.clone()])
    }

    /// Adds a missing comma after the last child, before another child is written.
    fn add_missing_comma(&mut self) {
        if let Some(at) = self.last.as_mut().and_then(|last| last.missing_comma.take()) {
            self.out.insert(at, ',');
        }
    }

    /// Writes a blank line if the style has one between the last child and `key`.
    fn push_blank_line_before(&mut self, key: &str) {
        let style = self.formatter.style;
        if self.blank_lines && self.last.as_ref().is_some_and(|last| style.blank_line_between(last.key, key))
        {
            self.out += self.formatter.newline;
        }
    }

    fn last_is_new(&self) -> bool {
        self.last.as_ref().is_some_and(|last| last.is_new)
    }

    /// The trivia above child `k`; empty if there is no such child.
    fn head(&self, k: usize) -> &'a str {
        self.contents.segments.get(k).map_or("", |segment| &self.text[segment.head.clone()])
    }
}

/// The columns in which the line comments of two or more children start.
fn shared_comment_columns(text: &str, contents: &BracketContents) -> BTreeSet<usize> {
    let (mut seen, mut shared) = (BTreeSet::new(), BTreeSet::new());
    for segment in &contents.segments {
        if let Some((_, column)) = line_comment(text, segment.after.clone())
            && !seen.insert(column)
        {
            shared.insert(column);
        }
    }
    shared
}
