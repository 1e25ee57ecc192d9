//! The results of a test of a policy, for its model card.

use serde::Deserialize;
use wayfield_policy::Policy;

use crate::ExportError;

/// The results of a test: a part of the JSON object that `wayfield --eval POLICY --json` prints. Unknown fields are ignored.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct EvalResults {
    /// The checksum of the weights of the policy ([`Policy::weights_crc32c`]).
    pub weights_crc32c: String,
    /// What was tested: `A` for the policy alone, `B` for the policy with a map; `None` if not recorded.
    #[serde(alias = "driver_class")]
    pub class: Option<String>,
    /// The name of the scenario.
    pub scenario: String,
    /// Fraction of the episodes that succeeded, 0 to 1.
    pub success_rate: f64,
    /// The 95 % confidence interval of the success rate, within 0 to 1.
    pub success_interval: [f64; 2],
    /// Fraction of the episodes that ended in a collision, 0 to 1.
    pub collision_rate: f64,
    /// Fraction of the episodes that ended at the time limit, 0 to 1.
    pub timeout_rate: f64,
    /// Mean simulated time of the successful episodes in s; `None` if none succeeded.
    pub mean_time_s: Option<f64>,
    /// Number of episodes.
    pub episodes: u64,
    /// The seed of starts and goals.
    pub seed: u64,
}

impl EvalResults {
    /// Parses the results of a test in `json` (UTF-8), which must be those of `policy`.
    ///
    /// # Errors
    /// `json` is not an object with these fields, a number is out of range, or the results are those of another policy or of the
    /// policy with a map.
    pub fn parse(json: &[u8], policy: &Policy) -> Result<Self, ExportError> {
        let results: Self =
            serde_json::from_slice(json).map_err(|error| ExportError::Results(error.to_string()))?;
        results.check()?;
        let weights = policy.weights_crc32c();
        if results.weights_crc32c != weights {
            return Err(ExportError::OtherPolicy { tested: results.weights_crc32c, exported: weights });
        }
        if results.class.as_ref().is_some_and(|class| class != "A") {
            return Err(ExportError::WithMap);
        }
        Ok(results)
    }

    fn check(&self) -> Result<(), ExportError> {
        let [low, high] = self.success_interval;
        let rates = [self.success_rate, low, high, self.collision_rate, self.timeout_rate];
        let sum = self.success_rate + self.collision_rate + self.timeout_rate;
        let problem = if rates.iter().any(|rate| !(0.0..=1.0).contains(rate)) {
            "a rate is not between 0 and 1"
        } else if (sum - 1.0).abs() > 1e-6 {
            "the rates of success, collision and timeout do not add up to 1"
        } else if self.mean_time_s.is_some_and(|time_s| !(time_s.is_finite() && time_s >= 0.0)) {
            "mean_time_s is not a time"
        } else if self.episodes == 0 {
            "there are no episodes"
        } else {
            return Ok(());
        };
        Err(ExportError::Results(problem.into()))
    }
}
