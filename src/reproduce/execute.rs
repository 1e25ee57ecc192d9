//! Carries out a plan: every training and every test of it, several at a time, each once and for all.
//!
//! In: a [`RunPlan`], a folder. Out: a folder for each training in it, with its trials. A run depends on its
//! configuration alone, so no result depends on how many are under way at a time, or in what order, or whether it was
//! stopped and taken up again.

use std::collections::BTreeSet;
use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Condvar, Mutex, PoisonError};
use std::thread;
use std::time::Instant;

use super::plan::{RunPlan, Training};
use super::policy_test;
use super::progress::OverallProgress;
use crate::policy::Policy;
use crate::run::folder::RunFolder;
use crate::run::metric_rows::Summary;
use crate::run::preset::Budget;
use crate::run::train::{CHECKPOINT_INTERVAL, Job, train};
use crate::run::{RunError, checkpoint};
use crate::simulation::Extensions;

/// Carries out all of `plan` in folders under `folder`, `jobs` runs side by side.
///
/// # Errors
/// The first run that failed (the others are stopped, their checkpoints kept); or `stop` was set.
pub fn execute(
    plan: &RunPlan,
    folder: &Path,
    jobs: usize,
    stop: &'static AtomicBool,
) -> Result<(), RunError> {
    let board = OverallProgress::new(&plan.trainings);
    let queue = Queue::new(plan);
    let worker = || {
        while let Some(index) = queue.next(stop) {
            // A run that panics must be reported too, or others would wait for it for ever.
            let run = AssertUnwindSafe(|| one(plan, index, folder, &board, stop));
            let done = catch_unwind(run).unwrap_or_else(|_| {
                Err(RunError::Failed("ended unexpectedly (its own message stands above)".into()))
            });
            queue.done(index, done, stop);
        }
    };
    thread::scope(|scope| {
        for _ in 0..jobs.max(1) {
            scope.spawn(worker);
        }
    });
    board.finish();
    let state = queue.state.into_inner().unwrap_or_else(PoisonError::into_inner);
    match state.failed {
        Some(error) => Err(error),
        None if state.done.len() < plan.trainings.len() => Err(RunError::Failed(format!(
            "stopped after {} of {} runs; the same command goes on from there",
            state.done.len(),
            plan.trainings.len()
        ))),
        None => Ok(()),
    }
}

/// What is still to be done.
struct Queue<'a> {
    plan: &'a RunPlan,
    state: Mutex<State>,
    changed: Condvar,
}

struct State {
    /// Not begun yet, the most urgent first.
    waiting: Vec<usize>,
    done: BTreeSet<usize>,
    under_way: usize,
    failed: Option<RunError>,
}

impl<'a> Queue<'a> {
    fn new(plan: &'a RunPlan) -> Self {
        let mut waiting: Vec<usize> = (0..plan.trainings.len()).collect();
        // Those that others wait for first, then the longest: so no core is left without work for long at the end.
        let urgency = |&index: &usize| {
            let awaited = plan.trainings.iter().any(|t| t.origin == Some(index));
            let length = match plan.trainings[index].config.preset.budget {
                Budget::Episodes(n) => n,
                Budget::EnvSteps(n) => n / 2000,
            };
            (std::cmp::Reverse(awaited), std::cmp::Reverse(length))
        };
        waiting.sort_by_key(urgency);
        let state = State { waiting, done: BTreeSet::new(), under_way: 0, failed: None };
        Self { plan, state: Mutex::new(state), changed: Condvar::new() }
    }

    /// The next training that can begin; waits for one if need be. None when there is nothing left to do.
    fn next(&self, stop: &AtomicBool) -> Option<usize> {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        loop {
            if stop.load(Ordering::Relaxed) || state.failed.is_some() || state.waiting.is_empty() {
                return None;
            }
            let ready = |&index: &usize| match self.plan.trainings[index].origin {
                Some(from) => state.done.contains(&from),
                None => true,
            };
            if let Some(at) = state.waiting.iter().position(ready) {
                state.under_way += 1;
                return Some(state.waiting.remove(at));
            }
            if state.under_way == 0 {
                return None;
            }
            state = self.changed.wait(state).unwrap_or_else(PoisonError::into_inner);
        }
    }

    /// Training `index` has come to an end: finished, stopped or failed.
    fn done(&self, index: usize, result: Result<bool, RunError>, stop: &AtomicBool) {
        let mut state = self.state.lock().unwrap_or_else(PoisonError::into_inner);
        state.under_way -= 1;
        match result {
            Ok(true) => {
                state.done.insert(index);
            }
            Ok(false) => {}
            Err(error) => {
                let name = &self.plan.trainings[index].name;
                let error = match error {
                    RunError::Failed(why) => RunError::Failed(format!("{name}: {why}")),
                    invalid_input => invalid_input,
                };
                state.failed.get_or_insert(error);
                // Runs under way stop at their next step, with a checkpoint.
                stop.store(true, Ordering::Relaxed);
            }
        }
        self.changed.notify_all();
    }
}

