//! The mode `--eval`: tests a policy over rounds of episodes.

use std::fmt::Write as _;
use std::path::Path;
use std::sync::Arc;

use clap::Args;
use serde::Serialize;

use super::output::{print_json, print_stdout};
use super::policy;
use super::shared::SharedArgs;
use super::values;
use crate::learning::Policy;
use crate::limits::MAX_EVAL_EPISODES;
use crate::planner::unsupported_reason;
use crate::run::evaluate::{self, EpisodeResult, Evaluation, Evaluator};
use crate::run::progress::print_stderr;
use crate::run::{RunError, policy_card, shipped};
use crate::scenario::{BenchmarkRoute, Scenario, printable};
use crate::simulation::Extensions;
use crate::task::EpisodeSetup;

/// The number of episodes on the benchmark route (the paper: 5 rounds of 5).
const ROUTE_EPISODES: usize = 25;
/// The number of these episodes per round.
const ROUTE_EPISODES_PER_ROUND: usize = 5;

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
}

/// The JSON object that `--eval --json` prints.
#[derive(Serialize)]
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

/// The policy's results on the benchmark route.
#[derive(Serialize)]
struct CourseReport {
    course_success_rate: f64,
    course_time_s: Option<f64>,
    course_times_s: Vec<f64>,
    /// Whether this is the paper's Scenario I, whose time applies.
    #[serde(skip)]
    in_paper_scenario: bool,
}

/// The policy's times, compared with the optimal ones.
#[derive(Serialize)]
struct OptimumReport {
    optimum_episodes: usize,
    optimum_mean_time_s: Option<f64>,
    time_ratio: Option<f64>,
}

/// Tests the policy in the file at `path` and prints the results.
///
/// # Errors
/// The scenario, the policy or an option is invalid.
pub fn run(path: &Path, args: &EvalArgs, shared: &SharedArgs) -> Result<(), RunError> {
    let policy = policy_card::read(path)?;
    let mut scenario = scenario_for(path, &policy, shared)?;
    shared.settings().apply_to_scenario(&mut scenario)?;
    let scenario = Arc::new(scenario);
    let route = args.course.then(|| benchmark_route(&scenario)).transpose()?;
    policy::check(path, &policy, &scenario, &shared.extensions)?;
    if let Some(note) = policy_card::note(&policy, &scenario) {
        print_stderr(&format!("note: {note}"));
    }
    let (count, per_round) = episode_counts(args.rounds, shared.episodes.unwrap_or(100))?;
    let seed = shared.seed();
    let episodes = Evaluator::with_extensions(&scenario, count, &shared.extensions).run(
        &policy,
        seed,
        count,
        EpisodeSetup::Random,
    )?;
    let evaluation = Evaluation::from_episodes(&episodes, per_round, &scenario.task, seed);
    let course = route
        .map(|route| CourseReport::new(&scenario, route, &policy, seed, &shared.extensions))
        .transpose()?;
    let optimum = args.optimum.then(|| OptimumReport::new(&scenario, &episodes));
    let report = EvaluationReport {
        policy: path.display().to_string(),
        scenario: scenario.name.clone(),
        evaluation,
        course,
        optimum,
    };
    if shared.json { print_json(&report) } else { print_stdout(&report.text()) }
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

/// The scenario of the test: the one that the user names, or else the policy's own, or else Scenario I.
fn scenario_for(path: &Path, policy: &Policy, shared: &SharedArgs) -> Result<Scenario, RunError> {
    if shared.scenario.is_none() {
        let own = policy_card::own_scenario(policy).map_err(|error| RunError::invalid_input(path, error))?;
        if let Some(own) = own {
            return Ok(own);
        }
    }
    Ok(shipped::scenario(shared.scenario())?)
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

impl CourseReport {
    fn new(
        scenario: &Arc<Scenario>,
        route: BenchmarkRoute,
        policy: &Policy,
        seed: u64,
        extensions: &Extensions,
    ) -> Result<Self, RunError> {
        let mut evaluator = Evaluator::with_extensions(scenario, ROUTE_EPISODES, extensions);
        let episodes = evaluator.run(policy, seed, ROUTE_EPISODES, EpisodeSetup::Route(route))?;
        let evaluation = Evaluation::from_episodes(&episodes, ROUTE_EPISODES_PER_ROUND, &scenario.task, seed);
        Ok(Self {
            course_success_rate: evaluation.success_rate,
            course_time_s: evaluation.mean_time_s,
            course_times_s: evaluate::times_s(&episodes, scenario.task.control_period_s).collect(),
            in_paper_scenario: shipped::is_paper_scenario_1(scenario),
        })
    }
}

impl OptimumReport {
    fn new(scenario: &Scenario, episodes: &[EpisodeResult]) -> Self {
        if let Some(reason) = unsupported_reason(scenario) {
            print_stderr(&format!(
                "note: no optimal times in {}: the planner does not support {reason}",
                scenario.name
            ));
        }
        let comparison = evaluate::compare_with_optimum(scenario, episodes);
        Self {
            optimum_episodes: comparison.map_or(0, |c| c.episodes),
            optimum_mean_time_s: comparison.map(|c| c.optimum_mean_time_s),
            time_ratio: comparison.map(|c| c.time_ratio),
        }
    }
}

impl EvaluationReport {
    fn text(&self) -> String {
        let e = &self.evaluation;
        let rounds: Vec<String> = e.rounds.iter().map(|r| format!("{:.0}", 100.0 * r)).collect();
        let mut text = format!(
            "{} in {}, {} episodes, seed {}\n\
             success         {:.1} %  (rounds: {})\n\
             collision       {:.1} %\n\
             timeout         {:.1} %\n\
             mean time       {}\n",
            self.policy,
            printable(&self.scenario),
            e.episodes,
            e.seed,
            100.0 * e.success_rate,
            rounds.join(" "),
            100.0 * e.collision_rate,
            100.0 * e.timeout_rate,
            seconds(e.mean_time_s),
        );
        if let Some(course) = &self.course {
            let _ = writeln!(
                text,
                "benchmark route {}, {:.0} % of {ROUTE_EPISODES} episodes{}",
                seconds(course.course_time_s),
                100.0 * course.course_success_rate,
                if course.in_paper_scenario { " (the paper's PER-D3QN: 13.155 s)" } else { "" },
            );
        }
        if let Some(optimum) = &self.optimum {
            let _ = match optimum.time_ratio {
                Some(ratio) => writeln!(
                    text,
                    "optimal time    {} over {} of these episodes; the policy takes {ratio:.3} times as long",
                    seconds(optimum.optimum_mean_time_s),
                    optimum.optimum_episodes,
                ),
                None if e.success_rate == 0.0 => {
                    writeln!(text, "optimal time    not compared: no episode succeeded")
                }
                None => {
                    writeln!(
                        text,
                        "optimal time    not compared: the planner found no path in these episodes"
                    )
                }
            };
        }
        text
    }
}

fn seconds(time_s: Option<f64>) -> String {
    time_s.map_or("-".into(), |s| format!("{s:.3} s"))
}
