//! Text from files and file names, made safe to print.
//!
//! In: any text or path. Out: text in which every character that a terminal would act on, or that a reader can't see, is
//! written as an escape; and paths quoted for a shell.

use std::borrow::Cow;
use std::ffi::OsStr;
use std::fmt::Write;
use std::path::Path;

/// `text` for one line of a message: [unprintable](is_unprintable) characters are written as escapes, such as `\u{1b}`.
#[must_use]
pub fn printable(text: &str) -> Cow<'_, str> {
    escaped(text, is_unprintable)
}

/// `text` for a message of several lines: like [`printable`], but line breaks and tabs stay.
#[must_use]
pub fn printable_lines(text: &str) -> Cow<'_, str> {
    escaped(text, |c| is_unprintable(c) && !matches!(c, '\n' | '\t'))
}

/// `path` for one line of a message: like [`printable`]. Bytes that are not valid Unicode become U+FFFD.
#[must_use]
pub fn printable_path(path: &Path) -> String {
    printable(&path.to_string_lossy()).into_owned()
}

fn escaped(text: &str, is_escaped: impl Fn(char) -> bool) -> Cow<'_, str> {
    if !text.contains(&is_escaped) {
        return Cow::Borrowed(text);
    }
    let mut escaped = String::with_capacity(text.len() + 8);
    for c in text.chars() {
        if is_escaped(c) {
            escaped.extend(c.escape_unicode());
        } else {
            escaped.push(c);
        }
    }
    Cow::Owned(escaped)
}

/// Whether `c` should not be printed as it is: a control character (terminal escapes begin with one), a mark that
/// reverses the direction of text, an invisible character, a line break other than `\n`, or a noncharacter. Joiners (U+200C and
/// U+200D) may be printed, because some scripts and emoji need them. `wayfield-export` has the same list for model cards.
#[must_use]
pub fn is_unprintable(c: char) -> bool {
    c.is_control()
        || is_noncharacter(c)
        || matches!(c,
            '\u{ad}' | '\u{34f}' | '\u{61c}' | '\u{115f}' | '\u{1160}' | '\u{180e}' | '\u{200b}' | '\u{200e}' | '\u{200f}'
            | '\u{2028}'..='\u{202e}' | '\u{2060}'..='\u{206f}' | '\u{3164}' | '\u{feff}' | '\u{ffa0}'
            | '\u{fff9}'..='\u{fffb}' | '\u{e0000}'..='\u{e007f}')
}

/// Whether Unicode reserves `c` for internal use. XML does not allow U+FFFE and U+FFFF.
#[must_use]
pub fn is_noncharacter(c: char) -> bool {
    matches!(c, '\u{fdd0}'..='\u{fdef}') || u32::from(c) & 0xfffe == 0xfffe
}

/// The name of `c` for a message, such as `U+00A0`.
pub(super) fn code_point(c: char) -> String {
    format!("U+{:04X}", u32::from(c))
}

/// The byte order mark with which some editors begin a UTF-8 file.
const MARK: char = '\u{feff}';

/// `text` without a byte order mark.
pub(super) fn without_mark(text: &str) -> &str {
    text.strip_prefix(MARK).unwrap_or(text)
}

/// `word` as one word of a shell command. A plain word stays as it is, others get single quotes. A word with bytes that
/// can't be printed is written with escapes, such as `$'w\377.ron'`, which bash, zsh and every shell of POSIX 2024 read.
#[must_use]
pub fn quoted(word: impl AsRef<OsStr>) -> String {
    let word = word.as_ref();
    match word.to_str() {
        Some(text) if text.contains(is_unprintable) => {}
        Some(text) if !text.is_empty() && text.chars().all(is_plain) => return text.into(),
        Some(text) => return format!("'{}'", text.replace('\'', r"'\''")),
        None => {}
    }
    let mut quoted = String::from("$'");
    for &byte in word.as_encoded_bytes() {
        match byte {
            b'\'' | b'\\' => quoted.extend(['\\', char::from(byte)]),
            b' '..=b'~' => quoted.push(char::from(byte)),
            // Writing to a string can't fail.
            _ => drop(write!(quoted, "\\{byte:03o}")),
        }
    }
    quoted + "'"
}

/// Whether `c` has no special meaning inside a word in any shell.
fn is_plain(c: char) -> bool {
    c.is_alphanumeric() || "-_./,:@%+".contains(c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_terminal_would_act_on_is_escaped() {
        for (text, shown) in [
            ("plain, ünï 迷路 \u{1f916}", "plain, ünï 迷路 \u{1f916}"),
            ("\u{1b}]0;taken\u{7}\u{9b}31m\u{7f}", r"\u{1b}]0;taken\u{7}\u{9b}31m\u{7f}"),
            ("a\u{202e}nor.b\u{2066}\u{200f}", r"a\u{202e}nor.b\u{2066}\u{200f}"),
            ("na\u{200b}me\u{feff}\u{e0041}", r"na\u{200b}me\u{feff}\u{e0041}"),
            (
                "\u{ad}\u{34f}\u{115f}\u{1160}\u{180e}\u{3164}\u{ffa0}",
                r"\u{ad}\u{34f}\u{115f}\u{1160}\u{180e}\u{3164}\u{ffa0}",
            ),
            ("\u{ffff}\u{1fffe}", r"\u{ffff}\u{1fffe}"),
        ] {
            assert_eq!(printable(text), shown);
            assert_eq!(printable_lines(text), shown);
        }
        assert_eq!(printable("a\nb\tc\r"), r"a\u{a}b\u{9}c\u{d}");
        assert_eq!(printable_lines("a\nb\tc\r"), "a\nb\tc\\u{d}");
    }

    #[test]
    fn words_are_quoted_only_if_a_shell_would_change_them() {
        for (word, quoted_word) in [
            ("runs/scenario-1-fast-0/policy.safetensors", "runs/scenario-1-fast-0/policy.safetensors"),
            ("迷路.ron", "迷路.ron"),
            ("it's", r"'it'\''s'"),
            ("two words", "'two words'"),
            ("$HOME", "'$HOME'"),
            ("~root", "'~root'"),
            ("a\u{1b}'b", r"$'a\033\'b'"),
            ("", "''"),
        ] {
            assert_eq!(quoted(word), quoted_word);
        }
    }

    #[cfg(unix)]
    #[test]
    fn a_shell_reads_a_quoted_word_back_to_the_same_bytes() {
        use std::os::unix::ffi::OsStrExt;
        let mut words: Vec<Vec<u8>> = (1..=255).map(|byte| vec![b'w', byte, b'7']).collect();
        words.push(b"\\'\"`$(x)* \xff\n".to_vec());
        for word in words {
            let command = format!("printf %s {}", quoted(OsStr::from_bytes(&word)));
            match std::process::Command::new("bash").args(["-c", &command]).output() {
                Ok(output) => assert_eq!(output.stdout, word, "{command}"),
                Err(_) => return println!("skipped: there is no bash"),
            }
        }
    }
}
