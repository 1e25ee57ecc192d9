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
    /// The measure that decides. A claim about a curve uses the measure of the curve: `SuccessRate`, `Return` or `Goals`.
    /// `Success` is measured in the test after training.
    pub measure: Measure,
    /// The arm that is claimed to be better.
    pub better: String,
    /// The other arm.
    pub than: String,
    /// The episodes or env steps, over all stages, after which the arms are compared, such as `EnvSteps(20_000)`; 0 is before the
    /// first step or, with `of_last_stage`, right after a transfer. If omitted, they are compared after training.
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
