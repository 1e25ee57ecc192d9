//! The paper, reproduced: every figure and table, over several seeds, by one command.
//!
//! In: experiments (RON files), a folder. Out: in that folder a run for every training, and a report: `report.html`,
//! `README.md`, each figure as SVG and PNG, each table as CSV and Markdown.
//!
//! Data flows one way:
//!
//! | step | file | what becomes of what |
//! |---|---|---|
//! | ask | `experiment.rs` (`check.rs`, `overrides.rs`, `measure.rs`) | a RON file becomes arms, stages, figures, tables, claims |
//! | choose | `select.rs`, `quick.rs` | what the user wants of them, and how roughly |
//! | plan | `plan.rs` | experiments become trainings, each once |
//! | carry out | `execute.rs`, `policy_test.rs`, `progress.rs` | trainings become run folders with trials, several at a time |
//! | measure | `results.rs`, `optimal_times.rs` | records and trials become numbers, beside the planner's |
//! | judge | `claim_result.rs` | numbers become verdicts on the paper's claims |
//! | show | `figures.rs`, `tables.rs`, `compose.rs` | numbers become pictures, tables and a page |

mod check;
pub mod claim_result;
mod compose;
mod execute;
pub mod experiment;
mod figures;
pub mod measure;
mod optimal_times;
pub mod overrides;
pub mod plan;
pub mod policy_test;
mod progress;
mod quick;
mod results;
mod select;
mod tables;
#[cfg(test)]
mod tests;

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use serde::{Deserialize, Serialize};

use crate::report::claim::ClaimResult;
use crate::report::page::{Item, Page};
use crate::report::raster;
use crate::run::RunError;
use crate::run::lock::Lock;

pub use experiment::Experiment;

/// Points of a PNG for each point of the SVG.
const PNG_SCALE: f32 = 2.0;

/// What is to be reproduced.
#[derive(Clone, Debug, Default)]
pub struct ReproduceOptions {
    /// The user's own experiments; none for those that come with the program.
    pub experiments: Vec<PathBuf>,
    /// Names of figures, tables or experiments; none for all.
    pub only: Vec<String>,
    /// How many seeds, if not as the experiments say.
    pub seeds: Option<u64>,
    /// Roughly, in a minute.
    pub quick: bool,
    /// The folder, if not the default one.
    pub out: Option<PathBuf>,
    /// How many runs at a time; none for as many as there are cores.
    pub jobs: Option<usize>,
}

/// What came of it.
#[derive(Debug)]
pub struct Reproduction {
    /// The folder of the report.
    pub folder: PathBuf,
    /// The claims, and what became of each.
    pub claims: Vec<ClaimResult>,
    /// Trainings that the report rests on.
    pub runs: usize,
    /// Wall time of all processes that worked on it, in s.
    pub wall_s: f64,
}

/// What was spent on a report so far: `spent.json`.
#[derive(Clone, Copy, Debug, Default, Serialize, Deserialize)]
struct Spent {
    /// Wall time of all processes, in s.
    wall_s: f64,
}

/// Trains, tests and reports what `request` asks for. What is there already is not done again.
///
/// # Errors
/// Files that cannot be used or written; a run that failed; or `stop` was set: what is done so far is kept, and the same
/// request goes on from there.
pub fn reproduce(
    request: &ReproduceOptions,
    stop: &'static AtomicBool,
    began: Instant,
) -> Result<Reproduction, RunError> {
    let selected = select::select(request)?;
    let plan = plan::RunPlan::new(&selected)?;
    let folder = request.out.clone().unwrap_or_else(|| {
        Path::new("runs").join(if request.quick { "reproduce-quick" } else { "reproduce" })
    });
    let before = ready(&folder)?;
    let _lock = Lock::acquire(&folder, &folder.join("lock"))?;
    let runs = folder.join("runs");
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let jobs = request.jobs.unwrap_or_else(cores);

    let done = execute::execute(&plan, &runs, jobs, stop);
    let spent = spend(&folder, before, began)?;
    done?;

    crate::run::progress::print_stderr("planning least times, drawing the report");
    let optimal_times = optimal_times::OptimalTimesCache::new(folder.join("optimum"));
    let results = results::Results::read(&plan, &selected, &runs, optimal_times)?;
    let page = compose::page(&results, &selected, &plan, request, jobs, spent.wall_s)?;
    write(&folder, &page)?;
    let spent = spend(&folder, before, began)?;
    Ok(Reproduction { folder, claims: page.claims, runs: plan.trainings.len(), wall_s: spent.wall_s })
}

/// Makes the folder, or takes up one that an earlier reproduction made; gives what was spent on it.
fn ready(folder: &Path) -> Result<Spent, RunError> {
    let note = folder.join("spent.json");
    let foreign = fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_some()) && !note.exists();
    if foreign {
        let why = "is not empty and holds no reproduction: give --out another folder";
        return Err(RunError::invalid_input(folder, why));
    }
    let unwritable = |error: std::io::Error| {
        RunError::invalid_input(folder, format!("can't be written ({error}): give --out another folder"))
    };
    fs::create_dir_all(folder.join("runs")).map_err(unwritable)?;
    let spent = fs::read_to_string(&note).unwrap_or_default();
    let spent: Spent = serde_json::from_str(&spent).unwrap_or_default();
    let text = serde_json::to_string(&spent).map_err(|error| RunError::Failed(error.to_string()))?;
    fs::write(&note, text).map_err(unwritable)?;
    Ok(spent)
}

/// Notes what was spent: wall time of the processes `before` this one, and of this one since it `began`.
fn spend(folder: &Path, before: Spent, began: Instant) -> Result<Spent, RunError> {
    let path = folder.join("spent.json");
    let spent = Spent { wall_s: before.wall_s + began.elapsed().as_secs_f64() };
    let text = serde_json::to_string(&spent).map_err(|error| RunError::Failed(error.to_string()))?;
    fs::write(&path, text).map_err(|error| RunError::failed(&path, error))?;
    Ok(spent)
}

/// Writes the report: the page, and each figure and table as files of their own.
fn write(folder: &Path, page: &Page) -> Result<(), RunError> {
    let file =
        |path: PathBuf, bytes: &[u8]| fs::write(&path, bytes).map_err(|error| RunError::failed(&path, error));
    let (figures, tables) = (folder.join("figures"), folder.join("tables"));
    for made in [&figures, &tables] {
        // What an earlier report showed and this one does not would only mislead.
        let _ = fs::remove_dir_all(made);
        fs::create_dir_all(made).map_err(|error| RunError::failed(made, error))?;
    }
    for item in page.sections.iter().flat_map(|section| &section.items) {
        match item {
            Item::Figure { name, svg, .. } => {
                let png = raster::png(svg, PNG_SCALE)
                    .map_err(|error| RunError::Failed(format!("figure {name}: {error}")))?;
                file(figures.join(format!("{name}.svg")), svg.as_bytes())?;
                file(figures.join(format!("{name}.png")), &png)?;
            }
            Item::Table { table, .. } => {
                file(tables.join(format!("{}.csv", table.name)), table.to_csv().as_bytes())?;
                file(tables.join(format!("{}.md", table.name)), table.to_markdown().as_bytes())?;
            }
            Item::Text(_) => {}
        }
    }
    file(folder.join("README.md"), page.to_markdown().as_bytes())?;
    file(folder.join("report.html"), page.to_html().as_bytes())
}
