//! The mode `--train`: starts a new training run, or resumes one.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use clap::Args;

use super::check::kind::{FileKind, expect_kind};
use super::output::{print_json, print_stdout};
use super::policy;
use super::shared::SharedArgs;
use super::values;
use crate::limits::MAX_ARENAS;
use crate::report::format::percent;
use crate::run::RunError;
use crate::run::folder::{INITIAL_POLICY_FILE, POLICY_FILE, RunConfig, RunFolder, Transfer};
use crate::run::metric_rows::{Milestone, Summary};
use crate::run::preset::Budget;
use crate::run::progress::print_stderr;
use crate::run::provenance::{COMMIT, VERSION};
use crate::run::signals::stop_on_signal;
use crate::run::train::{CHECKPOINT_INTERVAL, Job, train};
use crate::scenario::{printable_path, quoted};

/// The options of `--train`.
#[derive(Args, Debug)]
#[command(next_help_heading = "Options of --train")]
pub struct TrainArgs {
    /// Stop after N env steps over all arenas, rounded up to whole control steps [default: the preset's
    /// budget]
    #[arg(long, value_name = "N", conflicts_with = "episodes", value_parser = values::budget, allow_negative_numbers = true)]
    steps: Option<u64>,

    /// Number of parallel arenas [default: the preset's]
    #[arg(long, value_name = "N", value_parser = values::whole::<usize>(1..=MAX_ARENAS as u64), allow_negative_numbers = true)]
    arenas: Option<usize>,

    /// Start from the weights of a policy (transfer)
    #[arg(long, value_name = "POLICY")]
    init: Option<PathBuf>,

    /// Initial epsilon with --init (the paper: 0.5) [default: the preset's]
    #[arg(long, value_name = "X", requires = "init", value_parser = values::fraction, allow_negative_numbers = true)]
    epsilon: Option<f32>,

    /// Continue the run in DIR exactly where it stopped (--train may be left out); --episodes or --steps sets a
    /// larger budget, counted from the start of the run
    #[arg(long, value_name = "DIR",
        conflicts_with_all = ["scenario", "preset", "set", "seed", "arenas", "out", "init", "epsilon"])]
    pub resume: Option<PathBuf>,

    /// Write a checkpoint every S seconds; the interval does not change what is learned [default: 30].
    #[cfg_attr(
        feature = "gui",
        doc = "In the app: save the training run automatically every S seconds [default: 25]"
    )]
    #[arg(long, value_name = "S", value_parser = values::seconds, allow_negative_numbers = true)]
    pub checkpoint_every: Option<Duration>,
}

/// What the first signal prints.
pub const SAVING: &str = "saving a checkpoint, then stopping (a second Ctrl-C quits without saving)";

/// Trains, and prints the run's summary. `again` is the run to repeat: its folder or `config.ron`.
///
/// # Errors
/// An option or a file is invalid, the run failed, or a signal stopped it.
pub fn run(
    again: Option<PathBuf>,
    args: TrainArgs,
    shared: SharedArgs,
    began: Instant,
) -> Result<(), RunError> {
    let json = shared.json;
    let checkpoint_interval = args.checkpoint_every.unwrap_or(CHECKPOINT_INTERVAL);
    let budget = shared.episodes.map(Budget::Episodes).or(args.steps.map(Budget::EnvSteps));
    let job = match args.resume {
        Some(_) if again.is_some() => {
            let why =
                "--resume continues a run, and --train with a file repeats one; help: leave out one of them";
            return Err(RunError::InvalidInput(why.into()));
        }
        Some(folder) => Job::Resume { folder, budget, extensions: shared.extensions },
        None => new_run(again.as_deref(), args, shared, budget)?,
    };
    let (folder, summary) = train(job, checkpoint_interval, stop_on_signal(SAVING), began, None)?;
    if json { print_json(&summary) } else { print_stdout(&summary_text(&folder, &summary)) }?;
    if summary.finished {
        return Ok(());
    }
    let folder = quoted(folder);
    Err(RunError::Stopped(format!("stopped; help: `{} --resume {folder}` continues", program())))
}

