//! Output of results on stdout.

use std::io::{ErrorKind, Write};

use serde::Serialize;

use crate::run::RunError;
use crate::scenario::{is_unprintable, printable_lines};

/// Prints `value` as one line of JSON, with unprintable characters escaped.
///
/// # Errors
/// `value` cannot be serialized, or stdout cannot be written.
pub fn print_json(value: &impl Serialize) -> Result<(), RunError> {
    let text = serde_json::to_string(value).map_err(|error| RunError::Failed(error.to_string()))?;
    print_json_text(&text)
}

/// Prints the JSON in `text` on one line.
///
/// # Errors
/// Stdout cannot be written.
pub fn print_json_text(text: &str) -> Result<(), RunError> {
    print_stdout(&(escaped_json(text) + "\n"))
}

/// Replaces unprintable characters in the strings of `json` by `\u` escapes, which does not change its value. Line breaks and
/// tabs occur only between tokens, and become spaces.
fn escaped_json(json: &str) -> String {
    let mut escaped = String::with_capacity(json.len());
    for c in json.chars() {
        if matches!(c, '\n' | '\r' | '\t') {
            escaped.push(' ');
        } else if is_unprintable(c) {
            let units =
                c.encode_utf16(&mut [0; 2]).iter().map(|unit| format!("\\u{unit:04x}")).collect::<String>();
            escaped += &units;
        } else {
            escaped.push(c);
        }
    }
    escaped
}

/// Prints `text`. Text from files can't control the terminal: it is made [printable](printable_lines).
///
/// # Errors
/// Stdout cannot be written. A reader that closes the pipe early (`| head`) is not an error.
pub fn print_stdout(text: &str) -> Result<(), RunError> {
    let text = printable_lines(text);
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != ErrorKind::BrokenPipe => {
            Err(RunError::Failed(format!("stdout: the results can't be written: {error}")))
        }
        _ => Ok(()),
    }
}
