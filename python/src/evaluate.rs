//! Evaluations: a policy tested over episodes, as by `wayfield --eval`.

use std::sync::Arc;

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use serde::Serialize;
use wayfield::limits::MAX_EVAL_EPISODES;
use wayfield::planner::StepBounds;
use wayfield::policy::Policy;
use wayfield::run::evaluate::{
    EpisodeRecord, EpisodeResult, Evaluation, Evaluator, OptimumComparison, bounds as step_bounds,
    shortest_paths_m,
};
use wayfield::run::policy_card;
use wayfield::scenario::Scenario;
use wayfield::task::EpisodeSetup;

use crate::act_function::ActFunction;
use crate::env_options::{self, scenario as find_scenario};
use crate::errors::{detached, run_error, setting_errors};
use crate::policy::NativePolicy;

/// The control steps between two checks for Ctrl-C.
const STEPS_BETWEEN_SIGNALS: u32 = 50;

/// The episodes that are planned between two checks for Ctrl-C.
const PLANNED_AT_ONCE: usize = 50;

/// The options of an evaluation.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct EvaluateOptions {
    scenario: Option<String>,
    settings: Vec<(String, String)>,
    seed: u64,
    episodes: u64,
    rounds: u64,
    benchmark_route: bool,
    optimum: bool,
}

/// What the Python layer gets, as JSON.
#[derive(Serialize)]
struct Report {
    weights_crc32c: Option<String>,
    scenario: String,
    warning: Option<String>,
    #[serde(flatten)]
    evaluation: Evaluation,
    optimum_mean_time_s: Option<f64>,
    time_ratio: Option<f64>,
    records: Vec<EpisodeRecord>,
}

/// Tests `policy`. Returns the report as JSON.
#[pyfunction]
pub fn evaluate(
    py: Python<'_>,
    policy: PyRef<'_, NativePolicy>,
    options: EvaluateOptions,
) -> PyResult<String> {
    report(py, &Chooser::Policy(&policy.policy), options)
}

/// Tests the function `act`, which gets observations in `observation` (`scaled` or `raw`), as bytes, and their number. It returns
/// an array of actions (i64), or with `is_continuous` of motions (f32, rows x 2: m/s, rad/s). Returns the report as JSON.
#[pyfunction]
pub fn evaluate_function(
    py: Python<'_>,
    act: Py<PyAny>,
    observation: &str,
    is_continuous: bool,
    options: EvaluateOptions,
) -> PyResult<String> {
    let encoding = env_options::encoding(observation)?;
    report(py, &Chooser::Function(&ActFunction { act, encoding, is_continuous }), options)
}

