//! Trivia: the comments, spaces and line breaks between values.

use std::ops::Range;

use crate::literal::columns;
use crate::tokens::block_comment_length;

/// Whether `trivia` contains a comment.
pub(crate) fn has_comment(trivia: &str) -> bool {
    trivia.contains("//") || trivia.contains("/*")
}

/// Whether `trivia` starts with a blank line.
pub(crate) fn starts_with_blank_line(trivia: &str) -> bool {
    trivia.trim_start_matches([' ', '\t', '\r']).starts_with('\n')
}

pub(crate) fn without_first_line(trivia: &str) -> &str {
    trivia.split_once('\n').map_or("", |(_, rest)| rest)
}

/// The concatenation of `above`, which is empty or ends with a blank line, and `below`. Two blank lines in a row become
/// one.
pub(crate) fn stacked(above: String, below: &str) -> String {
    let doubled = !above.is_empty() && starts_with_blank_line(below);
    above + if doubled { without_first_line(below) } else { below }
}

/// The offset in `head`, the trivia above a value, at which the comments of that value start: after the last blank line.
pub(crate) fn own_comments_start(head: &str) -> usize {
    let (mut own, mut at, mut breaks) = (0, 0, 1);
    while let Some(first) = head[at..].chars().next() {
        let rest = &head[at..];
        if rest.starts_with("//") {
            (at, breaks) = (at + rest.find('\n').unwrap_or(rest.len()), 0);
        } else if rest.starts_with("/*") {
            (at, breaks) = (at + block_comment_length(rest), 0);
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

/// The offset after the line break that ends the line of `from`, if only spaces and whole comments are in between;
/// otherwise `from`. Only the text before `limit` is considered.
pub(crate) fn line_rest_end(text: &str, from: usize, limit: usize) -> usize {
    let mut at = from;
    while at < limit {
        let rest = &text[at..limit];
        at += if rest.starts_with('\n') {
            return at + 1;
        } else if rest.starts_with("//") {
            rest.find('\n').unwrap_or(rest.len())
        } else if rest.starts_with("/*") && !rest[..block_comment_length(rest)].contains('\n') {
            block_comment_length(rest)
        } else {
            match rest.chars().next().filter(|c| c.is_whitespace()) {
                Some(space) => space.len_utf8(),
                None => return from,
            }
        };
    }
    from
}

/// The offset and column of a `//` comment that follows a value on the same line, with only a comma and spaces in between.
/// `after` is the range of the text after the value.
pub(crate) fn line_comment(text: &str, after: Range<usize>) -> Option<(usize, usize)> {
    let at = after.start + text[after.clone()].find("//")?;
    let spaces = text[after.start..at].strip_prefix(',')?;
    (spaces.trim().is_empty() && !spaces.contains('\n')).then(|| (at, line_start(text, at).1))
}

/// The indentation of the line that contains the offset `at`, and the column of `at`.
pub(crate) fn line_start(text: &str, at: usize) -> (&str, usize) {
    let start = text[..at].rfind('\n').map_or(0, |end| end + 1);
    let line = &text[start..at];
    (&line[..line.len() - line.trim_start().len()], columns(line))
}

pub(crate) fn last_line(text: &str) -> &str {
    text.rsplit('\n').next().unwrap_or_default()
}
