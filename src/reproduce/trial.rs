//! The test of a trained policy: rounds of navigations that it has never seen, and the timed course.
//!
//! In: a policy's file, a scenario, a rule. Out: a [`Trial`], kept in the run's folder in `trials.json`, so that it is
//! not made twice.

use std::path::Path;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use super::experiment::TestRule;
use super::plan::Which;
use crate::learning::Policy;
use crate::run::RunError;
use crate::run::evaluate::{Evaluator, Navigation};
use crate::run::folder::RunFolder;
use crate::scenario::Scenario;
use crate::task::{EpisodeEnd, Places};

/// Drives of the timed course: 5 rounds of 5 (tables 3, 4, 6, 7).
pub const COURSE_DRIVES: usize = 25;

/// How a policy did in its test.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Trial {
    /// The policy's file in the run's folder.
    pub policy: String,
    /// How it was tested.
    pub rule: TestRule,
    /// For each navigation its control steps, null where it failed.
    pub steps: Vec<Option<u32>>,
    /// How many navigations ended in a collision (the others that failed ran out of time).
    pub collisions: usize,
    /// For each drive of the course its control steps, null where it failed.
    pub course_steps: Vec<Option<u32>>,
}

impl Trial {
    /// Share of navigations that succeeded, 0 to 1.
    #[must_use]
    pub fn success_rate(&self) -> f64 {
        self.steps.iter().flatten().count() as f64 / self.steps.len() as f64
    }

    /// The same round by round.
    #[must_use]
    pub fn rounds(&self) -> Vec<f64> {
        let rate = |round: &[Option<u32>]| round.iter().flatten().count() as f64 / round.len() as f64;
        self.steps.chunks(self.rule.navigations).map(rate).collect()
    }
}

/// The file of a policy in its run's folder.
#[must_use]
pub fn file(which: Which) -> String {
    match which {
        Which::After(episodes) => RunFolder::policy_after(episodes),
        Which::Best => "policy.safetensors".into(),
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
pub fn test(folder: &Path, scenario: &Scenario, which: Which, rule: TestRule) -> Result<Trial, RunError> {
    let name = file(which);
    let policy = read_policy(&folder.join(&name))?;
    let (navigations, course) = drive(&policy, scenario, rule)?;
    let steps = |driven: &[Navigation]| driven.iter().map(|n| n.succeeded().then_some(n.steps)).collect();
    Ok(Trial {
        policy: name,
        rule,
        steps: steps(&navigations),
        collisions: navigations.iter().filter(|n| n.end == EpisodeEnd::Collided).count(),
        course_steps: steps(&course),
    })
}

/// Drives the test's navigations and the course's drives with `policy`. Starts, targets and the obstacles' clocks are
/// the same for every policy.
///
/// # Errors
/// The policy does not fit; no place was found for a start.
pub fn drive(
    policy: &Policy,
    scenario: &Scenario,
    rule: TestRule,
) -> Result<(Vec<Navigation>, Vec<Navigation>), RunError> {
    let scenario = Arc::new(scenario.clone());
    let count = rule.rounds * rule.navigations;
    let mut evaluator = Evaluator::new(&scenario, count);
    let navigations = evaluator.run(policy, rule.seed, count, Places::Drawn)?;
    let course = evaluator.run(policy, rule.seed, COURSE_DRIVES, Places::Course)?;
    Ok((navigations, course))
}

/// The trials noted in the folder of a run; none if there are none yet (or the file is of another version).
#[must_use]
pub fn noted(folder: &Path) -> Vec<Trial> {
    let text = std::fs::read_to_string(folder.join("trials.json")).unwrap_or_default();
    serde_json::from_str(&text).unwrap_or_default()
}

/// The trial of the policy `which` by `rule` among `trials`.
#[must_use]
pub fn find(trials: &[Trial], which: Which, rule: TestRule) -> Option<&Trial> {
    let file = file(which);
    trials.iter().find(|trial| trial.policy == file && trial.rule == rule)
}

/// Notes `trials` in the folder of a run.
///
/// # Errors
/// The file cannot be written.
pub fn note(folder: &RunFolder, trials: &[Trial]) -> Result<(), RunError> {
    let text = serde_json::to_string(trials).map_err(|error| RunError::Failed(error.to_string()))?;
    folder.write("trials.json", |file| std::io::Write::write_all(file, text.as_bytes()))
}
