//! The command line: what a user types becomes a job, what comes of it becomes text and an exit status.
//!
//! In: arguments. Out: results on stdout, logs and progress on stderr; exit status 0 on success, 1 when a run failed,
//! 2 for arguments or files that cannot be used.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

use clap::{ArgGroup, Parser};

#[cfg(feature = "gui")]
use crate::app::{
    commands::Pace,
    session::{StartOptions, journal},
    view_state::{Overlays, ThemeChoice},
    window::{self, ScreenshotRequest, WindowOptions},
};
use crate::learning::Policy;
use crate::planner::unsupported_reason;
use crate::reproduce::{Experiment, ReproduceOptions, reproduce};
use crate::run::check_files::{self, CheckedFile};
use crate::run::evaluate::{self, Evaluation, Evaluator};
use crate::run::folder::{RunConfig, Transfer};
use crate::run::metric_rows::{Milestone, Summary};
use crate::run::policy_card;
use crate::run::preset::{Budget, MAX_STEPS};
use crate::run::progress::print_stderr;
use crate::run::train::{CHECKPOINT_INTERVAL, Job, train};
use crate::run::{RunError, scenario_image, shipped};
use crate::scenario::Scenario;
use crate::task::EpisodeSetup;

const AFTER_HELP: &str = "\
Examples:
  wayfield                                           the window: watch it learn
  wayfield --train                                   Scenario I, in seconds, into runs/
  wayfield --eval runs/scenario-1-fast-0/policy.safetensors --course
  wayfield --train --scenario scenario-2 --init POLICY --epsilon 0.5
  wayfield --train --resume runs/scenario-1-fast-0 --steps 900000
  wayfield --reproduce --only fig9,table2 --seeds 3  two of the paper's results, into runs/reproduce/
  wayfield --check scenarios/                        whether all worlds in a folder can be used

Results go to stdout, logs and progress to stderr. Exit status: 0 success, 1 a run failed,
2 arguments or files that cannot be used. Ctrl-C saves a checkpoint and ends cleanly.";

/// A LIDAR robot learns to navigate, in seconds, by prioritized-replay double dueling DQN
#[derive(Parser, Debug)]
#[command(version, max_term_width = 110, after_help = AFTER_HELP, group(ArgGroup::new("mode").args(["train", "eval", "reproduce", "check", "draw"])),
    group(ArgGroup::new("writing").args(["train", "reproduce"]).multiple(true)))]
struct Arguments {
    // clap drops a `requires` whose object conflicts with what was given; so whatever requires --train also
    // conflicts with --eval and --reproduce, and so on; and with --check, which says so itself.
    /// Train: by default the preset `fast` in Scenario I, into a new folder under runs/
    #[arg(long, help_heading = "What to do")]
    train: bool,

    /// Test a policy greedily: success over rounds of episodes it has never seen
    #[arg(long, value_name = "POLICY", help_heading = "What to do")]
    eval: Option<PathBuf>,

    /// Reproduce the paper: train, test and report every figure and table over several seeds
    #[arg(long, help_heading = "What to do")]
    reproduce: bool,

