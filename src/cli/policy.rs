//! Policy files given on the command line.

use std::path::Path;

use crate::learning::Policy;
use crate::policy::Encoding;
use crate::run::progress::print_stderr;
use crate::run::{RunError, evaluate, policy_card};
use crate::scenario::Scenario;
use crate::simulation::Extensions;
use crate::task::ObservationLayout;

/// The policy in the file at `path`, which will be used in `scenario`. Warns on stderr of settings there that differ from
/// the policy's card.
///
/// # Errors
/// The file cannot be read, or the policy's inputs or actions do not match `scenario`.
pub fn read(path: &Path, scenario: &Scenario, extensions: &Extensions) -> Result<Policy, RunError> {
    let policy = policy_card::read(path)?;
    check(path, &policy, scenario, extensions)?;
    Ok(policy)
}

/// Checks that the policy from `path` can be used in `scenario`. Warns on stderr of settings there that differ from its card.
///
/// # Errors
/// The policy's inputs or actions do not match `scenario`.
pub fn check(
    path: &Path,
    policy: &Policy,
    scenario: &Scenario,
    extensions: &Extensions,
) -> Result<(), RunError> {
    let layout = ObservationLayout::new(Encoding::default(), extensions.describe().0);
    let warning = evaluate::check_compatible(policy, scenario, &layout)
        .and_then(|()| policy_card::warning(policy, scenario))
        .map_err(|error| RunError::invalid_input(path, error))?;
    if let Some(warning) = warning {
        print_stderr(&format!("warning: {}: {warning}", path.display()));
    }
    Ok(())
}
