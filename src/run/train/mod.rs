//! The training loop: takes control steps, records metrics, evaluates, and keeps the best policy.
//!
//! In: a [`Job`] and a stop flag. Out: a run folder and its [`Summary`]. Wall time decides when a checkpoint
//! is written and what the progress bar shows, never what is learned.

mod start;

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use super::RunError;
use super::background_evaluator::{BackgroundEvaluator, EvalResult};
use super::checkpoint::{self, BestPolicy, TrainerState};
use super::final_test::{self, FinalTest};
use super::folder::{CHECKPOINT_FOLDER, POLICY_FILE, RunConfig, RunFolder};
use super::metric_rows::Summary;
use super::metrics;
use super::metrics_writer::MetricsWriter;
use super::notes::run_notes;
use super::preset::Budget;
use super::progress::{Progress, ProgressListener, ProgressReporter};
use super::provenance::Provenance;
use crate::agent::{ActiveLearner, TrainingWarning};
use crate::learning::Learner;
use crate::policy::Policy;
use crate::scenario::NoteLevel;
use crate::simulation::{Extensions, Simulation};

/// The default interval between checkpoints. A new run also writes one before its first step, and every run at its end.
pub const CHECKPOINT_INTERVAL: Duration = Duration::from_secs(30);

/// Maximum number of notes about questionable settings that a run prints.
const MAX_PRINTED_NOTES: usize = 10;

/// A new run, or one to resume.
pub enum Job {
    /// A new run.
    New {
        /// The run's configuration.
        config: Box<RunConfig>,
        /// The policy to start from, if any.
        policy: Option<Policy>,
        /// The run folder; `None` for the default one.
        out: Option<PathBuf>,
    },
    /// An existing run, resumed.
    Resume {
        /// The run folder.
        folder: PathBuf,
        /// A new budget, counted from the start of the run; `None` to keep the old one.
        budget: Option<Budget>,
        /// The plugins that the run was started with.
        extensions: Extensions,
    },
}

/// Runs `job` until its budget is used up or `stop` is set. Returns the run folder and the summary.
///
/// Checkpoints are written every `checkpoint_interval` and at the end; a new run also writes one before its first step.
/// Wall time is counted from `began`, the start of the process. Progress is shown on stderr, or passed to `listener` if
/// there is one.
///
/// # Errors
/// A file is invalid or cannot be written, or learning diverged. Earlier checkpoints are kept.
pub fn train(
    job: Job,
    checkpoint_interval: Duration,
    stop: &AtomicBool,
    began: Instant,
    listener: Option<ProgressListener>,
) -> Result<(PathBuf, Summary), RunError> {
    let mut run = match job {
        Job::New { config, policy, out } => Run::start(*config, policy, out, began, listener)?,
        Job::Resume { folder, budget, extensions } => {
            Run::resume(&folder, budget, &extensions, began, listener)?
        }
    };
    run.progress.line(&format!("{}: {}", run.folder.path().display(), run.config.description()));
    run.print_notes();
    let result = run.run_until_done(checkpoint_interval, stop);
    // Even after an error: wait for pending evaluations, and keep the rows that were written.
    let evaluated = run.await_evaluations();
    let flushed = run.metrics_writer.flush();
    result.map_err(|error| {
        let folder = run.folder.path().join(CHECKPOINT_FOLDER);
        error.with_remark(&format!("the last checkpoint is in {}", folder.display()))
    })?;
    evaluated?;
    flushed?;
    let summary = run.finish()?;
    Ok((run.folder.path().to_path_buf(), summary))
}

struct Run {
    config: RunConfig,
    simulation: Simulation,
    evaluator: BackgroundEvaluator,
    folder: RunFolder,
    metrics_writer: MetricsWriter,
    progress: ProgressReporter,
    trainer_state: TrainerState,
    began: Instant,
    /// Wall time of earlier processes, in s.
    earlier_s: f64,
    last_checkpoint: Instant,
}

impl Run {
    fn learner(&self) -> &Learner {
        &self.simulation.world().resource::<ActiveLearner>().0
    }

    /// The current policy, with its card.
    fn policy(&self) -> Policy {
        metrics::policy(&self.config, self.simulation.world())
    }

    fn wall_s(&self) -> f64 {
        self.earlier_s + self.began.elapsed().as_secs_f64()
    }

    /// Prints notes about questionable settings of the run.
    fn print_notes(&mut self) {
        let notes = run_notes(&self.config);
        for found in notes.iter().take(MAX_PRINTED_NOTES) {
            match found.note.level {
                NoteLevel::Warning => self.progress.warn(&found.to_string()),
                NoteLevel::Note => self.progress.line(&format!("note: {found}")),
            }
        }
        if let Some(more @ 1..) = notes.len().checked_sub(MAX_PRINTED_NOTES) {
            self.progress.line(&format!("note: and {more} more"));
        }
    }

