//! The start of a training loop: a new run, or a resumed one.

use std::fs::File;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::Instant;

use super::{Run, remaining};
use crate::learning::Learner;
use crate::policy::Policy;
use crate::run::background_evaluator::BackgroundEvaluator;
use crate::run::checkpoint::{self, LoadedCheckpoint, TrainerState};
use crate::run::folder::{EPISODES_FILE, INITIAL_POLICY_FILE, POLICY_FILE, RunConfig, RunFolder};
#[cfg(unix)]
use crate::run::memory_limit;
use crate::run::metric_rows::Summary;
use crate::run::metrics_writer::MetricsWriter;
use crate::run::preset::Budget;
use crate::run::progress::{ProgressListener, ProgressReporter, ProgressTotal};
use crate::run::training_setup::{self, create_learner};
use crate::run::{RunError, metrics, policy_card, processor, without_help};
use crate::simulation::Extensions;

impl Run {
    pub(super) fn start(
        config: RunConfig,
        policy: Option<Policy>,
        out: Option<PathBuf>,
        began: Instant,
        listener: Option<ProgressListener>,
    ) -> Result<Self, RunError> {
        // These checks come before the folder is created, so that invalid input leaves no empty folder.
        #[cfg(unix)]
        memory_limit::check(&config)?;
        let learner = create_learner(&config, policy.as_ref())?;
        let initial_policy = policy.as_ref().map(metrics::policy_bytes).transpose()?;
        let folder = RunFolder::create(out, &config, initial_policy.as_deref())?;
        Self::from_scratch(config, folder, learner, began, listener)
    }

    fn from_scratch(
        config: RunConfig,
        folder: RunFolder,
        learner: Learner,
        began: Instant,
        listener: Option<ProgressListener>,
    ) -> Result<Self, RunError> {
        let mut run = Self::open(config, folder, learner, TrainerState::default(), began, listener)?;
        run.save()?;
        Ok(run)
    }

    pub(super) fn resume(
        path: &Path,
        budget: Option<Budget>,
        extensions: &Extensions,
        began: Instant,
        listener: Option<ProgressListener>,
    ) -> Result<Self, RunError> {
        let (folder, config) = RunFolder::open(path)?;
        let folder = folder.locked()?;
        let config = config.resume_with_extensions(extensions, path)?;
        let earlier_budget = config.preset.budget;
        let config = config.with_length(budget, None)?;
        #[cfg(unix)]
        memory_limit::check(&config)?;
        if !checkpoint::exists(path) && !has_rows(path) {
            // The run was killed before its first checkpoint, and so before its first step.
            let policy = config
                .transfer
                .as_ref()
                .map(|_| policy_card::read(&path.join(INITIAL_POLICY_FILE)))
                .transpose()?;
            let learner = create_learner(&config, policy.as_ref())?;
            folder.write_config(&config)?;
            return Self::from_scratch(config, folder, learner, began, listener);
        }
        let LoadedCheckpoint { trainer_state, learner, skipped } = checkpoint::load(&folder, &config)?;
        let budget = config.preset.budget;
        if remaining(budget, &learner) == 0 && is_complete(path, &learner) {
            let done = match budget {
                Budget::Episodes(_) => format!("{} episodes", learner.episodes()),
                Budget::EnvSteps(_) => format!("{} env steps", learner.env_steps()),
            };
            return Err(RunError::invalid_input(
                path,
                format!(
                    "this run already has {done}; help: give --episodes or --steps a larger number (counted from the \
                     start of the run)"
                ),
            ));
        }
        if budget != earlier_budget {
            check_not_passed(path, budget, &config, &learner)?;
        }
        checkpoint::mark_damaged(&skipped)?;
        if budget != earlier_budget {
            folder.write_config(&config)?;
        }
        let env_steps = learner.env_steps();
        let mut run = Self::open(config, folder, learner, trainer_state, began, listener)?;
        for (_, error) in skipped {
            let error = error.to_string();
            // Its help is about a run without a readable checkpoint.
            let why = without_help(&error);
            run.progress.warn(&format!("{why}; resuming from an older checkpoint, at {env_steps} env steps"));
        }
        checkpoint::restore(run.simulation.world_mut(), &run.trainer_state);
        if let Some(best) = &run.trainer_state.best {
            run.write_policy(POLICY_FILE, &best.bytes)?;
        }
        Ok(run)
    }

    fn open(
        config: RunConfig,
        folder: RunFolder,
        learner: Learner,
        trainer_state: TrainerState,
        began: Instant,
        listener: Option<ProgressListener>,
    ) -> Result<Self, RunError> {
        processor::record(&folder)?;
        let (scenario, plugins) = (Arc::new(config.scenario.clone()), config.simulation_plugins());
        let preset = &config.preset;
        let env_steps = learner.env_steps();
        let budget = match preset.budget {
            Budget::Episodes(n) => ProgressTotal::Episodes(n),
            Budget::EnvSteps(n) => ProgressTotal::EnvSteps(n),
        };
        Ok(Self {
            simulation: training_setup::training(&scenario, preset, config.seed, learner, &plugins),
            evaluator: BackgroundEvaluator::new(&scenario, metrics::evaluation_episodes(&config), &plugins),
            metrics_writer: MetricsWriter::open(&folder, &trainer_state, env_steps, &config)?,
            progress: listener
                .map_or_else(|| ProgressReporter::new(budget, false), ProgressReporter::with_listener),
            earlier_s: trainer_state.wall_s,
            trainer_state,
            began,
            last_checkpoint: Instant::now(),
            folder,
            config,
        })
    }
}

/// Whether the run in `folder` has its final summary. A run that was killed between its last checkpoint and its summary has
/// none, or that of an earlier process.
fn is_complete(folder: &Path, learner: &Learner) -> bool {
    Summary::read(folder).is_some_and(|s| s.finished && s.env_steps == learner.env_steps())
}

/// Checks that the run in `folder` has not passed the new `budget`: its configuration would no longer describe it.
///
/// # Errors
/// It has passed the budget by at least the number of arenas. A run ends after a whole control step of all arenas, so it can
/// pass its budget by less than that.
fn check_not_passed(
    folder: &Path,
    budget: Budget,
    config: &RunConfig,
    learner: &Learner,
) -> Result<(), RunError> {
    let (flag, given, done, unit) = match budget {
        Budget::Episodes(n) => ("--episodes", n, learner.episodes(), "episodes"),
        Budget::EnvSteps(n) => ("--steps", n, learner.env_steps(), "env steps"),
    };
    if done.saturating_sub(given) < config.preset.arenas as u64 {
        return Ok(());
    }
    let why = format!(
        "this run already has {done} {unit}, more than {flag} {given}; help: give {flag} a larger number (counted from the start \
         of the run), or leave it out to keep the budget"
    );
    Err(RunError::invalid_input(folder, why))
}

/// Whether `episodes.csv` in `folder` has a row after its header.
fn has_rows(folder: &Path) -> bool {
    let Ok(file) = File::open(folder.join(EPISODES_FILE)) else { return false };
    let mut file = BufReader::new(file);
    file.skip_until(b'\n').is_ok() && file.fill_buf().is_ok_and(|rest| !rest.is_empty())
}
