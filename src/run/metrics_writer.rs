//! The metrics writer: CSV files, TensorBoard events and learning curves of a run.
//!
//! In: rows. Out: `episodes.csv`, `evaluations.csv`, TensorBoard events, and at the end `learning-curve.svg`.

use std::fs::File;
use std::io::Write;
use std::time::{Duration, Instant};

use super::RunError;
use super::checkpoint::TrainerState;
use super::folder::{EPISODES_FILE, EVALUATIONS_FILE, RunConfig, RunFolder};
use super::metric_rows::{EpisodeRow, EvaluationRow, SetColumns};
use super::run_image;
use super::tensorboard::{EventWriter, cut_back};
use super::write_points::write_point;
use crate::scenario::column_name;

/// The TensorBoard event files, in messages.
const EVENT_FILES: &str = "events.out.tfevents.*";

/// The tags of an evaluation's scalars start with this.
const EVALUATION_TAGS: &str = "evaluation/";

/// The interval between flushes, each of which makes new rows visible to other programs.
const FLUSH_INTERVAL: Duration = Duration::from_secs(1);

/// The open metrics files of a run.
pub struct MetricsWriter {
    folder: RunFolder,
    episodes: csv::Writer<File>,
    evaluations: csv::Writer<File>,
    events: EventWriter,
    /// The names of the columns for plugin reward terms.
    reward_columns: Vec<String>,
    /// The names of the scenarios of a set.
    scenarios: Vec<String>,
    flushed: Instant,
}

impl MetricsWriter {
    /// Opens the files, after cutting them back to the checkpoint: each CSV file to its length there, and the TensorBoard
    /// events to the `env_steps` and the last evaluation there.
    ///
    /// # Errors
    /// A file cannot be opened, or is shorter than its length in the checkpoint.
    pub fn open(
        folder: &RunFolder,
        trainer_state: &TrainerState,
        env_steps: u64,
        config: &RunConfig,
    ) -> Result<Self, RunError> {
        let reward_columns: Vec<String> =
            config.reward_terms.iter().map(|term| format!("reward_{}", column_name(term))).collect();
        let scenarios: Vec<String> = config.member_names().map(String::from).collect();
        let episode_columns = [EpisodeRow::set_columns(&scenarios), reward_columns.clone()].concat();
        let rate_columns = EvaluationRow::set_columns(&scenarios);
        let is_kept = |tag: &str, step: u64| {
            let latest =
                if tag.starts_with(EVALUATION_TAGS) { trainer_state.evaluated_at } else { Some(env_steps) };
            latest.is_some_and(|latest| step <= latest)
        };
        Ok(Self {
            episodes: folder.csv::<EpisodeRow>(
                EPISODES_FILE,
                trainer_state.episodes_bytes,
                &episode_columns,
            )?,
            evaluations: folder.csv::<EvaluationRow>(
                EVALUATIONS_FILE,
                trainer_state.evaluations_bytes,
                &rate_columns,
            )?,
            events: cut_back(folder.path(), is_kept)
                .and_then(|latest_s| EventWriter::create(folder.path(), latest_s))
                .map_err(|error| RunError::InvalidInput(error.to_string()))?,
            folder: folder.clone(),
            reward_columns,
            scenarios,
            flushed: Instant::now(),
        })
    }

    /// Writes the row of an episode.
    ///
    /// # Errors
    /// The row cannot be written.
    pub fn episode(&mut self, row: &EpisodeRow) -> Result<(), RunError> {
        let scenario = row.set_values(&self.scenarios);
        self.episodes
            .serialize((row, scenario, &row.extra_rewards))
            .map_err(|error| self.failed(EPISODES_FILE, error))?;
        if let Some(name) = &row.scenario {
            self.scalars(row.env_steps, &[(&format!("episode/return/{name}"), Some(row.total_return))])?;
        }
        for (column, &reward) in self.reward_columns.iter().zip(&row.extra_rewards) {
            let tag = format!("episode/{column}");
            self.events
                .scalar(&tag, row.env_steps, reward)
                .map_err(|error| self.failed(EVENT_FILES, error))?;
        }
        self.scalars(
            row.env_steps,
            &[
                ("episode/return", Some(row.total_return)),
                ("episode/steps", Some(f64::from(row.steps))),
                ("episode/goals", Some(f64::from(row.goals))),
                ("learning/loss", row.loss),
                ("learning/td_error", row.td_error),
                ("learning/mean_q", row.mean_q),
                ("learning/epsilon", Some(f64::from(row.epsilon))),
            ],
        )
    }

