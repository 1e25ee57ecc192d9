//! A training as a task for another machine: all that it needs, in one text.
//!
//! In: a training of a plan, or the configuration of a single run. Out: a [`TrainingTask`] as RON, which another process with
//! the same version of wayfield carries out. It needs no other file, except the policy that the training starts from.

use std::collections::BTreeSet;
use std::path::Path;
use std::sync::atomic::AtomicBool;

use serde::{Deserialize, Serialize};

use super::arm_run::PolicyId;
use super::execute::{is_done, train_and_test};
use super::experiment::{TestRule, TestedPolicy};
use super::plan::Training;
use super::progress::gradient_steps;
use super::run_config::run_name;
use crate::run::RunError;
use crate::run::folder::RunConfig;
use crate::run::progress::ProgressListener;
use crate::scenario::{Diagnostic, parse_checked, to_ron};

/// A training and its tests.
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

impl From<&Training> for TrainingTask {
    fn from(training: &Training) -> Self {
        let Training { name, config, tests, .. } = training.clone();
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

    /// The task in the RON text of [`to_text`](Self::to_text).
    ///
    /// # Errors
    /// The text is not a task, or has invalid values.
    pub fn parse(text: &str) -> Result<Self, RunError> {
        let diagnostics = |task: &Self| -> Vec<Diagnostic> { task.config.diagnostics() };
        let task: Self = parse_checked(text, "<task>", |task, _| diagnostics(task), diagnostics)?;
        if Path::new(&task.name).file_name() != Some(task.name.as_ref()) {
            let why = format!(
                "<task>: the name {:?} is not that of a folder; help: pass on the text unchanged",
                task.name
            );
            return Err(RunError::InvalidInput(why));
        }
        Ok(task)
    }

    /// The task as RON.
    ///
    /// # Errors
    /// None that is known.
    pub fn to_text(&self) -> Result<String, RunError> {
        to_ron(self).map_err(|error| RunError::Failed(error.to_string()))
    }

    /// The name of the run's folder.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The file with the policy that the training starts from, relative to the folder of all runs.
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

    /// Trains and tests in the folder `runs`, and calls the listener with the progress. What is done already is not repeated.
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

    fn training(&self) -> Training {
        let Self { name, config, tests } = self.clone();
        Training { name, config, origin: None, tests, elsewhere: None }
    }
}
