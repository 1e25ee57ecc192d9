//! The figure of the learning curves for export: the curves, marks and reference lines of the screen.
//!
//! In: the history; from the session, the title, the best evaluation, and whether the scenario is the paper's Scenario I. Out: a
//! [`RunFigure`], and its PNG, PDF or SVG file.

#[cfg(target_arch = "wasm32")]
use std::io::Write;
use std::path::Path;

use egui_plot::PlotPoint;

use super::History;
use crate::report::run_figure::{EarlierRun, EpisodePoint, EvaluationPoint, RunFigure, RunMark};
use crate::run::RunError;
#[cfg(not(target_arch = "wasm32"))]
use crate::run::image_file::{self, ImageSize};
#[cfg(target_arch = "wasm32")]
use crate::run::output_file::write_atomic;

/// The maximum number of episodes in a figure. If there are more, every n-th is drawn.
const MAX_EPISODES: u64 = 1_000_000;

impl History {
    /// The figure of the curves, with `title`. If a temporary file cannot be read, it has the points of the downsampled curves.
    pub fn figure(
        &mut self,
        title: String,
        best: Option<EvaluationPoint>,
        is_paper_scenario_1: bool,
    ) -> RunFigure {
        let mark = |mark: &super::Annotation| RunMark { env_steps: mark.env_steps, text: mark.text.clone() };
        let pairs = |points: &[PlotPoint]| points.iter().map(|point| (point.x, point.y)).collect();
        RunFigure {
            title,
            episodes: self.episode_points(),
            evaluations: self.evaluation_points(),
            best,
            marks: self.annotations.iter().map(mark).collect(),
            earlier: self.earlier.as_ref().map_or_else(EarlierRun::default, |earlier| EarlierRun {
                success_rate: pairs(earlier.evaluated.points()),
                return_mean: pairs(earlier.return_mean.points()),
                goal_mean: pairs(earlier.goal_mean.points()),
            }),
            is_paper_scenario_1,
        }
    }

    fn episode_points(&mut self) -> Vec<EpisodePoint> {
        let nth = self.episodes.div_ceil(MAX_EPISODES).max(1);
        let mut points = Vec::new();
        let mut index = 0;
        let all = self.rows.for_each(|row| {
            if index % nth == 0 {
                points.push(row.point());
            }
            index += 1;
        });
        if all.is_ok() {
            return points;
        }
        let pairs = self.curves.returns.points().iter().zip(self.curves.goals.points());
        let point = |(total_return, goals): (&PlotPoint, &PlotPoint)| EpisodePoint {
            env_steps: total_return.x as u64,
            total_return: total_return.y,
            goals: goals.y.round() as u32,
        };
        pairs.map(point).collect()
    }

    fn evaluation_points(&mut self) -> Vec<EvaluationPoint> {
        let mut points = Vec::new();
        if self.evaluations.for_each(|row| points.push(row.point())).is_ok() {
            return points;
        }
        // The times of these evaluations are unknown.
        let point = |point: &PlotPoint| EvaluationPoint {
            env_steps: point.x as u64,
            success_rate: point.y,
            mean_time_s: None,
            mean_cost_s: f64::NAN,
        };
        self.curves.evaluated.points().iter().map(point).collect()
    }
}

/// Writes `figure` to `to`: as SVG, as PDF or as a PNG 2560 pixels wide, by the file's extension. In a browser it is always
/// SVG.
///
/// # Errors
/// The figure cannot be drawn, or `to` cannot be written.
pub fn write_figure(figure: &RunFigure, to: &Path) -> Result<(), RunError> {
    let svg = figure.svg().map_err(|error| RunError::failed(to, error))?;
    #[cfg(not(target_arch = "wasm32"))]
    return image_file::write(svg, ImageSize::Print, to);
    #[cfg(target_arch = "wasm32")]
    write_atomic(to, |file| file.write_all(svg.as_bytes())).map_err(|error| RunError::not_written(to, error))
}
