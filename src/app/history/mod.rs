//! The history of a training: the data of the plots and of their exports.
//!
//! In: a row for each episode and each evaluation, and annotations for the user's changes. Out:
//! [`LearningCurves`] to draw, the same `episodes.csv` as a headless run writes, and the learning curve as
//! PNG. Memory does not grow with the length of the training: curves are [`DownsampledSeries`], and the rows
//! are in temporary files (`spool.rs`).

mod annotations;
mod curves;
mod series;
mod spool;
#[cfg(test)]
mod tests;

use std::io::{self, Write};
use std::path::Path;

pub use self::annotations::Annotation;
pub use self::curves::LearningCurves;
pub use self::series::{DownsampledSeries, MAX_POINTS, MOVING_AVERAGE_EPISODES, MovingAverage};
use self::spool::Spool;
use crate::report::run_figure::{EpisodePoint, EvaluationPoint, learning_curve_svg};
use crate::run::RunError;
use crate::run::checkpoint::BestPolicy;
use crate::run::folder::write_atomic;
#[cfg(not(target_arch = "wasm32"))]
use crate::run::image_file::ImageFormat;
use crate::run::metric_rows::{EpisodeRow, EvaluationRow};

/// The maximum number of episodes drawn in the PNG. If there are more, every n-th is drawn.
const MAX_PNG_EPISODES: u64 = 200_000;

/// The history of a training.
pub struct History {
    curves: LearningCurves,
    annotations: Vec<Annotation>,
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
    /// An empty history. If temporary files cannot be written, plots and a coarser PNG still work, but not
    /// the CSV.
    #[must_use]
    pub fn new() -> Self {
        Self {
            curves: LearningCurves::default(),
            annotations: Vec::new(),
            range: None,
            episodes: 0,
            rows: Spool::new(),
            evaluations: Spool::new(),
        }
    }

    /// Removes everything, before a new training starts.
    pub fn clear(&mut self) {
        *self = Self::new();
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
        self.curves.evaluated.push(row.env_steps as f64, row.success_rate);
        self.evaluations.push(row);
        self.extend_to(row.env_steps, row.episodes <= 1);
    }

    /// Adds an annotation at `env_steps`.
    pub fn annotate(&mut self, env_steps: u64, text: String) {
        annotations::add(&mut self.annotations, env_steps, text);
    }

    /// Extends the x axis to `env_steps`. It starts at 0 if the first row is the `first_row` of a training,
    /// not of a resumed run.
    fn extend_to(&mut self, env_steps: u64, first_row: bool) {
        let first = if first_row { 0 } else { env_steps };
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

    /// The ends of the x axis, in env steps: from 0, or from the first row of a resumed run, to the last row.
    /// `None` without rows.
    #[must_use]
    pub fn range(&self) -> Option<(u64, u64)> {
        self.range
    }

    /// The points of the learning curve for export: all episodes (or every n-th, if there are very many) and all
    /// evaluations. If the temporary files failed, the points of the downsampled curves.
    pub fn learning_curve_points(&mut self) -> (Vec<EpisodePoint>, Vec<EvaluationPoint>) {
        (self.episode_points(), self.evaluation_points())
    }

    fn episode_points(&mut self) -> Vec<EpisodePoint> {
        let nth = self.episodes.div_ceil(MAX_PNG_EPISODES).max(1);
        let mut points = Vec::new();
        let mut index = 0;
        let all = self.rows.for_each(|row| {
            if index % nth == 0 {
                let EpisodeRow { env_steps, total_return, goals, .. } = row;
                points.push(EpisodePoint { env_steps, total_return, goals });
            }
            index += 1;
        });
        if all.is_ok() {
            return points;
        }
        let pairs = self.curves.returns.points().iter().zip(self.curves.goals.points());
        let point = |(total_return, goals): (&egui_plot::PlotPoint, &egui_plot::PlotPoint)| EpisodePoint {
            env_steps: total_return.x as u64,
            total_return: total_return.y,
            goals: goals.y.round() as u32,
        };
        pairs.map(point).collect()
    }

    fn evaluation_points(&mut self) -> Vec<EvaluationPoint> {
        let mut points = Vec::new();
        let all = self.evaluations.for_each(|row| {
            let EvaluationRow { env_steps, success_rate, mean_time_s, mean_cost_s, .. } = row;
            points.push(EvaluationPoint { env_steps, success_rate, mean_time_s, mean_cost_s });
        });
        if all.is_ok() {
            return points;
        }
        // The times of these evaluations are unknown. A NaN cost keeps all of them from being marked as the best.
        let point = |point: &egui_plot::PlotPoint| EvaluationPoint {
            env_steps: point.x as u64,
            success_rate: point.y,
            mean_time_s: None,
            mean_cost_s: f64::NAN,
        };
        self.curves.evaluated.points().iter().map(point).collect()
    }

    /// Writes a row per episode, with the columns of `episodes.csv`. The file is written atomically.
    ///
    /// # Errors
    /// The rows could not be stored, or `to` cannot be written.
    pub fn write_csv(&mut self, to: &Path) -> io::Result<()> {
        write_atomic(to, |file| self.rows.write_csv_to(file))
    }

    /// Writes the learning curve with `title` as an SVG file or a PNG file 1280 pixels wide, by the file's extension. In a
    /// browser it is always SVG. `compare_with_paper` adds the paper's success rate in Scenario I.
    ///
    /// # Errors
    /// The figure cannot be drawn, or `to` cannot be written.
    pub fn write_figure(&mut self, title: &str, compare_with_paper: bool, to: &Path) -> Result<(), RunError> {
        #[cfg(not(target_arch = "wasm32"))]
        let format = ImageFormat::of(to)?;
        let (episodes, evaluations) = self.learning_curve_points();
        let tolerance = BestPolicy::COST_TOLERANCE;
        let svg = learning_curve_svg(title, &episodes, &evaluations, tolerance, compare_with_paper);
        #[cfg(not(target_arch = "wasm32"))]
        let bytes = svg.and_then(|svg| format.encode(svg, 2.0));
        #[cfg(target_arch = "wasm32")]
        let bytes = svg.map(String::into_bytes);
        let bytes = bytes.map_err(|error| RunError::failed(to, error))?;
        write_atomic(to, |file| file.write_all(&bytes)).map_err(|error| RunError::failed(to, error))
    }
}