    /// Say whether scenarios, presets and experiments can be used, files or whole folders of them, and what is wrong with them
    #[arg(long, value_name = "PATH", help_heading = "What to do", num_args = 1..,
        conflicts_with_all = ["scenario", "seed", "preset", "episodes", "steps", "arenas", "out", "init", "epsilon", "resume",
            "checkpoint_every", "rounds", "course", "optimum", "only", "seeds", "quick", "experiment", "jobs"])]
    check: Vec<PathBuf>,

    /// Draw the world from above, as an SVG or PNG file
    #[arg(long, value_name = "FILE", help_heading = "What to do",
        conflicts_with_all = ["seed", "preset", "episodes", "steps", "arenas", "out", "init", "epsilon", "resume", "json",
            "checkpoint_every", "rounds", "course", "optimum", "only", "seeds", "quick", "experiment", "jobs"])]
    draw: Option<PathBuf>,

    /// The world: a RON file, or a shipped one by name (scenario-1, scenario-2, empty, corridor, doorway,
    /// slalom, random-field, u-trap, crossing, crowd, hall, maze) [default: scenario-1]
    #[arg(long, value_name = "FILE", help_heading = "Training and testing",
        conflicts_with_all = ["resume", "reproduce"])]
    scenario: Option<String>,

    /// The seed of every random draw [default: 0]
    #[arg(long, value_name = "N", help_heading = "Training and testing", conflicts_with_all = ["resume", "reproduce"],
        value_parser = seed, allow_negative_numbers = true)]
    seed: Option<u64>,

    /// Print one JSON object instead of text
    #[arg(long, help_heading = "Training and testing", requires = "mode")]
    json: bool,

    /// How to learn: a RON file, or a shipped one by name (fast, per_d3qn, per_d3qn_tuned, dqn) [default: fast]
    #[arg(
        long,
        value_name = "FILE",
        help_heading = "Training and testing",
        conflicts_with_all = ["eval", "reproduce", "resume"]
    )]
    preset: Option<String>,

    /// Train until N episodes have ended [default: the preset's budget]; test over N episodes in a round [default: 100]
    #[arg(long, value_name = "N", help_heading = "Training and testing", conflicts_with_all = ["reproduce", "steps"],
        value_parser = budget, allow_negative_numbers = true)]
    episodes: Option<u64>,

    /// Train for N env steps over all arenas, rounded up to whole control steps [default: the preset's budget]
    #[arg(long, value_name = "N", help_heading = "Training", requires = "train", conflicts_with_all = ["eval", "reproduce"],
        value_parser = budget, allow_negative_numbers = true)]
    steps: Option<u64>,

    /// How many arenas run side by side [default: the preset's]
    #[arg(long, value_name = "N", help_heading = "Training", requires = "train", conflicts_with_all = ["eval", "reproduce", "resume"])]
    arenas: Option<usize>,

    /// The run's folder, which must not hold a run yet [default: runs/<scenario>-<preset>-<seed>]; with --reproduce the
    /// report's, which is taken up again if it holds one [default: runs/reproduce]
    #[arg(
        long,
        value_name = "DIR",
        help_heading = "Training",
        requires = "writing",
        conflicts_with_all = ["eval", "resume"]
    )]
    out: Option<PathBuf>,

    /// Start from a policy's weights (transfer)
    #[arg(
        long,
        value_name = "POLICY",
        help_heading = "Training",
        requires = "train",
        conflicts_with_all = ["eval", "reproduce", "resume"]
    )]
    init: Option<PathBuf>,

    /// Epsilon at the start, with --init (the paper: 0.5) [default: the preset's]
    #[arg(long, value_name = "X", help_heading = "Training", requires = "init", conflicts_with_all = ["eval", "reproduce", "resume"])]
    epsilon: Option<f32>,

    /// Go on exactly where the run in DIR stopped; --episodes or --steps give it a larger budget, counted from its start
    #[arg(long, value_name = "DIR", help_heading = "Training", requires = "train", conflicts_with_all = ["eval", "reproduce"])]
    resume: Option<PathBuf>,

    /// Write a checkpoint every S seconds; what is learnt does not depend on it [default: 30]
    #[arg(long, value_name = "S", help_heading = "Training", requires = "train", conflicts_with_all = ["eval", "reproduce"],
        value_parser = seconds, allow_negative_numbers = true)]
    checkpoint_every: Option<Duration>,

    /// Open a policy, a run's folder, a scenario or a preset in the window
    #[cfg(feature = "gui")]
    #[arg(long, value_name = "PATH", help_heading = "Window", conflicts_with = "mode")]
    open: Option<PathBuf>,

    /// Open the world in the editor
    #[cfg(feature = "gui")]
    #[arg(long, help_heading = "Window", conflicts_with_all = ["mode", "replay"])]
    edit: bool,

    /// How many times real time it goes at first, or `full`: as quickly as it goes [default: 5]
    #[cfg(feature = "gui")]
    #[arg(long, value_name = "X", help_heading = "Window", conflicts_with = "mode", value_parser = pace)]
    pace: Option<Pace>,

    /// Light or dark [default: as remembered, at first as the system has it]
    #[cfg(feature = "gui")]
    #[arg(long, value_name = "THEME", help_heading = "Window", conflicts_with = "mode", value_enum)]
    theme: Option<ThemeArgument>,

    /// What to draw over the world: beams, path, trails, potential, value, q-values, grid; `none` for nothing
    #[cfg(feature = "gui")]
    #[arg(
        long,
        value_name = "NAMES",
        help_heading = "Window",
        conflicts_with = "mode",
        value_delimiter = ',',
        value_enum
    )]
    show: Vec<OverlayArgument>,

    /// The window's width and height in points, such as 1280x800
    #[cfg(feature = "gui")]
    #[arg(long, value_name = "WxH", help_heading = "Window", conflicts_with = "mode", value_parser = size)]
    size: Option<(f32, f32)>,

    /// Train again what was trained and saved in the window, changes by hand included, and see whether it comes out the same
    #[cfg(feature = "gui")]
    #[arg(long, value_name = "DIR", help_heading = "Window", conflicts_with_all = ["mode", "scenario", "preset", "seed"])]
    replay: Option<PathBuf>,

    /// Write a picture of the window to a PNG file, and end
    #[cfg(feature = "gui")]
    #[arg(long, value_name = "FILE", help_heading = "Window", conflicts_with = "mode")]
    screenshot: Option<PathBuf>,

    /// The picture is taken after N control steps
    #[cfg(feature = "gui")]
    #[arg(long, value_name = "N", help_heading = "Window", requires = "screenshot", default_value_t = 0)]
    screenshot_after: u64,

    /// Rounds of episodes
    #[arg(long, value_name = "N", help_heading = "Testing", requires = "eval", conflicts_with_all = ["train", "reproduce"], default_value_t = 5,
        value_parser = clap::value_parser!(u32).range(1..=10_000))]
    rounds: u32,

    /// Also drive the benchmark route, 5 rounds of 5: from (0, 0) to (1.2, 1.2)
    #[arg(long, help_heading = "Testing", requires = "eval", conflicts_with_all = ["train", "reproduce"])]
    course: bool,

    /// Also compare the times with the least possible ones, found by a planner that knows the world
    #[arg(long, help_heading = "Testing", requires = "eval", conflicts_with_all = ["train", "reproduce"])]
    optimum: bool,

    /// Only these figures, tables or experiments, such as fig9,table2
    #[arg(long, value_name = "NAMES", help_heading = "Reproducing", requires = "reproduce", value_delimiter = ',',
        conflicts_with_all = ["train", "eval"])]
    only: Vec<String>,

    /// How many seeds [default: the experiments' own, 5]
    #[arg(long, value_name = "N", help_heading = "Reproducing", requires = "reproduce",
        conflicts_with_all = ["train", "eval"], value_parser = clap::value_parser!(u64).range(1..=1000))]
    seeds: Option<u64>,

    /// A rough report in a minute: a tenth of the episodes and of the tests, two seeds
    #[arg(long, help_heading = "Reproducing", requires = "reproduce", conflicts_with_all = ["train", "eval"])]
    quick: bool,

    /// An experiment of your own, a RON file like those in assets/experiments, instead of the paper's; may be repeated
    #[arg(long, value_name = "FILE", help_heading = "Reproducing", requires = "reproduce",
        conflicts_with_all = ["train", "eval"])]
    experiment: Vec<PathBuf>,

    /// How many runs at a time; no result depends on it [default: as many as there are cores]
    #[arg(long, value_name = "N", help_heading = "Reproducing", requires = "reproduce",
        conflicts_with_all = ["train", "eval"], value_parser = clap::value_parser!(u16).range(1..=1024))]
    jobs: Option<u16>,
}

