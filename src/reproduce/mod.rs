//! Reproduction of the paper: trains the policies for its figures and tables, over several seeds, and writes a report.
//!
//! In: experiments (RON files) and a folder. Out, in that folder: a run folder for each training, and the report:
//! `report.html`, `README.md`, each figure as SVG and PNG, each table as CSV and Markdown.
//!
//! | step | files | duty |
//! |---|---|---|
//! | read | `experiment.rs`, `figure_spec.rs`, `table_spec.rs`, `claim.rs`, `measure.rs`, `seeds.rs` | the schema of an experiment's file |
//! | | `load.rs`, `check/`, `training_check.rs` | reading and checking such a file, and its trainings |
//! | select | `options.rs`, `select.rs`, `selected.rs`, `quick.rs` | the figures and tables that the user asked for |
//! | plan | `plan.rs`, `arm_run.rs`, `test_point.rs`, `run_config.rs`, `shard.rs` | the trainings they need, each once, and the policies to test; parts of them for several machines |
//! | | `elsewhere.rs` | runs that were trained elsewhere |
//! | execute | `execute.rs`, `queue.rs`, `policy_test.rs`, `progress.rs` | training and testing, several runs in parallel |
//! | measure | `results.rs`, `records.rs`, `measured_value.rs`, `optimal_times.rs` | numbers from the run folders |
//! | compare | `claim_result.rs` | whether a claim held |
//! | present | `rows.rs`, `data_note.rs`, `figures.rs`, `learning_curves.rs`, `tables/`, `compose.rs`, `provenance.rs` | figures, tables and the page |
//! | write | `report_folder.rs`, `report_contents.rs`, `report_files.rs` | the folder and the files of the report, and which report they may replace |

pub mod arm_run;
mod check;
pub mod claim;
mod claim_result;
mod compose;
mod data_note;
pub mod elsewhere;
mod execute;
pub mod experiment;
pub mod figure_spec;
mod figures;
mod learning_curves;
mod load;
pub mod measure;
mod measured_value;
mod optimal_times;
mod options;
pub mod plan;
mod policy_test;
mod progress;
mod provenance;
mod queue;
mod quick;
mod records;
mod report_contents;
mod report_files;
mod report_folder;
mod results;
mod rows;
mod run_config;
pub mod seeds;
mod select;
pub mod selected;
mod shard;
pub mod table_spec;
mod tables;
pub mod test_point;
#[cfg(test)]
mod tests;
mod training_check;

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use crate::report::claim::ClaimResult;
use crate::run::RunError;
use crate::run::progress::print_stderr;

pub use experiment::Experiment;
pub use options::ReproduceOptions;
pub use seeds::Seeds;
pub use shard::Shard;

/// A finished reproduction.
#[derive(Debug)]
pub struct Reproduction {
    /// The folder of the report.
    pub folder: PathBuf,
    /// The page of the report; `None` for a shard, which writes none.
    pub page: Option<PathBuf>,
    /// The results of all claims.
    pub claims: Vec<ClaimResult>,
    /// The number of trainings that the report is based on, or of the shard.
    pub runs: usize,
    /// Wall time of all processes that worked on it, in s.
    pub wall_s: f64,
}

/// Trains, tests and writes the report; with a shard, only trains and tests its part. Runs that exist already are not
/// repeated.
///
/// # Errors
/// A file cannot be read or written, a run failed, or `stop` was set. Finished work is kept, and the same options
/// continue it.
pub fn reproduce(
    options: &ReproduceOptions,
    stop: &'static AtomicBool,
    began: Instant,
) -> Result<Reproduction, RunError> {
    let selected = select::select(options)?;
    let plan = plan::RunPlan::new(&selected)?;
    let folder = options.out.clone().unwrap_or_else(|| options.default_folder());
    let contents = report_contents::ReportContents::new(options, &selected);
    let mut report = report_folder::ReportFolder::open(&folder, contents, options.shard)?;
    let runs = report.join("runs");
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = options.jobs.unwrap_or_else(cores);

    let part = options.shard.map(|shard| shard.of(&plan));
    let done = execute::execute(part.as_ref().unwrap_or(&plan), &runs, jobs, stop);
    let wall_s = report.record_time(began);
    done?;
    if let Some(part) = part {
        let (claims, runs) = (Vec::new(), part.trainings.len());
        return Ok(Reproduction { folder, page: None, claims, runs, wall_s: wall_s? });
    }

    print_stderr("computing optimal times and drawing the report");
    let optimal_times = optimal_times::OptimalTimesCache::new(report.join("optimum"));
    let results = results::Results::read(&plan, &selected, &runs, optimal_times)?;
    let page = compose::page(&results, &selected, &plan, options, jobs, wall_s?)?;
    report.write(&page)?;
    let wall_s = report.record_time(began)?;
    let path = Some(report.join("report.html"));
    Ok(Reproduction { folder, page: path, claims: page.claims, runs: plan.trainings.len(), wall_s })
}
