//! The test of a trained policy: rounds of episodes that it has never seen, and the benchmark route.
//!
//! In: a policy's file, a scenario, a rule. Out: a [`PolicyTestResult`], kept in the run's folder in `trials.json`, so that it is
//! not made twice.

use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::experiment::TestRule;
use super::plan::PolicyId;
use crate::policy::Policy;
use crate::run::RunError;
use crate::run::evaluate::{EpisodeResult, Evaluator};
use crate::run::folder::RunFolder;
use crate::scenario::Scenario;
use crate::task::{EpisodeEnd, EpisodeSetup};

/// Drives of the benchmark route: 5 rounds of 5 (tables 3, 4, 6, 7).
pub const BENCHMARK_ROUTE_EPISODES: usize = 25;

/// How a policy did in its test.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct PolicyTestResult {
    /// The policy's file in the run's folder.
    pub policy: String,
    /// How it was tested.
    pub rule: TestRule,
    /// For each navigation its control steps, null where it failed.
    pub steps: Vec<Option<u32>>,
    /// How many episodes ended in a collision (the others that failed ran out of time).
    pub collisions: usize,
    /// For each drive of the benchmark route its control steps, null where it failed.
    pub benchmark_route_steps: Vec<Option<u32>>,
}

impl PolicyTestResult {
    /// Share of episodes that succeeded, 0 to 1.
    #[must_use]
    pub fn success_rate(&self) -> f64 {
        self.steps.iter().flatten().count() as f64 / self.steps.len() as f64
    }

    /// The same round by round.
    #[must_use]
    pub fn rounds(&self) -> Vec<f64> {
        let rate = |round: &[Option<u32>]| round.iter().flatten().count() as f64 / round.len() as f64;
        self.steps.chunks(self.rule.episodes).map(rate).collect()
    }
}

/// The file of a policy in its run's folder.
#[must_use]
pub fn policy_file(which: PolicyId) -> String {
    match which {
        PolicyId::AfterEpisodes(episodes) => RunFolder::policy_after_file(episodes),
        PolicyId::Best => "policy.safetensors".into(),
    }
}

/// The policy in the file at `path`.
///
/// # Errors
/// It cannot be read, or is none.
pub fn read_policy(path: &Path) -> Result<Policy, RunError> {
    let bytes = std::fs::read(path).map_err(|error| RunError::failed(path, error))?;
    Policy::from_bytes(&bytes).map_err(|error| RunError::failed(path, error))
}

/// Tests the policy `which` of the run in `folder`.
///
/// # Errors
/// Its file cannot be read; no place was found for a start.
pub fn run(
    folder: &Path,
    scenario: &Scenario,
    which: PolicyId,
    rule: TestRule,
) -> Result<PolicyTestResult, RunError> {
    let name = policy_file(which);
    let policy = read_policy(&folder.join(&name))?;
    let (episodes, benchmark_route) = run_episodes(&policy, scenario, rule)?;
    let steps = |driven: &[EpisodeResult]| driven.iter().map(|n| n.succeeded().then_some(n.steps)).collect();
    Ok(PolicyTestResult {
        policy: name,
        rule,
        steps: steps(&episodes),
        collisions: episodes.iter().filter(|n| n.end == EpisodeEnd::Collided).count(),
        benchmark_route_steps: steps(&benchmark_route),
    })
}

/// Drives the test's episodes and the benchmark route's drives with `policy`. Starts, goals and the obstacles' clocks are
/// the same for every policy.
///
/// # Errors
/// The policy does not fit; no place was found for a start.
pub fn run_episodes(
    policy: &Policy,
    scenario: &Scenario,
    rule: TestRule,
) -> Result<(Vec<EpisodeResult>, Vec<EpisodeResult>), RunError> {
    let scenario = Arc::new(scenario.clone());
    let count = rule.rounds * rule.episodes;
    let mut evaluator = Evaluator::new(&scenario, count);
    let episodes = evaluator.run(policy, rule.seed, count, EpisodeSetup::Random)?;
    let benchmark_route =
        evaluator.run(policy, rule.seed, BENCHMARK_ROUTE_EPISODES, EpisodeSetup::BenchmarkRoute)?;
    Ok((episodes, benchmark_route))
}

/// The trials noted in the folder of a run; none if there are none yet (or the file is of another version).
#[must_use]
pub fn read_results(folder: &Path) -> Vec<PolicyTestResult> {
    let text = std::fs::read_to_string(folder.join("trials.json")).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}

/// The trial of the policy `which` by `rule` among `trials`.
#[must_use]
pub fn find(trials: &[PolicyTestResult], which: PolicyId, rule: TestRule) -> Option<&PolicyTestResult> {
    let file = policy_file(which);
    trials.iter().find(|trial| trial.policy == file && trial.rule == rule)
}

/// Notes `trials` in the folder of a run.
///
/// # Errors
/// The file cannot be written.
pub fn write_results(folder: &RunFolder, trials: &[PolicyTestResult]) -> Result<(), RunError> {
    let text = serde_json::to_string(trials).map_err(|error| RunError::Failed(error.to_string()))?;
    folder.write("trials.json", |file| std::io::Write::write_all(file, text.as_bytes()))
}
