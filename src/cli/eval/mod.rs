//! The mode `--eval`: its options, and the policies, drivers, scenario and files that a test needs.
//!
//! | file | contents |
//! |---|---|
//! | `test.rs` | the test in one scenario |
//! | `suite.rs` | the test in a suite |
//! | `suite_page.rs`, `suite_failures.rs` | the report on a suite, with images of all failures |
//! | `report.rs` | the results, as JSON |
//! | `text.rs` | the results, as text |
//! | `files.rs` | the files of `--csv` and `--trace` |

mod files;
mod report;
mod suite;
mod suite_failures;
mod suite_page;
mod test;
mod text;

use std::path::PathBuf;
use std::sync::Arc;

use clap::Args;
use serde::Serialize;

use super::driver::TestDriver;
use super::output::{print_json, print_stdout};
use super::shared::SharedArgs;
use super::values;
use crate::limits::MAX_EVAL_EPISODES;
use crate::run::progress::print_stderr;
use crate::run::shipped::Source;
use crate::run::signals::{exit_on_signal, stop_on_signal};
use crate::run::{RunError, policy_card, shipped};
use crate::scenario::{BenchmarkRoute, Scenario, printable};
use files::{TestEnd, TestFiles};
use report::{ComparisonReport, PolicyReport};
use test::{Named, Test};

/// The options of `--eval`.
#[derive(Args, Debug)]
#[command(next_help_heading = "Options of --eval")]
pub struct EvalArgs {
    /// Test in many scenarios, with results by family: a suite (a RON file, or a shipped one by name: shipped, validation,
    /// general, circle-crossing), a folder of scenarios, a set of scenarios, or a level generator, in levels that no training
    /// run uses; --episodes is the number in each scenario
    #[arg(long, value_name = "NAME", conflicts_with = "scenario")]
    suite: Option<String>,

    /// Write a report of a test in a suite, or in what --scenario names, into DIR: the results, and an image of every failure
    /// with the command that repeats it in the app. If DIR holds an interrupted test, the test continues
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,

    /// Rounds of episodes [default: 5]
    #[arg(long, value_name = "N", value_parser = values::whole::<u32>(1..=10_000), allow_negative_numbers = true)]
    rounds: Option<u32>,

    /// Also drive the scenario's benchmark route, 5 rounds of 5 episodes; in Scenarios I and II it is the paper's, from
    /// (0, 0) to (1.2, 1.2)
    #[arg(long)]
    course: bool,

    /// Also compare the times with the optimal ones, from a planner that knows the whole scenario
    #[arg(long)]
    optimum: bool,

    /// Write a row per episode to a CSV file: start, goal, outcome, what was hit, time, path length, SPL, clearance;
    /// `-` for standard output
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,

    /// Write every control step to a file of JSON lines: pose, speed, scan, Q-values, action, reward; `-` for standard
    /// output
    #[arg(long, value_name = "FILE")]
    trace: Option<PathBuf>,
}

/// The message on the first signal if the test writes files.
const STOPPING: &str = "stopping; no file is written";

/// The message on the first signal if the test writes a report, without plugins: tests with plugins are not stored.
const STOPPING_REPORT: &str = "stopping; finished tests are kept";

