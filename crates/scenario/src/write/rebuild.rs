//! The inside of a pair of brackets put together anew: some children stay, some go, some are new.
//!
//! In: a [`SyntaxNode`] of the text, and in order what becomes of its children ([`ChildrenRebuilder::keep`], [`ChildrenRebuilder::remove`],
//! [`ChildrenRebuilder::insert`]). Out: the text of the piece, in which commas, line ends, empty lines and comments are right again.

use std::collections::BTreeSet;
use std::ops::Range;

use super::format::{Cursor, Formatter, INDENT, blank_line_between, columns};
use super::syntax::{BracketContents, SyntaxNode, attached_trivia_start, has_comment};
use super::tree::Node;

/// What is written between two brackets.
pub(super) struct ChildrenRebuilder<'a> {
    text: &'a str,
    speller: &'a Formatter,
    piece: &'a SyntaxNode,
    inside: BracketContents,
    /// What a line of the bracket's own starts with, and what one of a child's does.
    indents: (&'a str, String),
    /// Whether fields are kept apart by empty lines, as those of the whole are if they ever were.
    spaced: bool,
    out: String,
    /// The columns in which comments behind two or more children start.
    aligned: BTreeSet<usize>,
    /// Comments above what has gone, parted from it by an empty line: they stay.
    left: String,
    /// The key of the last child that was written; empty for an element.
    before: Option<&'a str>,
    /// Whether that was a new one.
    after_new: bool,
    /// Where the last child lacks a comma, if it does.
    lacking: Option<usize>,
    /// Where it has one that it could do without, if nothing follows.
    needless: Option<usize>,
}

impl<'a> ChildrenRebuilder<'a> {
    /// For the children of `piece`, whose bracket opens at `open`; `whole` if they are the fields of the whole file.
    pub fn new(
        text: &'a str,
        speller: &'a Formatter,
        piece: &'a SyntaxNode,
        open: usize,
        whole: bool,
    ) -> Self {
        let inside = BracketContents::new(text, piece, open);
        let (line, _) = line_start(text, open);
        let mut starts = piece.children.iter().map(SyntaxNode::start);
        let own_line = starts.find(|&at| text[..at].trim_end_matches([' ', '\t']).ends_with('\n'));
        let indent = own_line.map_or(format!("{line}{INDENT}"), |at| line_start(text, at).0.to_string());
        let (mut seen, mut aligned) = (BTreeSet::new(), BTreeSet::new());
        for segment in &inside.segments {
            if let Some((_, column)) = comment(text, segment.after.clone())
                && !seen.insert(column)
            {
                aligned.insert(column);
            }
        }
        let mut heads = inside.segments.iter().skip(1).map(|segment| &text[segment.head.clone()]);
        let spaced = whole && (inside.segments.len() < 3 || heads.any(starts_empty));
        Self {
            text,
            speller,
            piece,
            spaced,
            out: text[piece.value.start..inside.front.end].into(),
            inside,
            indents: (line, indent),
            aligned,
            left: String::new(),
            before: None,
            after_new: false,
            lacking: None,
            needless: None,
        }
    }

    /// Child `k` stays, with `value` for its value.
    pub fn keep(&mut self, k: usize, value: &str) {
        let (child, after) = (&self.piece.children[k], self.inside.segments[k].after.clone());
        let first_head = self.head(0);
        let mut head = stacked(std::mem::take(&mut self.left), self.head(k));
        let is_first = self.before.is_none();
        while is_first && k > 0 && starts_empty(&head) {
            head = without_first_line(&head).into();
        }
        if self.out.ends_with('\n') {
            // At the start of a line now, even if it stood behind another child.
            if head.trim().is_empty() && !head.contains('\n') {
                head.clone_from(&self.indents.1);
            }
        } else if is_first && k > 0 {
            head = first_head[..first_head.len() - first_head.trim_start().len()].to_string()
                + head.trim_start();
        } else if self.after_new && head.is_empty() {
            head = " ".into();
        }
        let key = child.key.clone().map_or("", |key| &self.text[key]);
        if self.after_new && !starts_empty(&head) {
            self.part_from(key);
        }
        self.next(key, false);
        self.out += &head;
        self.out += &self.text[child.start()..child.value.start];
        self.out += value;
        match child.comma {
            None => self.lacking = Some(self.out.len()),
            Some(comma) if !self.text[after.clone()].contains('\n') => {
                self.needless = Some(self.out.len() + comma - child.value.end);
            }
            Some(_) => {}
        }
        let changed = value != &self.text[child.value.clone()];
        match comment(self.text, after.clone()) {
            Some((at, column)) if changed && self.aligned.contains(&column) => {
                self.out += self.text[child.value.end..at].trim_end();
                let spaces = column.saturating_sub(columns(last_line(&self.out))).max(1);
                self.out += &" ".repeat(spaces);
                self.out += &self.text[at..after.end];
            }
            _ => self.out += &self.text[after],
        }
    }

