//! Training runs as tasks for other machines, and the report of these runs.

use std::panic::resume_unwind;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use pyo3::exceptions::{PyRuntimeError, PyValueError};
use pyo3::prelude::*;
use serde::Serialize;
use wayfield::cli::{ReproductionReport, parse_seeds};
use wayfield::reproduce::{OpenReport, ReproduceOptions, TrainingTask};
use wayfield::run::provenance::{COMMIT, VERSION};

use crate::env_options::settings;
use crate::errors::{check_ctrl_c, detached, run_error};
use crate::train::listener;

/// How often Ctrl-C is checked for while a report is finished.
const POLL_INTERVAL: Duration = Duration::from_millis(50);

/// The options of a reproduction.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub struct ReproductionOptions {
    experiments: Vec<PathBuf>,
    only: Vec<String>,
    seeds: Option<String>,
    settings: Vec<(String, String)>,
    quick: bool,
    out: Option<PathBuf>,
}

/// A report that is being made. Its folder is locked until `finish` has written it, or until this object is gone.
#[pyclass(module = "wayfield._native")]
pub struct NativeReport(Option<OpenReport>);

/// A task as the Python layer gets it, in JSON.
#[derive(Serialize)]
pub struct TaskRecord {
    name: String,
    starts_from: Option<String>,
    cost: f64,
    text: String,
}

#[pymethods]
impl NativeReport {
    #[new]
    fn new(py: Python<'_>, options: ReproductionOptions) -> PyResult<Self> {
        let seeds = options.seeds.as_deref().map(parse_seeds).transpose();
        let options = ReproduceOptions {
            experiments: options.experiments,
            only: options.only,
            seeds: seeds.map_err(|error| PyValueError::new_err(format!("seeds: {error}")))?,
            settings: settings(options.settings),
            quick: options.quick,
            out: options.out,
            shard: None,
            jobs: None,
        };
        detached(py, || Ok(Self(Some(OpenReport::open(&options, Instant::now()).map_err(run_error)?))))
    }

    /// The folder of the runs.
    #[getter]
    fn runs(&self) -> PyResult<PathBuf> {
        Ok(self.report()?.runs())
    }

    /// The training runs of the report, as a JSON list of tasks.
    fn tasks(&self) -> PyResult<String> {
        let records: PyResult<Vec<TaskRecord>> =
            self.report()?.tasks().iter().map(TaskRecord::try_from).collect();
        json(&records?)
    }

    /// Carries out the missing training runs and writes the report. Returns its folder, and the JSON object of
    /// `--reproduce --json`. `parallel` is the number of runs that the cluster executed in parallel. Ctrl-C stops
    /// the training runs; it is raised when the work has ended.
    fn finish(&mut self, py: Python<'_>, parallel: usize) -> PyResult<(PathBuf, String)> {
        let report = self.0.take().ok_or_else(finished)?;
        let folder = report.path().to_owned();
        let stop = AtomicBool::new(false);
        let done = detached(py, || {
            thread::scope(|scope| {
                let work = scope.spawn(|| report.finish(Some(parallel), &stop));
                // Only this thread can notice Ctrl-C.
                let mut noticed = Ok(());
                while !work.is_finished() {
                    thread::sleep(POLL_INTERVAL);
                    // A training run that fails sets the flag as well, so it is never cleared here.
                    if let Err(ctrl_c) = check_ctrl_c() {
                        stop.store(true, Ordering::Relaxed);
                        noticed = Err(ctrl_c);
                    }
                }
                let done = work.join().unwrap_or_else(|panic| resume_unwind(panic));
                noticed?;
                done.map_err(run_error)
            })
        })?;
        Ok((folder, json(&ReproductionReport::new(done, None))?))
    }
}

impl NativeReport {
    fn report(&self) -> PyResult<&OpenReport> {
        self.0.as_ref().ok_or_else(finished)
    }
}

fn finished() -> PyErr {
    PyRuntimeError::new_err("the report is finished; help: open it again")
}

impl TryFrom<&TrainingTask> for TaskRecord {
    type Error = PyErr;

    fn try_from(task: &TrainingTask) -> PyResult<Self> {
        Ok(Self {
            name: task.name().into(),
            starts_from: task.starts_from().map(String::from),
            cost: task.cost(),
            text: task.to_text().map_err(run_error)?,
        })
    }
}

/// Whether the folder `runs` has the finished run of the task `text`.
#[pyfunction]
pub fn is_task_done(text: &str, runs: PathBuf) -> PyResult<bool> {
    Ok(TrainingTask::parse(text).map_err(run_error)?.is_done(&runs))
}

/// Carries out the task `text` in the folder `runs`, which has the policy that the run starts from. Returns the name of the
/// run's folder.
#[pyfunction]
pub fn run_task(py: Python<'_>, text: &str, runs: PathBuf) -> PyResult<String> {
    let task = TrainingTask::parse(text).map_err(run_error)?;
    let (stop, raised) = (Arc::new(AtomicBool::new(false)), Arc::new(Mutex::new(None)));
    let done = detached(py, || {
        let listener = || listener(None, stop.clone(), raised.clone());
        Ok(task.run(&runs, &listener, &stop))
    })?;
    match raised.lock().ok().and_then(|mut raised| raised.take()) {
        Some(ctrl_c) => Err(ctrl_c),
        None => done.map(|()| task.name().into()).map_err(run_error),
    }
}

/// The version and the commit of wayfield. A task is carried out only by the build that it comes from.
#[pyfunction]
pub fn build() -> String {
    COMMIT.map_or_else(|| VERSION.into(), |commit| format!("{VERSION}, commit {commit}"))
}

/// `value` as JSON.
pub fn json(value: &impl Serialize) -> PyResult<String> {
    serde_json::to_string(value).map_err(|error| PyRuntimeError::new_err(error.to_string()))
}
