//! The width of text, and how it is shortened and wrapped to a width.
//!
//! Widths follow Arial's metrics, rounded up slightly, because a viewer may use another font of the stack.

/// The width of a line of text in drawn pixels. `size` is plotters' size, 1.24 times the font size (see `canvas.rs`).
pub(crate) fn text_width(text: &str, size: f64) -> i32 {
    let ems: f64 = text.chars().map(advance).sum();
    (ems * size / 1.24 * 1.02).ceil() as i32
}

/// The approximate advance of a character, in ems.
fn advance(c: char) -> f64 {
    match c {
        'i' | 'j' | 'l' | '\'' => 0.23,
        ' ' | '.' | ',' | ':' | ';' | '!' | '/' | '|' | '\\' | 't' | 'f' | 'I' | '·' | '[' | ']' => 0.28,
        '(' | ')' | 'r' | '-' | '°' | '"' | '‘' | '’' | '“' | '”' => 0.36,
        'c' | 'k' | 's' | 'v' | 'x' | 'y' | 'z' | 'J' => 0.5,
        'm' | 'M' | '@' | '%' => 0.89,
        'W' | '—' | '…' | '→' => 0.95,
        'A'..='Z' | 'w' => 0.72,
        _ => 0.58,
    }
}

/// The text, shortened with an ellipsis if it is wider than `width` drawn pixels.
pub(crate) fn ellipsized(text: &str, size: f64, width: i32) -> String {
    if text_width(text, size) <= width {
        return text.to_owned();
    }
    let mut cut = text.to_owned();
    while !cut.is_empty() && text_width(&cut, size) + text_width("…", size) > width {
        cut.pop();
    }
    cut.truncate(cut.trim_end().len());
    cut + "…"
}

/// The text wrapped into lines of similar length, each at most `width` drawn pixels wide; at least one line.
pub(crate) fn wrapped(text: &str, size: f64, width: i32) -> Vec<String> {
    let lines = filled(text, size, width);
    // The smallest width with the same number of lines, so that the last line is not left with a single word.
    let narrower = (width / 2..width).step_by(16).map(|narrow| filled(text, size, narrow));
    let mut balanced =
        narrower.filter(|other| other.len() == lines.len() && !other.iter().any(|l| l.ends_with('…')));
    balanced.next().unwrap_or(lines)
}

/// The text wrapped into lines that are filled one after another.
fn filled(text: &str, size: f64, width: i32) -> Vec<String> {
    let mut lines = vec![String::new()];
    for word in text.split_whitespace() {
        let last = lines.len() - 1;
        let longer = if lines[last].is_empty() { word.to_owned() } else { format!("{} {word}", lines[last]) };
        if lines[last].is_empty() || text_width(&longer, size) <= width {
            lines[last] = ellipsized(&longer, size, width);
        } else {
            lines.push(ellipsized(word, size, width));
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn text_is_shortened_and_wrapped_to_a_width() {
        let size = 26.0 * 1.24;
        assert_eq!(ellipsized("short", size, 200), "short");
        let cut = ellipsized("a name that is much too long to fit in here", size, 200);
        assert!(cut.ends_with('…') && text_width(&cut, size) <= 200, "{cut}");
        let lines = wrapped("several words that do not fit into a single line", size, 200);
        assert!(lines.len() > 2 && lines.iter().all(|l| text_width(l, size) <= 200), "{lines:?}");
        assert_eq!(wrapped("", size, 200), [""]);
    }
}
