//! The modes of the command line, and the options that each mode takes.

use std::path::PathBuf;

use clap::error::ErrorKind;
use clap::parser::ValueSource;
use clap::{Arg, ArgMatches, Args, Command};

/// The flags that select a mode. Without a mode, the app opens.
#[derive(Args, Debug)]
#[group(multiple = false)]
#[command(next_help_heading = super::MODES_HEADING)]
pub struct ModeArgs {
    /// Train a policy into a new run folder. With the config.ron of a run: run it again, with the same scenario, preset
    /// and seed, and so with the same result
    #[arg(long, value_name = "CONFIG", num_args = 0..=1)]
    pub train: Option<Option<PathBuf>>,

    /// Test policies (files, or shipped ones by name) and classical drivers (field, dwa, dwa-cv, grid-dwa, astar-dwa,
    /// astar, orca, or RON files) over rounds of episodes that they have not been trained on; all drive the same episodes
    /// and act greedily. With POLICY+map, the policy builds a map and drives to waypoints on a path planned in it
    #[arg(long, value_name = "POLICY", num_args = 1..)]
    pub eval: Vec<PathBuf>,

    /// Print a policy's card as JSON: inputs, actions, scenario, training, and a worked example to verify other programs
    #[arg(long, value_name = "POLICY")]
    pub card: Option<PathBuf>,

    /// Write a policy for other programs, with the encoding of its inputs and the choice of its actions (see --onnx)
    #[arg(long, value_name = "POLICY")]
    pub export: Option<PathBuf>,

    /// Reproduce the paper: train, test and report every figure and table over several seeds
    #[arg(long)]
    pub reproduce: bool,

    /// Import a world into the scenario file given with --out: a map of ROS's map_server (.yaml), an image (.png, .pgm), a
    /// world of Gazebo (.world, .sdf) or a file of BARN worlds or stages (.json)
    #[arg(long, value_name = "FILE")]
    pub import: Option<PathBuf>,

    /// Check scenarios, sets, level generators, suites, drivers, presets, experiments and policies, and print every problem. In
    /// a folder, all .ron files are checked
    #[arg(long, value_name = "PATH", num_args = 1..)]
    pub check: Vec<PathBuf>,

    /// Draw a scenario from above, levels of a level generator, the scenarios of a set, or with --run the learning curves
    /// of a run, into an SVG, PNG or PDF file
    #[arg(long, value_name = "FILE")]
    pub draw: Option<PathBuf>,

    /// Repeat a training session saved from the app, including its interventions, and compare the results
    #[cfg(feature = "gui")]
    #[arg(long, value_name = "DIR")]
    pub replay: Option<PathBuf>,
}

/// The options that each mode takes, by clap id. The id of a group (a struct of options) stands for all options in
/// the group.
const MODES: &[(&str, &[&str])] = &[
    ("train", &["scenario", "preset", "set", "seed", "episodes", "out", "json", "TrainArgs"]),
    ("eval", &["scenario", "set", "seed", "episodes", "json", "EvalArgs"]),
    ("card", &["json"]),
    ("export", &["ExportArgs"]),
    ("reproduce", &["set", "out", "json", "ReproduceArgs"]),
    ("import", &["set", "out", "json", "ImportArgs"]),
    ("check", &["json"]),
    ("draw", &["scenario", "set", "seed", "size", "resolution", "DrawArgs"]),
    #[cfg(feature = "gui")]
    ("replay", &[]),
];

/// The options that the app takes, by clap id.
#[cfg(feature = "gui")]
const APP: &[&str] = &["scenario", "preset", "set", "seed", "checkpoint_every", "size", "WindowArgs"];
#[cfg(not(feature = "gui"))]
const APP: &[&str] = &[];

