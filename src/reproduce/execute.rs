//! The execution of a plan: trains and tests, several runs in parallel.
//!
//! In: a [`RunPlan`] and a folder. Out: a run folder for each training run, with its test results. A run depends only on
//! its configuration, so no result depends on the number of parallel runs, on their order, or on interruptions.

use std::fs;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::thread;
use std::time::Instant;

use super::plan::{PlannedRun, RunPlan};
use super::policy_test;
use super::progress::OverallProgress;
use super::queue::Queue;
use crate::policy::Policy;
use crate::run::folder::{CHECKPOINT_FOLDER, RunConfig, RunFolder};
use crate::run::lock::Lock;
use crate::run::metric_rows::Summary;
use crate::run::preset::Budget;
use crate::run::progress::ProgressListener;
use crate::run::train::{CHECKPOINT_INTERVAL, Job, train};
use crate::run::{RunError, checkpoint};
use crate::simulation::Extensions;

/// Trains and tests all runs of `plan` in folders below `folder`, `jobs` at a time.
///
/// # Errors
/// A run failed (the others are stopped and keep their checkpoints), or `stop` was set.
pub fn execute(plan: &RunPlan, folder: &Path, jobs: usize, stop: &AtomicBool) -> Result<(), RunError> {
    let progress = OverallProgress::new(&plan.training_runs);
    let queue = Queue::new(plan);
    let worker = || {
        while let Some(index) = queue.next(stop) {
            // A panic must be recorded, or threads would wait forever for runs that start from this one.
            let work = AssertUnwindSafe(|| run(plan, index, folder, &progress, stop));
            let result = catch_unwind(work)
                .unwrap_or_else(|_| Err(RunError::Failed("panicked (see the message above)".into())));
            queue.finish(index, result, stop);
        }
    };
    thread::scope(|scope| {
        // This thread works too, so threads that cannot be started only cost time.
        for _ in 1..jobs {
            let _ = thread::Builder::new().spawn_scoped(scope, worker);
        }
        worker();
    });
    progress.finish();
    let (done, all) = (queue.into_result()?, plan.training_runs.len());
    if done < all {
        return Err(RunError::Stopped(format!(
            "stopped after {done} of {all} runs; help: the same command continues from there"
        )));
    }
    Ok(())
}

/// Trains and tests the run at `index`; `false` if it was stopped.
fn run(
    plan: &RunPlan,
    index: usize,
    folder: &Path,
    progress: &Arc<OverallProgress>,
    stop: &AtomicBool,
) -> Result<bool, RunError> {
    let training = &plan.training_runs[index];
    let was_finished = is_trained(training, folder);
    let is_done = train_and_test(training, folder, &|| progress.listener(index, training), stop)?;
    if is_done {
        progress.finish_run(index, was_finished);
    }
    Ok(is_done)
}

/// Trains and tests `training` below `folder`, which must contain the policy that the training starts from, if any. Finished
/// work is not repeated. Returns `false` if it was stopped.
///
/// # Errors
/// The run failed, or a file cannot be read or written.
pub fn train_and_test(
    training: &PlannedRun,
    folder: &Path,
    listener: &dyn Fn() -> ProgressListener,
    stop: &AtomicBool,
) -> Result<bool, RunError> {
    if !is_trained(training, folder) && !run_training(training, folder, listener, stop)? {
        return Ok(false);
    }
    run_tests(training, folder)?;
    Ok(true)
}

/// Whether nothing is left to do for `training` below `folder`.
#[must_use]
pub fn is_done(training: &PlannedRun, folder: &Path) -> bool {
    let results = policy_test::read_results(&folder.join(&training.name));
    let is_tested = |&(policy, rule)| policy_test::find(&results, policy, rule).is_some();
    is_trained(training, folder) && training.tests.iter().all(is_tested)
}