/// What chooses the actions.
enum Chooser<'a> {
    Policy(&'a Policy),
    Function(&'a ActFunction),
}

fn report(py: Python<'_>, chooser: &Chooser<'_>, options: EvaluateOptions) -> PyResult<String> {
    let count = options.episodes.saturating_mul(options.rounds);
    if !(1..=MAX_EVAL_EPISODES).contains(&count) {
        return Err(PyValueError::new_err(format!(
            "episodes={} with rounds={} is {count} episodes; help: give 1 to {MAX_EVAL_EPISODES} in total",
            options.episodes, options.rounds
        )));
    }
    let mut scenario = match (&options.scenario, chooser) {
        (Some(wanted), _) => find_scenario(wanted)?,
        (None, Chooser::Policy(policy)) => own_scenario(policy)?,
        (None, Chooser::Function(_)) => find_scenario("scenario-1")?,
    };
    let settings = env_options::settings(options.settings);
    settings.apply_to_scenario(&mut scenario).map_err(setting_errors)?;
    let scenario = Arc::new(scenario);
    let setup = if options.benchmark_route { route(&scenario)? } else { EpisodeSetup::Random };
    let (seed, per_round, optimum) = (options.seed, options.episodes as usize, options.optimum);
    detached(py, || {
        let results = run(chooser, &scenario, seed, count as usize, setup)?;
        let (shortest_m, bounds) = plan(&scenario, &results, optimum)?;
        let comparison = OptimumComparison::from_episodes(&results, &bounds, &scenario.task);
        let records = results.iter().zip(&shortest_m).enumerate().map(|(index, (episode, shortest_m))| {
            EpisodeRecord::new("", index + 1, episode, &scenario, *shortest_m, bounds.get(index).copied())
        });
        let report = Report {
            weights_crc32c: match chooser {
                Chooser::Policy(policy) => Some(policy.weights_crc32c()),
                Chooser::Function(_) => None,
            },
            scenario: scenario.name.clone(),
            warning: match chooser {
                Chooser::Policy(policy) => policy_card::warning(policy, &scenario).map_err(run_error)?,
                Chooser::Function(_) => None,
            },
            evaluation: Evaluation::from_episodes(&results, per_round, &scenario.task, seed),
            optimum_mean_time_s: comparison.as_ref().map(|c| c.optimum_mean_time_s),
            time_ratio: comparison.as_ref().map(|c| c.time_ratio),
            records: records.collect(),
        };
        serde_json::to_string(&report).map_err(|error| PyRuntimeError::new_err(error.to_string()))
    })
}

/// The results of `count` episodes.
fn run(
    chooser: &Chooser<'_>,
    scenario: &Arc<Scenario>,
    seed: u64,
    count: usize,
    setup: EpisodeSetup,
) -> PyResult<Vec<EpisodeResult>> {
    let mut evaluator = Evaluator::new(scenario, count).measuring_paths();
    let mut run = match chooser {
        Chooser::Policy(policy) => evaluator.start(policy, seed, count, setup).map_err(run_error)?,
        Chooser::Function(function) => evaluator.start_commanded(function.encoding, seed, count, setup),
    };
    loop {
        for _ in 0..STEPS_BETWEEN_SIGNALS {
            if let Chooser::Function(function) = chooser {
                function.command(&mut evaluator, &mut run, scenario.robot.motions.len())?;
            }
            if evaluator.step(&mut run).map_err(run_error)? {
                return Ok(run.episodes);
            }
        }
        check_ctrl_c()?;
    }
}

/// The shortest path of each episode in m; with `optimum` also the bounds on its optimal time.
fn plan(
    scenario: &Scenario,
    results: &[EpisodeResult],
    optimum: bool,
) -> PyResult<(Vec<f64>, Vec<StepBounds>)> {
    let (mut shortest_m, mut bounds) = (Vec::new(), Vec::new());
    for some in results.chunks(PLANNED_AT_ONCE) {
        check_ctrl_c()?;
        shortest_m.extend(shortest_paths_m(scenario, some, 0));
        if optimum {
            bounds.extend(step_bounds(scenario, some, 0));
        }
    }
    Ok((shortest_m, bounds))
}

fn check_ctrl_c() -> PyResult<()> {
    Python::attach(|py| {
        py.check_signals()?;
        Ok(())
    })
}

/// The scenario's benchmark route in every episode.
fn route(scenario: &Scenario) -> PyResult<EpisodeSetup> {
    scenario.benchmark_route.map(EpisodeSetup::Route).ok_or_else(|| {
        PyValueError::new_err(format!(
            "{} has no benchmark route; help: write one into the scenario, such as \
             `benchmark_route: (start_m: (0.0, 0.0), goal_m: (1.2, 1.2))`, or leave out benchmark_route",
            scenario.name
        ))
    })
}

/// The scenario that `policy` was trained in, or Scenario I for a policy without a card.
fn own_scenario(policy: &Policy) -> PyResult<Scenario> {
    match policy_card::own_scenario(policy).map_err(run_error)? {
        Some(scenario) => Ok(scenario),
        None => find_scenario("scenario-1"),
    }
}
