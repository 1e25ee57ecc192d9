//! The records of a training run: every episode and evaluation, and the measures computed from them.

use std::path::Path;

use serde::de::DeserializeOwned;

use super::arm_run::PolicyId;
use super::figure_spec::{Axis, Series};
use super::measured_value::MeasuredValue;
use crate::report::curves::value_at;
use crate::report::smoothing::moving_mean;
use crate::run::RunError;
use crate::run::folder::{EPISODES_FILE, EVALUATIONS_FILE};
use crate::run::metric_rows::{EpisodeRow, EvaluationRow, Summary};
use crate::run::preset::Budget;

/// The numbers of training episodes over which means are taken.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Windows {
    /// Episodes in the mean at the end of training.
    pub last: usize,
    /// Episodes in the moving mean of [`Records::episodes_to`] and [`Records::steps_to`].
    pub moving: usize,
}

impl Default for Windows {
    fn default() -> Self {
        Self { last: 100, moving: 50 }
    }
}

impl Windows {
    /// The same window for both means, as in a figure.
    pub fn equal(window: usize) -> Self {
        Self { last: window, moving: window }
    }
}

/// The episodes and evaluations of a training run.
#[derive(Debug)]
pub struct Records {
    /// Env steps that the run had taken at the end of each episode.
    env_steps: Vec<u64>,
    /// Env steps of the whole run.
    total_env_steps: u64,
    returns: Vec<f64>,
    goals: Vec<f64>,
    evaluations: Vec<EvaluationRow>,
    /// The number of arenas, which is the number of env steps per control step.
    arenas: u64,
}

impl Records {
    /// Reads the records in the folder of a run with this number of arenas.
    ///
    /// # Errors
    /// A file cannot be read.
    pub fn read(folder: &Path, arenas: usize) -> Result<Self, RunError> {
        let episodes: Vec<EpisodeRow> = rows(&folder.join(EPISODES_FILE))?;
        let env_steps: Vec<u64> = episodes.iter().map(|row| row.env_steps).collect();
        let last = env_steps.last().copied().unwrap_or(0);
        Ok(Self {
            env_steps,
            total_env_steps: Summary::read(folder).map_or(last, |summary| summary.env_steps),
            returns: episodes.iter().map(|row| row.total_return).collect(),
            goals: episodes.iter().map(|row| f64::from(row.goals)).collect(),
            evaluations: rows(&folder.join(EVALUATIONS_FILE))?,
            arenas: arenas.max(1) as u64,
        })
    }

    /// The env steps of the whole run.
    pub fn total_env_steps(&self) -> u64 {
        self.total_env_steps
    }

    /// The number of episodes until `policy` was saved; all for the best and the last policy.
    pub fn episodes(&self, policy: PolicyId) -> usize {
        match policy {
            PolicyId::After(Budget::Episodes(n)) => (n as usize).min(self.env_steps.len()),
            PolicyId::After(Budget::EnvSteps(n)) => {
                let reached = self.whole_steps(n);
                self.env_steps.partition_point(|&steps| steps <= reached)
            }
            PolicyId::Best | PolicyId::Last => self.env_steps.len(),
        }
    }

    /// `env_steps`, rounded up to whole control steps: the policy is saved after a control step.
    fn whole_steps(&self, env_steps: u64) -> u64 {
        env_steps.div_ceil(self.arenas).saturating_mul(self.arenas)
    }

    /// The env steps until `policy` was saved; all for the best and the last policy.
    pub fn env_steps(&self, policy: PolicyId) -> u64 {
        match policy {
            PolicyId::After(Budget::EnvSteps(n)) => self.whole_steps(n),
            PolicyId::After(Budget::Episodes(_)) => {
                self.episodes(policy).checked_sub(1).map_or(0, |last| self.env_steps[last])
            }
            PolicyId::Best | PolicyId::Last => self.total_env_steps,
        }
    }

    /// The length of training until `policy` was saved, in units of `axis`.
    pub fn length(&self, policy: PolicyId, axis: Axis) -> f64 {
        match axis {
            Axis::Episodes => self.episodes(policy) as f64,
            Axis::EnvSteps => self.env_steps(policy) as f64,
        }
    }