/// Whether `training` was done elsewhere, or `folder` holds a finished run with this configuration, at least this long, and with
/// all policies that are needed.
fn is_trained(training: &PlannedRun, folder: &Path) -> bool {
    if training.elsewhere.is_some() {
        return true;
    }
    let path = &folder.join(&training.name);
    let Some(summary) = Summary::read(path) else { return false };
    let long_enough = match training.config.preset.budget {
        Budget::Episodes(n) => summary.episodes >= n,
        Budget::EnvSteps(n) => summary.env_steps >= n,
    };
    let saved = |&after: &Budget| path.join(RunFolder::policy_after_file(after)).exists();
    let same = RunFolder::open(path).is_ok_and(|(_, mut config)| {
        config.preset.budget = training.config.preset.budget;
        config.save_policy_after.clone_from(&training.config.save_policy_after);
        is_equal(config, &training.config)
    });
    summary.finished && long_enough && same && training.config.save_policy_after.iter().all(saved)
}

/// Whether two configurations are equal, except perhaps in the program's commit: a report can be continued by a program of the
/// same version from another commit.
fn is_equal(mut found: RunConfig, planned: &RunConfig) -> bool {
    found.commit.clone_from(&planned.commit);
    found == *planned
}

/// Trains, from the latest checkpoint if there is a suitable one; `false` if it was stopped.
fn run_training(
    training: &PlannedRun,
    folder: &Path,
    listener: &dyn Fn() -> ProgressListener,
    stop: &AtomicBool,
) -> Result<bool, RunError> {
    let path = folder.join(&training.name);
    let began = Instant::now();
    let run = |job: Job| train(job, CHECKPOINT_INTERVAL, stop, began, Some(listener()));
    let mut resumed = None;
    let is_same_run = RunFolder::open(&path).is_ok_and(|(_, config)| is_equal(config, &training.config));
    if is_same_run && checkpoint::exists(&path) {
        match run(Job::Resume { folder: path.clone(), budget: None, extensions: Extensions::default() }) {
            Ok((_, summary)) => resumed = Some(summary),
            // The checkpoint is damaged, or is the final one of a run without a summary: train from the start.
            Err(RunError::InvalidInput(_)) => {}
            Err(error) => return Err(error),
        }
    }
    let summary = match resumed {
        Some(summary) => summary,
        None => {
            // The folder holds the beginning of the same run, or a run that is too short.
            if path.exists() {
                check_unused(&path)?;
                fs::remove_dir_all(&path).map_err(|error| RunError::failed(&path, error))?;
            }
            let config = Box::new(training.config.clone());
            run(Job::New { config, policy: origin(training, folder)?, out: Some(path.clone()) })?.1
        }
    };
    if !summary.finished {
        return Ok(false);
    }
    // Checkpoints of all runs would take hundreds of megabytes, and a finished run does not need them.
    let checkpoints = path.join(CHECKPOINT_FOLDER);
    fs::remove_dir_all(&checkpoints).map_err(|error| RunError::failed(&checkpoints, error))?;
    Ok(true)
}

/// Checks that no other process is writing in the run folder `path`, such as one that resumes the run.
fn check_unused(path: &Path) -> Result<(), RunError> {
    let lock = path.join(RunFolder::LOCK_FILE);
    if lock.exists() { Lock::acquire(path, &lock).map(drop) } else { Ok(()) }
}

/// Reads the policy that a training run starts from, if any. Its path is relative to `folder`.
fn origin(training: &PlannedRun, folder: &Path) -> Result<Option<Policy>, RunError> {
    let transfer = training.config.transfer.as_ref();
    transfer.map(|transfer| policy_test::read_policy(&folder.join(&transfer.policy))).transpose()
}

/// Runs the tests that have no result yet. The results are written below `folder`, even for a run from elsewhere.
fn run_tests(training: &PlannedRun, folder: &Path) -> Result<(), RunError> {
    let (from, into) = (training.folder(folder), folder.join(&training.name));
    let mut results = policy_test::read_results(&into);
    let known = results.len();
    for &(policy, rule) in &training.tests {
        if policy_test::find(&results, policy, rule).is_none() {
            results.push(policy_test::run(&from, &training.config.scenario, policy, rule)?);
        }
    }
    if results.len() > known {
        policy_test::write_results(&into, &results)?;
    }
    Ok(())
}
