//! The scenario that several policies have in common.

use std::path::Path;

use super::{differing_parts, own_scenario};
use crate::policy::Policy;
use crate::run::{RunError, shipped};
use crate::scenario::{Scenario, printable};

/// The scenario that is assumed for a policy without a card.
const DEFAULT: &str = "scenario-1";

/// The scenario in which all `policies`, given with their names, were trained. For a policy without a card, Scenario I is
/// assumed; if there are no policies, it is the result.
///
/// # Errors
/// Two policies were trained in different scenarios, or the scenario on a card is invalid.
pub fn common_scenario<'a>(
    policies: impl IntoIterator<Item = (&'a str, &'a Policy)>,
) -> Result<Scenario, RunError> {
    let mut first: Option<(&str, Scenario)> = None;
    for (name, policy) in policies {
        let own = own_scenario(policy).map_err(|error| RunError::invalid_input(Path::new(name), error))?;
        let own = own.map_or_else(|| shipped::scenario(DEFAULT), Ok)?;
        match &first {
            Some((first_name, first)) if *first != own => {
                return Err(different(first_name, first, name, &own));
            }
            Some(_) => {}
            None => first = Some((name, own)),
        }
    }
    first.map_or_else(|| Ok(shipped::scenario(DEFAULT)?), |(_, own)| Ok(own))
}

fn different(first_name: &str, first: &Scenario, name: &str, own: &Scenario) -> RunError {
    let differing = if first.name == own.name { differing_parts(first, own) } else { String::new() };
    RunError::InvalidInput(format!(
        "{first_name} was trained in scenario \"{}\" and {name} in \"{}\"{differing}; help: give --scenario, so that \
         they drive the same episodes",
        printable(&first.name),
        printable(&own.name),
    ))
}
