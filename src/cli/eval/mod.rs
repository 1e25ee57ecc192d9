//! The mode `--eval`: tests policies over rounds of episodes.
//!
//! | file | contents |
//! |---|---|
//! | `report.rs` | the results, as JSON |
//! | `text.rs` | the results, as text |
//! | `files.rs` | the files of `--csv` and `--trace` |

mod files;
mod report;
mod text;

use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use clap::Args;

use super::output::{print_json, print_stdout};
use super::policy;
use super::shared::SharedArgs;
use super::values;
use crate::learning::Policy;
use crate::limits::MAX_EVAL_EPISODES;
use crate::planner::{StepBounds, unsupported_reason};
use crate::run::evaluate::{self, EpisodeRecord, EpisodeResult, Evaluation, Evaluator, OptimumComparison};
use crate::run::progress::print_stderr;
use crate::run::signals::{exit_on_signal, stop_on_signal};
use crate::run::{RunError, policy_card, shipped};
use crate::scenario::{Scenario, benchmark_route_problem, printable};
use crate::simulation::Extensions;
use crate::task::EpisodeSetup;
use files::{TestEnd, TestFile, TestFiles};
use report::{ComparisonReport, CourseReport, OptimumReport, PolicyReport};

/// The options of `--eval`.
#[derive(Args, Debug)]
#[command(next_help_heading = "Options of --eval")]
pub struct EvalArgs {
    /// Rounds of episodes
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = values::whole::<u32>(1..=10_000), allow_negative_numbers = true)]
    rounds: u32,

    /// Also drive the scenario's benchmark route, 5 rounds of 5 episodes; the paper's, from (0, 0) to (1.2, 1.2), in
    /// Scenario I and II
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

/// What the first signal prints if the test writes files.
const STOPPING: &str = "stopping; no file is written";

/// A policy under test, with its file or shipped name.
type Named = (String, Policy);

/// A test of policies, which all drive the same episodes.
struct Test<'a> {
    scenario: Arc<Scenario>,
    /// The number of episodes.
    count: usize,
    per_round: usize,
    seed: u64,
    args: &'a EvalArgs,
    extensions: &'a Extensions,
    stop: Option<&'static AtomicBool>,
}

/// What the planner knows about the episodes of a test.
struct References {
    shortest_paths_m: Vec<f64>,
    /// Bounds of all episodes, if the file of the episodes needs them.
    bounds: Option<Vec<StepBounds>>,
}

/// Tests the policies in the files (or of the shipped names) `paths` and prints the results.
///
/// # Errors
/// The scenario, a policy, an option or a file is invalid.
pub fn run(paths: &[PathBuf], args: &EvalArgs, shared: &SharedArgs) -> Result<(), RunError> {
    let files = TestFiles::new(args.csv.as_deref(), args.trace.as_deref(), shared.json)?;
    let named = |path: &PathBuf| Ok((path.display().to_string(), policy::load(path)?));
    let policies: Vec<Named> = paths.iter().map(named).collect::<Result<_, RunError>>()?;
    let scenario = Arc::new(scenario_for(&policies, shared)?);
    if args.course {
        check_benchmark_route(&scenario)?;
    }
    for (path, (_, policy)) in paths.iter().zip(&policies) {
        policy::check(path, policy, &scenario, &shared.extensions)?;
        if let Some(note) = policy_card::note(policy, &scenario) {
            print_stderr(&format!("note: {note}"));
        }
    }
    let (count, per_round) = episode_counts(args.rounds, shared.episodes.unwrap_or(100))?;
    // Without files, there is nothing to clean up.
    let stop = (!files.is_empty()).then(|| stop_on_signal(STOPPING));
    if stop.is_none() {
        exit_on_signal();
    }
    let (seed, extensions) = (shared.seed(), &shared.extensions);
    let test = Test { scenario, count, per_round, seed, args, extensions, stop };
    match files.write(|csv, trace| test.run(&policies, csv, trace)) {
        Ok(reports) => print(&reports, shared.json, files.use_stdout()),
        Err(TestEnd::ReaderClosed) => Ok(()),
        Err(TestEnd::Error(error)) => Err(error),
    }
}

/// Prints the results: on stdout, unless that is one of the files.
fn print(reports: &[PolicyReport], json: bool, stdout_is_file: bool) -> Result<(), RunError> {
    let Some(comparison) = ComparisonReport::new(reports) else { return Ok(()) };
    let text = || match reports {
        [one] => text::list(one),
        _ => text::table(&comparison),
    };
    match (json, reports) {
        (true, [one]) => print_json(one),
        (true, _) => print_json(&comparison),
        (false, _) if stdout_is_file => {
            print_stderr(text().trim_end());
            Ok(())
        }
        (false, _) => print_stdout(&text()),
    }
}

/// Checks that the benchmark route can be driven. A scenario without one of its own has the paper's, unchecked.
fn check_benchmark_route(scenario: &Scenario) -> Result<(), RunError> {
    let Some(found) = benchmark_route_problem(scenario) else { return Ok(()) };
    Err(RunError::InvalidInput(format!(
        "{}: {found}; help: this is the paper's route: write a `benchmark_route` into the scenario, or leave out --course",
        printable(&scenario.name)
    )))
}