/// Tests the policies and drivers `paths`, which are files or shipped names, and prints the results.
///
/// # Errors
/// The scenario, a policy, an option or a file is invalid.
pub fn run(paths: &[PathBuf], args: &EvalArgs, shared: &SharedArgs) -> Result<(), RunError> {
    // Must come before the first file is created. Without files, there is nothing to clean up.
    let has_files = args.csv.is_some() || args.trace.is_some() || args.report.is_some();
    let keeps_tests = args.report.is_some() && shared.extensions.is_empty();
    let stopping = if keeps_tests { STOPPING_REPORT } else { STOPPING };
    let stop = has_files.then(|| stop_on_signal(stopping));
    if stop.is_none() {
        exit_on_signal();
    }
    let files = TestFiles::new(args.csv.as_deref(), args.trace.as_deref(), shared.json)?;
    let named = |path: &PathBuf| Ok((path.display().to_string(), TestDriver::load(path)?));
    let policies: Vec<Named> = paths.iter().map(named).collect::<Result<_, RunError>>()?;
    if let Some(suite) = suite_name(args, shared)? {
        return suite::run(suite, (paths, &policies), args, shared, (&files, stop));
    }
    let mut scenario = scenario_for(&policies, shared)?;
    shared.settings().apply_to_scenario(&mut scenario)?;
    let scenario = Arc::new(scenario);
    let route = args.course.then(|| benchmark_route(&scenario)).transpose()?;
    for (path, (_, driver)) in paths.iter().zip(&policies) {
        driver.check(path, &scenario, &shared.extensions)?;
        if let Some(note) = driver.policy().and_then(|policy| policy_card::note(policy, &scenario)) {
            print_stderr(&format!("note: {}: {note}", path.display()));
        }
    }
    let (count, per_round) = episode_counts(args.rounds.unwrap_or(5), shared.episodes.unwrap_or(100))?;
    let (seed, extensions) = (shared.seed(), &shared.extensions);
    let test = Test { scenario, count, per_round, seed, route, args, extensions, stop };
    match files.write(|csv, trace| test.run(&policies, csv, trace)) {
        Ok(reports) => print(&reports, shared.json, files.use_stdout()),
        Err(TestEnd::ReaderClosed) => {
            files.print_reader_closed();
            Ok(())
        }
        Err(TestEnd::Error(error)) => Err(error),
    }
}

/// The suite of the test: what `--suite` names, or what `--scenario` names if that is a set, or if a report is written.
fn suite_name<'a>(args: &'a EvalArgs, shared: &'a SharedArgs) -> Result<Option<&'a str>, RunError> {
    match (&args.suite, &shared.scenario) {
        (None, Some(name)) if matches!(Source::load(name)?, Source::Set(..)) || args.report.is_some() => {
            Ok(Some(name))
        }
        (None, None) if args.report.is_some() => Err(RunError::InvalidInput(
            "--report needs scenarios to test in; help: give --suite NAME, or --scenario NAME with a scenario, a set or a \
             level generator"
                .into(),
        )),
        (suite, _) => Ok(suite.as_deref()),
    }
}

/// Prints the results of a test in one scenario.
fn print(reports: &[PolicyReport], json: bool, stdout_is_file: bool) -> Result<(), RunError> {
    let Some(comparison) = ComparisonReport::new(reports) else { return Ok(()) };
    match reports {
        [one] => print_results(one, || text::list(one), json, stdout_is_file),
        _ => print_results(&comparison, || text::table(&comparison), json, stdout_is_file),
    }
}

/// Prints results as JSON or as text on stdout. If stdout is one of the files, the text goes to stderr.
fn print_results(
    report: &impl Serialize,
    text: impl FnOnce() -> String,
    json: bool,
    stdout_is_file: bool,
) -> Result<(), RunError> {
    if json {
        return print_json(report);
    }
    if stdout_is_file {
        print_stderr(text().trim_end());
        return Ok(());
    }
    print_stdout(&text())
}

/// The scenario's benchmark route.
fn benchmark_route(scenario: &Scenario) -> Result<BenchmarkRoute, RunError> {
    scenario.benchmark_route.ok_or_else(|| {
        RunError::InvalidInput(format!(
            "{} has no benchmark route; help: write one into the scenario, such as \
             `benchmark_route: (start_m: (0.0, 0.0), goal_m: (1.2, 1.2))`, or leave out --course",
            printable(&scenario.name)
        ))
    })
}

/// The scenario of the test: the one that the user names, or else that of the policies, or else Scenario I.
fn scenario_for(policies: &[Named], shared: &SharedArgs) -> Result<Scenario, RunError> {
    if shared.scenario.is_some() {
        return Ok(shipped::scenario(shared.scenario())?);
    }
    let with_policy = policies.iter().filter_map(|(name, driver)| Some((name.as_str(), driver.policy()?)));
    policy_card::common_scenario(with_policy)
}

/// The total number of episodes, and the number per round.
fn episode_counts(rounds: u32, episodes: u64) -> Result<(usize, usize), RunError> {
    let count = u64::from(rounds).saturating_mul(episodes);
    if count > MAX_EVAL_EPISODES {
        return Err(RunError::InvalidInput(format!(
            "--rounds {rounds} with --episodes {episodes} is {count} episodes; help: give at most {MAX_EVAL_EPISODES} in total"
        )));
    }
    Ok((count as usize, episodes as usize))
}
