//! The mode `--card`: prints a policy's network and card.

use std::path::Path;

use super::output::print_json_text;
use super::policy;
use crate::run::RunError;

/// Prints the header of the policy at `path` (a file, or the name of a shipped policy) as one line of JSON: the network and the
/// card.
///
/// # Errors
/// The file is not a policy, or has no card.
pub fn run(path: &Path) -> Result<(), RunError> {
    let policy = policy::load(path)?;
    if policy.card.is_none() {
        let why = "has no card (wayfield 0.1.0 wrote none); help: train the policy again";
        return Err(RunError::invalid_input(path, why));
    }
    let header = policy.header().map_err(|error| RunError::invalid_input(path, error))?;
    print_json_text(&header)
}
