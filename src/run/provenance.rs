//! Provenance: the program and the scenario that a record of results comes from.

use serde::{Deserialize, Serialize};

use super::folder::RunConfig;
use crate::policy::card::RawJson;
use crate::scenario::{Scenario, ScenarioSet};

/// The version of wayfield.
pub const VERSION: &str = env!("CARGO_PKG_VERSION");

/// The Git commit that this program was built from, with `-dirty` if its files had been changed; `None` outside a clone.
pub const COMMIT: Option<&str> = option_env!("WAYFIELD_COMMIT");

/// The program that wrote a record, and the scenario, or set of scenarios, that the record is about.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Provenance {
    /// The version of wayfield.
    pub version: String,
    /// The Git commit; `None` if it is unknown.
    #[serde(default)]
    pub commit: Option<String>,
    /// The checksum of the scenario or set, as on the cards of its policies: eight hexadecimal digits. Empty in old records.
    #[serde(default)]
    pub scenario_crc32c: String,
}

impl Provenance {
    /// The provenance of a record about the run of `config`, with the checksum of its scenario or of its set of scenarios.
    #[must_use]
    pub fn of_run(config: &RunConfig) -> Self {
        let of_scenario = Self::of(&config.scenario);
        match &config.scenario_set {
            Some(set) => Self { scenario_crc32c: set_crc32c(set), ..of_scenario },
            None => of_scenario,
        }
    }

    /// The provenance of a record that this program writes about `scenario`.
    #[must_use]
    pub fn of(scenario: &Scenario) -> Self {
        Self {
            version: VERSION.into(),
            commit: COMMIT.map(String::from),
            scenario_crc32c: scenario_json(scenario).map(|json| json.crc32c()).unwrap_or_default(),
        }
    }
}

/// The checksum of a set of scenarios: the CRC-32C of its JSON text, as eight hexadecimal digits.
#[must_use]
pub fn set_crc32c(set: &ScenarioSet) -> String {
    serde_json::to_string(set).and_then(RawJson::new).map(|json| json.crc32c()).unwrap_or_default()
}

/// The scenario as JSON, as it is on policy cards.
///
/// # Errors
/// None are known: JSON can represent every value in a scenario.
pub fn scenario_json(scenario: &Scenario) -> Result<RawJson, serde_json::Error> {
    RawJson::new(serde_json::to_string(scenario)?)
}
