//! The figure of a run: its learning curves, from the rows in its folder.

use super::RunError;
use super::checkpoint::BestPolicy;
use super::folder::{EPISODES_FILE, EVALUATIONS_FILE, RunConfig, RunFolder};
use super::metric_rows::{EpisodeRow, EvaluationRow};
use crate::report::run_figure::{RunFigure, best_evaluation};

/// The figure of the run of `config` in `folder`, as SVG. The run may still be in progress.
///
/// # Errors
/// The rows cannot be read, or drawing fails.
pub fn figure(folder: &RunFolder, config: &RunConfig) -> Result<String, RunError> {
    let evaluations: Vec<EvaluationRow> = folder.rows(EVALUATIONS_FILE)?;
    let evaluations: Vec<_> = evaluations.iter().map(EvaluationRow::point).collect();
    let episodes: Vec<EpisodeRow> = folder.rows(EPISODES_FILE)?;
    let figure = RunFigure {
        title: config.description(),
        episodes: episodes.iter().map(EpisodeRow::point).collect(),
        best: best_evaluation(&evaluations, BestPolicy::COST_TOLERANCE),
        evaluations,
        is_paper_scenario_1: config.is_paper_scenario_1(),
        ..RunFigure::default()
    };
    figure.svg().map_err(|error| RunError::failed(folder.path(), error))
}