/// Runs the command line of this process, which began at `began`; gives its exit status.
pub fn main(began: Instant) -> ExitCode {
    let arguments = Arguments::parse();
    let done = if arguments.train {
        train_command(arguments, began)
    } else if let Some(policy) = arguments.eval.clone() {
        eval_command(&arguments, &policy)
    } else if arguments.reproduce {
        reproduce_command(arguments, began)
    } else if !arguments.check.is_empty() {
        check_command(&arguments)
    } else if let Some(file) = &arguments.draw {
        draw_command(&arguments, file)
    } else {
        window_command(arguments)
    };
    match done {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            print_stderr(&format!("error: {error}"));
            ExitCode::from(error.exit_status())
        }
    }
}

#[cfg(not(feature = "gui"))]
fn window_command(_: Arguments) -> Result<(), RunError> {
    Err(RunError::InvalidInput(
        "this build opens no window: train with `wayfield --train`, test with `wayfield --eval POLICY`; \
         `wayfield --help` lists everything"
            .into(),
    ))
}

#[cfg(feature = "gui")]
fn window_command(arguments: Arguments) -> Result<(), RunError> {
    if let Some(folder) = &arguments.replay {
        return replay_command(folder);
    }
    let usual = StartOptions::default();
    let start = StartOptions {
        scenario: arguments.scenario.unwrap_or(usual.scenario),
        preset: arguments.preset.unwrap_or(usual.preset),
        seed: arguments.seed.unwrap_or(usual.seed),
        pace: arguments.pace.unwrap_or(usual.pace),
        open: arguments.open,
        edit: arguments.edit,
        ..usual
    };
    // What cannot be used is said here, not in a window.
    // (But a broken scenario is waited for: the window takes it as soon as it is mended.)
    match shipped::scenario(&start.scenario) {
        Err(error) if Path::new(&start.scenario).is_file() && arguments.screenshot.is_none() => {
            print_stderr(&error.to_string());
        }
        found => drop(found?),
    }
    shipped::preset(&start.preset)?;
    let shows = |what: OverlayArgument| arguments.show.contains(&what);
    let asked = !arguments.show.is_empty();
    window::run(WindowOptions {
        start,
        screenshot: arguments
            .screenshot
            .map(|file| ScreenshotRequest { file, after_steps: arguments.screenshot_after }),
        theme: arguments.theme.map(|theme| match theme {
            ThemeArgument::Light => ThemeChoice::Light,
            ThemeArgument::Dark => ThemeChoice::Dark,
        }),
        overlays: asked.then(|| Overlays {
            beams: shows(OverlayArgument::Beams),
            path: shows(OverlayArgument::Path),
            trails: shows(OverlayArgument::Trails),
            potential: shows(OverlayArgument::Potential),
            value: shows(OverlayArgument::Value),
            q_values: shows(OverlayArgument::QValues),
        }),
        grid: asked.then(|| shows(OverlayArgument::Grid)),
        size: arguments.size,
    })
}

