//! Characters that look like those of RON but are different ones: the quotes, spaces and symbols of word processors, phones and
//! web pages.

use crate::text::{code_point, is_unprintable};

/// The character at `offset` of `text`, its problem with the fix, and the text that replaces it while the rest of the file is
/// checked. `None` if it is neither invisible nor similar to a character of RON.
pub(super) fn lookalike(text: &str, offset: usize) -> Option<(char, String, &'static str)> {
    let c = text[offset..].chars().next()?;
    let code = code_point(c);
    let (name, instead) = match c {
        '“' | '”' | '„' | '‟' | '«' | '»' | '‹' | '›' | '‘' | '’' | '‚' | '`' | '＂' => {
            return Some((c, quote_problem(c), "\""));
        }
        '\u{a0}' | '\u{2007}' | '\u{202f}' => ("a no-break space", " "),
        '−' | '–' | '—' | '‐' | '‑' => ("a dash or minus sign", "-"),
        '×' | '·' | '•' => ("a symbol", "*"),
        '\u{ff01}'..='\u{ff5e}' => ("a full-width character", ascii_of_full_width(c)),
        _ if is_unprintable(c) && !c.is_ascii_whitespace() => {
            return Some((c, format!("an invisible character ({code}): delete it"), ""));
        }
        _ if c.is_whitespace() && !c.is_ascii() => ("a special space", " "),
        _ => return None,
    };
    let fix = match instead {
        " " => "write an ordinary space".into(),
        "*" => "write a number instead".into(),
        other => format!("write `{other}`"),
    };
    Some((c, format!("{name} ({code}): {fix}"), instead))
}

/// The problem of `c`, a quotation mark other than those of RON.
pub(super) fn quote_problem(c: char) -> String {
    let name = if c == '`' { "a backtick" } else { "a typographic quotation mark" };
    format!("{name} ({}): write \"...\"", code_point(c))
}

/// The ASCII character that the full-width character `c` stands for.
fn ascii_of_full_width(c: char) -> &'static str {
    const ASCII: &str =
        "!\"#$%&'()*+,-./0123456789:;<=>?@ABCDEFGHIJKLMNOPQRSTUVWXYZ[\\]^_`abcdefghijklmnopqrstuvwxyz{|}~";
    let index = (u32::from(c) - 0xff01) as usize;
    ASCII.get(index..=index).unwrap_or_default()
}