    /// Takes control steps until the budget is used up or `stop` is set.
    fn run_until_done(&mut self, checkpoint_interval: Duration, stop: &AtomicBool) -> Result<(), RunError> {
        if self.learner().env_steps() == 0 {
            self.save_policies(|after| matches!(after, Budget::Episodes(0) | Budget::EnvSteps(0)))?;
        }
        self.submit_if_due()?;
        while remaining(self.config.preset.budget, self.learner()) > 0 && !stop.load(Ordering::Relaxed) {
            let before = (self.learner().episodes(), self.learner().env_steps());
            self.simulation.step()?;
            if let Some(warning) = self.simulation.world_mut().resource_mut::<TrainingWarning>().take_new() {
                self.progress.warn(&format!("{}: {warning}", self.folder.path().display()));
            }
            self.record_episodes()?;
            self.save_policy(before)?;
            self.submit_if_due()?;
            while let Some(eval_result) = self.evaluator.poll(false)? {
                self.record_evaluation(eval_result)?;
            }
            if self.last_checkpoint.elapsed() >= checkpoint_interval {
                self.save()?;
            }
            self.show_progress();
            self.metrics_writer.flush_if_due()?;
        }
        Ok(())
    }

    fn show_progress(&mut self) {
        let returns = &self.trainer_state.recent_returns;
        let mean_return = (!returns.is_empty()).then(|| returns.iter().sum::<f64>() / returns.len() as f64);
        let learner = &self.simulation.world().resource::<ActiveLearner>().0;
        self.progress.update(&Progress {
            episodes: learner.episodes(),
            env_steps: learner.env_steps(),
            gradient_steps: learner.gradient_steps(),
            mean_return,
            success_rate: self.trainer_state.last_success_rate,
            epsilon: learner.epsilon(),
        });
    }

    /// Writes a row for every episode that ended in the last step.
    fn record_episodes(&mut self) -> Result<(), RunError> {
        let wall_s = self.wall_s();
        for row in metrics::take_episode_rows(self.simulation.world_mut(), &mut self.trainer_state, wall_s) {
            self.metrics_writer.episode(&row)?;
        }
        Ok(())
    }

    /// Saves the current policy if the last step reached a number of episodes or env steps in `save_policy_after`.
    /// `episodes` and `env_steps` are the counts before the step.
    fn save_policy(&self, (episodes, env_steps): (u64, u64)) -> Result<(), RunError> {
        let learner = self.learner();
        self.save_policies(|after| match after {
            Budget::Episodes(n) => (episodes + 1..=learner.episodes()).contains(&n),
            Budget::EnvSteps(n) => (env_steps + 1..=learner.env_steps()).contains(&n),
        })
    }

    /// Saves the current policy for each entry of `save_policy_after` that is due.
    fn save_policies(&self, is_due: impl Fn(Budget) -> bool) -> Result<(), RunError> {
        for &after in self.config.save_policy_after.iter().filter(|&&after| is_due(after)) {
            self.write_policy(&RunFolder::policy_after_file(after), &metrics::policy_bytes(&self.policy())?)?;
        }
        Ok(())
    }

    /// Submits the current policy if an evaluation is due: before the first step, and at the preset's interval.
    fn submit_if_due(&mut self) -> Result<(), RunError> {
        if self.learner().env_steps() < self.trainer_state.next_evaluation {
            return Ok(());
        }
        self.trainer_state.next_evaluation += self.config.preset.evaluation.every_env_steps;
        self.submit()
    }

    /// Submits the current policy for evaluation, after waiting for the previous evaluation.
    fn submit(&mut self) -> Result<(), RunError> {
        self.await_evaluations()?;
        let candidate = metrics::candidate(&self.config, self.simulation.world());
        self.trainer_state.evaluated_at = Some(candidate.env_steps);
        self.evaluator.submit(candidate)
    }

    fn await_evaluations(&mut self) -> Result<(), RunError> {
        // The rows so far must be visible during the wait.
        self.metrics_writer.flush()?;
        while let Some(eval_result) = self.evaluator.poll(true)? {
            self.record_evaluation(eval_result)?;
        }
        Ok(())
    }