#[cfg(feature = "gui")]
fn replay_command(folder: &Path) -> Result<(), RunError> {
    let replayed = journal::verify(folder)?;
    let (steps, interventions) = (replayed.steps, replayed.interventions);
    if replayed.bit_identical {
        return print_stdout(&format!(
            "{steps} control steps, {interventions} changes by hand: the same to the bit\n"
        ));
    }
    Err(RunError::Failed(format!(
        "{}: {steps} control steps and {interventions} changes by hand came out otherwise than in its checkpoint: it was made by \
         another version, on another kind of CPU, or changed since",
        folder.display()
    )))
}

/// What `--theme` takes.
#[cfg(feature = "gui")]
#[derive(Clone, Copy, Debug, clap::ValueEnum)]
enum ThemeArgument {
    Light,
    Dark,
}

/// What `--show` takes.
#[cfg(feature = "gui")]
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum OverlayArgument {
    Beams,
    Path,
    Trails,
    Potential,
    Value,
    QValues,
    Grid,
    None,
}

#[cfg(feature = "gui")]
fn pace(text: &str) -> Result<Pace, String> {
    text.parse()
}

#[cfg(feature = "gui")]
fn size(text: &str) -> Result<(f32, f32), String> {
    let sides: Option<(u16, u16)> =
        text.split_once('x').and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    match sides {
        Some((w, h)) if (800..=8000).contains(&w) && (500..=8000).contains(&h) => Ok((w.into(), h.into())),
        _ => Err("give width and height, 800x500 to 8000x8000".into()),
    }
}

