//! What stands where in the text of a scenario that was read before: values, and the comments and spaces around them.
//!
//! In: text that ron accepts. Out: [`SyntaxNode`]s, and of those with brackets the [`BracketContents`], whose parts and values put
//! together are the text again, byte for byte.

use std::ops::Range;

use crate::source_map::{block_comment, token};

/// A value and, if it has one, its key.
pub(super) struct SyntaxNode {
    /// Its key.
    pub key: Option<Range<usize>>,
    /// The value, with its brackets and the name before them.
    pub value: Range<usize>,
    /// Where its opening bracket stands, if it has one.
    pub open: Option<usize>,
    /// What stands between its brackets.
    pub children: Vec<SyntaxNode>,
    /// Where the comma after it stands, if there is one.
    pub comma: Option<usize>,
}

impl SyntaxNode {
    /// The value of `text`, which must be whole: none if its brackets don't match.
    pub fn parse(text: &str) -> Option<Self> {
        Tokens { text, at: 0 }.piece()
    }

    /// Where it starts: its key or, without one, its value.
    pub fn start(&self) -> usize {
        self.key.as_ref().map_or(self.value.start, |key| key.start)
    }
}

/// The tokens of a text from an offset on.
struct Tokens<'a> {
    text: &'a str,
    at: usize,
}

impl Tokens<'_> {
    fn peek(&self) -> Option<u8> {
        token(self.text, self.at).map(|(start, _)| self.text.as_bytes()[start])
    }

    fn next(&mut self) -> Option<(usize, usize)> {
        let (start, end) = token(self.text, self.at)?;
        self.at = end;
        Some((start, end))
    }

    /// A key, if there is one, and a value. (Nested no deeper than ron allows, since ron has read it.)
    fn piece(&mut self) -> Option<SyntaxNode> {
        let (mut start, mut end) = self.next()?;
        let mut key = None;
        if self.peek() == Some(b':') {
            key = Some(start..end);
            self.next()?;
            (start, end) = self.next()?;
        }
        let bracket = |at: usize| matches!(self.text.as_bytes()[at], b'(' | b'[' | b'{');
        let mut open = bracket(start).then_some(start);
        if open.is_none() && self.peek() == Some(b'(') {
            open = self.next().map(|(at, _)| at);
        }
        let mut children: Vec<SyntaxNode> = Vec::new();
        while open.is_some() {
            match self.peek()? {
                b')' | b']' | b'}' => {
                    end = self.next()?.1;
                    break;
                }
                b',' => {
                    let (comma, _) = self.next()?;
                    children.last_mut()?.comma = Some(comma);
                }
                _ => children.push(self.piece()?),
            }
        }
        Some(SyntaxNode { key, value: start..end, open, children, comma: None })
    }
}

/// The stretch of a bracket's inside that belongs to one child.
pub(super) struct Segment {
    /// Spaces and comments before it: those on lines of their own above it.
    pub head: Range<usize>,
    /// From behind the value to the next segment: the comma, and what else stands in that line if no other child does.
    pub after: Range<usize>,
}

/// The inside of a bracket: what follows the bracket in its line, a segment for each child, and what stands before the
/// closing bracket.
pub(super) struct BracketContents {
    /// From the bracket, inclusive.
    pub front: Range<usize>,
    /// One for each child.
    pub segments: Vec<Segment>,
    /// Up to the closing bracket, inclusive.
    pub tail: Range<usize>,
}

impl BracketContents {
    /// The inside of `piece`, whose bracket opens at `open`.
    pub fn new(text: &str, piece: &SyntaxNode, open: usize) -> Self {
        let limit = |k: usize| piece.children.get(k).map_or(piece.value.end - 1, SyntaxNode::start);
        let mut at = line_rest(text, open + 1, limit(0));
        let front = open..at;
        let mut segments = Vec::new();
        for (k, child) in piece.children.iter().enumerate() {
            let behind = child.comma.map_or(child.value.end, |comma| comma + 1);
            let end = line_rest(text, behind, limit(k + 1));
            segments.push(Segment { head: at..child.start(), after: child.value.end..end });
            at = end;
        }
        Self { front, segments, tail: at..piece.value.end }
    }
}

/// The end of the line that `from` is in, if only spaces and whole comments stand between, else `from`. What follows
/// `limit` doesn't count as part of the line.
fn line_rest(text: &str, from: usize, limit: usize) -> usize {
    let mut at = from;
    while at < limit {
        let rest = &text[at..limit];
        at += if rest.starts_with('\n') {
            return at + 1;
        } else if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") && !rest[..block_comment(rest)].contains('\n') {
            block_comment(rest)
        } else {
            match rest.chars().next().filter(|c| c.is_whitespace()) {
                Some(space) => space.len_utf8(),
                None => return from,
            }
        };
    }
    from
}

/// Where in a segment's head the part starts that belongs to the child alone: behind the last empty line.
pub(super) fn attached_trivia_start(head: &str) -> usize {
    let (mut own, mut at, mut breaks) = (0, 0, 1);
    while let Some(first) = head[at..].chars().next() {
        let rest = &head[at..];
        if rest.starts_with("//") {
            (at, breaks) = (at + rest.find('\n').unwrap_or(rest.len()), 0);
        } else if rest.starts_with("/*") {
            (at, breaks) = (at + block_comment(rest), 0);
        } else {
            at += first.len_utf8();
            breaks += usize::from(first == '\n');
            if first == '\n' && breaks > 1 {
                own = at;
            }
        }
    }
    own
}

/// Whether `trivia` has a comment.
pub(super) fn has_comment(trivia: &str) -> bool {
    trivia.contains("//") || trivia.contains("/*")
}