    /// Child `k` goes, with the comments right above it and behind it.
    pub fn remove(&mut self, k: usize) {
        let head = self.head(k);
        self.left = stacked(std::mem::take(&mut self.left), &head[..attached_trivia_start(head)]);
        if self.text[self.inside.segments[k].after.clone()].ends_with('\n') && !self.out.ends_with('\n') {
            self.out += self.speller.newline;
        }
    }

    /// A new child comes here, in a line of its own if the last one ended its line. The key of an element is empty.
    pub fn insert(&mut self, key: &'a str, value: &Node) {
        let own_line = self.out.ends_with('\n');
        if own_line {
            self.part_from(key);
        }
        let is_first = self.before.is_none();
        self.next(key, true);
        let indent = if own_line { self.indents.1.as_str() } else { self.indents.0 };
        self.out += match (own_line, is_first) {
            (true, _) => indent,
            (false, true) => "",
            (false, false) => " ",
        };
        if !key.is_empty() {
            self.out += &format!("{key}: ");
        }
        let column = columns(last_line(&self.out));
        self.out += &self.speller.value(value, Cursor { indent, column });
        if own_line {
            self.out += &format!(",{}", self.speller.newline);
        } else {
            self.lacking = Some(self.out.len());
        }
    }

    /// The text of the piece.
    pub fn finish(mut self) -> String {
        let tail = &self.text[self.inside.tail.clone()];
        let bracket = self.inside.front.start + 1 - self.piece.value.start;
        let none = self.before.is_none() && self.out[bracket..].trim().is_empty();
        if none && !has_comment(&self.left) && tail.trim().len() == 1 {
            self.out.truncate(bracket);
            return self.out + tail.trim();
        }
        let trailing = self.piece.children.last().is_none_or(|last| last.comma.is_some());
        match (trailing, self.lacking, self.needless) {
            (true, Some(at), _) => self.out.insert(at, ','),
            (false, _, Some(at)) => drop(self.out.remove(at)),
            _ => {}
        }
        if has_comment(&self.left) {
            self.out += &self.left;
        }
        self.out + tail
    }

    /// Whether child `k` has no comments of its own, neither inside nor around it.
    pub fn is_plain(&self, k: usize) -> bool {
        let (child, segment) = (&self.piece.children[k], &self.inside.segments[k]);
        let own = segment.head.start + attached_trivia_start(self.head(k));
        !has_comment(&self.text[own..child.start()])
            && !has_comment(&self.text[child.start()..child.value.end])
            && !has_comment(&self.text[segment.after.clone()])
    }

    /// A child with this key is about to be written.
    fn next(&mut self, key: &'a str, new: bool) {
        if let Some(at) = self.lacking.take() {
            self.out.insert(at, ',');
        }
        (self.before, self.after_new, self.needless) = (Some(key), new, None);
    }

    /// An empty line, if there is to be one between the last child and `key`.
    fn part_from(&mut self, key: &str) {
        if self.spaced && self.before.is_some_and(|before| blank_line_between(before, key)) {
            self.out += self.speller.newline;
        }
    }

    fn head(&self, k: usize) -> &'a str {
        self.inside.segments.get(k).map_or("", |segment| &self.text[segment.head.clone()])
    }
}

/// Where the comment starts that ends a line, and in which column, if only a comma and spaces stand between the child
/// and it; `after` is what follows the child.
fn comment(text: &str, after: Range<usize>) -> Option<(usize, usize)> {
    let at = after.start + text[after.clone()].find("//")?;
    let spaces = text[after.start..at].strip_prefix(',')?;
    (spaces.trim().is_empty() && !spaces.contains('\n')).then(|| (at, line_start(text, at).1))
}

/// What the line of `at` starts with, and the column of `at`.
pub(super) fn line_start(text: &str, at: usize) -> (&str, usize) {
    let start = text[..at].rfind('\n').map_or(0, |end| end + 1);
    let line = &text[start..at];
    (&line[..line.len() - line.trim_start().len()], columns(line))
}

fn last_line(text: &str) -> &str {
    text.rsplit('\n').next().unwrap_or_default()
}

/// `head` below what was left `above`, which is nothing or ends with an empty line; not two of those in a row.
fn stacked(above: String, head: &str) -> String {
    let doubled = !above.is_empty() && starts_empty(head);
    above + if doubled { without_first_line(head) } else { head }
}

/// Whether `head` starts with an empty line.
fn starts_empty(head: &str) -> bool {
    head.trim_start_matches([' ', '\t', '\r']).starts_with('\n')
}

fn without_first_line(head: &str) -> &str {
    head.split_once('\n').map_or("", |(_, rest)| rest)
}