fn train_command(arguments: Arguments, began: Instant) -> Result<(), RunError> {
    let budget = match (arguments.episodes, arguments.steps) {
        (Some(n), _) => Some(Budget::Episodes(n)),
        (None, Some(n)) => Some(Budget::EnvSteps(n)),
        (None, None) => None,
    };
    let every = arguments.checkpoint_every.unwrap_or(CHECKPOINT_INTERVAL);
    let job = match arguments.resume {
        Some(folder) => Job::Resume { folder, budget },
        None => {
            let scenario_from = arguments.scenario.unwrap_or_else(|| "scenario-1".into());
            let preset_from = arguments.preset.unwrap_or_else(|| "fast".into());
            let mut config = RunConfig::resolve(&scenario_from, &preset_from, arguments.seed.unwrap_or(0))?;
            let preset = &mut config.preset;
            preset.budget = budget.unwrap_or(preset.budget);
            preset.arenas = arguments.arenas.unwrap_or(preset.arenas);
            if let Some(arenas) = arguments.arenas.filter(|n| !(1..=4096).contains(n)) {
                return Err(RunError::InvalidInput(format!("--arenas is {arenas}; give 1 to 4096")));
            }
            if let Some(finding) = preset.diagnostics().first() {
                return Err(RunError::InvalidInput(format!("{preset_from}: {finding}")));
            }
            if let Some(epsilon) = arguments.epsilon.filter(|x| !(0.0..=1.0).contains(x)) {
                return Err(RunError::InvalidInput(format!("--epsilon is {epsilon}; give 0 to 1")));
            }
            let warmup = preset.learning.replay.learning_starts;
            if matches!(preset.budget, Budget::EnvSteps(n) if n <= warmup) {
                print_stderr(&format!(
                    "warning: nothing will be learnt: the budget ends before the preset's warm-up of {warmup} env \
                     steps"
                ));
            }
            let policy =
                arguments.init.as_deref().map(|path| read_policy(path, &config.scenario)).transpose()?;
            config.transfer = arguments
                .init
                .map(|init| Transfer { policy: init.display().to_string(), epsilon: arguments.epsilon });
            Job::New { config: Box::new(config), policy, out: arguments.out }
        }
    };
    let (folder, summary) = train(job, every, stop_on_signal(), began, None)?;
    if arguments.json { print_json(&summary) } else { print_stdout(&summary_text(&folder, &summary)) }
}

/// A flag that Ctrl-C and SIGTERM set; a second one ends the process at once.
fn stop_on_signal() -> &'static AtomicBool {
    static STOP: AtomicBool = AtomicBool::new(false);
    let handler = || {
        if STOP.swap(true, Ordering::Relaxed) {
            std::process::exit(130);
        }
        print_stderr("stopping: saving a checkpoint (once more ends at once, without one)");
    };
    if let Err(error) = ctrlc::set_handler(handler) {
        print_stderr(&format!("warning: Ctrl-C will not save a checkpoint: {error}"));
    }
    &STOP
}

