//! What came of it: the number of any measure for any arm, condition and seed.
//!
//! In: a plan that was carried out, and its folder. Out: [`MeasuredValue`]s and learning curves, read from the records of
//! training and the trials.

use std::path::{Path, PathBuf};

use super::experiment::{EpisodeSeries, Experiment, TestRule, TestedPolicy};
use super::measure::Measure;
use super::optimal_times::OptimalTimesCache;
use super::plan::{ArmRun, PolicyId, RunPlan, SelectedExperiment, Training};
use super::policy_test::{self, PolicyTestResult};
use crate::report::smoothing::moving_mean;
use crate::run::RunError;
use crate::run::evaluate::{period_s, round_to_microsecond};
use crate::run::metric_rows::{EpisodeRow, Summary};

/// Episodes in the means that tell how far training is.
const WINDOW: usize = 100;
/// Episodes in the moving mean that tells when a level is reached.
const LEVEL_WINDOW: usize = 50;

/// A number measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MeasuredValue {
    /// The number, in the measure's unit.
    pub value: f64,
    /// The run ended before the level was reached, or every drive failed: the true number is more than this.
    pub is_lower_bound: bool,
}

impl MeasuredValue {
    fn exact(value: f64) -> Self {
        Self { value, is_lower_bound: false }
    }
}

/// Episodes of a training, as far as they are needed.
#[derive(Debug)]
struct Records {
    env_steps: Vec<u64>,
    returns: Vec<f64>,
    goals: Vec<f64>,
}

impl Records {
    /// A series up to where the policy `which` was taken; of the best policy all of it.
    fn until(&self, series: EpisodeSeries, which: PolicyId) -> &[f64] {
        let all = match series {
            EpisodeSeries::Return => &self.returns,
            EpisodeSeries::Goals => &self.goals,
        };
        match which {
            PolicyId::AfterEpisodes(episodes) => &all[..(episodes as usize).min(all.len())],
            PolicyId::Best => all,
        }
    }
}

/// All that came of a plan.
pub struct Results<'a> {
    plan: &'a RunPlan,
    selected: &'a [SelectedExperiment],
    runs: PathBuf,
    optimal_times_cache: OptimalTimesCache,
    records: Vec<Records>,
    trials: Vec<Vec<PolicyTestResult>>,
}

impl<'a> Results<'a> {
    /// Reads the records and trials of every training of `plan`, which was carried out in `runs`.
    ///
    /// # Errors
    /// A record cannot be read.
    pub fn read(
        plan: &'a RunPlan,
        selected: &'a [SelectedExperiment],
        runs: &Path,
        optimal_times_cache: OptimalTimesCache,
    ) -> Result<Self, RunError> {
        let read = |training: &Training| records(&runs.join(&training.name).join("episodes.csv"));
        let records = plan.trainings.iter().map(read).collect::<Result<_, _>>()?;
        let trials = plan
            .trainings
            .iter()
            .map(|training| policy_test::read_results(&runs.join(&training.name)))
            .collect();
        Ok(Self { plan, selected, runs: runs.into(), optimal_times_cache, records, trials })
    }

