//! A report that is being made: its plan, and its locked folder.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use super::Reproduction;
use super::compose;
use super::execute::execute;
use super::optimal_times::OptimalTimesCache;
use super::options::ReproduceOptions;
use super::plan::RunPlan;
use super::report_contents::ReportContents;
use super::report_folder::ReportFolder;
use super::report_progress::ReportProgress;
use super::results::Results;
use super::select::select;
use super::selected::SelectedExperiment;
use super::training_task::TrainingTask;
use crate::run::RunError;
use crate::run::progress::print_stderr;

/// A report that is being made. Its folder is locked by this process.
pub struct OpenReport {
    options: ReproduceOptions,
    selected: Vec<SelectedExperiment>,
    plan: RunPlan,
    path: PathBuf,
    folder: ReportFolder,
    began: Instant,
}

impl OpenReport {
    /// Plans the report, and creates or continues its folder. Wall time counts from `began`.
    ///
    /// # Errors
    /// An option or a file is invalid, or the folder holds something else or is in use.
    pub fn open(options: &ReproduceOptions, began: Instant) -> Result<Self, RunError> {
        let selected = select(options)?;
        let plan = RunPlan::new(&selected)?;
        let path = options.out.clone().unwrap_or_else(|| options.default_folder());
        let contents = ReportContents::new(options, &selected);
        let folder = ReportFolder::open(&path, contents, options.shard)?;
        Ok(Self { options: options.clone(), selected, plan, path, folder, began })
    }

    /// The folder of the report.
    #[must_use]
    pub fn path(&self) -> &Path {
        &self.path
    }

    /// The folder of the runs.
    #[must_use]
    pub fn runs(&self) -> PathBuf {
        self.folder.join("runs")
    }

    /// The training runs of the plan, each before those that start from it, except those that were trained elsewhere.
    #[must_use]
    pub fn tasks(&self) -> Vec<TrainingTask> {
        let own = self.plan.training_runs.iter().filter(|training| training.elsewhere.is_none());
        own.map(TrainingTask::from).collect()
    }

    /// Executes the missing training runs and writes the report; with a shard, only executes the training runs in it.
    /// `parallel` is the number of runs that other machines executed in parallel, for the report; `None` if this machine
    /// executes all.
    ///
    /// # Errors
    /// As for [`reproduce`](super::reproduce).
    pub fn finish(mut self, parallel: Option<usize>, stop: &AtomicBool) -> Result<Reproduction, RunError> {
        let (runs, began) = (self.runs(), self.began);
        let cores = || std::thread::available_parallelism().map_or(1, usize::from);
        let jobs = self.options.jobs.unwrap_or_else(cores);
        let part = self.options.shard.map(|shard| shard.of(&self.plan));
        let done = execute(part.as_ref().unwrap_or(&self.plan), &runs, jobs, stop);
        let wall_s = self.folder.record_time(began);
        done?;
        if let Some(part) = part {
            let (claims, runs) = (Vec::new(), part.training_runs.len());
            return Ok(Reproduction { folder: self.path, page: None, claims, runs, wall_s: wall_s? });
        }

        print_stderr("computing optimal times and drawing the report");
        let items = self.selected.iter().map(|selected| selected.figures.len() + selected.tables.len());
        let progress = ReportProgress::new(items.sum());
        let optimal_times = OptimalTimesCache::new(self.folder.join("optimum"), progress);
        let results = Results::read(&self.plan, &self.selected, &runs, optimal_times)?;
        let jobs = parallel.unwrap_or(jobs);
        let page = compose::page(&results, &self.selected, &self.plan, &self.options, jobs, wall_s?)?;
        results.progress().finish();
        self.folder.write(&page)?;
        let wall_s = self.folder.record_time(began)?;
        let path = Some(self.folder.join("report.html"));
        let runs = self.plan.training_runs.len();
        Ok(Reproduction { folder: self.path, page: path, claims: page.claims, runs, wall_s })
    }
}
