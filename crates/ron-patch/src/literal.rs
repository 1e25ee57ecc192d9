//! RON string literals: quoting, escapes, and wrapping of long texts.

/// A RON string literal with the content `text`, in one line.
pub(crate) fn quoted(text: &str) -> String {
    format!("\"{}\"", escaped(text))
}

/// A RON string literal with the content `text`, wrapped at spaces to lines of at most `width` columns; a longer word is not
/// broken. The literal starts in `column`. Every line but the last ends with a space and `\`: RON ignores the backslash, the
/// line break and the spaces after it.
pub(crate) fn wrapped(text: &str, column: usize, width: usize, newline: &str) -> String {
    let mut literal = String::new();
    let mut used = column + 1;
    let mut words = text.split_inclusive(' ').peekable();
    while let Some(word) = words.next() {
        let word = escaped(word);
        literal += &word;
        used += columns(&word);
        // The next word needs space for a closing quote and a comma, or for a backslash. There is no break before a word
        // that starts with a space, because RON would ignore that space.
        let next = words.peek().map_or(0, |next| columns(&escaped(next)) + 3);
        if next > 0
            && used + next > width
            && words.peek().is_some_and(|next| !next.starts_with(char::is_whitespace))
        {
            literal += &(String::from("\\") + newline);
            used = 0;
        }
    }
    format!("\"{literal}\"")
}

/// The width of `text`, a single line, in columns: the number of its characters.
pub(crate) fn columns(text: &str) -> usize {
    text.chars().count()
}

fn escaped(text: &str) -> String {
    let mut escaped = String::new();
    for c in text.chars() {
        match c {
            '"' => escaped += "\\\"",
            '\\' => escaped += "\\\\",
            '\n' => escaped += "\\n",
            '\r' => escaped += "\\r",
            '\t' => escaped += "\\t",
            c if c.is_control() => escaped += &format!("\\u{{{:x}}}", u32::from(c)),
            c => escaped.push(c),
        }
    }
    escaped
}