/// Checks that every option in `matches` belongs to the chosen mode.
///
/// # Errors
/// An option belongs to another mode. The message names the option, the chosen mode, and the modes that take it.
pub fn check(command: &mut Command, matches: &ArgMatches) -> Result<(), clap::Error> {
    let is_given = |id: &str| matches.value_source(id) == Some(ValueSource::CommandLine);
    // Only a training run can be resumed, so `--resume` needs no `--train`.
    let implied = |flag: &str| flag == "train" && is_given("resume");
    let mode = MODES
        .iter()
        .find(|(flag, _)| is_given(flag))
        .or_else(|| MODES.iter().find(|(flag, _)| implied(flag)));
    let options = mode.map_or(APP, |(_, options)| options);
    let misplaced = command.get_arguments().find(|arg| {
        let id = arg.get_id().as_str();
        is_given(id) && !MODES.iter().any(|(flag, _)| *flag == id) && !takes(command, options, arg)
    });
    let Some(option) = misplaced else { return Ok(()) };
    let owners = owners(command, option);
    let message = match mode.and_then(|(flag, _)| find(command, flag)) {
        Some(flag) => {
            format!("the argument '{option}' cannot be used with '{flag}'; help: use it with {owners}")
        }
        None => format!("the argument '{option}' cannot be used on its own; help: use it with {owners}"),
    };
    Err(command.error(ErrorKind::ArgumentConflict, message))
}

/// Whether `options` (ids of options or groups) include `arg`.
fn takes(command: &Command, options: &[&str], arg: &Arg) -> bool {
    options.iter().any(|id| {
        arg.get_id() == id
            || command
                .get_groups()
                .any(|group| group.get_id() == id && group.get_args().any(|member| member == arg.get_id()))
    })
}

/// The modes that take `option`, as text for a message.
fn owners(command: &Command, option: &Arg) -> String {
    let flags = MODES.iter().filter(|(_, options)| takes(command, options, option));
    let flags = flags.filter_map(|(flag, _)| find(command, flag)).map(|flag| format!("'{flag}'"));
    let app = takes(command, APP, option).then(|| "the app (no mode)".to_owned());
    flags.chain(app).collect::<Vec<_>>().join(" or ")
}

fn find<'a>(command: &'a Command, id: &str) -> Option<&'a Arg> {
    command.get_arguments().find(|arg| arg.get_id() == id)
}

#[cfg(test)]
mod tests {
    use std::ffi::OsString;

    use clap::CommandFactory;

    use super::*;
    use crate::cli::Arguments;

    #[test]
    fn every_option_belongs_to_a_mode_and_every_id_exists() {
        let mut command = Arguments::command();
        command.build();
        let others = ["help", "version"];
        let flags: Vec<&str> = MODES.iter().map(|(flag, _)| *flag).chain(others).collect();
        for arg in command.get_arguments().filter(|arg| !flags.contains(&arg.get_id().as_str())) {
            assert_ne!(owners(&command, arg), "", "{arg} belongs to no mode");
        }
        for id in MODES.iter().flat_map(|(flag, options)| options.iter().chain([flag])).chain(APP) {
            let is_group = command.get_groups().any(|group| group.get_id() == id);
            assert!(is_group || find(&command, id).is_some(), "`{id}` is neither an option nor a group");
        }
    }

    #[test]
    fn an_option_of_another_mode_is_rejected_and_the_error_names_both() {
        let message = |words: &str| {
            let words = ["wayfield"].into_iter().chain(words.split_whitespace()).map(OsString::from);
            Arguments::parse_words(words).expect_err("rejected").to_string()
        };
        for (words, expected) in [
            (
                "--rounds 3 --train",
                "error: the argument '--rounds <N>' cannot be used with '--train [<CONFIG>]'; help: use it with '--eval <POLICY>...'\n",
            ),
            (
                "--draw map.svg --out here",
                "error: the argument '--out <DIR>' cannot be used with '--draw <FILE>'; help: use it with '--train [<CONFIG>]' or \
                 '--reproduce' or '--import <FILE>'\n",
            ),
            (
                "--epsilon 0.5 --init policy",
                "error: the argument '--init <POLICY>' cannot be used on its own; help: use it with '--train [<CONFIG>]'\n",
            ),
            (
                "--resume run --edit",
                "error: the argument '--edit' cannot be used with '--train [<CONFIG>]'; help: use it with the app (no mode)\n",
            ),
            (
                "--resume run --eval policy",
                "error: the argument '--resume <DIR>' cannot be used with '--eval <POLICY>...'; help: use it with '--train [<CONFIG>]'\n",
            ),
        ] {
            let message = message(words);
            assert!(message.starts_with(expected), "{words}: {message}");
        }
    }

    #[test]
    fn resume_alone_selects_the_training_mode() {
        for words in ["wayfield --resume run --steps 900", "wayfield --train --resume run --json"] {
            let arguments = Arguments::parse_words(words.split(' ').map(OsString::from)).expect("accepted");
            assert!(arguments.train.resume.is_some(), "{words}");
        }
    }
}
