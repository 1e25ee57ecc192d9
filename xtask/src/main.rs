//! Maintenance commands, run as `cargo xtask <command>`.
//!
//! Most of them regenerate files that tests compare with what the code would write.

use std::path::Path;
use std::process::{Command, ExitCode};

const USAGE: &str = "\
usage: cargo xtask <command>

  docs        regenerate the file formats in docs/ (from the types), the flags in docs/command-line.md
              (from clap) and the limits in docs/trust.md (from the constants)
  policies    regenerate the cards of the shipped policies in assets/policies/; the weights do not change
  messages    regenerate the error messages in tests/snapshots/messages/ and crates/scenario/tests/fixtures/
  snapshots   regenerate the app's screenshots in tests/snapshots/; look at each before you commit it
  images      redraw the shipped scenarios in docs/worlds/ and the level generators in docs/generators/
  ci          run all CI checks, .ci/run";

/// One step: a program, its arguments, and the environment variables that make a test write instead of compare.
struct Step<'a> {
    program: &'a str,
    arguments: Vec<String>,
    variables: &'a [(&'a str, &'a str)],
}

fn main() -> ExitCode {
    let command = std::env::args().nth(1).unwrap_or_default();
    let Some(steps) = steps(&command) else {
        eprintln!("{USAGE}");
        return ExitCode::from(2);
    };
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap_or(Path::new("."));
    for Step { program, arguments, variables } in steps {
        eprintln!("+ {program} {}", arguments.join(" "));
        let status =
            Command::new(program).args(&arguments).envs(variables.iter().copied()).current_dir(root).status();
        match status {
            Ok(status) if status.success() => {}
            Ok(_) => return ExitCode::FAILURE,
            Err(error) => {
                eprintln!("error: {program} cannot be started: {error}");
                return ExitCode::FAILURE;
            }
        }
    }
    ExitCode::SUCCESS
}

/// The steps of `command`; None if there is no such command.
fn steps(command: &str) -> Option<Vec<Step<'static>>> {
    const RENEW: &[(&str, &str)] = &[("WAYFIELD_RENEW", "1")];
    const UPDATE: &[(&str, &str)] = &[("UPDATE_SNAPSHOTS", "1")];
    Some(match command {
        "docs" => {
            vec![cargo("test --release -p wayfield --lib -- flag_tables limits::table format_docs", RENEW)]
        }
        "policies" => {
            vec![cargo("test --release -p wayfield --lib -- the_cards_of_the_shipped_policies", RENEW)]
        }
        "messages" => vec![
            cargo("test --release -p wayfield --test cli_errors", RENEW),
            cargo("test --release -p wayfield --test cli_policy_card reversed_or_reordered", RENEW),
            cargo("test --release -p wayfield --test cli_export invalid_exports", RENEW),
            cargo("test --release -p wayfield --test cli_check faults_of_every_kind", RENEW),
            cargo("test --release -p wayfield-scenario --test errors", RENEW),
        ],
        "snapshots" => vec![cargo("test --release -p wayfield --test app_snapshots", UPDATE)],
        "images" => images(),
        "ci" => vec![Step { program: "bash", arguments: vec![".ci/run".into()], variables: &[] }],
        _ => return None,
    })
}

/// One step per shipped scenario and per shipped level generator.
fn images() -> Vec<Step<'static>> {
    let draw = |options: String| cargo(&format!("run --release -p wayfield -- {options}"), &[]);
    let scenario = |name: String| format!("--scenario {name} --plain --draw docs/worlds/{name}.png");
    let sheet = |name: String| {
        format!("--scenario {name} --levels 8 --size 940x640 --draw docs/generators/{name}.png")
    };
    let scenarios = names("../scenarios").into_iter().map(scenario);
    scenarios.chain(names("../scenarios/generators").into_iter().map(sheet)).map(draw).collect()
}

/// The names of the RON files in a folder, sorted.
fn names(folder: &str) -> Vec<String> {
    let entries =
        std::fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join(folder)).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries
        .filter_map(|file| Some(file.file_name().to_str()?.strip_suffix(".ron")?.to_owned()))
        .collect();
    names.sort();
    names
}

fn cargo(arguments: &str, variables: &'static [(&'static str, &'static str)]) -> Step<'static> {
    Step { program: "cargo", arguments: arguments.split(' ').map(String::from).collect(), variables }
}
