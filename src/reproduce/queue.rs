//! The queue of training runs. It returns the runs that can start, and collects the results.

use std::collections::BTreeSet;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Condvar, Mutex, PoisonError};

use super::plan::RunPlan;
use crate::run::RunError;
use crate::run::preset::Budget;

/// The training runs of a plan: which of them wait and which are done.
pub struct Queue<'a> {
    plan: &'a RunPlan,
    state: Mutex<State>,
    changed: Condvar,
}

struct State {
    /// Training runs not started yet, the most urgent first.
    waiting: Vec<usize>,
    done: BTreeSet<usize>,
    running: usize,
    failed: Option<RunError>,
}

impl<'a> Queue<'a> {
    pub fn new(plan: &'a RunPlan) -> Self {
        let mut waiting: Vec<usize> = (0..plan.training_runs.len()).collect();
        // Runs that others start from come first, then the longest, so that all cores stay busy until the end.
        let urgency = |&index: &usize| {
            let is_origin = plan.training_runs.iter().any(|t| t.origin == Some(index));
            // For a rough comparison, an episode counts as 2,000 env steps.
            let length = match plan.training_runs[index].config.preset.budget {
                Budget::Episodes(n) => n,
                Budget::EnvSteps(n) => n / 2000,
            };
            (std::cmp::Reverse(is_origin), std::cmp::Reverse(length))
        };
        waiting.sort_by_key(urgency);
        let state = State { waiting, done: BTreeSet::new(), running: 0, failed: None };
        Self { plan, state: Mutex::new(state), changed: Condvar::new() }
    }

    /// Returns the next training run that can start; waits for one if necessary. `None` if none can start any more, or
    /// after a stop or a failure.
    pub fn next(&self, stop: &AtomicBool) -> Option<usize> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if stop.load(Ordering::Relaxed) || state.failed.is_some() || state.waiting.is_empty() {
                return None;
            }
            let ready = |&index: &usize| match self.plan.training_runs[index].origin {
                Some(from) => state.done.contains(&from),
                None => true,
            };
            if let Some(at) = state.waiting.iter().position(ready) {
                state.running += 1;
                return Some(state.waiting.remove(at));
            }
            if state.running == 0 {
                return None;
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Records the result of training run `index`: `Ok(true)` if it is finished, `Ok(false)` if it was stopped.
    ///
    /// After a failure, `stop` is set: the other runs write a checkpoint and stop.
    pub fn finish(&self, index: usize, result: Result<bool, RunError>, stop: &AtomicBool) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.running -= 1;
        match result {
            Ok(true) => {
                state.done.insert(index);
            }
            Ok(false) => {}
            Err(error) => {
                let name = &self.plan.training_runs[index].name;
                let error = match error {
                    RunError::Failed(why) => RunError::Failed(format!("{name}: {why}")),
                    other => other,
                };
                state.failed.get_or_insert(error);
                stop.store(true, Ordering::Relaxed);
            }
        }
        self.changed.notify_all();
    }

    /// The number of finished training runs.
    ///
    /// # Errors
    /// A run failed; the error is that of the first one.
    pub fn into_result(self) -> Result<usize, RunError> {
        let state = self.state.into_inner().unwrap_or_else(PoisonError::into_inner);
        state.failed.map_or(Ok(state.done.len()), Err)
    }
}
