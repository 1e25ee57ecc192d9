//! The driver of a test, as given on the command line: a policy, with or without a map, or a classical driver.

use std::path::Path;

use super::policy;
use crate::drivers::{DriverConfig, DrivingPolicy};
use crate::policy::Policy;
use crate::run::evaluate::Evaluated;
use crate::run::policy_card::{self, WITH_MAP};
use crate::run::{RunError, shipped};
use crate::scenario::{Scenario, path_exists, read_text};
use crate::simulation::Extensions;

/// A policy or a classical driver.
pub enum TestDriver {
    /// A policy.
    Policy(Policy),
    /// A policy with a map that it builds.
    PolicyWithMap(DrivingPolicy),
    /// A classical driver.
    Classical(DriverConfig),
}

impl TestDriver {
    /// The policy in the file at `path`, the driver whose parameters are in that RON file, or the shipped policy or driver
    /// with that name. A file takes precedence over a name. `+map` after a policy gives it a map.
    ///
    /// # Errors
    /// There is no such file or name, or the file is neither a policy nor a driver.
    pub fn load(path: &Path) -> Result<Self, RunError> {
        let exists = path_exists(path) && !path.is_dir();
        let name = path.to_str().unwrap_or_default();
        if !exists && let Some(name) = name.strip_suffix(WITH_MAP) {
            return Self::load(Path::new(name))?.with_map(path);
        }
        if !exists && let Some(driver) = DriverConfig::shipped(name) {
            return Ok(Self::Classical(driver));
        }
        if exists && path.extension().is_some_and(|extension| extension == "ron") {
            return Self::parse(&read_text(path)?, path);
        }
        if !exists && policy::is_unknown_name(path) {
            let policies: Vec<&str> =
                shipped::policies().iter().map(|shipped| shipped.scenario_from).collect();
            let why = format!(
                "no such file, shipped policy or driver; help: give the policy.safetensors of a run, a shipped policy ({}), a \
                 driver ({}) or its RON file",
                policies.join(", "),
                DriverConfig::NAMES.join(", ")
            );
            return Err(RunError::invalid_input(path, why));
        }
        policy::load(path).map(Self::Policy)
    }

    /// The driver whose parameters are in the RON text `text`, which is called `path` in messages.
    ///
    /// # Errors
    /// It is not a driver, or a parameter is out of range.
    pub fn parse(text: &str, path: &Path) -> Result<Self, RunError> {
        Ok(Self::Classical(DriverConfig::parse(text, path)?))
    }

    /// This policy with a map; error messages call it `path`.
    ///
    /// # Errors
    /// It is a classical driver, has a map already, or is a policy whose encoding this version does not support.
    pub fn with_map(self, path: &Path) -> Result<Self, RunError> {
        match self {
            Self::Policy(policy) => policy_card::driving(policy, true)
                .map(Self::PolicyWithMap)
                .map_err(|error| RunError::invalid_input(path, error)),
            Self::PolicyWithMap(_) => {
                Err(RunError::invalid_input(path, format!("{WITH_MAP} is given twice; help: give it once")))
            }
            Self::Classical(_) => Err(RunError::invalid_input(
                path,
                format!(
                    "{WITH_MAP} gives a map to a policy only; help: grid-dwa is a classical driver with a map"
                ),
            )),
        }
    }

    /// Its policy; `None` for a classical driver.
    pub fn policy(&self) -> Option<&Policy> {
        match self {
            Self::Policy(policy) => Some(policy),
            Self::PolicyWithMap(with_map) => Some(&with_map.policy),
            Self::Classical(_) => None,
        }
    }

    /// Checks that it can drive in `scenario`. Every classical driver can.
    ///
    /// # Errors
    /// The policy's inputs or actions do not match `scenario`, or a policy with a map was trained with plugin sensors.
    pub fn check(&self, path: &Path, scenario: &Scenario, extensions: &Extensions) -> Result<(), RunError> {
        self.policy().map_or(Ok(()), |policy| policy::check(path, policy, scenario, extensions))?;
        match self {
            Self::PolicyWithMap(with_map) => policy_card::check_without_sensors(&with_map.policy)
                .map_err(|error| RunError::invalid_input(path, error)),
            _ => Ok(()),
        }
    }

    /// This driver, in the form that the evaluator takes.
    pub fn evaluated(&self) -> Evaluated<'_> {
        match self {
            Self::Policy(policy) => policy.into(),
            Self::PolicyWithMap(with_map) => with_map.into(),
            Self::Classical(driver) => driver.into(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scenario::to_ron;

    #[test]
    fn every_driver_written_as_ron_is_recognized_and_read_back() {
        for name in DriverConfig::NAMES {
            let driver = DriverConfig::shipped(name).expect("shipped");
            let text = to_ron(&driver).expect("RON");
            assert!(DriverConfig::looks_like(&text), "{text}");
            assert_eq!(DriverConfig::parse(&text, "driver.ron"), Ok(driver));
        }
        assert!(!DriverConfig::looks_like("(name: \"Dwa\")"), "a scenario with the name of a driver");
    }
}
