//! Reproduction of the paper: trains the policies for its figures and tables, over several seeds, and writes a report.
//!
//! In: experiments (RON files) and a folder. Out, in that folder: a run folder for each training run, and the report:
//! `report.html`, `README.md`, each figure as SVG and PNG, each table as CSV and Markdown.
//!
//! | step | files | purpose |
//! |---|---|---|
//! | read | `experiment.rs`, `figure_spec.rs`, `table_spec.rs`, `claim.rs`, `measure.rs`, `seeds.rs` | the schema of an experiment's file |
//! | | `load.rs`, `check/`, `training_check.rs` | reading and checking such a file, and its training runs |
//! | select | `options.rs`, `select.rs`, `selected.rs`, `quick.rs` | the figures and tables that the user asked for |
//! | plan | `plan.rs`, `arm_run.rs`, `test_point.rs`, `run_config.rs`, `shard.rs` | the training runs they need, each once, and the policies to test; parts of the plan for several machines |
//! | | `elsewhere.rs` | runs that were trained elsewhere |
//! | | `training_task.rs` | a training run as a task for another machine |
//! | execute | `open_report.rs`, `execute.rs`, `queue.rs`, `policy_test.rs`, `progress.rs` | training and testing, several runs in parallel |
//! | measure | `results.rs`, `records.rs`, `measured_value.rs`, `optimal_times.rs` | numbers from the run folders |
//! | compare | `claim_result.rs` | whether a claim held |
//! | present | `rows.rs`, `data_note.rs`, `figures.rs`, `learning_curves.rs`, `tables/`, `compose.rs`, `provenance.rs`, `report_progress.rs` | figures, tables and the page |
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
mod open_report;
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
pub(crate) mod report_files;
pub(crate) mod report_folder;
mod report_progress;
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
mod training_task;

use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use crate::report::claim::ClaimResult;
use crate::run::RunError;

pub use experiment::Experiment;
pub use open_report::OpenReport;
pub use options::ReproduceOptions;
pub use seeds::Seeds;
pub use shard::Shard;
pub use training_task::TrainingTask;

/// A finished reproduction.
#[derive(Debug)]
pub struct Reproduction {
    /// The folder of the report.
    pub folder: PathBuf,
    /// The page of the report; `None` for a shard, which writes none.
    pub page: Option<PathBuf>,
    /// The results of all claims.
    pub claims: Vec<ClaimResult>,
    /// The number of training runs that the report is based on, or that the shard contains.
    pub runs: usize,
    /// Total wall time of all processes that worked on it, in s.
    pub wall_s: f64,
}

/// Trains, tests and writes the report; with a shard, only trains and tests its part. Runs that already exist are not
/// repeated. Wall time counts from `began`.
///
/// # Errors
/// A file cannot be read or written, a run failed, or `stop` was set. Finished work is kept; another call with the
/// same options continues from there.
pub fn reproduce(
    options: &ReproduceOptions,
    stop: &AtomicBool,
    began: Instant,
) -> Result<Reproduction, RunError> {
    OpenReport::open(options, began)?.finish(None, stop)
}
