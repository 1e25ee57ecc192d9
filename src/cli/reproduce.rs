//! The mode `--reproduce`: reproduces the paper's figures and tables, or runs the user's experiments.

use std::fmt::Write as _;
use std::path::PathBuf;
use std::time::Instant;

use clap::Args;
use serde::Serialize;

use super::output::{print_json, print_stdout};
use super::shared::SharedArgs;
use super::train::SAVING;
use super::values;
use crate::report::format::counted;
use crate::reproduce::{ReproduceOptions, Reproduction, Seeds, Shard, reproduce};
use crate::run::RunError;
use crate::run::settings::Settings;
use crate::run::signals::stop_on_signal;

/// The options of `--reproduce`.
#[derive(Args, Debug)]
#[command(next_help_heading = "Options of --reproduce")]
pub struct ReproduceArgs {
    /// Only these figures, tables or experiments, such as fig9,table2
    #[arg(long, value_name = "NAMES", value_delimiter = ',')]
    only: Vec<String>,

    /// Number of seeds, such as 5, or a list of them, such as 3,17,42 (a single one: 17,) [default: the experiment's, 5
    /// for the paper's]
    #[arg(long, value_name = "SEEDS", value_parser = values::seeds, allow_negative_numbers = true)]
    seeds: Option<Seeds>,

    /// Make a rough report in a minute: at most two seeds, a tenth of the episodes or env steps [default folder:
    /// runs/reproduce-quick, runs/reproduce-<experiment>-quick]; a full report is never overwritten
    #[arg(long)]
    quick: bool,

    /// Run this experiment (a RON file like those in assets/experiments) instead of the paper's; may be
    /// repeated
    #[arg(long, value_name = "FILE")]
    experiment: Vec<PathBuf>,

    /// Do only part K of N of the training runs, without the report. When all parts are done, in one folder or copied into one,
    /// the same command without --shard writes the report
    #[arg(long, value_name = "K/N")]
    shard: Option<Shard>,

    /// Number of parallel runs; it does not change the results [default: the number of cores]
    #[arg(long, value_name = "N", value_parser = values::whole::<u16>(1..=1024), allow_negative_numbers = true)]
    jobs: Option<u16>,
}

/// The JSON object that `--reproduce --json` prints.
#[derive(Serialize)]
pub struct ReproductionReport {
    #[serde(skip)]
    folder: String,
    report: Option<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    shard: Option<String>,
    runs: usize,
    wall_s: f64,
    claims: Vec<ClaimReport>,
}

#[derive(Serialize)]
struct ClaimReport {
    claim: String,
    outcome: &'static str,
    because: String,
}

/// Runs the selected experiments, and prints the claim results and the report's path.
///
/// # Errors
/// An option or a file is invalid, a run failed, or a signal stopped it.
pub fn run(args: ReproduceArgs, shared: SharedArgs, began: Instant) -> Result<(), RunError> {
    let options = ReproduceOptions {
        experiments: args.experiment,
        only: args.only,
        seeds: args.seeds,
        settings: Settings(shared.set),
        quick: args.quick,
        out: shared.out,
        shard: args.shard,
        jobs: args.jobs.map(usize::from),
    };
    let report = ReproductionReport::new(reproduce(&options, stop_on_signal(SAVING), began)?, args.shard);
    if shared.json { print_json(&report) } else { print_stdout(&report.text()) }
}

impl ReproductionReport {
    /// The report of a reproduction, or of a shard of it.
    #[must_use]
    pub fn new(reproduction: Reproduction, shard: Option<Shard>) -> Self {
        let claims = reproduction.claims.into_iter().map(|result| ClaimReport {
            claim: result.claim,
            outcome: result.outcome.word(),
            because: result.sentence,
        });
        Self {
            folder: reproduction.folder.display().to_string(),
            report: reproduction.page.map(|page| page.display().to_string()),
            shard: shard.map(|shard| shard.to_string()),
            runs: reproduction.runs,
            wall_s: reproduction.wall_s,
            claims: claims.collect(),
        }
    }

    fn text(&self) -> String {
        let mut text = String::new();
        for claim in &self.claims {
            let _ = writeln!(text, "{:<11} {}\n            {}", claim.outcome, claim.claim, claim.because);
        }
        let minutes = self.wall_s / 60.0;
        let (what, path) = match (&self.report, &self.shard) {
            (None, Some(shard)) => (format!("part {shard}"), &self.folder),
            (report, _) => ("report".to_owned(), report.as_ref().unwrap_or(&self.folder)),
        };
        let _ =
            writeln!(text, "{what:<11} {path} ({}, {minutes:.1} minutes)", counted(self.runs as f64, "run"));
        text
    }
}
