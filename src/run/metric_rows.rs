//! The metrics of a run: a row per episode, a row per evaluation, and a summary.
//!
//! The field names are the columns of `episodes.csv` and `evaluations.csv` and the keys of `summary.json`.
//! Only `wall_s` differs between two runs with the same scenario, preset and seed.

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::final_test::FinalTest;
use super::provenance::Provenance;
use crate::report::run_figure::{EpisodePoint, EvaluationPoint};
use crate::scenario::{column_name, read_text};
use crate::task::EpisodeEnd;

/// A row with further columns in a run over a set of scenarios: the set columns. They come after the fields of the row.
pub trait SetColumns: Sized {
    /// The type of a value in these columns.
    type Value: Serialize;

    /// The names of the columns for a set whose scenarios have the names `scenarios`; no columns if that is empty.
    fn set_columns(scenarios: &[String]) -> Vec<String>;

    /// The values of the columns.
    fn set_values(&self, scenarios: &[String]) -> Vec<Self::Value>;

    /// Reads the values of the columns; `value` returns the text in the column with a given name.
    fn read_set_values<'v>(&mut self, scenarios: &[String], value: impl Fn(&str) -> Option<&'v str>);
}

/// The rows in `csv`, the contents of a CSV file with a header. `scenarios` are the names of the scenarios in the run's set, for
/// the set columns; it is empty without a set.
///
/// # Errors
/// A row cannot be parsed as `Row`.
pub fn parse_rows<Row: DeserializeOwned + SetColumns>(
    csv: &[u8],
    scenarios: &[String],
) -> csv::Result<Vec<Row>> {
    let mut reader = csv::Reader::from_reader(csv);
    let header = reader.headers()?.clone();
    let mut rows = Vec::new();
    for record in reader.records() {
        let record = record?;
        let mut row: Row = record.deserialize(Some(&header))?;
        let value = |name: &str| record.get(header.iter().position(|column| column == name)?);
        row.read_set_values(scenarios, value);
        rows.push(row);
    }
    Ok(rows)
}

/// A row of `episodes.csv`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EpisodeRow {
    /// Number of the episode, from 1, in the order in which episodes end.
    pub episode: u64,
    /// Index of the arena, from 0.
    pub arena: usize,
    /// Env steps of the run when the episode ended.
    pub env_steps: u64,
    /// Gradient steps of the run when the episode ended.
    pub gradient_steps: u64,
    /// Length of the episode in control steps.
    pub steps: u32,
    /// Undiscounted sum of the rewards.
    #[serde(rename = "return")]
    pub total_return: f64,
    /// Part of the return: r+ for reached goals.
    pub reward_goal: f32,
    /// Part of the return: r- for the collision.
    pub reward_collision: f32,
    /// Part of the return: the decrease of the attractive potential U_a.
    pub reward_attraction: f32,
    /// Part of the return: the decrease of the repulsive potential U_r.
    pub reward_repulsion: f32,
    /// The scenario of the episode, by its name in the run's set. With a set, it is the column `scenario` after the other fields.
    #[serde(skip)]
    pub scenario: Option<String>,
    /// Parts of the return from plugin reward terms. They are written as extra columns `reward_<name>` after all others.
    #[serde(skip)]
    pub extra_rewards: Vec<f32>,
    /// Number of goals reached.
    pub goals: u32,
    /// 1 if the episode ended in a collision, 0 if it ended at the time limit.
    pub collision: u8,
    /// Epsilon when the episode ended.
    pub epsilon: f32,
    /// Mean loss of the gradient steps since the previous row; the previous row's mean if there were none.
    pub loss: Option<f64>,
    /// Mean absolute TD error of the same gradient steps.
    pub td_error: Option<f64>,
    /// Mean Q-value of the actions taken, over the same gradient steps.
    pub mean_q: Option<f64>,
    /// Wall time from the start of the process, in s; summed over all processes of a resumed run.
    pub wall_s: f64,
}

impl EpisodeRow {
    /// The value of the column `collision`.
    #[must_use]
    pub fn collision_flag(end: EpisodeEnd) -> u8 {
        u8::from(end == EpisodeEnd::Collided)
    }

    /// The episode in the figure of the run.
    #[must_use]
    pub fn point(&self) -> EpisodePoint {
        EpisodePoint { env_steps: self.env_steps, total_return: self.total_return, goals: self.goals }
    }
}

impl SetColumns for EpisodeRow {
    type Value = Option<String>;

    fn set_columns(scenarios: &[String]) -> Vec<String> {
        if scenarios.is_empty() { Vec::new() } else { vec!["scenario".into()] }
    }

    fn set_values(&self, scenarios: &[String]) -> Vec<Option<String>> {
        if scenarios.is_empty() { Vec::new() } else { vec![self.scenario.clone()] }
    }

    fn read_set_values<'v>(&mut self, scenarios: &[String], value: impl Fn(&str) -> Option<&'v str>) {
        self.scenario = value("scenario").map(String::from).filter(|name| scenarios.contains(name));
    }
}

