//! The history of a training run: the data of the plots and of their exports.
//!
//! In: a row for each episode and each evaluation, and annotations for the user's changes. Out:
//! [`LearningCurves`] to draw, the same `episodes.csv` as a headless run writes, and the figure of the
//! curves (`figure.rs`). Memory does not grow with the length of training: curves are [`DownsampledSeries`], and the rows
//! are in temporary files (`spool.rs`).

mod annotations;
mod curves;
mod figure;
mod series;
mod spool;
#[cfg(test)]
mod tests;

use std::io;
use std::path::Path;

pub use self::annotations::Annotation;
pub use self::curves::{EarlierCurves, LearningCurves};
pub use self::figure::write_figure;
pub use self::series::{DownsampledSeries, MAX_POINTS, MOVING_AVERAGE_EPISODES, MovingAverage};
use self::spool::Spool;
use crate::run::metric_rows::{EpisodeRow, EvaluationRow};
use crate::run::output_file::write_atomic;

/// The history of a training run.
pub struct History {
    curves: LearningCurves,
    annotations: Vec<Annotation>,
    /// The curves of the training run before a transfer.
    earlier: Option<EarlierCurves>,
    /// The ends of the x axis, in env steps.
    range: Option<(u64, u64)>,
    /// The number of rows in `rows`.
    episodes: u64,
    rows: Spool<EpisodeRow>,
    evaluations: Spool<EvaluationRow>,
}

impl Default for History {
    fn default() -> Self {
        Self::new()
    }
}

impl History {
    /// An empty history. If temporary files cannot be written, plots and a coarser figure still work, but not
    /// the CSV.
    #[must_use]
    pub fn new() -> Self {
        Self::of_set(&[])
    }

    /// An empty history of a training run on a set; `scenarios` are the names of the set's scenarios.
    #[must_use]
    pub fn of_set(scenarios: &[String]) -> Self {
        let evaluated_in = scenarios.iter().map(|name| (name.clone(), DownsampledSeries::default()));
        Self {
            curves: LearningCurves { evaluated_in: evaluated_in.collect(), ..LearningCurves::default() },
            annotations: Vec::new(),
            earlier: None,
            range: None,
            episodes: 0,
            rows: Spool::new(scenarios),
            evaluations: Spool::new(scenarios),
        }
    }

    /// The curves to show in the background of the next training run, which starts from this one's policy.
    #[must_use]
    pub fn to_earlier(&self) -> EarlierCurves {
        EarlierCurves {
            evaluated: self.curves.evaluated.clone(),
            return_mean: self.curves.return_mean.series().clone(),
            goal_mean: self.curves.goal_mean.series().clone(),
            env_steps: self.range.map_or(0, |(_, last)| last),
        }
    }

    /// Shows the curves of the training run before a transfer in the background.
    pub fn set_earlier(&mut self, earlier: EarlierCurves) {
        self.earlier = Some(earlier);
    }

    /// The curves of the training run before a transfer.
    #[must_use]
    pub fn earlier(&self) -> Option<&EarlierCurves> {
        self.earlier.as_ref()
    }

    /// Adds a finished episode.
    pub fn push_episode(&mut self, row: &EpisodeRow) {
        self.curves.push_episode(row);
        self.rows.push(row);
        self.episodes += 1;
        self.extend_to(row.env_steps, row.episode <= 1);
    }

    /// Adds an evaluation.
    pub fn push_evaluation(&mut self, row: &EvaluationRow) {
        self.curves.push_evaluation(row);
        self.evaluations.push(row);
        self.extend_to(row.env_steps, row.episodes <= 1);
    }

    /// Adds an annotation at `env_steps`.
    pub fn annotate(&mut self, env_steps: u64, text: String) {
        annotations::add(&mut self.annotations, env_steps, text);
    }

    /// Extends the x axis to `env_steps`. The axis starts at 0 if its first row is also the first of the training run
    /// (`is_first`), and otherwise, after a resume, at that row.
    fn extend_to(&mut self, env_steps: u64, is_first: bool) {
        let first = if is_first { 0 } else { env_steps };
        let (from, to) = self.range.unwrap_or((first, env_steps));
        self.range = Some((from.min(env_steps), to.max(env_steps)));
    }

    /// The curves to draw.
    #[must_use]
    pub fn curves(&self) -> &LearningCurves {
        &self.curves
    }

    /// The annotations, in order.
    #[must_use]
    pub fn annotations(&self) -> &[Annotation] {
        &self.annotations
    }

    /// The ends of the x axis, in env steps: from 0, or from the first row of a resumed run, to the last row, or to the end
    /// of the training run before a transfer if that is later. `None` if neither has rows.
    #[must_use]
    pub fn range(&self) -> Option<(u64, u64)> {
        let earlier =
            self.earlier.as_ref().map(|earlier| (0, earlier.env_steps)).filter(|(_, last)| *last > 0);
        match (self.range, earlier) {
            (Some((first, last)), Some((_, earlier))) => Some((first, last.max(earlier))),
            (own, earlier) => own.or(earlier),
        }
    }

    /// The rows of all episodes as CSV, with the columns of `episodes.csv`, after its first `offset` bytes.
    ///
    /// # Errors
    /// The rows could not be stored.
    pub fn episodes_csv_from(&mut self, offset: u64) -> io::Result<Vec<u8>> {
        self.rows.csv_from(offset)
    }

    /// Writes a row per episode, with the columns of `episodes.csv`. The file is written atomically.
    ///
    /// # Errors
    /// The rows could not be stored, or `to` cannot be written.
    pub fn write_csv(&mut self, to: &Path) -> io::Result<()> {
        write_atomic(to, |file| self.rows.write_csv_to(file))
    }
}
