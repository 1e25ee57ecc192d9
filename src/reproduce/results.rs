//! What came of it: the number of any measure for any arm, condition and seed.
//!
//! In: a plan that was carried out, and its folder. Out: [`Value`]s and learning curves, read from the records of
//! training and the trials.

use std::path::{Path, PathBuf};

use super::experiment::{Experiment, Series, TestRule, Tested};
use super::measure::Measure;
use super::plan::{Chain, Plan, Selected, Training, Which};
use super::trial::{self, Trial};
use super::yardstick::Yardstick;
use crate::report::statistics::moving_mean;
use crate::run::RunError;
use crate::run::evaluate::{period_s, to_microsecond};
use crate::run::records::{EpisodeRow, Summary};

/// Episodes in the means that tell how far training is.
const WINDOW: usize = 100;
/// Episodes in the moving mean that tells when a level is reached.
const LEVEL_WINDOW: usize = 50;

/// A number measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Value {
    /// The number, in the measure's unit.
    pub value: f64,
    /// The run ended before the level was reached, or every drive failed: the true number is more than this.
    pub at_least: bool,
}

impl Value {
    fn exact(value: f64) -> Self {
        Self { value, at_least: false }
    }
}

/// Episodes of a training, as far as they are needed.
#[derive(Debug)]
struct Records {
    env_steps: Vec<u64>,
    returns: Vec<f64>,
    targets: Vec<f64>,
}

impl Records {
    /// A series up to where the policy `which` was taken; of the best policy all of it.
    fn until(&self, series: Series, which: Which) -> &[f64] {
        let all = match series {
            Series::Return => &self.returns,
            Series::Targets => &self.targets,
        };
        match which {
            Which::After(episodes) => &all[..(episodes as usize).min(all.len())],
            Which::Best => all,
        }
    }
}

/// All that came of a plan.
pub struct Results<'a> {
    plan: &'a Plan,
    selected: &'a [Selected],
    runs: PathBuf,
    yardsticks: Yardstick,
    records: Vec<Records>,
    trials: Vec<Vec<Trial>>,
}

impl<'a> Results<'a> {
    /// Reads the records and trials of every training of `plan`, which was carried out in `runs`.
    ///
    /// # Errors
    /// A record cannot be read.
    pub fn read(
        plan: &'a Plan,
        selected: &'a [Selected],
        runs: &Path,
        yardsticks: Yardstick,
    ) -> Result<Self, RunError> {
        let read = |training: &Training| records(&runs.join(&training.name).join("episodes.csv"));
        let records = plan.trainings.iter().map(read).collect::<Result<_, _>>()?;
        let trials = plan.trainings.iter().map(|training| trial::noted(&runs.join(&training.name))).collect();
        Ok(Self { plan, selected, runs: runs.into(), yardsticks, records, trials })
    }

