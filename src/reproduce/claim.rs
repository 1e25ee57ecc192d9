//! The schema of a claim.

use serde::{Deserialize, Serialize};

use super::measure::Measure;

/// A claim to test: arm `better` is better than arm `than`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Claim {
    /// The claim in words.
    pub statement: String,
    /// The measure that decides.
    pub measure: Measure,
    /// The arm that is claimed to be better.
    pub better: String,
    /// The other arm.
    pub than: String,
    /// The number of episodes after which the policies are compared, over all stages.
    pub after: u64,
    /// Whether the episodes are those of the last stage only.
    #[serde(default)]
    pub of_last_stage: bool,
}
