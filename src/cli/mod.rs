//! The command line.
//!
//! In: the process's arguments. Out: results on stdout, logs and progress on stderr, and an exit status: 0 on
//! success, 1 when a run failed, 2 for invalid arguments or files, 128 plus the number of the signal that stopped a run.
//!
//! One file per mode contains the mode's options and its `run` function. `modes` rejects options of other modes;
//! `shared` contains the options that several modes take.

mod card;
mod check;
mod draw;
mod driver;
mod eval;
mod export;
#[cfg(all(test, feature = "gui"))]
mod flag_tables;
mod import;
mod modes;
mod output;
mod policy;
#[cfg(feature = "gui")]
mod replay;
mod reproduce;
mod shared;
mod train;
mod values;
#[cfg(feature = "gui")]
mod window;

use self::check::kind::{FileKind, expect_kind};
pub use check::{CheckReport, check_files};
pub use draw::ScenarioFigure;
pub use driver::TestDriver;
pub use policy::load as load_policy;
pub use reproduce::ReproductionReport;
pub use values::{seeds as parse_seeds, size as parse_size};

use std::any::TypeId;
use std::ffi::OsString;
use std::path::PathBuf;
use std::process::ExitCode;
use std::sync::OnceLock;
use std::time::Instant;

use clap::error::ErrorKind;
use clap::{Arg, Command, CommandFactory, FromArgMatches, Parser};

#[cfg(unix)]
use crate::run::memory_limit;
use crate::run::progress::print_stderr;
use crate::run::{RunError, signals};
use crate::scenario::is_unprintable;
use crate::simulation::{Extensions, use_one_task_thread};

/// The heading of the modes.
const MODES_HEADING: &str =
    if cfg!(feature = "gui") { "Modes (without one, the app opens)" } else { "Modes" };

const EXAMPLES: &str =
    "  wayfield --train                                   train in Scenario I, in seconds, into runs/
  wayfield --eval runs/scenario-1-fast-0/policy.safetensors --course
  wayfield --train --scenario scenario-2 --init POLICY --epsilon 0.5
  wayfield --resume runs/scenario-1-fast-0 --steps 900000
  wayfield --reproduce --only fig9,table2 --seeds 3  two of the paper's results, into runs/reproduce/
  wayfield --check scenarios/                        check every scenario in a folder
  wayfield --import map.yaml --out room.ron          a ROS map as a scenario
  wayfield --draw curves.pdf --run runs/scenario-1-fast-0
  wayfield --export POLICY --onnx policy.onnx        a policy for ONNX Runtime

A file may be `-`, standard input. Whole numbers may be written 600000, 600_000, 6e5 or 600k.
Results go to stdout, logs and progress to stderr. Exit status: 0 success, 1 a run failed,
2 invalid arguments or files, 128 + N a run stopped by signal N: Ctrl-C (130), SIGTERM (143) and
SIGHUP (129) save a checkpoint and the summary, and --resume continues.";

/// The name by which the program was started.
static PROGRAM: OnceLock<OsString> = OnceLock::new();

/// The end of the help. A build without the app leaves out the example that opens the app.
fn after_help() -> String {
    let app = "  wayfield                                           open the app and watch a robot learn\n";
    let app = if cfg!(feature = "gui") { app } else { "" };
    format!("Examples:\n{app}{EXAMPLES}")
}

/// Trains a LIDAR robot to navigate, in seconds, with prioritized-replay double dueling DQN
#[derive(Parser, Debug)]
#[command(name = "wayfield", version, max_term_width = 110, after_help = after_help())]
struct Arguments {
    #[command(flatten)]
    mode: modes::ModeArgs,
    #[command(flatten)]
    shared: shared::SharedArgs,
    #[command(flatten)]
    train: train::TrainArgs,
    #[command(flatten)]
    eval: eval::EvalArgs,
    #[command(flatten)]
    export: export::ExportArgs,
    #[command(flatten)]
    reproduce: reproduce::ReproduceArgs,
    #[command(flatten)]
    import: import::ImportArgs,
    #[command(flatten)]
    draw: draw::DrawArgs,
    #[cfg(feature = "gui")]
    #[command(flatten)]
    window: window::WindowArgs,
}

impl Arguments {
    /// The arguments parsed from `words`; the first word is the program's name.
    fn parse_words(words: impl IntoIterator<Item = OsString>) -> Result<Self, clap::Error> {
        let words: Vec<OsString> = words.into_iter().collect();
        let mut command = Self::command();
        let matches = match command.try_get_matches_from_mut(&words) {
            Err(error) if error.kind() == ErrorKind::InvalidUtf8 => {
                return Err(not_utf8(&mut command, &words).unwrap_or(error));
            }
            matches => matches?,
        };
        modes::check(&mut command, &matches)?;
        Self::from_arg_matches(&matches).map_err(|error| error.format(&mut command))
    }
}

