//! The learning curves over env steps.

use super::series::{DownsampledSeries, MovingAverage};
use crate::run::metric_rows::{EpisodeRow, EvaluationRow};

/// The learning curves over env steps. Moving averages are over
/// [`MOVING_AVERAGE_EPISODES`](super::MOVING_AVERAGE_EPISODES) episodes.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct LearningCurves {
    /// Moving success rate in training, 0 to 1: goals reached over goals attempted. An episode that reached n
    /// goals attempted n + 1, whether it ended in a collision or at the time limit.
    pub success: MovingAverage,
    /// Success rate of the greedy policy in each evaluation, 0 to 1.
    pub evaluated: DownsampledSeries,
    /// The same in each scenario of a set, by name; empty without a set.
    pub evaluated_in: Vec<(String, DownsampledSeries)>,
    /// Return of each episode.
    pub returns: DownsampledSeries,
    /// Moving average of the return.
    pub return_mean: MovingAverage,
    /// Goals reached in each episode.
    pub goals: DownsampledSeries,
    /// Moving average of the goals per episode.
    pub goal_mean: MovingAverage,
    /// Base-10 logarithm of the loss. A bucket's mean is then the geometric mean, which suits a logarithmic axis.
    pub loss_log: DownsampledSeries,
    /// Base-10 logarithm of the mean absolute TD error.
    pub td_error_log: DownsampledSeries,
    /// Mean Q-value of the actions taken, in units of the scaled reward.
    pub mean_q: DownsampledSeries,
    /// Epsilon, 0 to 1.
    pub epsilon: DownsampledSeries,
    /// Moving average of an episode's reward for reaching goals.
    pub reached: MovingAverage,
    /// Moving average of an episode's reward for a collision.
    pub collided: MovingAverage,
    /// Moving average of an episode's attraction term.
    pub attraction: MovingAverage,
    /// Moving average of an episode's repulsion term.
    pub repulsion: MovingAverage,
}

/// The curves of the training run before a transfer, over its own env steps.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct EarlierCurves {
    /// Success rate of the greedy policy in each evaluation, 0 to 1.
    pub evaluated: DownsampledSeries,
    /// Moving average of the return.
    pub return_mean: DownsampledSeries,
    /// Moving average of the goals per episode.
    pub goal_mean: DownsampledSeries,
    /// Env steps of that whole run.
    pub env_steps: u64,
}

impl LearningCurves {
    /// Adds an evaluation.
    pub(super) fn push_evaluation(&mut self, row: &EvaluationRow) {
        let x = row.env_steps as f64;
        self.evaluated.push(x, row.success_rate);
        for (name, series) in &mut self.evaluated_in {
            if let Some((_, rate)) = row.scenario_success_rates.iter().find(|(other, _)| other == name) {
                series.push(x, *rate);
            }
        }
    }

    /// Adds a finished episode to all curves but those of evaluations.
    pub(super) fn push_episode(&mut self, row: &EpisodeRow) {
        let x = row.env_steps as f64;
        let goals = f64::from(row.goals);
        self.success.push_ratio(x, goals, goals + 1.0);
        self.returns.push(x, row.total_return);
        self.return_mean.push(x, row.total_return);
        self.goals.push(x, goals);
        self.goal_mean.push(x, goals);
        for (series, value) in [
            // The logarithm of 0 is not finite, and is ignored.
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