    /// Experiment `index`.
    #[must_use]
    pub fn experiment(&self, index: usize) -> &'a Experiment {
        &self.selected[index].source.experiment
    }

    /// The trainings of an arm (by index) under a condition with a seed.
    #[must_use]
    pub fn chain(&self, experiment: usize, condition: usize, arm: usize, seed: u64) -> &'a Chain {
        &self.plan.chains[&(experiment, condition, arm, seed)]
    }

    /// [`values`](Self::values) of the arm called `name`; `after` counts over all its stages, or, `of_last_stage`, in
    /// the last alone.
    ///
    /// # Errors
    /// As those of [`values`](Self::values).
    pub fn values_of(
        &self,
        experiment: usize,
        condition: usize,
        name: &str,
        measure: Measure,
        (after, of_last_stage): (u64, bool),
    ) -> Result<Vec<Value>, RunError> {
        // That there is an arm of that name was checked when the experiment was read.
        let arm = self.experiment(experiment).arms.iter().position(|arm| arm.name == name).unwrap_or(0);
        let before = if of_last_stage { self.chain(experiment, condition, arm, 1).before_last() } else { 0 };
        self.values(experiment, condition, arm, measure, before + after)
    }

    /// What `measure` says of an arm (by index) after so many episodes, a value for each seed.
    ///
    /// # Errors
    /// A trial is missing; the planner's world cannot be made.
    pub fn values(
        &self,
        experiment: usize,
        condition: usize,
        arm: usize,
        measure: Measure,
        after: u64,
    ) -> Result<Vec<Value>, RunError> {
        let seeds = 1..=self.experiment(experiment).seeds;
        seeds.map(|seed| self.value(experiment, condition, arm, seed, measure, after)).collect()
    }

    fn value(
        &self,
        experiment: usize,
        condition: usize,
        arm: usize,
        seed: u64,
        measure: Measure,
        after: u64,
    ) -> Result<Value, RunError> {
        let (training, which) = self.policy(experiment, condition, arm, seed, after);
        Ok(match measure {
            Measure::Success
            | Measure::CourseTime
            | Measure::MeanTime
            | Measure::TimeRatio
            | Measure::BoundRatio => {
                self.tested(training, which, self.experiment(experiment).test, measure)?
            }
            Measure::Return | Measure::Targets => {
                let series = if measure == Measure::Return { Series::Return } else { Series::Targets };
                let all = self.records[training].until(series, which);
                let last = &all[all.len().saturating_sub(WINDOW)..];
                Value::exact(last.iter().sum::<f64>() / last.len().max(1) as f64)
            }
            Measure::EpisodesTo(level) | Measure::StepsTo(level) => {
                let records = &self.records[training];
                let targets = records.until(Series::Targets, which);
                let window = LEVEL_WINDOW.min(targets.len());
                let reached = moving_mean(targets, window)
                    .iter()
                    .enumerate()
                    .position(|(i, &mean)| i + 1 >= window && mean >= level);
                let episode = reached.unwrap_or(targets.len().saturating_sub(1));
                let value = match measure {
                    Measure::StepsTo(_) => records.env_steps.get(episode).map_or(0.0, |&n| n as f64 / 1e3),
                    _ => (episode + 1) as f64,
                };
                Value { value, at_least: reached.is_none() }
            }
        })
    }

    /// Success round by round, in percent, of an arm (by index) with a seed after so many episodes.
    ///
    /// # Errors
    /// The trial is missing.
    pub fn rounds(
        &self,
        experiment: usize,
        condition: usize,
        arm: usize,
        seed: u64,
        after: u64,
    ) -> Result<Vec<f64>, RunError> {
        let (training, which) = self.policy(experiment, condition, arm, seed, after);
        let trial = self.trial(training, which, self.experiment(experiment).test)?;
        Ok(trial.rounds().into_iter().map(|rate| 100.0 * rate).collect())
    }

    /// A measure that is taken from a trial.
    fn tested(
        &self,
        training: usize,
        which: Which,
        rule: TestRule,
        measure: Measure,
    ) -> Result<Value, RunError> {
        let trial = self.trial(training, which, rule)?;
        let task = &self.plan.trainings[training].config.scenario.task;
        let (period_s, limit) = (period_s(task.control_period_s), task.time_limit_steps);
        let mean_s = |steps: &[Option<u32>]| {
            let sum: u64 = steps.iter().map(|steps| u64::from(steps.unwrap_or(limit))).sum();
            to_microsecond(sum as f64 / steps.len() as f64 * period_s)
        };
        Ok(match measure {
            Measure::CourseTime => Value {
                value: mean_s(&trial.course_steps),
                at_least: trial.course_steps.iter().all(Option::is_none),
            },
            Measure::MeanTime => Value::exact(mean_s(&trial.steps)),
            Measure::TimeRatio | Measure::BoundRatio => {
                let measured = self.yardstick(training, which, rule)?;
                let pairs = trial.steps.iter().zip(&measured.navigations);
                let both = pairs.filter_map(|(driven, least)| {
                    let plan_steps = least.plan_steps?;
                    let to = if measure == Measure::TimeRatio { plan_steps } else { least.lower_steps };
                    Some(((*driven)?, to))
                });
                let (driven, least) = both.fold((0_u64, 0_u64), |(driven, least), (d, l)| {
                    (driven + u64::from(d), least + u64::from(l))
                });
                Value::exact(if least == 0 { f64::NAN } else { driven as f64 / least as f64 })
            }
            _ => Value::exact(100.0 * trial.success_rate()),
        })
    }

    /// The least times of the world that a training's policies are tested in.
    ///
    /// # Errors
    /// The policy that shows the test's starts and targets cannot be read.
    pub fn yardstick(
        &self,
        training: usize,
        which: Which,
        rule: TestRule,
    ) -> Result<std::rc::Rc<super::yardstick::Least>, RunError> {
        let policy = self.policy_file(training, which);
        self.yardsticks.of(&self.training(training).config.scenario, rule, &policy)
    }

    fn trial(&self, training: usize, which: Which, rule: TestRule) -> Result<&Trial, RunError> {
        trial::find(&self.trials[training], which, rule).ok_or_else(|| {
            RunError::failed(&self.policy_file(training, which), "holds a policy that was not tested")
        })
    }

    /// The training in which an arm's policy is found after so many episodes, and which of its policies that is.
    #[must_use]
    pub fn policy(
        &self,
        experiment: usize,
        condition: usize,
        arm: usize,
        seed: u64,
        after: u64,
    ) -> (usize, Which) {
        let chain = self.chain(experiment, condition, arm, seed);
        let last = chain.stages.len() - 1;
        match self.experiment(experiment).arms[arm].policy {
            Tested::Best => (chain.stages[last].0, Which::Best),
            Tested::AsItStands => {
                let (stage, episodes) = chain.at(after).unwrap_or((last, after));
                (chain.stages[stage].0, Which::After(episodes))
            }
        }
    }

    /// Where a policy's file is.
    #[must_use]
    pub fn policy_file(&self, training: usize, which: Which) -> PathBuf {
        self.runs.join(&self.plan.trainings[training].name).join(trial::file(which))
    }

    /// The training at `index`.
    #[must_use]
    pub fn training(&self, index: usize) -> &'a Training {
        &self.plan.trainings[index]
    }

    /// A series over the episodes of all stages of an arm, one curve for each seed.
    #[must_use]
    pub fn curves(&self, experiment: usize, condition: usize, arm: usize, series: Series) -> Vec<Vec<f64>> {
        let seeds = 1..=self.experiment(experiment).seeds;
        seeds
            .map(|seed| {
                let chain = self.chain(experiment, condition, arm, seed);
                let stages = chain.stages.iter().flat_map(|&(training, length)| {
                    let whole = length.map_or(Which::Best, Which::After);
                    self.records[training].until(series, whole).iter().copied()
                });
                stages.collect()
            })
            .collect()
    }

    /// Wall time of all trainings together, in minutes.
    #[must_use]
    pub fn minutes(&self) -> f64 {
        let wall_s = |training: &Training| {
            Summary::read(&self.runs.join(&training.name)).map(|summary| summary.wall_s)
        };
        self.plan.trainings.iter().filter_map(wall_s).sum::<f64>() / 60.0
    }

    /// Env steps of all trainings together.
    #[must_use]
    pub fn env_steps(&self) -> u64 {
        self.records.iter().filter_map(|records| records.env_steps.last()).sum()
    }
}

fn records(path: &Path) -> Result<Records, RunError> {
    let mut reader = csv::Reader::from_path(path).map_err(|error| RunError::failed(path, error))?;
    let mut records = Records { env_steps: Vec::new(), returns: Vec::new(), targets: Vec::new() };
    for row in reader.deserialize::<EpisodeRow>() {
        let row = row.map_err(|error| RunError::failed(path, error))?;
        records.env_steps.push(row.env_steps);
        records.returns.push(row.total_return);
        records.targets.push(f64::from(row.targets));
    }
    Ok(records)
}
