//! The syntax tree of a RON text: the byte ranges of its values, and of the trivia around them.
//!
//! In: text that ron accepts. Out: a [`SyntaxNode`] for each value, and the [`BracketContents`] of each value with brackets.
//! Their ranges together cover every byte.

use std::ops::Range;

use crate::tokens::token;
use crate::trivia::line_rest_end;

/// A value, with its key if it has one.
pub(crate) struct SyntaxNode {
    pub key: Option<Range<usize>>,
    /// The value, including its brackets and the name before them.
    pub value: Range<usize>,
    /// The offset of its opening bracket, if it has one.
    pub open: Option<usize>,
    /// The values between its brackets.
    pub children: Vec<SyntaxNode>,
    /// The offset of the comma after it, if there is one.
    pub comma: Option<usize>,
}

impl SyntaxNode {
    /// Parses the top-level value of `text`; `None` if its brackets do not match.
    pub fn parse(text: &str) -> Option<Self> {
        Parser { text, at: 0 }.node()
    }

    /// The offset of its key or, without one, of its value.
    pub fn start(&self) -> usize {
        self.key.as_ref().map_or(self.value.start, |key| key.start)
    }
}

/// A parser: a text, and the offset after the last token read.
struct Parser<'a> {
    text: &'a str,
    at: usize,
}

impl Parser<'_> {
    fn peek(&self) -> Option<u8> {
        token(self.text, self.at).map(|(start, _)| self.text.as_bytes()[start])
    }

    fn next(&mut self) -> Option<(usize, usize)> {
        let (start, end) = token(self.text, self.at)?;
        self.at = end;
        Some((start, end))
    }

    /// Reads the next value with its key. The recursion cannot overflow the stack: ron, which limits the depth, has already read
    /// the text.
    fn node(&mut self) -> Option<SyntaxNode> {
        let (mut start, mut end) = self.next()?;
        let mut key = None;
        if self.peek() == Some(b':') {
            key = Some(start..end);
            self.next()?;
            (start, end) = self.next()?;
        }
        let is_bracket = |at: usize| matches!(self.text.as_bytes()[at], b'(' | b'[' | b'{');
        let mut open = is_bracket(start).then_some(start);
        if open.is_none() && self.peek() == Some(b'(') {
            open = self.next().map(|(at, _)| at);
        }
        let mut children = Vec::new();
        if open.is_some() {
            end = self.children(&mut children)?;
        }
        Some(SyntaxNode { key, value: start..end, open, children, comma: None })
    }

    /// Reads the values up to the closing bracket into `children`, and returns the offset after that bracket.
    fn children(&mut self, children: &mut Vec<SyntaxNode>) -> Option<usize> {
        loop {
            match self.peek()? {
                b')' | b']' | b'}' => return self.next().map(|(_, end)| end),
                b',' => {
                    let (comma, _) = self.next()?;
                    children.last_mut()?.comma = Some(comma);
                }
                _ => children.push(self.node()?),
            }
        }
    }
}

/// The byte ranges around one child of a bracket.
pub(crate) struct Segment {
    /// The trivia before the child: spaces, and the comments in the lines above it.
    pub head: Range<usize>,
    /// The bytes from the end of the value to the next segment: the comma and, if no other child follows on the line, the
    /// rest of the line.
    pub after: Range<usize>,
}

/// A pair of brackets: the line of the opening bracket, a segment for each child, and the trivia before the closing one.
pub(crate) struct BracketContents {
    /// The opening bracket and, if no child follows on its line, the rest of that line.
    pub front: Range<usize>,
    /// The segments, one for each child.
    pub segments: Vec<Segment>,
    /// The trivia after the last child, and the closing bracket.
    pub tail: Range<usize>,
}

impl BracketContents {
    /// The contents of `node`, whose bracket opens at `open`.
    pub fn new(text: &str, node: &SyntaxNode, open: usize) -> Self {
        let limit = |k: usize| node.children.get(k).map_or(node.value.end - 1, SyntaxNode::start);
        let mut at = line_rest_end(text, open + 1, limit(0));
        let front = open..at;
        let mut segments = Vec::new();
        for (k, child) in node.children.iter().enumerate() {
            let after_child = child.comma.map_or(child.value.end, |comma| comma + 1);
            let end = line_rest_end(text, after_child, limit(k + 1));
            segments.push(Segment { head: at..child.start(), after: child.value.end..end });
            at = end;
        }
        Self { front, segments, tail: at..node.value.end }
    }
}
