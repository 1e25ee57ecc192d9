//! Policy files given on the command line.

use std::path::Path;

use crate::learning::Policy;
use crate::policy::Encoding;
use crate::run::{RunError, evaluate, policy_card};
use crate::scenario::Scenario;
use crate::simulation::Extensions;
use crate::task::ObservationLayout;

/// The policy in the file at `path`.
///
/// # Errors
/// The file cannot be read, or the policy's inputs or actions do not match `scenario`.
pub fn read(path: &Path, scenario: &Scenario, extensions: &Extensions) -> Result<Policy, RunError> {
    let policy = policy_card::read(path)?;
    evaluate::check_compatible(
        &policy,
        scenario,
        &ObservationLayout::new(Encoding::default(), extensions.describe().0),
    )
    .map_err(|error| RunError::invalid_input(path, error))?;
    Ok(policy)
}