/// A new training run, or a repetition of the run `again`.
fn new_run(
    again: Option<&Path>,
    args: TrainArgs,
    shared: SharedArgs,
    budget: Option<Budget>,
) -> Result<Job, RunError> {
    let settings = shared.settings();
    let (config, init) = match again {
        Some(path) => earlier_run(path, &args, &shared)?,
        None => {
            let scenario = shared.scenario.as_deref();
            (RunConfig::resolve_default(scenario, shared.preset(), shared.seed())?, args.init.clone())
        }
    };
    let config = config.with_settings(&settings)?.with_extensions(&shared.extensions);
    if !settings.is_empty() {
        print_stderr(&format!("set {settings}"));
    }
    let mut config = config.with_length(budget, args.arenas)?;
    let read = |path: &PathBuf| policy::read(path, &config.scenario, &shared.extensions);
    let policy = init.as_ref().map(read).transpose()?;
    if let Some(init) = args.init {
        config.transfer = Some(Transfer { policy: init.display().to_string(), epsilon: args.epsilon });
    }
    Ok(Job::New { config: Box::new(config), policy, out: shared.out })
}

/// The configuration that repeats the earlier run at `path` (its folder or its `config.ron`), and the file of the policy that the
/// run started from.
fn earlier_run(
    path: &Path,
    args: &TrainArgs,
    shared: &SharedArgs,
) -> Result<(RunConfig, Option<PathBuf>), RunError> {
    let given = [
        ("--scenario", shared.scenario.is_some()),
        ("--preset", shared.preset.is_some()),
        ("--init", args.init.is_some()),
    ];
    if let Some((flag, _)) = given.into_iter().find(|(_, is_given)| *is_given) {
        let why =
            format!("the run to repeat has its own; help: leave out {flag}, or use --train without a file");
        return Err(RunError::InvalidInput(format!("{flag}: {why}")));
    }
    let file = if path.is_dir() { path.join(RunFolder::CONFIG_FILE) } else { path.into() };
    expect_kind(&file, FileKind::RunConfig)?;
    let mut config = RunConfig::load(&file)?.resume_with_extensions(&shared.extensions, &file)?;
    config.version = VERSION.into();
    config.commit = COMMIT.map(String::from);
    config.seed = shared.seed.unwrap_or(config.seed);
    let copy = file.with_file_name(INITIAL_POLICY_FILE);
    let init = config.transfer.as_ref().map(|transfer| match copy.exists() {
        true => copy,
        false => transfer.policy.clone().into(),
    });
    Ok((config, init))
}

fn summary_text(folder: &Path, summary: &Summary) -> String {
    let percent = |rate: Option<f64>| rate.map_or("-".into(), percent);
    let seconds = |s: Option<f64>| s.map_or("-".into(), |s| format!("{s:.2} s"));
    let first = |m: &Option<Milestone>| match m {
        Some(m) => format!("{} env steps, {} episodes, {:.1} s", m.env_steps, m.episodes, m.wall_s),
        None => "not reached".into(),
    };
    let final_test = match &summary.final_test {
        Some(test) => {
            let [low, high] = test.success_interval.map(|rate| percent(Some(rate)));
            format!(
                "{} success (95% interval {low} to {high}), mean time {}, {} new episodes (seed {}); report this number",
                percent(Some(test.success_rate)),
                seconds(test.mean_time_s),
                test.episodes,
                test.seed
            )
        }
        None if summary.finished => "none: the preset asks for none".into(),
        None => "none yet: it follows at the end of training".into(),
    };
    let best_at = match summary.best_env_steps {
        Some(0) => ", at env step 0, before any training".into(),
        Some(n) => format!(", at env step {n}"),
        None => String::new(),
    };
    let Summary { episodes, env_steps, gradient_steps, wall_s, .. } = summary;
    format!(
        "best policy     {} success, mean time {}, in the best of {} evaluations (optimistic){}\n\
         final test      {final_test}\n\
         last policy     {} success\n\
         first 96%       {}\n\
         first 99%       {}\n\
         trained         {episodes} episodes, {env_steps} env steps, {gradient_steps} gradient steps, {wall_s:.1} s\n\
         run folder      {}\n\
         test it         {}\n",
        percent(summary.best_success_rate),
        seconds(summary.best_mean_time_s),
        summary.evaluations,
        best_at,
        percent(summary.last_success_rate),
        first(&summary.first_96),
        first(&summary.first_99),
        printable_path(folder),
        eval_command(folder),
    )
}

/// The command that tests the run's best policy, in the run's scenario.
fn eval_command(folder: &Path) -> String {
    format!("{} --eval {}", program(), quoted(folder.join(POLICY_FILE)))
}

/// The name by which the program was started, quoted for a shell.
fn program() -> String {
    super::PROGRAM.get().map_or_else(|| "wayfield".into(), quoted)
}