/// Trains and tests training `index`; false if it was stopped.
fn one(
    plan: &RunPlan,
    index: usize,
    folder: &Path,
    board: &Arc<OverallProgress>,
    stop: &'static AtomicBool,
) -> Result<bool, RunError> {
    let training = &plan.trainings[index];
    let path = folder.join(&training.name);
    let before = is_finished(training, &path);
    if !before && !train_it(plan, index, folder, board, stop)? {
        return Ok(false);
    }
    test_it(training, &path)?;
    board.done(index, before);
    Ok(true)
}

/// Whether the run in `path` is the one that is wanted, has come to the end of its budget, and has kept all that is
/// wanted.
fn is_finished(training: &Training, path: &Path) -> bool {
    let Some(summary) = Summary::read(path) else { return false };
    let long_enough = match training.config.preset.budget {
        Budget::Episodes(n) => summary.episodes >= n,
        Budget::EnvSteps(n) => summary.env_steps >= n,
    };
    let kept = |&episodes: &u64| path.join(RunFolder::policy_after_file(episodes)).exists();
    let same = RunFolder::open(path).is_ok_and(|(_, mut there)| {
        there.preset.budget = training.config.preset.budget;
        there.save_policy_after_episodes.clone_from(&training.config.save_policy_after_episodes);
        there == training.config
    });
    summary.finished && long_enough && same && training.config.save_policy_after_episodes.iter().all(kept)
}

/// Trains, from the last checkpoint if there is one that fits; false if it was stopped.
fn train_it(
    plan: &RunPlan,
    index: usize,
    folder: &Path,
    board: &Arc<OverallProgress>,
    stop: &'static AtomicBool,
) -> Result<bool, RunError> {
    let training = &plan.trainings[index];
    let path = folder.join(&training.name);
    let began = Instant::now();
    let listener = || Some(board.listener(index, training));
    let mut gone_on = None;
    if RunFolder::open(&path).is_ok_and(|(_, there)| there == training.config) && checkpoint::exists(&path) {
        match train(
            Job::Resume { folder: path.clone(), budget: None, extensions: Extensions::default() },
            CHECKPOINT_INTERVAL,
            stop,
            began,
            listener(),
        ) {
            Ok((_, summary)) => gone_on = Some(summary),
            // A checkpoint that cannot be used, or one of the very end, when the summary was not yet written.
            Err(RunError::InvalidInput(_)) => {}
            Err(error) => return Err(error),
        }
    }
    let summary = match gone_on {
        Some(summary) => summary,
        None => {
            // What is there is the beginning of the same run, or too short a run to be of use: it can be made again.
            if path.exists() {
                fs::remove_dir_all(&path).map_err(|error| RunError::failed(&path, error))?;
            }
            let config = Box::new(training.config.clone());
            let job = Job::New { config, policy: origin(plan, training, folder)?, out: Some(path.clone()) };
            train(job, CHECKPOINT_INTERVAL, stop, began, listener())?.1
        }
    };
    if !summary.finished {
        return Ok(false);
    }
    // Hundreds of megabytes over all runs, and of no more use.
    let kept = path.join("checkpoint");
    fs::remove_dir_all(&kept).map_err(|error| RunError::failed(&kept, error))?;
    Ok(true)
}

/// The policy that a training starts from, if any.
fn origin(plan: &RunPlan, training: &Training, folder: &Path) -> Result<Option<Policy>, RunError> {
    let (Some(transfer), Some(from)) = (&training.config.transfer, training.origin) else {
        return Ok(None);
    };
    let name = Path::new(&transfer.policy).file_name().unwrap_or_default();
    policy_test::read_policy(&folder.join(&plan.trainings[from].name).join(name)).map(Some)
}

/// Makes the trials that are wanted and not yet noted.
fn test_it(training: &Training, path: &Path) -> Result<(), RunError> {
    let mut trials = policy_test::read_results(path);
    let noted = trials.len();
    for &(which, rule) in &training.tests {
        if policy_test::find(&trials, which, rule).is_none() {
            trials.push(policy_test::run(path, &training.config.scenario, which, rule)?);
        }
    }
    if trials.len() > noted {
        let (folder, _) = RunFolder::open(path)?;
        policy_test::write_results(&folder, &trials)?;
    }
    Ok(())
}