    /// Experiment `index`.
    #[must_use]
    pub fn experiment(&self, index: usize) -> &'a Experiment {
        &self.selected[index].source.experiment
    }

    /// The trainings of an arm (by index) under a condition with a seed.
    #[must_use]
    pub fn arm_run(&self, experiment: usize, condition: usize, arm: usize, seed: u64) -> &'a ArmRun {
        &self.plan.arm_runs[&(experiment, condition, arm, seed)]
    }

    /// [`values`](Self::values) of the arm called `name`; `after` counts over all its stages, or, `of_last_stage`, in
    /// the last alone.
    ///
    /// # Errors
    /// As those of [`values`](Self::values).
    pub fn values_by_arm_name(
        &self,
        experiment: usize,
        condition: usize,
        name: &str,
        measure: Measure,
        (after, of_last_stage): (u64, bool),
    ) -> Result<Vec<MeasuredValue>, RunError> {
        // That there is an arm of that name was checked when the experiment was read.
        let arm = self.experiment(experiment).arms.iter().position(|arm| arm.name == name).unwrap_or(0);
        let before = if of_last_stage {
            self.arm_run(experiment, condition, arm, 1).episodes_before_last_stage()
        } else {
            0
        };
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
    ) -> Result<Vec<MeasuredValue>, RunError> {
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
    ) -> Result<MeasuredValue, RunError> {
        let (training, which) = self.policy(experiment, condition, arm, seed, after);
        Ok(match measure {
            Measure::Success
            | Measure::BenchmarkRouteTime
            | Measure::MeanTime
            | Measure::TimeRatio
            | Measure::BoundRatio => {
                self.tested(training, which, self.experiment(experiment).test, measure)?
            }
            Measure::Return | Measure::Goals => {
                let series =
                    if measure == Measure::Return { EpisodeSeries::Return } else { EpisodeSeries::Goals };
                let all = self.records[training].until(series, which);
                let last = &all[all.len().saturating_sub(WINDOW)..];
                MeasuredValue::exact(last.iter().sum::<f64>() / last.len().max(1) as f64)
            }
            Measure::EpisodesTo(level) | Measure::StepsTo(level) => {
                let records = &self.records[training];
                let goals = records.until(EpisodeSeries::Goals, which);
                let window = LEVEL_WINDOW.min(goals.len());
                let reached = moving_mean(goals, window)
                    .iter()
                    .enumerate()
                    .position(|(i, &mean)| i + 1 >= window && mean >= level);
                let episode = reached.unwrap_or(goals.len().saturating_sub(1));
                let value = match measure {
                    Measure::StepsTo(_) => records.env_steps.get(episode).map_or(0.0, |&n| n as f64 / 1e3),
                    _ => (episode + 1) as f64,
                };
                MeasuredValue { value, is_lower_bound: reached.is_none() }
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
        which: PolicyId,
        rule: TestRule,
        measure: Measure,
    ) -> Result<MeasuredValue, RunError> {
        let trial = self.trial(training, which, rule)?;
        let task = &self.plan.trainings[training].config.scenario.task;
        let (period_s, limit) = (period_s(task.control_period_s), task.max_episode_steps);
        let mean_s = |steps: &[Option<u32>]| {
            let sum: u64 = steps.iter().map(|steps| u64::from(steps.unwrap_or(limit))).sum();
            round_to_microsecond(sum as f64 / steps.len() as f64 * period_s)
        };
        Ok(match measure {
            Measure::BenchmarkRouteTime => MeasuredValue {
                value: mean_s(&trial.benchmark_route_steps),
                is_lower_bound: trial.benchmark_route_steps.iter().all(Option::is_none),
            },
            Measure::MeanTime => MeasuredValue::exact(mean_s(&trial.steps)),
            Measure::TimeRatio | Measure::BoundRatio => {
                let measured = self.optimal_times(training, which, rule)?;
                let pairs = trial.steps.iter().zip(&measured.episodes);
                let both = pairs.filter_map(|(driven, least)| {
                    let plan_steps = least.plan_steps?;
                    let to = if measure == Measure::TimeRatio { plan_steps } else { least.lower_steps };
                    Some(((*driven)?, to))
                });
                let (driven, least) = both.fold((0_u64, 0_u64), |(driven, least), (d, l)| {
                    (driven + u64::from(d), least + u64::from(l))
                });
                MeasuredValue::exact(if least == 0 { f64::NAN } else { driven as f64 / least as f64 })
            }
            _ => MeasuredValue::exact(100.0 * trial.success_rate()),
        })
    }

    /// The least times of the world that a training's policies are tested in.
    ///
    /// # Errors
    /// The policy that shows the test's starts and goals cannot be read.
    pub fn optimal_times(
        &self,
        training: usize,
        which: PolicyId,
        rule: TestRule,
    ) -> Result<std::rc::Rc<super::optimal_times::OptimalTimes>, RunError> {
        let policy = self.policy_file(training, which);
        self.optimal_times_cache.for_test(&self.training(training).config.scenario, rule, &policy)
    }

    fn trial(&self, training: usize, which: PolicyId, rule: TestRule) -> Result<&PolicyTestResult, RunError> {
        policy_test::find(&self.trials[training], which, rule).ok_or_else(|| {
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
    ) -> (usize, PolicyId) {
        let chain = self.arm_run(experiment, condition, arm, seed);
        let last = chain.stages.len() - 1;
        match self.experiment(experiment).arms[arm].policy {
            TestedPolicy::Best => (chain.stages[last].0, PolicyId::Best),
            TestedPolicy::AtEpisode => {
                let (stage, episodes) = chain.stage_at(after).unwrap_or((last, after));
                (chain.stages[stage].0, PolicyId::AfterEpisodes(episodes))
            }
        }
    }

    /// Where a policy's file is.
    #[must_use]
    pub fn policy_file(&self, training: usize, which: PolicyId) -> PathBuf {
        self.runs.join(&self.plan.trainings[training].name).join(policy_test::policy_file(which))
    }

    /// The training at `index`.
    #[must_use]
    pub fn training(&self, index: usize) -> &'a Training {
        &self.plan.trainings[index]
    }

    /// A series over the episodes of all stages of an arm, one curve for each seed.
    #[must_use]
    pub fn curves(
        &self,
        experiment: usize,
        condition: usize,
        arm: usize,
        series: EpisodeSeries,
    ) -> Vec<Vec<f64>> {
        let seeds = 1..=self.experiment(experiment).seeds;
        seeds
            .map(|seed| {
                let chain = self.arm_run(experiment, condition, arm, seed);
                let stages = chain.stages.iter().flat_map(|&(training, length)| {
                    let whole = length.map_or(PolicyId::Best, PolicyId::AfterEpisodes);
                    self.records[training].until(series, whole).iter().copied()
                });
                stages.collect()
            })
            .collect()
    }

    /// Wall time of all trainings together, in minutes.
    #[must_use]
    pub fn total_wall_minutes(&self) -> f64 {
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
    let mut records = Records { env_steps: Vec::new(), returns: Vec::new(), goals: Vec::new() };
    for row in reader.deserialize::<EpisodeRow>() {
        let row = row.map_err(|error| RunError::failed(path, error))?;
        records.env_steps.push(row.env_steps);
        records.returns.push(row.total_return);
        records.goals.push(f64::from(row.goals));
    }
    Ok(records)
}