fn summary_text(folder: &Path, summary: &Summary) -> String {
    let percent = |rate: Option<f64>| rate.map_or("-".into(), |r| format!("{:.1} %", 100.0 * r));
    let seconds = |s: Option<f64>| s.map_or("-".into(), |s| format!("{s:.2} s"));
    let first = |m: &Option<Milestone>| match m {
        Some(m) => format!("{} env steps, {} episodes, {:.1} s", m.env_steps, m.episodes, m.wall_s),
        None => "not reached".into(),
    };
    let Summary { episodes, env_steps, gradient_steps, wall_s, .. } = summary;
    let quoted = |text: &str| if text.contains(' ') { format!("'{text}'") } else { text.to_owned() };
    // Tests are made in Scenario I unless another is named.
    let scenario = match summary.scenario_from.as_str() {
        "scenario-1" => String::new(),
        other => format!(" --scenario {}", quoted(other)),
    };
    format!(
        "best policy     {} success, mean time {}\n\
         last policy     {} success\n\
         first 96 %      {}\n\
         first 99 %      {}\n\
         trained         {episodes} episodes, {env_steps} env steps, {gradient_steps} gradient steps, {wall_s:.1} s\n\
         run folder      {}\n\
         test it         {} --eval {}{scenario}\n",
        percent(summary.best_success_rate),
        seconds(summary.best_mean_time_s),
        percent(summary.last_success_rate),
        first(&summary.first_96),
        first(&summary.first_99),
        folder.display(),
        std::env::args().next().unwrap_or_else(|| "wayfield".into()),
        quoted(&folder.join("policy.safetensors").display().to_string()),
    )
}

/// What `--reproduce --json` prints.
#[derive(serde::Serialize)]
struct ReproductionReport {
    report: String,
    runs: usize,
    wall_s: f64,
    claims: Vec<ClaimReport>,
}

#[derive(serde::Serialize)]
struct ClaimReport {
    claim: String,
    outcome: &'static str,
    because: String,
}

fn reproduce_command(arguments: Arguments, began: Instant) -> Result<(), RunError> {
    let request = ReproduceOptions {
        experiments: arguments.experiment,
        only: arguments.only,
        seeds: arguments.seeds,
        quick: arguments.quick,
        out: arguments.out,
        jobs: arguments.jobs.map(usize::from),
    };
    let done = reproduce(&request, stop_on_signal(), began)?;
    let claims = done.claims.into_iter().map(|claim_result| ClaimReport {
        claim: claim_result.claim,
        outcome: claim_result.outcome.word(),
        because: claim_result.sentence,
    });
    let report = ReproductionReport {
        report: done.folder.join("report.html").display().to_string(),
        runs: done.runs,
        wall_s: done.wall_s,
        claims: claims.collect(),
    };
    if arguments.json { print_json(&report) } else { print_stdout(&reproduction_text(&report)) }
}

fn reproduction_text(report: &ReproductionReport) -> String {
    use std::fmt::Write as _;
    let mut text = String::new();
    for claim in &report.claims {
        let _ = writeln!(text, "{:<11} {}\n            {}", claim.outcome, claim.claim, claim.because);
    }
    let minutes = report.wall_s / 60.0;
    let _ = writeln!(text, "report      {} ({} runs, {minutes:.1} minutes)", report.report, report.runs);
    text
}

/// A picture of the world.
fn draw_command(arguments: &Arguments, file: &Path) -> Result<(), RunError> {
    let scenario = shipped::scenario(arguments.scenario.as_deref().unwrap_or("scenario-1"))?;
    scenario_image::draw(&scenario, file)?;
    print_stdout(&format!("{}\n", file.display()))
}

/// What `--check --json` prints.
#[derive(serde::Serialize)]
struct CheckReport {
    /// All that were looked at.
    files: Vec<String>,
    problems: Vec<ProblemReport>,
}

#[derive(serde::Serialize)]
struct ProblemReport {
    path: String,
    line: Option<usize>,
    column: Option<usize>,
    message: String,
}

