//! Evaluations: policies and drivers tested over episodes, as by `wayfield --eval`.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use serde::Serialize;
use wayfield::cli::TestDriver;
use wayfield::drivers::DriverClass;
use wayfield::limits::MAX_EVAL_EPISODES;
use wayfield::planner::StepBounds;
use wayfield::policy::Policy;
use wayfield::run::evaluate::{
    EpisodeRecord, EpisodeResult, Evaluation, Evaluator, OptimumComparison, bounds as step_bounds,
    shortest_paths_m,
};
use wayfield::run::output_file::{Sink, check_writable, write_atomic};
use wayfield::run::{RunError, policy_card};
use wayfield::scenario::{Scenario, to_ron};
use wayfield::task::EpisodeSetup;

use crate::act_function::ActFunction;
use crate::env_options::{self, scenario as find_scenario};
use crate::errors::{check_ctrl_c, detached, run_error, setting_errors};
use crate::tested::Tested;

/// The number of control steps between two checks for Ctrl-C.
const STEPS_BETWEEN_CHECKS: u32 = 50;

/// The number of episodes that are planned between two checks for Ctrl-C.
const PLANNED_AT_ONCE: usize = 50;

/// The options of an evaluation.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct EvaluateOptions {
    names: Vec<String>,
    scenario: Option<String>,
    settings: Vec<(String, String)>,
    seed: u64,
    episodes: u64,
    rounds: u64,
    benchmark_route: bool,
    optimum: bool,
    trace: Option<PathBuf>,
}

impl EvaluateOptions {
    /// The number of episodes in all rounds.
    fn count(&self) -> PyResult<u64> {
        let Self { episodes, rounds, .. } = self;
        let count = episodes.saturating_mul(*rounds);
        if (1..=MAX_EVAL_EPISODES).contains(&count) {
            return Ok(count);
        }
        Err(PyValueError::new_err(format!(
            "episodes={episodes} with rounds={rounds} is {count} episodes; help: give 1 to {MAX_EVAL_EPISODES} in total"
        )))
    }
}

/// The results of a policy or a driver as the Python layer gets them, in JSON.
#[derive(Serialize)]
struct Report {
    driver_class: DriverClass,
    weights_crc32c: Option<String>,
    scenario: String,
    warning: Option<String>,
    #[serde(flatten)]
    evaluation: Evaluation,
    spl: f64,
    optimum_mean_time_s: Option<f64>,
    time_ratio: Option<f64>,
    records: Vec<EpisodeRecord>,
}

/// An evaluation that is ready to run.
struct Test<'a> {
    drivers: &'a [(String, TestDriver)],
    scenario: Arc<Scenario>,
    setup: EpisodeSetup,
    seed: u64,
    /// The number of episodes in all rounds.
    count: usize,
    /// The number of episodes in a round.
    per_round: usize,
    optimum: bool,
}

/// The planner's results for each episode, to which those of the drivers are compared.
struct References {
    shortest_m: Vec<f64>,
    bounds: Vec<StepBounds>,
}

/// Tests `drivers` in the same episodes. Returns a list of reports as JSON.
#[pyfunction]
pub fn evaluate(py: Python<'_>, drivers: Vec<Tested<'_>>, options: EvaluateOptions) -> PyResult<String> {
    let drivers = named(&options.names, &drivers)?;
    run_test(py, &drivers, options, |test, trace| match trace {
        Some(path) => test.traced(path),
        None => test.run(None),
    })
}

/// Tests the function `act`. Its argument is an array of observations (rows x width), encoded as `observation` says: `scaled` or
/// `raw`. Its result is an array of actions, of the kind `actions`: `discrete` (rows), or `continuous` (rows x 2: m/s, rad/s).
/// Returns a list of one report as JSON.
#[pyfunction]
pub fn evaluate_function(
    py: Python<'_>,
    act: Py<PyAny>,
    observation: &str,
    actions: &str,
    options: EvaluateOptions,
) -> PyResult<String> {
    let is_continuous = env_options::is_continuous(actions)?;
    let function = ActFunction { act, encoding: env_options::encoding(observation)?, is_continuous };
    run_test(py, &[], options, |test, _| test.function(&function).map(|report| vec![report]))
}

