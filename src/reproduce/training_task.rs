//! A training run as a task for another machine: all that it needs, in one text.
//!
//! In: a training run of a plan, or the configuration of a single one. Out: a [`TrainingTask`] as RON, which another process
//! with the same version of wayfield executes. It needs no other file, except the policy that the run starts from.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use serde::{Deserialize, Serialize};

use super::arm_run::PolicyId;
use super::execute::{is_done, train_and_test};
use super::experiment::{TestRule, TestedPolicy};
use super::plan::PlannedRun;
use super::progress::gradient_steps;
use super::run_config::run_name;
use crate::limits::MAX_CONFIG_BYTES;
use crate::run::RunError;
use crate::run::folder::RunConfig;
use crate::run::progress::ProgressListener;
use crate::scenario::{Diagnostic, FileError, parse_ron_with_limit, to_ron};

/// The name of a task's text in messages.
const NAME: &str = "<task>";

/// A training run and its tests.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct TrainingTask {
    /// The name of the run's folder. Equal configurations have equal names.
    name: String,
    /// The configuration of the run. The path of the policy that it starts from is relative to the folder of all runs.
    config: RunConfig,
    /// The policies to test, with their tests.
    tests: BTreeSet<(PolicyId, TestRule)>,
}

impl From<&PlannedRun> for TrainingTask {
    fn from(training: &PlannedRun) -> Self {
        let PlannedRun { name, config, tests, .. } = training.clone();
        Self { name, config, tests }
    }
}

impl TrainingTask {
    /// The task of a single run, without tests.
    ///
    /// # Errors
    /// The configuration cannot be written as RON, which does not occur.
    pub fn new(config: RunConfig) -> Result<Self, RunError> {
        Ok(Self { name: run_name(&config, TestedPolicy::Best)?, config, tests: BTreeSet::new() })
    }

    /// Reads a task from the RON text of [`to_text`](Self::to_text).
    ///
    /// # Errors
    /// The text is not a task, or has invalid values.
    pub fn parse(text: &str) -> Result<Self, RunError> {
        let task: Self = parse_ron_with_limit(text, NAME, MAX_CONFIG_BYTES)?;
        let inside = |found: Diagnostic| Diagnostic { path: format!("config.{}", found.path), ..found };
        let diagnostics: Vec<Diagnostic> = task.config.diagnostics().into_iter().map(inside).collect();
        if !diagnostics.is_empty() {
            return Err(FileError::from_diagnostics(Path::new(NAME), text, &diagnostics).into());
        }
        if Path::new(&task.name).file_name() != Some(task.name.as_ref()) {
            let why = format!(
                "{NAME}: the name {:?} is not that of a folder; help: pass on the text unchanged",
                task.name
            );
            return Err(RunError::InvalidInput(why));
        }
        Ok(task)
    }

    /// The task as RON.
    ///
    /// # Errors
    /// The task cannot be written as RON, which does not occur.
    pub fn to_text(&self) -> Result<String, RunError> {
        to_ron(self).map_err(|error| RunError::Failed(error.to_string()))
    }

    /// The name of the run's folder.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The file with the policy that the training run starts from, relative to the folder of all runs.
    #[must_use]
    pub fn starts_from(&self) -> Option<&str> {
        self.config.transfer.as_ref().map(|transfer| transfer.policy.as_str())
    }

    /// The approximate number of gradient steps, to which the time is proportional.
    #[must_use]
    pub fn cost(&self) -> f64 {
        gradient_steps(&self.training(), self.config.preset.budget)
    }

    /// Whether the folder `runs` has the finished run with all test results.
    #[must_use]
    pub fn is_done(&self, runs: &Path) -> bool {
        is_done(&self.training(), runs)
    }

    /// Trains and tests in the folder `runs`. `listener` creates the listener for the progress of training. Finished work is
    /// not repeated.
    ///
    /// # Errors
    /// The run failed, a file cannot be read or written, or `stop` was set.
    pub fn run(
        &self,
        runs: &Path,
        listener: &dyn Fn() -> ProgressListener,
        stop: &AtomicBool,
    ) -> Result<(), RunError> {
        if train_and_test(&self.training(), runs, listener, stop)? {
            return Ok(());
        }
        Err(RunError::Stopped(format!(
            "{}: stopped; help: run the same task again, in the same folder",
            self.name
        )))
    }

    fn training(&self) -> PlannedRun {
        let Self { name, config, tests } = self.clone();
        PlannedRun { name, config, origin: None, tests, elsewhere: None }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::reproduce::ReproduceOptions;
    use crate::reproduce::plan::RunPlan;
    use crate::reproduce::select::select;

    fn tasks() -> Vec<TrainingTask> {
        let selected = select(&ReproduceOptions::default()).expect("the selection works");
        RunPlan::new(&selected)
            .expect("the plan works")
            .training_runs
            .iter()
            .map(TrainingTask::from)
            .collect()
    }

    #[test]
    fn every_task_of_the_paper_is_read_as_it_was_written() {
        let tasks = tasks();
        assert!(tasks.iter().any(|task| task.starts_from().is_some()), "some runs start from others");
        for task in tasks {
            let text = task.to_text().expect("it can be written");
            assert_eq!(TrainingTask::parse(&text).expect("it can be read"), task);
        }
    }

    #[test]
    fn a_task_with_an_invalid_value_or_name_is_refused() {
        let text = tasks()[0].to_text().expect("it can be written");
        for (from, to, why) in [
            ("gamma: ", "gamma: 7", "`config.preset.learning.gamma` is 7"),
            ("name: \"", "name: \"../", "is not that of a folder; help:"),
            ("tests: ", "test: ", "did you mean `tests`"),
        ] {
            let error = TrainingTask::parse(&text.replacen(from, to, 1)).expect_err(to).to_string();
            assert!(error.contains("<task>") && error.contains(why), "{error}");
        }
    }
}