impl CheckReport {
    fn of(checked: &[CheckedFile]) -> Self {
        let errors = checked.iter().filter_map(|file| file.error.as_ref());
        let problems = errors.flat_map(|error| {
            error.problems().iter().map(|problem| ProblemReport {
                path: error.path().display().to_string(),
                line: problem.line_column.map(|(line, _)| line),
                column: problem.line_column.map(|(_, column)| column),
                message: problem.message.clone(),
            })
        });
        Self {
            files: checked.iter().map(|file| file.path.display().to_string()).collect(),
            problems: problems.collect(),
        }
    }
}

fn check_command(arguments: &Arguments) -> Result<(), RunError> {
    let mut checked = check_files::check(&arguments.check);
    for file in &mut checked {
        if file.error.is_some() && Experiment::load(&file.path).is_ok() {
            file.error = None;
        }
    }
    if arguments.json {
        print_json(&CheckReport::of(&checked))?;
    } else {
        for file in &checked {
            match &file.error {
                None => print_stdout(&format!("{}: ok\n", file.path.display()))?,
                Some(error) => print_stderr(&error.to_string()),
            }
        }
    }
    match checked.iter().filter(|file| file.error.is_some()).count() {
        0 => Ok(()),
        bad => Err(RunError::InvalidInput(format!("of {} checked, {bad} can't be used", checked.len()))),
    }
}

/// What `--eval --json` prints.
#[derive(serde::Serialize)]
struct EvaluationReport {
    policy: String,
    scenario: String,
    #[serde(flatten)]
    evaluation: Evaluation,
    #[serde(flatten)]
    course: Option<CourseReport>,
    #[serde(flatten)]
    optimum: Option<OptimumReport>,
}

#[derive(serde::Serialize)]
struct CourseReport {
    course_success_rate: f64,
    course_time_s: Option<f64>,
    course_times_s: Vec<f64>,
}

#[derive(serde::Serialize)]
struct OptimumReport {
    optimum_episodes: usize,
    optimum_mean_time_s: Option<f64>,
    time_ratio: Option<f64>,
}

fn eval_command(arguments: &Arguments, path: &Path) -> Result<(), RunError> {
    let scenario_from = arguments.scenario.as_deref().unwrap_or("scenario-1");
    let scenario = Arc::new(shipped::scenario(scenario_from)?);
    let policy = read_policy(path, &scenario)?;
    if let Some(other) = policy.metadata.get("scenario").filter(|name| **name != scenario.name) {
        print_stderr(&format!("note: this policy was trained in {other} and is tested in {}", scenario.name));
    }
    let seed = arguments.seed.unwrap_or(0);
    let period = scenario.task.control_period_s;
    let episodes = arguments.episodes.unwrap_or(100);
    let count = u64::from(arguments.rounds).saturating_mul(episodes);
    if count > MAX_EVAL_EPISODES {
        let why = format!("{count} episodes are asked for; give --rounds and --episodes for at most");
        return Err(RunError::InvalidInput(format!("{why} {MAX_EVAL_EPISODES} in all")));
    }
    let (round, count) = (episodes as usize, count as usize);

    let episodes = Evaluator::new(&scenario, count).run(&policy, seed, count, EpisodeSetup::Random)?;
    let evaluation = Evaluation::from_episodes(&episodes, round, &scenario.task, seed);
    let course = if arguments.course {
        let driven = Evaluator::new(&scenario, 25).run(&policy, seed, 25, EpisodeSetup::BenchmarkRoute)?;
        let of = Evaluation::from_episodes(&driven, 5, &scenario.task, seed);
        Some(CourseReport {
            course_success_rate: of.success_rate,
            course_time_s: of.mean_time_s,
            course_times_s: evaluate::times_s(&driven, period).collect(),
        })
    } else {
        None
    };
    if arguments.optimum
        && let Some(what) = unsupported_reason(&scenario)
    {
        print_stderr(&format!("note: no least times in {}: the planner does not know {what}", scenario.name));
    }
    let optimum = arguments.optimum.then(|| {
        let against = evaluate::compare_with_optimum(&scenario, &episodes);
        OptimumReport {
            optimum_episodes: against.map_or(0, |a| a.episodes),
            optimum_mean_time_s: against.map(|a| a.optimum_mean_time_s),
            time_ratio: against.map(|a| a.time_ratio),
        }
    });
    let report = EvaluationReport {
        policy: path.display().to_string(),
        scenario: scenario.name.clone(),
        evaluation,
        course,
        optimum,
    };
    if arguments.json {
        return print_json(&report);
    }
    print_stdout(&evaluation_text(&report))
}