/// Makes the test of `drivers`, and passes it to `run` with the path of the trace. Returns a list of reports as JSON.
fn run_test(
    py: Python<'_>,
    drivers: &[(String, TestDriver)],
    options: EvaluateOptions,
    run: impl FnOnce(&Test<'_>, Option<&Path>) -> PyResult<Vec<Report>> + Send,
) -> PyResult<String> {
    let count = options.count()?;
    let scenario = Arc::new(scenario(options.scenario.as_deref(), options.settings, drivers)?);
    let setup = if options.benchmark_route { route(&scenario)? } else { EpisodeSetup::Random };
    let EvaluateOptions { seed, optimum, trace, episodes, .. } = options;
    detached(py, || {
        let (count, per_round) = (count as usize, episodes as usize);
        let test = Test { drivers, scenario, setup, seed, count, per_round, optimum };
        serde_json::to_string(&run(&test, trace.as_deref())?)
            .map_err(|error| PyRuntimeError::new_err(error.to_string()))
    })
}

/// The RON text of the scenario in which `drivers` are tested, with all settings. Fails if `evaluate` would refuse the test.
#[pyfunction]
pub fn evaluation_scenario(drivers: Vec<Tested<'_>>, options: EvaluateOptions) -> PyResult<String> {
    options.count()?;
    let drivers = named(&options.names, &drivers)?;
    let scenario = Arc::new(scenario(options.scenario.as_deref(), options.settings, &drivers)?);
    let setup = if options.benchmark_route { route(&scenario)? } else { EpisodeSetup::Random };
    let mut evaluator = Evaluator::new(&scenario, 1);
    for (_, driver) in &drivers {
        evaluator.start(driver.evaluated(), options.seed, 1, setup).map_err(run_error)?;
    }
    to_ron(&*scenario).map_err(|error| PyRuntimeError::new_err(error.to_string()))
}

fn named(names: &[String], drivers: &[Tested<'_>]) -> PyResult<Vec<(String, TestDriver)>> {
    names.iter().zip(drivers).map(|(name, tested)| Ok((name.clone(), tested.driver()?))).collect()
}

/// The scenario `wanted`, changed by `settings`. Without `wanted`, the one that all policies among `drivers` were trained in;
/// without a policy, Scenario I.
fn scenario(
    wanted: Option<&str>,
    settings: Vec<(String, String)>,
    drivers: &[(String, TestDriver)],
) -> PyResult<Scenario> {
    let policies = drivers.iter().filter_map(|(name, driver)| Some((name.as_str(), driver.policy()?)));
    let mut scenario = match wanted {
        Some(wanted) => find_scenario(wanted)?,
        None => policy_card::common_scenario(policies).map_err(run_error)?,
    };
    env_options::settings(settings).apply_to_scenario(&mut scenario).map_err(setting_errors)?;
    Ok(scenario)
}

impl Test<'_> {
    /// Tests all drivers, and writes every control step to the file at `path`, which appears when all are tested.
    fn traced(&self, path: &Path) -> PyResult<Vec<Report>> {
        check_writable(path).map_err(run_error)?;
        let mut done = None;
        let written = write_atomic(path, |sink| {
            let result = done.insert(self.run(Some((path, sink))));
            // The error that matters is in `done`; this one keeps the old file.
            if result.is_ok() { Ok(()) } else { Err(io::Error::other("the test has failed")) }
        });
        match (written, done) {
            (_, Some(Err(error))) => Err(error),
            (Ok(()), Some(reports)) => reports,
            (Err(error), _) => Err(run_error(RunError::not_written(path, &error))),
            (Ok(()), None) => Err(PyRuntimeError::new_err("no test was run")),
        }
    }

    fn run(&self, mut trace: Option<(&Path, &mut Sink<'_>)>) -> PyResult<Vec<Report>> {
        // A trace lists one episode after the other. The number of parallel episodes changes no result.
        let parallel = if trace.is_some() { 1 } else { self.count };
        let mut evaluator = Evaluator::new(&self.scenario, parallel).measuring_paths();
        let mut references = None;
        let mut reports = Vec::new();
        for (name, driver) in self.drivers {
            let episodes = match &mut trace {
                Some((path, sink)) => self.traced_episodes(&mut evaluator, name, driver, (path, sink))?,
                None => self.episodes(&mut evaluator, driver)?,
            };
            // The references are the same for every driver.
            let references = match &mut references {
                Some(references) => references,
                none => none.insert(self.plan(&episodes)?),
            };
            reports.push(self.report(Some(driver), &episodes, references)?);
        }
        Ok(reports)
    }

    fn episodes(&self, evaluator: &mut Evaluator, driver: &TestDriver) -> PyResult<Vec<EpisodeResult>> {
        let started = evaluator.start(driver.evaluated(), self.seed, self.count, self.setup);
        let mut run = started.map_err(run_error)?;
        loop {
            for _ in 0..STEPS_BETWEEN_CHECKS {
                if evaluator.step(&mut run).map_err(run_error)? {
                    return Ok(run.episodes);
                }
            }
            check_ctrl_c()?;
        }
    }

    fn traced_episodes(
        &self,
        evaluator: &mut Evaluator,
        name: &str,
        driver: &TestDriver,
        (path, sink): (&Path, &mut Sink<'_>),
    ) -> PyResult<Vec<EpisodeResult>> {
        let result = evaluator.run_traced(driver.evaluated(), self.seed, self.count, self.setup, |step| {
            if step.step % STEPS_BETWEEN_CHECKS == 0 {
                check_ctrl_c().map_err(TraceError::Raised)?;
            }
            step.write_line(name, &mut *sink).map_err(TraceError::Unwritable)
        });
        result.map_err(|error| match error {
            TraceError::Run(error) => run_error(error),
            TraceError::Raised(error) => error,
            TraceError::Unwritable(error) => run_error(RunError::not_written(path, error)),
        })
    }

    /// Plans the shortest path of each episode; if wanted, also the bounds on its optimal time.
    fn plan(&self, episodes: &[EpisodeResult]) -> PyResult<References> {
        let mut references = References { shortest_m: Vec::new(), bounds: Vec::new() };
        for some in episodes.chunks(PLANNED_AT_ONCE) {
            check_ctrl_c()?;
            references.shortest_m.extend(shortest_paths_m(&self.scenario, some, 0));
            if self.optimum {
                references.bounds.extend(step_bounds(&self.scenario, some, 0));
            }
        }
        Ok(references)
    }

    /// Tests a Python function.
    fn function(&self, function: &ActFunction) -> PyResult<Report> {
        let mut evaluator = Evaluator::new(&self.scenario, self.count).measuring_paths();
        let mut run = evaluator.start_commanded(function.encoding, self.seed, self.count, self.setup);
        let num_actions = self.scenario.robot.motions.len();
        loop {
            function.command(&mut evaluator, &mut run, num_actions)?;
            if evaluator.step(&mut run).map_err(run_error)? {
                return self.report(None, &run.episodes, &self.plan(&run.episodes)?);
            }
        }
    }

    fn report(
        &self,
        driver: Option<&TestDriver>,
        episodes: &[EpisodeResult],
        references: &References,
    ) -> PyResult<Report> {
        let Self { scenario, seed, per_round, .. } = self;
        let References { shortest_m, bounds } = references;
        let comparison = OptimumComparison::from_episodes(episodes, bounds, &scenario.task);
        let each = || episodes.iter().zip(shortest_m);
        let records = each().enumerate().map(|(index, (episode, &shortest_m))| {
            EpisodeRecord::new("", index + 1, episode, scenario, shortest_m, bounds.get(index).copied())
        });
        let spl: f64 = each().filter_map(|(episode, &shortest_m)| episode.spl(shortest_m)).sum();
        let policy = driver.and_then(TestDriver::policy);
        let warning = policy.map_or(Ok(None), |policy| policy_card::warning(policy, scenario));
        Ok(Report {
            // A function perceives what a policy perceives.
            driver_class: driver.map_or(DriverClass::A, |driver| driver.evaluated().class()),
            weights_crc32c: policy.map(Policy::weights_crc32c),
            scenario: scenario.name.clone(),
            warning: warning.map_err(run_error)?,
            evaluation: Evaluation::from_episodes(episodes, *per_round, &scenario.task, *seed),
            spl: spl / episodes.len() as f64,
            optimum_mean_time_s: comparison.as_ref().map(|c| c.optimum_mean_time_s),
            time_ratio: comparison.as_ref().map(|c| c.time_ratio),
            records: records.collect(),
        })
    }
}

/// The reason why a trace ended early.
enum TraceError {
    Run(RunError),
    Raised(PyErr),
    Unwritable(io::Error),
}

impl From<RunError> for TraceError {
    fn from(error: RunError) -> Self {
        Self::Run(error)
    }
}

/// The setup in which every episode drives the scenario's benchmark route.
fn route(scenario: &Scenario) -> PyResult<EpisodeSetup> {
    scenario.benchmark_route.map(EpisodeSetup::Route).ok_or_else(|| {
        PyValueError::new_err(format!(
            "{} has no benchmark route; help: write one into the scenario, such as \
             `benchmark_route: (start_m: (0.0, 0.0), goal_m: (1.2, 1.2))`, or leave out benchmark_route",
            scenario.name
        ))
    })
}
