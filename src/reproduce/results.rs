//! The results of a plan: the value of any measure for any arm, condition and seed.
//!
//! In: an executed plan and its folder. Out: [`MeasuredValue`]s and learning curves, from the records of training and
//! the test results.

use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::experiment::{Experiment, TestRule, TestedPolicy};
use super::figure_spec::EpisodeSeries;
use super::measure::Measure;
use super::measured_value::MeasuredValue;
use super::optimal_times::{OptimalTimes, OptimalTimesCache};
use super::plan::{ArmRun, PolicyId, RunPlan, Training};
use super::policy_test::{self, PolicyTestResult};
use super::records::Records;
use super::selected::SelectedExperiment;
use crate::run::RunError;
use crate::run::evaluate::{period_s, round_to_microsecond};
use crate::run::metric_rows::Summary;

/// All results of a plan.
pub struct Results<'a> {
    plan: &'a RunPlan,
    selected: &'a [SelectedExperiment],
    runs: PathBuf,
    optimal_times_cache: OptimalTimesCache,
    records: Vec<Records>,
    tests: Vec<Vec<PolicyTestResult>>,
}

impl<'a> Results<'a> {
    /// Reads the records and test results of all trainings of `plan`, which was executed in the folder `runs`.
    ///
    /// # Errors
    /// A record cannot be read.
    pub fn read(
        plan: &'a RunPlan,
        selected: &'a [SelectedExperiment],
        runs: &Path,
        optimal_times_cache: OptimalTimesCache,
    ) -> Result<Self, RunError> {
        let folder = |training: &Training| runs.join(&training.name);
        let records = |training| Records::read(&folder(training).join("episodes.csv"));
        let records = plan.trainings.iter().map(records).collect::<Result<_, _>>()?;
        let tests = plan.trainings.iter().map(|t| policy_test::read_results(&folder(t))).collect();
        Ok(Self { plan, selected, runs: runs.into(), optimal_times_cache, records, tests })
    }