fn evaluation_text(report: &EvaluationReport) -> String {
    use std::fmt::Write as _;
    let e = &report.evaluation;
    let rounds: Vec<String> = e.rounds.iter().map(|r| format!("{:.0}", 100.0 * r)).collect();
    let seconds = |s: Option<f64>| s.map_or("-".into(), |s| format!("{s:.3} s"));
    let mut text = format!(
        "{} in {}, {} episodes, seed {}\n\
         success         {:.1} %  (rounds: {})\n\
         collision       {:.1} %\n\
         out of time     {:.1} %\n\
         mean time       {}\n",
        report.policy,
        report.scenario,
        e.episodes,
        e.seed,
        100.0 * e.success_rate,
        rounds.join(" "),
        100.0 * e.collision_rate,
        100.0 * e.timeout_rate,
        seconds(e.mean_time_s),
    );
    if let Some(course) = &report.course {
        let _ = writeln!(
            text,
            "course          {}, {:.0} % of {} drives (the paper's PER-D3QN: 13.155 s in Scenario I)",
            seconds(course.course_time_s),
            100.0 * course.course_success_rate,
            25
        );
    }
    if let Some(optimum) = &report.optimum {
        let _ = writeln!(
            text,
            "least time      {} over {} of these episodes; the policy takes {} times that",
            seconds(optimum.optimum_mean_time_s),
            optimum.optimum_episodes,
            optimum.time_ratio.map_or("-".into(), |ratio| format!("{ratio:.3}"))
        );
    }
    text
}

fn print_json(value: &impl serde::Serialize) -> Result<(), RunError> {
    let text = serde_json::to_string(value).map_err(|error| RunError::Failed(error.to_string()))?;
    print_stdout(&format!("{text}\n"))
}

/// Results, to stdout. Whoever closes it early has seen enough.
fn print_stdout(text: &str) -> Result<(), RunError> {
    let mut stdout = std::io::stdout().lock();
    match stdout.write_all(text.as_bytes()).and_then(|()| stdout.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(RunError::Failed(format!("the results can't be written to stdout: {error}")))
        }
        _ => Ok(()),
    }
}

/// The most episodes of one `--eval`.
const MAX_EVAL_EPISODES: u64 = 1_000_000;

/// The policy in the file at `path`, which must be able to drive in `scenario`.
fn read_policy(path: &Path, scenario: &Scenario) -> Result<Policy, RunError> {
    let policy = policy_card::read(path)?;
    evaluate::check_compatible(&policy, scenario).map_err(|error| RunError::invalid_input(path, error))?;
    Ok(policy)
}

/// A number of episodes or env steps, as typed.
fn budget(text: &str) -> Result<u64, String> {
    let typed = text.parse().ok().filter(|n| (1..=MAX_STEPS).contains(n));
    typed.ok_or_else(|| format!("give a whole number, 1 to {MAX_STEPS}"))
}

/// A time in seconds, as typed.
fn seconds(text: &str) -> Result<Duration, String> {
    let typed = text.parse().ok().filter(|s| (0.01..=1e6).contains(s));
    typed.map(Duration::from_secs_f64).ok_or_else(|| "give 0.01 to 1000000 seconds".into())
}

/// A seed, as typed.
fn seed(text: &str) -> Result<u64, String> {
    text.parse().map_err(|_| format!("give a whole number from 0 to {}", u64::MAX))
}
