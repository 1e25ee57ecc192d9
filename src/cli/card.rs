//! The mode `--card`: prints the card of a policy.

use std::path::Path;

use super::output::print_stdout;
use crate::run::{RunError, policy_card};
use crate::scenario::is_unprintable;

/// Prints the network and the card of the policy in the file at `path`, as one line of JSON: what the file itself contains.
///
/// # Errors
/// The file is not a policy, or has no card.
pub fn run(path: &Path) -> Result<(), RunError> {
    let policy = policy_card::read(path)?;
    if policy.card.is_none() {
        let why = "has no card (wayfield 0.1.0 wrote none); help: train the policy again";
        return Err(RunError::invalid_input(path, why));
    }
    let header = policy.header().map_err(|error| RunError::invalid_input(path, error))?;
    print_stdout(&format!("{}\n", escaped(&header)))
}

/// `json` on one line, with escape sequences of JSON for all characters that a terminal might interpret.
fn escaped(json: &str) -> String {
    let escape = |c: char| match c {
        c if !is_unprintable(c) => c.to_string(),
        // Between tokens only: in strings JSON itself escapes them.
        '\n' | '\r' | '\t' => " ".into(),
        c => c.encode_utf16(&mut [0; 2]).iter().map(|unit| format!("\\u{unit:04x}")).collect(),
    };
    json.chars().map(escape).collect()
}
