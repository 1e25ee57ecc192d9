//! String literals: quotes, escapes, and line breaks in long ones.

/// `text` as a RON string literal.
pub(crate) fn quoted(text: &str) -> String {
    format!("\"{}\"", escaped(text))
}

/// `text` as a literal of several lines that starts in `column` and stays within `width` columns. Every line but the last
/// ends in a space and `\`; RON skips the backslash, the line break and the spaces after it.
pub(crate) fn wrapped(text: &str, column: usize, width: usize, newline: &str) -> String {
    let mut literal = String::new();
    let mut used = column + 1;
    let mut words = text.split_inclusive(' ').peekable();
    while let Some(word) = words.next() {
        let word = escaped(word);
        literal += &word;
        used += columns(&word);
        // The next word needs room for its closing quote and comma, or for its backslash. A break before a word that
        // starts with a space would lose that space.
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

/// The number of columns of `text`, which is a single line.
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
