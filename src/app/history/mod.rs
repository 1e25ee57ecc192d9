//! The history of a training: all that the plots draw, and what can be saved of it.
//!
//! In: a row for each episode and each evaluation, as they come; marks for what the user did. Out: [`LearningCurves`] to draw,
//! `episodes.csv` with the columns of a run without a window, and the learning curve as PNG. Memory stays flat
//! however long training goes: curves are [`DownsampledSeries`], and the rows lie in temporary files (`spool.rs`).

mod annotations;
mod series;
mod spool;
#[cfg(test)]
mod tests;

use std::io::{self, Write};
use std::path::Path;

pub use self::annotations::Annotation;
pub use self::series::{DownsampledSeries, MAX_POINTS, MOVING_AVERAGE_EPISODES, MovingAverage};
use self::spool::Spool;
#[cfg(not(target_arch = "wasm32"))]
use crate::report::raster::png;
use crate::report::run_figure::{EpisodePoint, EvaluationPoint, learning_curve_svg};
use crate::run::checkpoint::BestPolicy;
use crate::run::folder::write_atomic;
use crate::run::metric_rows::{EpisodeRow, EvaluationRow};

/// The PNG is drawn from so many episodes at most; of more, every n-th is taken.
const MAX_PNG_EPISODES: u64 = 200_000;

/// The curves over env steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LearningCurves {
    /// Share of the navigations in the last [`MOVING_AVERAGE_EPISODES`] episodes that reached their goal, 0 to 1. An episode with n
    /// goals is n + 1 navigations of which n succeeded, whether the last ended in a collision or was cut off by
    /// the time limit.
    pub success: MovingAverage,
    /// Success rate of the greedy policy in each evaluation, 0 to 1.
    pub evaluated: DownsampledSeries,
    /// Return of each episode.
    pub returns: DownsampledSeries,
    /// Its moving mean.
    pub return_mean: MovingAverage,
    /// Targets reached in each episode.
    pub goals: DownsampledSeries,
    /// Their moving mean.
    pub goal_mean: MovingAverage,
    /// The loss, as a logarithm to base 10: so the mean of many rows is the geometric one, as suits a log axis.
    pub loss_log: DownsampledSeries,
    /// The mean absolute TD error, likewise.
    pub td_error_log: DownsampledSeries,
    /// Mean Q-value of the actions taken, in units of reward as they are learnt.
    pub mean_q: DownsampledSeries,
    /// Epsilon, 0 to 1.
    pub epsilon: DownsampledSeries,
    /// Moving mean of the reward for reached goals in an episode.
    pub reached: MovingAverage,
    /// That for the collision.
    pub collided: MovingAverage,
    /// That of the attraction's fall.
    pub attraction: MovingAverage,
    /// That of the repulsion's fall.
    pub repulsion: MovingAverage,
}

impl LearningCurves {
    fn push_episode(&mut self, row: &EpisodeRow) {
        let x = row.env_steps as f64;
        let goals = f64::from(row.goals);
        self.success.push_ratio(x, goals, goals + 1.0);
        self.returns.push(x, row.total_return);
        self.return_mean.push(x, row.total_return);
        self.goals.push(x, goals);
        self.goal_mean.push(x, goals);
        for (series, value) in [
            // A logarithm of nothing is no number, and is left out.
            (&mut self.loss_log, row.loss.map(f64::log10)),
            (&mut self.td_error_log, row.td_error.map(f64::log10)),
            (&mut self.mean_q, row.mean_q),
            (&mut self.epsilon, Some(f64::from(row.epsilon))),
        ] {
            if let Some(value) = value {
                series.push(x, value);
            }
        }
        for (mean, term) in [
            (&mut self.reached, row.reward_goal),
            (&mut self.collided, row.reward_collision),
            (&mut self.attraction, row.reward_attraction),
            (&mut self.repulsion, row.reward_repulsion),
        ] {
            mean.push(x, f64::from(term));
        }
    }
}

/// The history of a training.
pub struct History {
    curves: LearningCurves,
    annotations: Vec<Annotation>,
    /// Where the x axis begins and ends, in env steps.
    range: Option<(u64, u64)>,
    /// Rows in `rows`.
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
    /// An empty one. Without room for temporary files there are still plots and a coarser PNG, but no CSV.
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

    /// Forgets everything: a new training begins.
    pub fn clear(&mut self) {
        *self = Self::new();
    }

    /// Adds an episode.
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

    /// Marks the place `env_steps` by a few words.
    pub fn annotate(&mut self, env_steps: u64, text: String) {
        annotations::add(&mut self.annotations, env_steps, text);
    }

    /// Lengthens the x axis. It begins at 0 if the first row is of a training's `beginning`.
    fn extend_to(&mut self, env_steps: u64, beginning: bool) {
        let first = if beginning { 0 } else { env_steps };
        let (from, to) = self.range.unwrap_or((first, env_steps));
        self.range = Some((from.min(env_steps), to.max(env_steps)));
    }

    /// What to draw.
    #[must_use]
    pub fn curves(&self) -> &LearningCurves {
        &self.curves
    }

    /// What happened, in order.
    #[must_use]
    pub fn annotations(&self) -> &[Annotation] {
        &self.annotations
    }

    /// From where to where the rows go, in env steps: from 0, or from the first row if that is not the training's first.
    /// None if there is no row.
    #[must_use]
    pub fn range(&self) -> Option<(u64, u64)> {
        self.range
    }

    /// The points of the learning curve: of each episode and each evaluation from the spooled rows (of very many
    /// episodes every n-th), or from the curves if the disk has failed.
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
        // Their times are lost; no cost at all means that none is called the best.
        let point = |point: &egui_plot::PlotPoint| EvaluationPoint {
            env_steps: point.x as u64,
            success_rate: point.y,
            mean_time_s: None,
            mean_cost_s: f64::NAN,
        };
        self.curves.evaluated.points().iter().map(point).collect()
    }

    /// Writes every episode's row, with the columns of a run's `episodes.csv`: whole or not at all.
    ///
    /// # Errors
    /// The rows could not be kept, or the file cannot be written.
    pub fn write_csv(&mut self, to: &Path) -> io::Result<()> {
        write_atomic(to, |file| self.rows.write_csv_to(file))
    }

    /// Draws the learning curve under `title`, as a PNG 1280 pixels wide; in a browser, which draws such itself, as
    /// the SVG.
    ///
    /// # Errors
    /// It cannot be drawn, or the file cannot be written; in words.
    pub fn write_png(&mut self, title: &str, to: &Path) -> Result<(), String> {
        let (episodes, evaluations) = self.learning_curve_points();
        let svg = learning_curve_svg(title, &episodes, &evaluations, BestPolicy::COST_TOLERANCE);
        #[cfg(not(target_arch = "wasm32"))]
        let bytes = svg.and_then(|svg| png(&svg, 2.0)).map_err(|error| error.to_string())?;
        #[cfg(target_arch = "wasm32")]
        let bytes = svg.map_err(|error| error.to_string())?.into_bytes();
        write_atomic(to, |file| file.write_all(&bytes)).map_err(|error| error.to_string())
    }
}