/// A row of `evaluations.csv`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EvaluationRow {
    /// Env steps of the run when the policy was submitted for evaluation.
    pub env_steps: u64,
    /// Episodes finished when the policy was submitted for evaluation.
    pub episodes: u64,
    /// Gradient steps of the run when the policy was submitted for evaluation.
    pub gradient_steps: u64,
    /// Fraction of episodes that succeeded, 0 to 1.
    pub success_rate: f64,
    /// Fraction of episodes that ended in a collision, 0 to 1.
    pub collision_rate: f64,
    /// Fraction of episodes that ended at the time limit, 0 to 1.
    pub timeout_rate: f64,
    /// Mean simulated time of the successful episodes, in s.
    pub mean_time_s: Option<f64>,
    /// Mean cost, in s: the simulated time of an episode, or the whole time limit if it failed. The best
    /// policy is the one with the lowest cost.
    pub mean_cost_s: f64,
    /// Wall time from the start of the process, in s; summed over all processes of a resumed run.
    pub wall_s: f64,
    /// The success rates in the scenarios of a set, 0 to 1, by name. With a set, they are columns `success_rate_<name>` after
    /// all others.
    #[serde(skip)]
    pub scenario_success_rates: Vec<(String, f64)>,
}

impl EvaluationRow {
    /// The evaluation in the figure of the run.
    #[must_use]
    pub fn point(&self) -> EvaluationPoint {
        let &Self { env_steps, success_rate, mean_time_s, mean_cost_s, .. } = self;
        EvaluationPoint { env_steps, success_rate, mean_time_s, mean_cost_s }
    }
}

impl SetColumns for EvaluationRow {
    type Value = Option<f64>;

    fn set_columns(scenarios: &[String]) -> Vec<String> {
        scenarios.iter().map(|name| rate_column(name)).collect()
    }

    fn set_values(&self, scenarios: &[String]) -> Vec<Option<f64>> {
        let rate = |name: &String| self.scenario_success_rates.iter().find(|(other, _)| other == name);
        scenarios.iter().map(|name| Some(rate(name)?.1)).collect()
    }

    fn read_set_values<'v>(&mut self, scenarios: &[String], value: impl Fn(&str) -> Option<&'v str>) {
        let rate = |name: &String| Some((name.clone(), value(&rate_column(name))?.parse().ok()?));
        self.scenario_success_rates = scenarios.iter().filter_map(rate).collect();
    }
}

/// The column of the success rate in the scenario `name` of a set.
fn rate_column(name: &str) -> String {
    format!("success_rate_{}", column_name(name))
}

/// The first evaluation that reached a given success rate.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Milestone {
    /// Env steps of the run at that evaluation.
    pub env_steps: u64,
    /// Episodes finished at that evaluation.
    pub episodes: u64,
    /// Wall time at that evaluation, in s, as in [`EvaluationRow::wall_s`].
    pub wall_s: f64,
}

/// The contents of `summary.json`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Summary {
    /// The program that wrote the summary, and the scenario's checksum.
    #[serde(flatten)]
    pub provenance: Provenance,
    /// The name of the scenario, or of the set of scenarios.
    pub scenario: String,
    /// The scenario's file or shipped name, as given by the user.
    pub scenario_from: String,
    /// The preset's file or shipped name, as given by the user.
    pub preset: String,
    /// The run's seed.
    pub seed: u64,
    /// Whether the budget is used up.
    pub finished: bool,
    /// Finished episodes.
    pub episodes: u64,
    /// Env steps taken, over all arenas.
    pub env_steps: u64,
    /// Gradient steps taken.
    pub gradient_steps: u64,
    /// Wall time from the start of the process, including evaluations but not the final test, in s; summed over all processes
    /// of a resumed run.
    pub wall_s: f64,
    /// Number of evaluations, including those at env step 0 and at the end.
    #[serde(default)]
    pub evaluations: usize,
    /// Success rate of the best policy in the evaluation that selected it, 0 to 1; `None` without an evaluation. The best of
    /// many evaluations is optimistic; `final_test` is not.
    pub best_success_rate: Option<f64>,
    /// Mean simulated time of the successful episodes in that evaluation, in s.
    pub best_mean_time_s: Option<f64>,
    /// Env steps of the run before that evaluation: 0 if the initial policy was never surpassed. `None` without an
    /// evaluation, or if the policy has no card.
    #[serde(default)]
    pub best_env_steps: Option<u64>,
    /// Success rate in the last evaluation, 0 to 1.
    pub last_success_rate: Option<f64>,
    /// The first evaluation with a success rate of at least 96 % (the paper's result).
    pub first_96: Option<Milestone>,
    /// The first evaluation with a success rate of at least 99 %.
    pub first_99: Option<Milestone>,
    /// The test of the best policy in fresh episodes, after training; `None` if the run has not finished or the preset asks
    /// for no test. These are the results to report.
    #[serde(default)]
    pub final_test: Option<FinalTest>,
}

impl Summary {
    /// The summary of the run in the folder `path`; `None` if it is missing or cannot be read.
    #[must_use]
    pub fn read(path: &std::path::Path) -> Option<Self> {
        let text = read_text(path.join("summary.json")).ok()?;
        serde_json::from_str(&text).ok()
    }
}
