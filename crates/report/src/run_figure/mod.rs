//! The figure of a single training run: success rate, return and goals over env steps.
//!
//! It shows what the app shows on the screen: the same smoothing, marks and reference lines.

mod panels;
#[cfg(test)]
mod tests;

use crate::DrawError;
use crate::chart::{CurveChart, EventMarker};
use crate::format::{number, percent};

/// The number of episodes in the moving mean, here and in the app.
pub const MEAN_EPISODES: usize = 100;
/// Up to this number of episodes, each one is drawn; beyond it, only a band from minimum to maximum. Here and in the app.
pub const MAX_SINGLE_EPISODES: usize = 1000;

/// A result of the paper, which is drawn as a reference line.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PaperResult {
    /// The value.
    pub value: f64,
    /// The label of the line: the value in words.
    pub label: &'static str,
}

/// The paper's success rate of PER-D3QN in Scenario I (table 2), 0 to 1.
pub const PAPER_SUCCESS_RATE: PaperResult = PaperResult { value: 0.96, label: "paper 96%" };
/// The return per episode at which the paper's PER-D3QN settles in Scenario I (fig. 9), as in
/// `assets/experiments/fig9.ron`.
pub const PAPER_RETURN: PaperResult = PaperResult { value: 2500.0, label: "paper 2,500" };

/// A finished episode.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EpisodePoint {
    /// Environment steps of the whole run when the episode ended.
    pub env_steps: u64,
    /// The undiscounted sum of the episode's rewards.
    pub total_return: f64,
    /// Goals reached in the episode.
    pub goals: u32,
}

/// An evaluation of the greedy policy.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct EvaluationPoint {
    /// Environment steps of the whole run when the policy was evaluated.
    pub env_steps: u64,
    /// Fraction of the episodes that succeeded, 0 to 1.
    pub success_rate: f64,
    /// Mean simulated time of the successful episodes, in s; `None` if none succeeded.
    pub mean_time_s: Option<f64>,
    /// Mean time of all episodes, in s; a failure counts as the time limit. [`best_evaluation`] compares it.
    pub mean_cost_s: f64,
}

/// A text at a position on the x axis, such as a change of the scenario.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct RunMark {
    /// Environment steps of the whole run.
    pub env_steps: u64,
    /// The text, a few words.
    pub text: String,
}

/// The curves of the training run before a transfer, as points (env steps, value).
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EarlierRun {
    /// Success rate of the greedy policy, 0 to 1.
    pub success_rate: Vec<(f64, f64)>,
    /// Moving mean of the return per episode.
    pub return_mean: Vec<(f64, f64)>,
    /// Moving mean of the goals per episode.
    pub goal_mean: Vec<(f64, f64)>,
}

/// The contents of a run's figure. Points may be in any order. Values that are not finite, or 1e12 or more, are left out.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RunFigure {
    /// The title.
    pub title: String,
    /// The finished episodes.
    pub episodes: Vec<EpisodePoint>,
    /// The evaluations.
    pub evaluations: Vec<EvaluationPoint>,
    /// The evaluation of the best policy.
    pub best: Option<EvaluationPoint>,
    /// Marks at changes made by the user.
    pub marks: Vec<RunMark>,
    /// The training run before a transfer.
    pub earlier: EarlierRun,
    /// Whether the run is in the paper's Scenario I, so that the paper's reference lines apply.
    pub is_paper_scenario_1: bool,
}

impl RunFigure {
    /// The figure as the text of an SVG file of less than 300 kB.
    ///
    /// # Errors
    /// The drawing library failed. No input is known to cause this.
    pub fn svg(&self) -> Result<String, DrawError> {
        let steps =
            self.episodes.iter().map(|e| e.env_steps).chain(self.evaluations.iter().map(|e| e.env_steps));
        let single = self.episodes.len() <= MAX_SINGLE_EPISODES;
        let chart = CurveChart {
            title: self.title.clone(),
            x_label: "env steps (thousands)".into(),
            include_x: vec![0.0, steps.max().filter(|&steps| steps > 0).map_or(1.0, thousands)],
            mean_label: format!("mean of {MEAN_EPISODES} episodes"),
            band_label: "lowest to highest episode".into(),
            raw_label: if single { "one evaluation or episode".into() } else { String::new() },
            panels: vec![self.success_panel(), self.return_panel(), self.goal_panel()],
            markers: self.markers(),
        };
        chart.svg()
    }

    fn markers(&self) -> Vec<EventMarker> {
        let mark = |mark: &RunMark| EventMarker { x: thousands(mark.env_steps), label: mark.text.clone() };
        self.marks.iter().map(mark).chain(self.best.as_ref().map(best_marker)).collect()
    }
}

/// The latest evaluation whose cost is at most `cost_tolerance` (1 or more) times the lowest.
#[must_use]
pub fn best_evaluation(evaluations: &[EvaluationPoint], cost_tolerance: f64) -> Option<EvaluationPoint> {
    let known = || evaluations.iter().filter(|e| e.success_rate.is_finite());
    let lowest = known().map(|e| e.mean_cost_s).fold(f64::INFINITY, f64::min);
    known().filter(|e| e.mean_cost_s <= cost_tolerance * lowest).max_by_key(|e| e.env_steps).copied()
}

fn best_marker(best: &EvaluationPoint) -> EventMarker {
    let steps = number(best.env_steps as f64, 0);
    let time = best.mean_time_s.map_or(String::new(), |s| format!(", {s:.1} s per goal"));
    let rate = percent(best.success_rate.clamp(0.0, 1.0));
    EventMarker { x: thousands(best.env_steps), label: format!("best: {rate} at {steps} steps{time}") }
}

fn thousands(env_steps: u64) -> f64 {
    env_steps as f64 / 1000.0
}