    /// A series until `policy` was saved, as points (x in units of `axis`, value).
    pub fn curve(&self, series: Series, policy: PolicyId, axis: Axis) -> Vec<(f64, f64)> {
        let values = match series {
            Series::Return => &self.returns,
            Series::Goals => &self.goals,
            Series::SuccessRate => return self.success_rates(policy, axis),
        };
        let x = |episode: usize| match axis {
            Axis::Episodes => (episode + 1) as f64,
            Axis::EnvSteps => self.env_steps[episode] as f64,
        };
        (0..self.episodes(policy)).map(|episode| (x(episode), values[episode])).collect()
    }

    /// The success rates of the evaluations, in percent.
    fn success_rates(&self, policy: PolicyId, axis: Axis) -> Vec<(f64, f64)> {
        let is_before = |row: &&EvaluationRow| match policy {
            PolicyId::After(Budget::Episodes(n)) => row.episodes <= n,
            PolicyId::After(Budget::EnvSteps(n)) => row.env_steps <= self.whole_steps(n),
            PolicyId::Best | PolicyId::Last => true,
        };
        let point = |row: &EvaluationRow| {
            let x = if axis == Axis::Episodes { row.episodes } else { row.env_steps };
            (x as f64, 100.0 * row.success_rate)
        };
        self.evaluations.iter().filter(is_before).map(point).collect()
    }

    /// The success rate in the evaluations, in percent, when `policy` was saved: the value of the curve up to `end` at that
    /// point, interpolated between evaluations. At 0 env steps, it is the success rate of the initial policy.
    pub fn success_rate(&self, policy: PolicyId, end: PolicyId) -> MeasuredValue {
        let axis = match policy {
            // On the axis of episodes, all evaluations before the end of the first episode are at 0.
            PolicyId::After(Budget::Episodes(1..)) => Axis::Episodes,
            _ => Axis::EnvSteps,
        };
        MeasuredValue::exact(value_at(&self.success_rates(end, axis), self.length(policy, axis)))
    }

    /// The mean return of the last `window` episodes until `policy` was saved (or of all, if there are fewer).
    pub fn last_return(&self, policy: PolicyId, window: usize) -> MeasuredValue {
        mean_of_last(&self.returns[..self.episodes(policy)], window)
    }

    /// The mean number of goals of the last `window` episodes until `policy` was saved (or of all, if there are fewer).
    pub fn last_goals(&self, policy: PolicyId, window: usize) -> MeasuredValue {
        mean_of_last(&self.goals[..self.episodes(policy)], window)
    }

    /// The first episode (from 0) at which the moving mean over `window` episodes reaches `goals` per episode; if none does,
    /// the last episode and `true`. `None` without episodes.
    fn episode_with_goals(&self, goals: f64, policy: PolicyId, window: usize) -> Option<(usize, bool)> {
        let series = &self.goals[..self.episodes(policy)];
        let window = window.min(series.len());
        let means = moving_mean(series, window);
        let reached = means.iter().enumerate().position(|(i, &mean)| i + 1 >= window && mean >= goals);
        Some((reached.or(series.len().checked_sub(1))?, reached.is_none()))
    }

    /// The number of episodes until the moving mean reaches `goals` per episode; a lower bound if it never does. NaN without
    /// episodes.
    pub fn episodes_to(&self, goals: f64, policy: PolicyId, window: usize) -> MeasuredValue {
        let found = self.episode_with_goals(goals, policy, window);
        found.map_or(MeasuredValue::exact(f64::NAN), |(episode, is_lower_bound)| MeasuredValue {
            value: (episode + 1) as f64,
            is_lower_bound,
        })
    }

    /// Thousands of env steps until the moving mean reaches `goals` per episode; a lower bound if it never does. NaN without
    /// episodes.
    pub fn steps_to(&self, goals: f64, policy: PolicyId, window: usize) -> MeasuredValue {
        let found = self.episode_with_goals(goals, policy, window);
        found.map_or(MeasuredValue::exact(f64::NAN), |(episode, is_lower_bound)| MeasuredValue {
            value: self.env_steps[episode] as f64 / 1e3,
            is_lower_bound,
        })
    }
}

fn mean_of_last(values: &[f64], window: usize) -> MeasuredValue {
    let last = &values[values.len().saturating_sub(window)..];
    // Without episodes, the mean is NaN: there is no value.
    MeasuredValue::exact(last.iter().sum::<f64>() / last.len() as f64)
}

fn rows<Row: DeserializeOwned>(path: &Path) -> Result<Vec<Row>, RunError> {
    let rows = csv::Reader::from_path(path).map(|mut reader| reader.deserialize().collect());
    rows.flatten().map_err(|error| RunError::failed(path, error))
}