    /// Writes the row of an evaluation, and saves the policy if it is the best.
    fn record_evaluation(&mut self, eval_result: EvalResult) -> Result<(), RunError> {
        let wall_s = self.earlier_s + eval_result.done.duration_since(self.began).as_secs_f64();
        let metrics = metrics::record_evaluation(&mut self.trainer_state, eval_result, wall_s)?;
        self.metrics_writer.evaluation(&metrics.row)?;
        for rate in metrics.milestones_reached {
            self.progress.line(&format!(
                "{:.0}% reached after {} env steps, {wall_s:.1} s",
                100.0 * rate,
                metrics.row.env_steps
            ));
        }
        if let Some(best) = self.trainer_state.best.as_ref().filter(|_| metrics.is_best) {
            self.write_policy(POLICY_FILE, &best.bytes)?;
        }
        Ok(())
    }

    fn write_policy(&self, name: &str, bytes: &[u8]) -> Result<(), RunError> {
        self.folder.write(name, |file| std::io::Write::write_all(file, bytes))
    }

    /// Writes a checkpoint.
    fn save(&mut self) -> Result<(), RunError> {
        self.await_evaluations()?;
        (self.trainer_state.episodes_bytes, self.trainer_state.evaluations_bytes) =
            self.metrics_writer.sync()?;
        self.trainer_state.wall_s = self.wall_s();
        checkpoint::save(&self.folder, self.simulation.world_mut(), &mut self.trainer_state)?;
        self.last_checkpoint = Instant::now();
        Ok(())
    }

    /// Tests the best policy of a finished run on episodes that were not used to select it. `None` if there is no such
    /// policy, or the preset asks for no test.
    fn final_test(&mut self) -> Result<Option<FinalTest>, RunError> {
        let began = Instant::now();
        let Some(candidate) = final_test::candidate(&self.config, &self.trainer_state)? else {
            return Ok(None);
        };
        self.evaluator.submit(candidate)?;
        let Some(tested) = self.evaluator.poll(true)? else { return Ok(None) };
        Ok(Some(FinalTest::new(tested.result?, began.elapsed().as_secs_f64())))
    }

    /// Writes the last checkpoint, evaluation and policy, the learning curves and the summary.
    ///
    /// The last evaluation comes after the checkpoint, because a run with a larger budget would not evaluate at this
    /// point, and a resumed run must equal an uninterrupted one.
    fn finish(&mut self) -> Result<Summary, RunError> {
        self.save()?;
        let finished = remaining(self.config.preset.budget, self.learner()) == 0;
        if self.trainer_state.evaluated_at != Some(self.learner().env_steps()) {
            self.submit()?;
            self.await_evaluations()?;
        }
        self.metrics_writer.sync()?;
        let wall_s = self.wall_s();
        self.write_policy("policy-last.safetensors", &metrics::policy_bytes(&self.policy())?)?;
        self.metrics_writer.draw(&self.config)?;
        let final_test = if finished { self.final_test()? } else { None };

        let summary = self.summary(finished, wall_s, final_test)?;
        let text = serde_json::to_string_pretty(&summary).map_err(|e| RunError::Failed(e.to_string()))?;
        // The summary comes last: everything that it counts is in the folder.
        self.folder.write("summary.json", |file| std::io::Write::write_all(file, text.as_bytes()))?;
        let how = if finished { "done" } else { "stopped" };
        self.progress.finish(&format!("{how}: {}", self.folder.path().display()));
        Ok(summary)
    }

    fn summary(
        &self,
        finished: bool,
        wall_s: f64,
        final_test: Option<FinalTest>,
    ) -> Result<Summary, RunError> {
        let best = self.trainer_state.best.as_ref();
        let learner = self.learner();
        Ok(Summary {
            provenance: Provenance::of_run(&self.config),
            scenario: self.config.scenario_title().into(),
            scenario_from: self.config.scenario_from.clone(),
            preset: self.config.preset_from.clone(),
            seed: self.config.seed,
            finished,
            episodes: learner.episodes(),
            env_steps: learner.env_steps(),
            gradient_steps: learner.gradient_steps(),
            wall_s,
            evaluations: self.metrics_writer.evaluations()?,
            best_success_rate: best.map(|b| b.success_rate),
            best_mean_time_s: best.and_then(|b| b.mean_time_s),
            best_env_steps: best.and_then(BestPolicy::env_steps),
            last_success_rate: self.trainer_state.last_success_rate,
            first_96: self.trainer_state.first_96,
            first_99: self.trainer_state.first_99,
            final_test,
        })
    }
}

/// The remaining part of a budget, in the budget's unit.
fn remaining(budget: Budget, learner: &Learner) -> u64 {
    match budget {
        Budget::Episodes(n) => n.saturating_sub(learner.episodes()),
        Budget::EnvSteps(n) => n.saturating_sub(learner.env_steps()),
    }
}
