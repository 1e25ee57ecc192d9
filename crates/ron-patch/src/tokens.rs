//! The RON tokenizer. It also accepts text that ron rejects.

use std::ops::Range;

/// The byte ranges of the tokens of a RON text, which may be invalid: words (names and numbers), string and character
/// literals, and single punctuation characters. Whitespace and comments are skipped.
pub fn tokens(text: &str) -> impl Iterator<Item = Range<usize>> {
    let mut at = 0;
    std::iter::from_fn(move || {
        let (start, end) = token(text, at)?;
        at = end;
        Some(start..end)
    })
}

/// The start and end of the next token at or after `at`. Whitespace, comments and `#![...]` are skipped.
pub(crate) fn token(text: &str, mut at: usize) -> Option<(usize, usize)> {
    loop {
        let rest = &text[at..];
        let first = rest.chars().next()?;
        if first.is_whitespace() {
            at += first.len_utf8();
        } else if rest.starts_with("//") {
            at += rest.find('\n').unwrap_or(rest.len());
        } else if rest.starts_with("/*") {
            at += block_comment_length(rest);
        } else if rest.starts_with("#!") {
            at += rest.find(']').map_or(rest.len(), |end| end + 1);
        } else {
            return Some((at, at + token_length(rest, first)));
        }
    }
}

/// The length of the token at the start of `rest`, whose first character is `first`.
fn token_length(rest: &str, first: char) -> usize {
    match first {
        '"' => string_length(rest),
        '\'' => char_length(rest),
        // A number may start with a dot: `.5`.
        c if c.is_alphanumeric() || matches!(c, '_' | '.' | '+' | '-') => {
            let word = word_length(rest, first);
            raw_string_length(rest, word).unwrap_or(word)
        }
        c => c.len_utf8(),
    }
}

/// The length of a name or number.
fn word_length(rest: &str, first: char) -> usize {
    rest[first.len_utf8()..]
        .find(|c: char| !(c.is_alphanumeric() || matches!(c, '_' | '.' | '+' | '-')))
        .map_or(rest.len(), |end| end + first.len_utf8())
}

/// The length of a raw string `r#"..."#`, whose prefix (`r` or `br`) has the length `word`; `None` if `rest` does not start
/// with a raw string.
fn raw_string_length(rest: &str, word: usize) -> Option<usize> {
    let hashes = rest[word..].bytes().take_while(|&b| b == b'#').count();
    if !matches!(&rest[..word], "r" | "br") || !rest[word + hashes..].starts_with('"') {
        return None;
    }
    let body = word + hashes + 1;
    let closing = format!("\"{}", "#".repeat(hashes));
    Some(rest[body..].find(&closing).map_or(rest.len(), |end| body + end + closing.len()))
}

/// The length of a character literal; 1 if the quote does not start a character literal.
fn char_length(rest: &str) -> usize {
    match rest.strip_prefix("'\\") {
        Some(escaped) => {
            let closing = escaped.char_indices().skip(1).find(|&(_, c)| c == '\'');
            closing.map_or(rest.len(), |(end, _)| end + 3)
        }
        None => rest.char_indices().nth(2).filter(|&(_, c)| c == '\'').map_or(1, |(end, _)| end + 1),
    }
}

/// The length of a string literal with escapes. Without a closing quote, it extends to the end of the text.
fn string_length(rest: &str) -> usize {
    let mut escaped = false;
    for (at, byte) in rest.bytes().enumerate().skip(1) {
        match byte {
            _ if escaped => escaped = false,
            b'\\' => escaped = true,
            b'"' => return at + 1,
            _ => {}
        }
    }
    rest.len()
}

/// The length of a block comment, which may contain nested ones. Without an end, it extends to the end of the text.
pub(crate) fn block_comment_length(rest: &str) -> usize {
    let bytes = rest.as_bytes();
    let (mut depth, mut at) = (0_usize, 0);
    while at + 1 < bytes.len() {
        match &bytes[at..at + 2] {
            b"/*" => (depth, at) = (depth + 1, at + 2),
            b"*/" if depth == 1 => return at + 2,
            b"*/" => (depth, at) = (depth - 1, at + 2),
            _ => at += 1,
        }
    }
    rest.len()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_and_numbers_are_whole_tokens() {
        let text = "(a_b: -1.5e-3, c: .5, d: +.5)";
        let found: Vec<_> = tokens(text).map(|token| &text[token]).collect();
        assert_eq!(found, ["(", "a_b", ":", "-1.5e-3", ",", "c", ":", ".5", ",", "d", ":", "+.5", ")"]);
    }
}