    /// Writes the row of an evaluation. Other programs see it at once.
    ///
    /// # Errors
    /// The row cannot be written.
    pub fn evaluation(&mut self, row: &EvaluationRow) -> Result<(), RunError> {
        let rates = row.set_values(&self.scenarios);
        self.evaluations.serialize((row, &rates)).map_err(|error| self.failed(EVALUATIONS_FILE, error))?;
        for (name, rate) in &row.scenario_success_rates {
            self.scalars(row.env_steps, &[(&format!("{EVALUATION_TAGS}success_rate/{name}"), Some(*rate))])?;
        }
        self.scalars(
            row.env_steps,
            &[
                ("evaluation/success_rate", Some(row.success_rate)),
                ("evaluation/mean_time_s", row.mean_time_s),
                ("evaluation/mean_cost_s", Some(row.mean_cost_s)),
            ],
        )?;
        self.flush()
    }

    /// Calls [`flush`](Self::flush) if the last call was at least a second ago.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn flush_if_due(&mut self) -> Result<(), RunError> {
        if self.flushed.elapsed() < FLUSH_INTERVAL { Ok(()) } else { self.flush() }
    }

    /// Writes all rows to the files, where other programs see them.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn flush(&mut self) -> Result<(), RunError> {
        self.flushed = Instant::now();
        self.episodes.flush().map_err(|error| self.failed(EPISODES_FILE, error))?;
        self.evaluations.flush().map_err(|error| self.failed(EVALUATIONS_FILE, error))?;
        self.events.flush().map_err(|error| self.failed(EVENT_FILES, error))
    }

    /// Like [`flush`](Self::flush), but also makes the rows survive a power cut, because a checkpoint will refer to them.
    /// Returns the lengths of `episodes.csv` and `evaluations.csv`, in bytes.
    ///
    /// # Errors
    /// A file cannot be written.
    pub fn sync(&mut self) -> Result<(u64, u64), RunError> {
        self.flush()?;
        self.events.sync().map_err(|error| self.failed(EVENT_FILES, error))?;
        let length = |writer: &csv::Writer<File>| {
            writer.get_ref().sync_data()?;
            write_point("CSV: flushed");
            Ok(writer.get_ref().metadata()?.len())
        };
        let episodes =
            length(&self.episodes).map_err(|error: std::io::Error| self.failed(EPISODES_FILE, error))?;
        let evaluations = length(&self.evaluations)
            .map_err(|error: std::io::Error| self.failed(EVALUATIONS_FILE, error))?;
        Ok((episodes, evaluations))
    }

    /// The number of evaluations on disk, including those before a resume.
    ///
    /// # Errors
    /// The rows cannot be read.
    pub fn evaluations(&self) -> Result<usize, RunError> {
        Ok(self.folder.rows::<EvaluationRow>(EVALUATIONS_FILE)?.len())
    }

    /// Draws `learning-curve.svg` of the run of `config`, from the rows on disk, including those before a resume.
    ///
    /// # Errors
    /// The rows cannot be read, or the SVG file cannot be written.
    pub fn draw(&self, config: &RunConfig) -> Result<(), RunError> {
        let svg = run_image::figure(&self.folder, config)?;
        self.folder.write("learning-curve.svg", |file| file.write_all(svg.as_bytes()))
    }

    fn scalars(&mut self, env_steps: u64, values: &[(&str, Option<f64>)]) -> Result<(), RunError> {
        for &(tag, value) in values {
            if let Some(value) = value {
                self.events
                    .scalar(tag, env_steps, value as f32)
                    .map_err(|error| self.failed(EVENT_FILES, error))?;
            }
        }
        Ok(())
    }

    fn failed(&self, name: &str, error: impl std::fmt::Display) -> RunError {
        RunError::not_written(&self.folder.path().join(name), error)
    }
}