/// The scenario of the test: the one that the user names, or else the policies' own, or else Scenario I.
fn scenario_for(policies: &[Named], shared: &SharedArgs) -> Result<Scenario, RunError> {
    if shared.scenario.is_some() {
        return Ok(shipped::scenario(shared.scenario())?);
    }
    let mut first: Option<(&str, Scenario)> = None;
    for (name, policy) in policies {
        let own = policy_card::own_scenario(policy)
            .map_err(|error| RunError::invalid_input(Path::new(name), error))?;
        let own = own.map_or_else(|| shipped::scenario(shared.scenario()), Ok)?;
        match &first {
            Some((first_name, first)) if *first != own => {
                return Err(RunError::InvalidInput(format!(
                    "{first_name} was trained in scenario \"{}\" and {name} in \"{}\"{}; help: give --scenario, so that \
                     they drive the same episodes",
                    printable(&first.name),
                    printable(&own.name),
                    if first.name == own.name { ", which differs" } else { "" }
                )));
            }
            Some(_) => {}
            None => first = Some((name, own)),
        }
    }
    first.map_or_else(|| Ok(shipped::scenario(shared.scenario())?), |(_, own)| Ok(own))
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

impl Test<'_> {
    /// Tests `policies` one after the other, and writes their episodes and steps to the files.
    fn run(
        &self,
        policies: &[Named],
        mut csv: Option<&mut TestFile>,
        mut trace: Option<&mut TestFile>,
    ) -> Result<Vec<PolicyReport>, TestEnd> {
        if self.args.optimum
            && let Some(reason) = unsupported_reason(&self.scenario)
        {
            let name = printable(&self.scenario.name);
            print_stderr(&format!("note: no optimal times in {name}: the planner does not support {reason}"));
        }
        // A trace has one episode after the other. The number of parallel episodes changes no result.
        let parallel = if trace.is_some() { 1 } else { self.count };
        let mut evaluator =
            Evaluator::with_extensions(&self.scenario, parallel, self.extensions).measuring_paths();
        let mut references = None;
        let mut reports = Vec::new();
        for named in policies {
            let episodes = self.episodes(&mut evaluator, named, trace.as_deref_mut())?;
            // They are the same for every policy.
            let references = references.get_or_insert_with(|| self.references(&episodes, csv.is_some()));
            if let Some(csv) = &mut csv {
                csv.episodes(self.records(&named.0, &episodes, references), reports.is_empty())?;
            }
            reports.push(self.report(named, &episodes, references)?);
        }
        Ok(reports)
    }

    fn episodes(
        &self,
        evaluator: &mut Evaluator,
        (name, policy): &Named,
        trace: Option<&mut TestFile>,
    ) -> Result<Vec<EpisodeResult>, TestEnd> {
        let (seed, count, setup) = (self.seed, self.count, EpisodeSetup::Random);
        if let Some(trace) = trace {
            return evaluator.run_traced(policy, seed, count, setup, |step| {
                self.check_signals()?;
                trace.step(name, &step)
            });
        }
        let mut run = evaluator.start(policy, seed, count, setup)?;
        while !evaluator.step(&mut run)? {
            self.check_signals()?;
        }
        Ok(run.episodes)
    }

    fn check_signals(&self) -> Result<(), RunError> {
        match self.stop {
            Some(stop) if stop.load(Ordering::Relaxed) => {
                Err(RunError::Stopped("stopped before the end of the test; no file was written".into()))
            }
            _ => Ok(()),
        }
    }

    fn references(&self, episodes: &[EpisodeResult], has_csv: bool) -> References {
        References {
            shortest_paths_m: evaluate::shortest_paths_m(&self.scenario, episodes, 0),
            bounds: (has_csv && self.args.optimum).then(|| evaluate::bounds(&self.scenario, episodes, 0)),
        }
    }

    fn records<'a>(
        &'a self,
        policy: &'a str,
        episodes: &'a [EpisodeResult],
        references: &'a References,
    ) -> impl Iterator<Item = EpisodeRecord> + 'a {
        episodes.iter().zip(&references.shortest_paths_m).enumerate().map(
            move |(index, (episode, shortest_m))| {
                let bounds = references.bounds.as_ref().and_then(|bounds| bounds.get(index).copied());
                EpisodeRecord::new(policy, index + 1, episode, &self.scenario, *shortest_m, bounds)
            },
        )
    }

    fn report(
        &self,
        (name, policy): &Named,
        episodes: &[EpisodeResult],
        references: &References,
    ) -> Result<PolicyReport, RunError> {
        let Self { scenario, seed, .. } = self;
        let spl = episodes
            .iter()
            .zip(&references.shortest_paths_m)
            .filter_map(|(e, shortest_m)| e.spl(*shortest_m));
        let compare = || match &references.bounds {
            Some(bounds) => OptimumComparison::from_episodes(episodes, bounds, &scenario.task),
            None => evaluate::compare_with_optimum(scenario, episodes),
        };
        let course = || CourseReport::new(scenario, policy, *seed, self.extensions);
        Ok(PolicyReport {
            policy: name.clone(),
            scenario: scenario.name.clone(),
            evaluation: Evaluation::from_episodes(episodes, self.per_round, &scenario.task, *seed),
            spl: spl.sum::<f64>() / episodes.len() as f64,
            course: self.args.course.then(course).transpose()?,
            optimum: self.args.optimum.then(|| OptimumReport::new(compare())),
        })
    }
}
