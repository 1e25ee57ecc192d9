//! The schema of a claim.

use serde::{Deserialize, Serialize};

use super::measure::Measure;
use super::test_point::TestPoint;
use crate::run::preset::Budget;

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
    /// The episodes or env steps after which the policies are compared, over all stages; without it, after the whole
    /// training.
    #[serde(default)]
    pub after: Option<Budget>,
    /// Whether `after` counts from the start of the last stage.
    #[serde(default)]
    pub of_last_stage: bool,
}

impl Claim {
    /// The point at which the arms are compared.
    #[must_use]
    pub fn point(&self) -> TestPoint {
        TestPoint { after: self.after, of_last_stage: self.of_last_stage }
    }
}
