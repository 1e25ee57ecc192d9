//! Policies named on the command line.

use std::path::Path;

use crate::learning::Policy;
use crate::run::{RunError, evaluate, policy_card};
use crate::scenario::Scenario;

/// The policy in the file at `path`.
///
/// # Errors
/// It cannot be read, or its inputs or actions are not those of `scenario`.
pub fn read(path: &Path, scenario: &Scenario) -> Result<Policy, RunError> {
    let policy = policy_card::read(path)?;
    evaluate::check_compatible(&policy, scenario, &crate::task::ObservationLayout::default())
        .map_err(|error| RunError::invalid_input(path, error))?;
    Ok(policy)
}