/// The error for the first word that must be text but is not UTF-8, with the name of its flag.
fn not_utf8(command: &mut Command, words: &[OsString]) -> Option<clap::Error> {
    let takes_text = |arg: &Arg| arg.get_value_parser().type_id() != TypeId::of::<PathBuf>();
    let mut flag = None;
    let mut message = None;
    for word in words.iter().skip(1) {
        let text = word.to_string_lossy();
        let rest = text.strip_prefix("--");
        let (name, value) = match rest.and_then(|rest| rest.split_once('=')) {
            Some((name, value)) => (Some(name), value),
            None => (rest, &*text),
        };
        let named = command.get_arguments().find(|arg| arg.get_long() == name && name.is_some());
        flag = named.or(flag);
        if let (None, Some(flag)) = (word.to_str(), flag.filter(|flag| takes_text(flag))) {
            message = Some(format!(
                "the value '{value}' for '{flag}' is not valid UTF-8; help: write text in UTF-8, and \
                 rename a file whose name is not"
            ));
            break;
        }
    }
    message.map(|message| command.error(ErrorKind::InvalidUtf8, message))
}

/// Runs the command line of this process and returns the exit status. `began` is the start of the process, from which wall
/// time is counted. `extensions` are the user's plugins for training, evaluation and the app. A program with its own
/// sensors and rewards gets the whole command line in a few lines:
///
/// ```no_run
/// # use bevy::prelude::*;
/// # #[derive(Clone)]
/// # struct MySensor;
/// # impl Plugin for MySensor { fn build(&self, _: &mut App) {} }
/// fn main() -> std::process::ExitCode {
///     let extensions = wayfield::simulation::Extensions::default().plugin(MySensor);
///     wayfield::cli::main(std::time::Instant::now(), extensions)
/// }
/// ```
pub fn main(began: Instant, extensions: Extensions) -> ExitCode {
    ExitCode::from(run_words(std::env::args_os(), began, extensions))
}

/// Runs the command line with the arguments `words` and returns the exit status. The first word is the program's name.
/// `--help`, `--version` and invalid options end the process. See [`main`] for the other arguments.
pub fn run_words(words: impl IntoIterator<Item = OsString>, began: Instant, extensions: Extensions) -> u8 {
    signals::survive_limits();
    let words: Vec<OsString> = words.into_iter().collect();
    PROGRAM.get_or_init(|| words.first().cloned().unwrap_or_default());
    let mut arguments = Arguments::parse_words(words).unwrap_or_else(|error| exit(&error));
    arguments.shared.extensions = extensions;
    match run(arguments, began) {
        Ok(()) => 0,
        Err(error) => {
            let label = if matches!(error, RunError::Stopped(_)) { "" } else { "error: " };
            print_stderr(&format!("{label}{error}{}", limit_help(&error.to_string())));
            error.exit_status()
        }
    }
}

/// The fix for an error at the limit on open files or on file sizes, which any code that opens or writes files can hit.
fn limit_help(error: &str) -> &'static str {
    let is_system_error = |number: u32| cfg!(unix) && error.contains(&format!("(os error {number})"));
    if error.contains("help:") {
        ""
    } else if is_system_error(24) {
        "; help: raise the limit on open files (`ulimit -n`)"
    } else if is_system_error(27) {
        "; help: raise the limit on file sizes (`ulimit -f`)"
    } else {
        ""
    }
}

/// Prints clap's message and exits. If an argument in it has unprintable characters, such as terminal control codes, they are
/// escaped, and the message has no colours.
fn exit(error: &clap::Error) -> ! {
    let text = error.to_string();
    if text.contains(|c| is_unprintable(c) && c != '\n' && c != '\t') {
        print_stderr(text.trim_end());
        std::process::exit(error.exit_code());
    }
    error.exit()
}

fn run(arguments: Arguments, began: Instant) -> Result<(), RunError> {
    let Arguments { mode, shared, .. } = arguments;
    let trains = mode.train.is_some() || arguments.train.resume.is_some();
    for (file, kind) in [(&shared.scenario, FileKind::Scenario), (&shared.preset, FileKind::Preset)] {
        file.as_ref().map_or(Ok(()), |file| expect_kind(file.as_ref(), kind))?;
    }
    let is_headless = trains || !mode.eval.is_empty() || mode.reproduce;
    #[cfg(unix)]
    if is_headless {
        memory_limit::check_start()?;
    }
    if is_headless && !use_one_task_thread() {
        return Err(RunError::Failed(
            "no thread can be started; help: raise `ulimit -u` or the container's limit on processes, or use a build \
             without the app (`--no-default-features`), which needs none"
                .into(),
        ));
    }
    if trains {
        train::run(mode.train.flatten(), arguments.train, shared, began)
    } else if !mode.eval.is_empty() {
        eval::run(&mode.eval, &arguments.eval, &shared)
    } else if let Some(policy) = mode.card {
        card::run(&policy)
    } else if let Some(policy) = mode.export {
        export::run(&policy, &arguments.export)
    } else if mode.reproduce {
        reproduce::run(arguments.reproduce, shared, began)
    } else if let Some(file) = mode.import {
        import::run(&file, &arguments.import, &shared)
    } else if !mode.check.is_empty() {
        check::run(&mode.check, shared.json)
    } else if let Some(file) = mode.draw {
        draw::run(&file, &arguments.draw, arguments.import.resolution, &shared)
    } else {
        #[cfg(feature = "gui")]
        return match mode.replay {
            Some(folder) => replay::run(&folder),
            None => window::run(arguments.window, shared, arguments.train.checkpoint_every),
        };
        #[cfg(not(feature = "gui"))]
        Err(RunError::InvalidInput(
            "this build has no app; help: build it with the feature `gui`, train with `wayfield --train`, test with \
             `wayfield --eval POLICY`, or see `wayfield --help`"
                .into(),
        ))
    }
}
