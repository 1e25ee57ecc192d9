//! Policy files given on the command line.

use std::path::Path;

use crate::learning::Policy;
use crate::policy::Encoding;
use crate::run::progress::print_stderr;
use crate::run::{RunError, evaluate, policy_card, shipped};
use crate::scenario::{Scenario, path_exists};
use crate::simulation::Extensions;
use crate::task::ObservationLayout;

/// The policy in the file at `path`, or the shipped policy of that name.
///
/// # Errors
/// The file cannot be read, or is not a policy.
pub fn load(path: &Path) -> Result<Policy, RunError> {
    if let Some(policy) = shipped::policy(path) {
        return Ok(policy.clone());
    }
    if is_unknown_name(path) {
        let names: Vec<&str> = shipped::policies().iter().map(|shipped| shipped.scenario_from).collect();
        let why = format!(
            "no such file or shipped policy; help: give the policy.safetensors of a run or a shipped name ({})",
            names.join(", ")
        );
        return Err(RunError::invalid_input(path, why));
    }
    policy_card::read(path)
}

/// Whether `path` looks like a shipped name rather than a file, but is neither.
pub fn is_unknown_name(path: &Path) -> bool {
    let is_name = path.extension().is_none() && path.components().count() == 1;
    is_name && shipped::policy(path).is_none() && !path_exists(path) && !path.is_dir()
}

/// Reads the policy in the file at `path`, or the shipped policy of that name, for use in `scenario`. Warns on stderr of settings
/// of the scenario that differ from the policy's card.
///
/// # Errors
/// The file cannot be read, or the policy's inputs or actions do not match `scenario`.
pub fn read(path: &Path, scenario: &Scenario, extensions: &Extensions) -> Result<Policy, RunError> {
    let policy = load(path)?;
    check(path, &policy, scenario, extensions)?;
    Ok(policy)
}

/// Checks that the policy from `path` can be used in `scenario`. Warns on stderr of settings of the scenario that differ from the
/// policy's card.
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
