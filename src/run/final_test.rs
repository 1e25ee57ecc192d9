//! The final test: the best policy of a training run, in episodes that did not select it.
//!
//! The best of many evaluations, all in the same episodes, is optimistic. This test is not, so it is the result to
//! report.

use serde::{Deserialize, Serialize};

use super::RunError;
use super::background_evaluator::{Candidate, EpisodeSet};
use super::checkpoint::TrainerState;
use super::evaluate::{Evaluation, ScenarioResult};
use super::folder::RunConfig;
use crate::policy::Policy;
use crate::random;

/// The results of testing the best policy after training, in episodes other than those of the evaluations.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct FinalTest {
    /// Fraction of episodes that succeeded, 0 to 1.
    pub success_rate: f64,
    /// Its 95 % confidence interval, within 0 to 1.
    pub success_interval: [f64; 2],
    /// Fraction of episodes that ended in a collision, 0 to 1.
    pub collision_rate: f64,
    /// Its 95 % confidence interval, within 0 to 1.
    pub collision_interval: [f64; 2],
    /// Fraction of episodes that ended at the time limit, 0 to 1.
    pub timeout_rate: f64,
    /// Its 95 % confidence interval, within 0 to 1.
    pub timeout_interval: [f64; 2],
    /// Mean simulated time of the successful episodes, in s; `None` without a success.
    pub mean_time_s: Option<f64>,
    /// Number of episodes.
    pub episodes: usize,
    /// The seed of the episodes. `--eval` with this seed, and with as many episodes, gives the same numbers.
    pub seed: u64,
    /// The results in each scenario of a set; empty if all episodes had the same scenario.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub scenarios: Vec<ScenarioResult>,
    /// Wall time of the test, in s. It is not part of the run's wall time.
    pub wall_s: f64,
}

impl FinalTest {
    /// The test with the result `evaluation`, which took `wall_s` seconds of wall time.
    #[must_use]
    pub fn new(evaluation: Evaluation, wall_s: f64) -> Self {
        Self {
            success_rate: evaluation.success_rate,
            success_interval: evaluation.success_interval,
            collision_rate: evaluation.collision_rate,
            collision_interval: evaluation.collision_interval,
            timeout_rate: evaluation.timeout_rate,
            timeout_interval: evaluation.timeout_interval,
            mean_time_s: evaluation.mean_time_s,
            episodes: evaluation.episodes,
            seed: evaluation.seed,
            scenarios: evaluation.scenarios,
            wall_s,
        }
    }
}

/// The best policy as a candidate for the final test; `None` if there is no such policy, or the preset asks for no test.
///
/// # Errors
/// The policy in `trainer_state` cannot be read.
pub fn candidate(config: &RunConfig, trainer_state: &TrainerState) -> Result<Option<Candidate>, RunError> {
    let count = config.preset.evaluation.final_episodes;
    let Some(best) = trainer_state.best.as_ref().filter(|_| count > 0) else { return Ok(None) };
    let policy = Policy::from_bytes(&best.bytes).map_err(|error| RunError::Failed(error.to_string()))?;
    let test = Some(EpisodeSet { count, seed: test_seed(config.seed) });
    Ok(Some(Candidate { policy, env_steps: 0, episodes: 0, gradient_steps: 0, test }))
}

/// The seed of the final test of a run with `seed`. It is hashed, so that its episodes are neither those of the evaluations nor
/// those of `--eval` with the run's seed; and below 2^32, so that it can be given to `--eval` by hand.
#[must_use]
pub fn test_seed(seed: u64) -> u64 {
    let mut stream = random::stream(seed, "final test", 0);
    random::random_u64(&mut stream) >> 32
}