    /// The experiment at `index`.
    pub fn experiment(&self, index: usize) -> &'a Experiment {
        &self.selected[index].source.experiment
    }

    /// The trainings of an arm (by index) under a condition with a seed.
    pub fn arm_run(&self, experiment: usize, condition: usize, arm: usize, seed: u64) -> &'a ArmRun {
        &self.plan.arm_runs[&(experiment, condition, arm, seed)]
    }

    /// [`values`](Self::values) of the arm called `name`. `after` counts the episodes of all stages or, with
    /// `of_last_stage`, those of the last stage.
    ///
    /// # Errors
    /// As [`values`](Self::values).
    pub fn values_by_arm_name(
        &self,
        experiment: usize,
        condition: usize,
        name: &str,
        measure: Measure,
        (after, of_last_stage): (u64, bool),
    ) -> Result<Vec<MeasuredValue>, RunError> {
        // The check of the experiment ensures that the arm exists.
        let arm = self.experiment(experiment).arms.iter().position(|arm| arm.name == name).unwrap_or(0);
        let before = if of_last_stage {
            self.arm_run(experiment, condition, arm, 1).episodes_before_last_stage()
        } else {
            0
        };
        self.values(experiment, condition, arm, measure, before + after)
    }

    /// The values of `measure` for an arm (by index) after a number of episodes, one for each seed.
    ///
    /// # Errors
    /// A test result is missing, or the optimal times cannot be computed.
    pub fn values(
        &self,
        experiment: usize,
        condition: usize,
        arm: usize,
        measure: Measure,
        after: u64,
    ) -> Result<Vec<MeasuredValue>, RunError> {
        let rule = self.experiment(experiment).test;
        let value = |seed| {
            let (training, policy) = self.policy(experiment, condition, arm, seed, after);
            self.value(training, policy, rule, measure)
        };
        (1..=self.experiment(experiment).seeds).map(value).collect()
    }

    fn value(
        &self,
        training: usize,
        policy: PolicyId,
        rule: TestRule,
        measure: Measure,
    ) -> Result<MeasuredValue, RunError> {
        let records = &self.records[training];
        Ok(match measure {
            Measure::Return => records.final_mean(EpisodeSeries::Return, policy),
            Measure::Goals => records.final_mean(EpisodeSeries::Goals, policy),
            Measure::EpisodesTo(goals) => {
                let (episode, is_lower_bound) = records.episode_with_goals(goals, policy);
                MeasuredValue { value: (episode + 1) as f64, is_lower_bound }
            }
            Measure::StepsTo(goals) => {
                let (episode, is_lower_bound) = records.episode_with_goals(goals, policy);
                let value = records.env_steps.get(episode).map_or(0.0, |&steps| steps as f64 / 1e3);
                MeasuredValue { value, is_lower_bound }
            }
            Measure::Success => {
                MeasuredValue::exact(100.0 * self.test(training, policy, rule)?.success_rate())
            }
            Measure::MeanTime => {
                let steps = &self.test(training, policy, rule)?.steps;
                MeasuredValue::exact(self.mean_time_s(training, steps))
            }
            Measure::BenchmarkRouteTime => {
                let steps = &self.test(training, policy, rule)?.benchmark_route_steps;
                let is_lower_bound = steps.iter().all(Option::is_none);
                MeasuredValue { value: self.mean_time_s(training, steps), is_lower_bound }
            }
            Measure::TimeRatio => MeasuredValue::exact(self.time_ratio(training, policy, rule, false)?),
            Measure::BoundRatio => MeasuredValue::exact(self.time_ratio(training, policy, rule, true)?),
        })
    }

    /// The mean time in s; a failure counts as the time limit.
    fn mean_time_s(&self, training: usize, steps: &[Option<u32>]) -> f64 {
        let task = &self.plan.trainings[training].config.scenario.task;
        let sum: u64 = steps.iter().map(|steps| u64::from(steps.unwrap_or(task.max_episode_steps))).sum();
        round_to_microsecond(sum as f64 / steps.len() as f64 * period_s(task.control_period_s))
    }

    /// The time of the successful episodes over the planner's time, or over the lower bounds, for the same episodes.
    fn time_ratio(
        &self,
        training: usize,
        policy: PolicyId,
        rule: TestRule,
        to_lower_bound: bool,
    ) -> Result<f64, RunError> {
        let steps = &self.test(training, policy, rule)?.steps;
        let optimal = self.optimal_times(training, policy, rule)?;
        let pairs = steps.iter().zip(&optimal.episodes).filter_map(|(steps, bounds)| {
            let plan_steps = bounds.plan_steps?;
            let reference = if to_lower_bound { bounds.lower_steps } else { plan_steps };
            Some((u64::from((*steps)?), u64::from(reference)))
        });
        let (steps, reference) = pairs.fold((0, 0), |sum, pair| (sum.0 + pair.0, sum.1 + pair.1));
        Ok(if reference == 0 { f64::NAN } else { steps as f64 / reference as f64 })
    }

    /// The success rate of each round, in percent, of an arm (by index) with a seed after a number of episodes.
    ///
    /// # Errors
    /// The test result is missing.
    pub fn rounds(
        &self,
        experiment: usize,
        condition: usize,
        arm: usize,
        seed: u64,
        after: u64,
    ) -> Result<Vec<f64>, RunError> {
        let (training, policy) = self.policy(experiment, condition, arm, seed, after);
        let result = self.test(training, policy, self.experiment(experiment).test)?;
        Ok(result.rounds().into_iter().map(|rate| 100.0 * rate).collect())
    }

    /// The optimal times of a test in a training's scenario.
    ///
    /// # Errors
    /// The policy that provides the test's starts and goals cannot be read.
    pub fn optimal_times(
        &self,
        training: usize,
        policy: PolicyId,
        rule: TestRule,
    ) -> Result<Rc<OptimalTimes>, RunError> {
        let policy = self.policy_file(training, policy);
        self.optimal_times_cache.for_test(&self.training(training).config.scenario, rule, &policy)
    }

    fn test(&self, training: usize, policy: PolicyId, rule: TestRule) -> Result<&PolicyTestResult, RunError> {
        policy_test::find(&self.tests[training], policy, rule)
            .ok_or_else(|| RunError::failed(&self.policy_file(training, policy), "has no test result"))
    }

    /// The training and the policy of an arm after a number of episodes.
    pub fn policy(
        &self,
        experiment: usize,
        condition: usize,
        arm: usize,
        seed: u64,
        after: u64,
    ) -> (usize, PolicyId) {
        let arm_run = self.arm_run(experiment, condition, arm, seed);
        let last = arm_run.stages.len() - 1;
        match self.experiment(experiment).arms[arm].policy {
            TestedPolicy::Best => (arm_run.stages[last].0, PolicyId::Best),
            TestedPolicy::AtEpisode => {
                let (stage, episodes) = arm_run.stage_at(after).unwrap_or((last, after));
                (arm_run.stages[stage].0, PolicyId::AfterEpisodes(episodes))
            }
        }
    }

    /// The path of a policy's file.
    pub fn policy_file(&self, training: usize, policy: PolicyId) -> PathBuf {
        self.runs.join(&self.plan.trainings[training].name).join(policy_test::policy_file(policy))
    }

    /// The training at `index`.
    pub fn training(&self, index: usize) -> &'a Training {
        &self.plan.trainings[index]
    }

    /// A series over the episodes of all stages of an arm, one curve for each seed.
    pub fn curves(
        &self,
        experiment: usize,
        condition: usize,
        arm: usize,
        series: EpisodeSeries,
    ) -> Vec<Vec<f64>> {
        let curve = |seed| {
            let arm_run = self.arm_run(experiment, condition, arm, seed);
            let stages = arm_run.stages.iter().flat_map(|&(training, length)| {
                let end = length.map_or(PolicyId::Best, PolicyId::AfterEpisodes);
                self.records[training].until(series, end).iter().copied()
            });
            stages.collect()
        };
        (1..=self.experiment(experiment).seeds).map(curve).collect()
    }

    /// The sum of all trainings' wall times, in minutes.
    pub fn total_wall_minutes(&self) -> f64 {
        let wall_s = |training: &Training| {
            Summary::read(&self.runs.join(&training.name)).map(|summary| summary.wall_s)
        };
        self.plan.trainings.iter().filter_map(wall_s).sum::<f64>() / 60.0
    }

    /// The sum of all trainings' environment steps.
    pub fn total_env_steps(&self) -> u64 {
        self.records.iter().filter_map(|records| records.env_steps.last()).sum()
    }
}
