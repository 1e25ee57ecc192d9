//! The records of a training: every episode, and the measures computed from them.

use std::path::Path;

use super::figure_spec::EpisodeSeries;
use super::measured_value::MeasuredValue;
use super::plan::PolicyId;
use crate::report::smoothing::moving_mean;
use crate::run::RunError;
use crate::run::metric_rows::EpisodeRow;

/// Episodes in the means at the end of training.
const FINAL_WINDOW: usize = 100;
/// Episodes in the moving mean that must reach a number of goals.
const GOALS_WINDOW: usize = 50;

/// The episodes of a training.
#[derive(Debug)]
pub struct Records {
    /// Environment steps of the whole run at the end of each episode.
    pub env_steps: Vec<u64>,
    returns: Vec<f64>,
    goals: Vec<f64>,
}

impl Records {
    /// The records in the file `episodes.csv` at `path`.
    ///
    /// # Errors
    /// The file cannot be read.
    pub fn read(path: &Path) -> Result<Self, RunError> {
        let mut reader = csv::Reader::from_path(path).map_err(|error| RunError::failed(path, error))?;
        let mut records = Self { env_steps: Vec::new(), returns: Vec::new(), goals: Vec::new() };
        for row in reader.deserialize::<EpisodeRow>() {
            let row = row.map_err(|error| RunError::failed(path, error))?;
            records.env_steps.push(row.env_steps);
            records.returns.push(row.total_return);
            records.goals.push(f64::from(row.goals));
        }
        Ok(records)
    }

    /// A series up to the episode after which `policy` was saved; all of it for the best policy.
    pub fn until(&self, series: EpisodeSeries, policy: PolicyId) -> &[f64] {
        let all = match series {
            EpisodeSeries::Return => &self.returns,
            EpisodeSeries::Goals => &self.goals,
        };
        match policy {
            PolicyId::AfterEpisodes(episodes) => &all[..(episodes as usize).min(all.len())],
            PolicyId::Best => all,
        }
    }

    /// The mean of the last episodes of a series.
    pub fn final_mean(&self, series: EpisodeSeries, policy: PolicyId) -> MeasuredValue {
        let all = self.until(series, policy);
        let last = &all[all.len().saturating_sub(FINAL_WINDOW)..];
        MeasuredValue::exact(last.iter().sum::<f64>() / last.len().max(1) as f64)
    }

    /// The first episode (from 0) at which the moving mean reaches `goals` per episode; if none does, the last episode
    /// and `true`.
    pub fn episode_with_goals(&self, goals: f64, policy: PolicyId) -> (usize, bool) {
        let series = self.until(EpisodeSeries::Goals, policy);
        let window = GOALS_WINDOW.min(series.len());
        let means = moving_mean(series, window);
        let reached = means.iter().enumerate().position(|(i, &mean)| i + 1 >= window && mean >= goals);
        (reached.unwrap_or(series.len().saturating_sub(1)), reached.is_none())
    }
}
