//! Training runs: new ones, and resumed ones.

use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::time::{Duration, Instant};

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict};
use wayfield::reproduce::TrainingTask;
use wayfield::run::folder::{RunConfig, Transfer};
use wayfield::run::preset::Budget;
use wayfield::run::progress::{Progress, ProgressListener};
use wayfield::run::train::{Job, train as run_job};
use wayfield::simulation::Extensions;

use crate::cluster::{TaskRecord, json};
use crate::env_options::{is_text, preset, scenario_or_set, settings};
use crate::errors::{detached, run_error, setting_errors};
use crate::policy::NativePolicy;

/// The options of a new run.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct TrainOptions {
    scenario: String,
    preset: String,
    seed: u64,
    steps: Option<u64>,
    episodes: Option<u64>,
    arenas: Option<usize>,
    out: Option<PathBuf>,
    epsilon: Option<f32>,
    init_from: String,
    settings: Vec<(String, String)>,
}

/// Trains, and returns the run folder and its summary as JSON. `callback` gets the progress every 0.1 s; the run stops if it
/// returns False.
#[pyfunction]
#[pyo3(signature = (options, init, callback, checkpoint_every_s))]
pub fn train(
    py: Python<'_>,
    options: TrainOptions,
    init: Option<PyRef<'_, NativePolicy>>,
    callback: Option<Py<PyAny>>,
    checkpoint_every_s: f64,
) -> PyResult<(PathBuf, String)> {
    let policy = init.map(|init| init.policy.clone());
    let out = options.out.clone();
    let config = config(options, policy.is_some())?;
    run(py, Job::New { config: Box::new(config), policy, out }, callback, checkpoint_every_s)
}

/// Continues the run in `folder`, with a larger budget if one is given.
#[pyfunction]
#[pyo3(signature = (folder, steps, episodes, callback, checkpoint_every_s))]
pub fn resume(
    py: Python<'_>,
    folder: PathBuf,
    steps: Option<u64>,
    episodes: Option<u64>,
    callback: Option<Py<PyAny>>,
    checkpoint_every_s: f64,
) -> PyResult<(PathBuf, String)> {
    let budget = budget(steps, episodes);
    run(py, Job::Resume { folder, budget, extensions: Extensions::default() }, callback, checkpoint_every_s)
}

/// The task of a new run, as JSON. If the run `transfers`, it starts from the policy in the file `init_from`, relative to the
/// folder of all runs.
#[pyfunction]
pub fn training_task(options: TrainOptions, transfers: bool) -> PyResult<String> {
    let task = TrainingTask::new(config(options, transfers)?).map_err(run_error)?;
    json(&TaskRecord::try_from(&task)?)
}

fn budget(steps: Option<u64>, episodes: Option<u64>) -> Option<Budget> {
    steps.map(Budget::EnvSteps).or(episodes.map(Budget::Episodes))
}

/// The configuration of a new run.
fn config(options: TrainOptions, transfers: bool) -> PyResult<RunConfig> {
    let (scenario, scenario_set) = scenario_or_set(&options.scenario)?;
    let preset = (name(&options.preset), preset(&options.preset)?);
    let config = RunConfig::new((name(&options.scenario), scenario), preset, options.seed);
    let mut config = RunConfig { scenario_set, ..config }
        .with_settings(&settings(options.settings))
        .map_err(setting_errors)?
        .with_length(budget(options.steps, options.episodes), options.arenas)
        .map_err(run_error)?;
    config.transfer = transfers.then_some(Transfer { policy: options.init_from, epsilon: options.epsilon });
    Ok(config)
}

/// The name of a scenario or preset in `config.ron` and in the name of the run folder.
fn name(wanted: &str) -> String {
    if is_text(wanted) { "text".into() } else { wanted.into() }
}

/// Runs `job`. Ctrl-C or an exception in the callback stops the run after a checkpoint, and is then raised.
fn run(
    py: Python<'_>,
    job: Job,
    callback: Option<Py<PyAny>>,
    checkpoint_every_s: f64,
) -> PyResult<(PathBuf, String)> {
    let every = Duration::try_from_secs_f64(checkpoint_every_s).map_err(|_| {
        PyValueError::new_err(format!(
            "checkpoint_every_s is {checkpoint_every_s}; help: give a number of seconds, at least 0"
        ))
    })?;
    let (stop, raised) = (Arc::new(AtomicBool::new(false)), Arc::new(Mutex::new(None)));
    let (stop_flag, error) = (stop.clone(), raised.clone());
    let (folder, summary) = detached(py, move || {
        let listener = listener(callback, stop_flag.clone(), error);
        run_job(job, every, &stop_flag, Instant::now(), Some(listener)).map_err(run_error)
    })?;
    let raised = raised.lock().ok().and_then(|mut raised| raised.take());
    if let Some(error) = raised {
        let note = format!(
            "the run was saved before it stopped; help: wayfield.resume({:?}) continues it",
            folder.display().to_string()
        );
        error.value(py).call_method1("add_note", (note,))?;
        return Err(error);
    }
    let summary = serde_json::to_string(&summary).map_err(|e| PyRuntimeError::new_err(e.to_string()))?;
    Ok((folder, summary))
}

/// A listener that passes the progress to `callback` and checks for Ctrl-C, every 0.1 s. It sets `stop` if the callback returns
/// False or an exception is raised, and stores the first exception in `raised`.
pub fn listener(
    callback: Option<Py<PyAny>>,
    stop: Arc<AtomicBool>,
    raised: Arc<Mutex<Option<PyErr>>>,
) -> ProgressListener {
    Box::new(move |progress| {
        let goes_on = Python::attach(|py| {
            py.check_signals()?;
            match &callback {
                Some(callback) => call(py, callback, progress),
                None => Ok(true),
            }
        });
        if !matches!(goes_on, Ok(true)) {
            stop.store(true, Ordering::Relaxed);
        }
        if let (Err(error), Ok(mut raised)) = (goes_on, raised.lock()) {
            raised.get_or_insert(error);
        }
    })
}

/// Calls `callback` with the progress. Returns whether the run continues.
fn call(py: Python<'_>, callback: &Py<PyAny>, progress: &Progress) -> PyResult<bool> {
    let fields = PyDict::new(py);
    fields.set_item("episodes", progress.episodes)?;
    fields.set_item("env_steps", progress.env_steps)?;
    fields.set_item("gradient_steps", progress.gradient_steps)?;
    fields.set_item("mean_return", progress.mean_return)?;
    fields.set_item("success_rate", progress.success_rate)?;
    fields.set_item("epsilon", progress.epsilon)?;
    let answer = callback.call1(py, (fields,))?;
    // Only False stops: a callback without `return` returns None.
    Ok(!answer.bind(py).is(&*PyBool::new(py, false)))
}
