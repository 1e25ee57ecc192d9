//! The test of a trained policy: rounds of random episodes, and the benchmark route.
//!
//! In: a policy's file, a scenario and a [`TestRule`]. Out: a [`PolicyTestResult`]. Results are kept in the report's
//! folder, in `runs/NAME/trials.json`, so that no test is repeated.

use std::io::Write;
use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::arm_run::PolicyId;
use super::experiment::TestRule;
use crate::policy::Policy;
use crate::run::RunError;
use crate::run::evaluate::{EpisodeResult, Evaluator};
use crate::run::folder::{POLICY_FILE, RunFolder};
use crate::run::output_file::replace;
use crate::scenario::Scenario;
use crate::task::{EpisodeEnd, EpisodeSetup};

/// Episodes on the benchmark route: 5 rounds of 5 (the paper's tables 3, 4, 6 and 7).
pub const BENCHMARK_ROUTE_EPISODES: usize = 25;

/// The file of the results in a run's folder.
const RESULTS: &str = "trials.json";

/// The result of a policy's test.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PolicyTestResult {
    /// The policy's file in the run's folder.
    pub policy: String,
    /// The test's rounds, episodes and seed.
    pub rule: TestRule,
    /// The control steps of each episode; null for a failure.
    pub steps: Vec<Option<u32>>,
    /// The number of episodes that ended in a collision; the other failures ran out of time.
    pub collisions: usize,
    /// The control steps of each episode on the benchmark route; null for a failure. Empty in a scenario without one.
    pub benchmark_route_steps: Vec<Option<u32>>,
}

impl PolicyTestResult {
    /// The fraction of episodes that succeeded, 0 to 1.
    pub fn success_rate(&self) -> f64 {
        self.steps.iter().flatten().count() as f64 / self.steps.len() as f64
    }

    /// The success rate of each round, 0 to 1.
    pub fn rounds(&self) -> Vec<f64> {
        let rate = |round: &[Option<u32>]| round.iter().flatten().count() as f64 / round.len() as f64;
        self.steps.chunks(self.rule.episodes).map(rate).collect()
    }
}

/// The name of a policy's file in its run's folder.
pub fn policy_file(policy: PolicyId) -> String {
    match policy {
        PolicyId::After(length) => RunFolder::policy_after_file(length),
        PolicyId::Best => POLICY_FILE.into(),
        PolicyId::Last => "policy-last.safetensors".into(),
    }
}

/// Reads the policy in the file at `path`.
///
/// # Errors
/// The file cannot be read, or is not a policy.
pub fn read_policy(path: &Path) -> Result<Policy, RunError> {
    let bytes = std::fs::read(path).map_err(|error| RunError::failed(path, error))?;
    Policy::from_bytes(&bytes).map_err(|error| RunError::failed(path, error))
}

/// Tests a policy of the run in `folder`.
///
/// # Errors
/// The policy's file cannot be read, the policy does not fit the scenario, or no free start was found.
pub fn run(
    folder: &Path,
    scenario: &Scenario,
    policy: PolicyId,
    rule: TestRule,
) -> Result<PolicyTestResult, RunError> {
    let name = policy_file(policy);
    let policy = read_policy(&folder.join(&name))?;
    let (episodes, benchmark_route) = run_episodes(&policy, scenario, rule)?;
    let steps =
        |results: &[EpisodeResult]| results.iter().map(|r| r.succeeded().then_some(r.steps)).collect();
    Ok(PolicyTestResult {
        policy: name,
        rule,
        steps: steps(&episodes),
        collisions: episodes.iter().filter(|r| r.end == EpisodeEnd::Collided).count(),
        benchmark_route_steps: steps(&benchmark_route),
    })
}

/// Runs the random episodes, and the episodes on the benchmark route if there is one. Starts, goals and the obstacles' clocks
/// are the same for every policy.
///
/// # Errors
/// The policy does not fit the scenario, or no free start was found.
pub fn run_episodes(
    policy: &Policy,
    scenario: &Scenario,
    rule: TestRule,
) -> Result<(Vec<EpisodeResult>, Vec<EpisodeResult>), RunError> {
    let scenario = Arc::new(scenario.clone());
    let count = rule.rounds * rule.episodes;
    let mut evaluator = Evaluator::new(&scenario, count);
    let episodes = evaluator.run(policy, rule.seed, count, EpisodeSetup::Random)?;
    let on_route = match scenario.benchmark_route {
        Some(route) => {
            evaluator.run(policy, rule.seed, BENCHMARK_ROUTE_EPISODES, EpisodeSetup::Route(route))?
        }
        None => Vec::new(),
    };
    Ok((episodes, on_route))
}

/// Reads the results in the folder at `folder`; empty if there are none, or if the file has another format.
pub fn read_results(folder: &Path) -> Vec<PolicyTestResult> {
    let text = std::fs::read_to_string(folder.join(RESULTS)).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}

/// The result of a policy's test among `results`.
pub fn find(results: &[PolicyTestResult], policy: PolicyId, rule: TestRule) -> Option<&PolicyTestResult> {
    let file = policy_file(policy);
    results.iter().find(|result| result.policy == file && result.rule == rule)
}

/// Writes the results to the folder at `folder`, which is created if necessary.
///
/// # Errors
/// The file cannot be written.
pub fn write_results(folder: &Path, results: &[PolicyTestResult]) -> Result<(), RunError> {
    let text = serde_json::to_string(results).map_err(|error| RunError::Failed(error.to_string()))?;
    let path = folder.join(RESULTS);
    std::fs::create_dir_all(folder)
        .and_then(|()| replace(&path, |file| file.write_all(text.as_bytes())))
        .map_err(|error| RunError::failed(&path, format!("can't be written: {error}")))
}
