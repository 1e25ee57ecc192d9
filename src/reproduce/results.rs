//! The results of a plan: the value of any measure for any arm, condition and seed.
//!
//! In: an executed plan and its folder. Out: [`ArmValues`] and learning curves, from the records of training and the test
//! results.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};
use std::rc::Rc;

use super::arm_run::{ArmRun, PolicyId};
use super::experiment::{Experiment, TestRule};
use super::figure_spec::{Axis, Series};
use super::measure::Measure;
use super::measured_value::{ArmValues, MeasuredValue};
use super::optimal_times::{OptimalTimes, OptimalTimesCache};
use super::plan::{PlannedRun, RunPlan};
use super::policy_test::{self, PolicyTestResult};
use super::records::{Records, Windows};
use super::report_progress::ReportProgress;
use super::selected::SelectedExperiment;
use super::test_point::TestPoint;
use crate::run::evaluate::{period_s, round_to_millionth};
use crate::run::metric_rows::Summary;
use crate::run::preset::Budget;
use crate::run::{RunError, processor};

/// An arm under a condition: the indices of the experiment, the condition and the arm.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ArmIndex {
    /// The index of the experiment.
    pub experiment: usize,
    /// The index of the condition; 0 without conditions.
    pub condition: usize,
    /// The index of the arm.
    pub arm: usize,
}

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
    /// Reads the records and test results of all training runs of `plan`, which was executed in the folder `runs`.
    ///
    /// # Errors
    /// A record cannot be read.
    pub fn read(
        plan: &'a RunPlan,
        selected: &'a [SelectedExperiment],
        runs: &Path,
        optimal_times_cache: OptimalTimesCache,
    ) -> Result<Self, RunError> {
        let records =
            |training: &PlannedRun| Records::read(&training.folder(runs), training.config.preset.arenas);
        let records = plan.training_runs.iter().map(records).collect::<Result<_, _>>()?;
        let tests =
            plan.training_runs.iter().map(|t| policy_test::read_results(&runs.join(&t.name))).collect();
        Ok(Self { plan, selected, runs: runs.into(), optimal_times_cache, records, tests })
    }

    /// The progress of the report.
    pub fn progress(&self) -> &ReportProgress {
        self.optimal_times_cache.progress()
    }

    /// The experiment at `index`.
    pub fn experiment(&self, index: usize) -> &'a Experiment {
        &self.selected[index].source.experiment
    }

    /// The arm called `name` under a condition.
    pub fn arm_by_name(&self, experiment: usize, condition: usize, name: &str) -> ArmIndex {
        // The check of the experiment ensures that the arm exists.
        let arm = self.experiment(experiment).arms.iter().position(|arm| arm.name == name).unwrap_or(0);
        ArmIndex { experiment, condition, arm }
    }

    /// The runs of an arm, by seed.
    pub fn arm_runs(&self, index: ArmIndex) -> impl Iterator<Item = (u64, &'a ArmRun)> + use<'a> {
        let ArmIndex { experiment, condition, arm } = index;
        let keys = (experiment, condition, arm, 0)..=(experiment, condition, arm, u64::MAX);
        self.plan.arm_runs.range(keys).map(|(key, arm_run)| (key.3, arm_run))
    }

    /// The run of an arm with its first seed.
    ///
    /// # Errors
    /// The arm has no run.
    pub fn first_run(&self, index: ArmIndex) -> Result<&'a ArmRun, RunError> {
        let first = self.arm_runs(index).next().map(|(_, arm_run)| arm_run);
        first.ok_or_else(|| RunError::Failed("an arm has no run".into()))
    }

    /// The policy of an arm's run at a point, and the index of its training run.
    ///
    /// # Errors
    /// The run is too short, which does not occur in a plan.
    pub fn policy(
        &self,
        index: ArmIndex,
        run: &ArmRun,
        point: TestPoint,
    ) -> Result<(usize, PolicyId), RunError> {
        let tested = self.experiment(index.experiment).arms[index.arm].policy;
        run.policy(&self.plan.training_runs, tested, point)
            .ok_or_else(|| RunError::Failed(format!("a run has no policy after {}", point.words())))
    }

    /// The values of `measure` for an arm at a point, one for each seed.
    ///
    /// # Errors
    /// A test result is missing, or the optimal times cannot be computed.
    pub fn values(
        &self,
        index: ArmIndex,
        measure: Measure,
        point: TestPoint,
        windows: Windows,
    ) -> Result<ArmValues, RunError> {
        let rule = self.experiment(index.experiment).test;
        let mut values = ArmValues::default();
        for (seed, run) in self.arm_runs(index) {
            let (training, policy) = self.policy(index, run, point)?;
            let end =
                run.stages.iter().find(|stage| stage.0 == training).map(|stage| self.end(training, stage.1));
            values.seeds.push(seed);
            values.values.push(self.value(
                training,
                policy,
                end.unwrap_or(policy),
                rule,
                measure,
                windows,
            )?);
        }
        Ok(values)
    }

    /// The value of `measure` for a policy of a training run. `end` is the last policy of its stage.
    fn value(
        &self,
        training: usize,
        policy: PolicyId,
        end: PolicyId,
        rule: TestRule,
        measure: Measure,
        windows: Windows,
    ) -> Result<MeasuredValue, RunError> {
        let records = &self.records[training];
        Ok(match measure {
            Measure::SuccessRate => records.success_rate(policy, end),
            Measure::Return => records.last_return(policy, windows.last),
            Measure::Goals => records.last_goals(policy, windows.last),
            Measure::EpisodesTo(goals) => records.episodes_to(goals, policy, windows.moving),
            Measure::StepsTo(goals) => records.steps_to(goals, policy, windows.moving),
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
        let task = &self.plan.training_runs[training].config.scenario.task;
        let sum: u64 = steps.iter().map(|steps| u64::from(steps.unwrap_or(task.max_episode_steps))).sum();
        round_to_millionth(sum as f64 / steps.len() as f64 * period_s(task.control_period_s))
    }

    /// The total time of the successful episodes divided by that of the planner, or by the lower bounds, for the same episodes.
    /// Episodes without a plan are left out. NaN if no episode remains.
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

    /// The success rate in each round of the test, in percent, of an arm's run at a point.
    ///
    /// # Errors
    /// The test result is missing.
    pub fn rounds(&self, index: ArmIndex, run: &ArmRun, point: TestPoint) -> Result<Vec<f64>, RunError> {
        let (training, policy) = self.policy(index, run, point)?;
        let result = self.test(training, policy, self.experiment(index.experiment).test)?;
        Ok(result.rounds().into_iter().map(|rate| 100.0 * rate).collect())
    }

    /// The optimal times of a test in the scenario of a training run.
    ///
    /// # Errors
    /// The policy that provides the test's starts and goals cannot be read, or the times cannot be stored.
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

    /// The path of a policy's file.
    pub fn policy_file(&self, training: usize, policy: PolicyId) -> PathBuf {
        self.plan.training_runs[training].folder(&self.runs).join(policy_test::policy_file(policy))
    }

    /// The training run at `index`.
    pub fn training(&self, index: usize) -> &'a PlannedRun {
        &self.plan.training_runs[index]
    }

    /// The records of the training run at `index`.
    pub fn records(&self, index: usize) -> &Records {
        &self.records[index]
    }

    /// A series over all stages of an arm, one curve for each seed, as points (x in units of `axis`, value).
    pub fn curves(&self, index: ArmIndex, series: Series, axis: Axis) -> Vec<Vec<(f64, f64)>> {
        let curve = |run: &ArmRun| {
            let mut curve = Vec::new();
            let mut before = 0.0;
            for &(training, length) in &run.stages {
                let (records, end) = (&self.records[training], self.end(training, length));
                curve.extend(records.curve(series, end, axis).into_iter().map(|(x, y)| (before + x, y)));
                before += records.length(end, axis);
            }
            curve
        };
        self.arm_runs(index).map(|(_, run)| curve(run)).collect()
    }

    /// The policy at the end of a stage.
    pub fn end(&self, training: usize, length: Budget) -> PolicyId {
        if self.plan.training_runs[training].elsewhere.is_some() {
            PolicyId::Last
        } else {
            PolicyId::After(length)
        }
    }

    /// The wall time of all training runs together, in minutes.
    pub fn total_wall_minutes(&self) -> f64 {
        let wall_s =
            |training: &PlannedRun| Summary::read(&training.folder(&self.runs)).map(|summary| summary.wall_s);
        self.plan.training_runs.iter().filter_map(wall_s).sum::<f64>() / 60.0
    }

    /// The number of training runs on each kind of processor.
    pub fn processors(&self) -> BTreeMap<String, usize> {
        let mut counts = BTreeMap::new();
        for training in &self.plan.training_runs {
            let kinds = processor::read(&training.folder(&self.runs));
            let kinds = if kinds.is_empty() { "an unknown processor".into() } else { kinds.join(", then ") };
            *counts.entry(kinds).or_default() += 1;
        }
        counts
    }

    /// The env steps of all training runs together.
    pub fn total_env_steps(&self) -> u64 {
        self.records.iter().map(Records::total_env_steps).sum()
    }

    /// The episodes of all training runs together.
    pub fn total_episodes(&self) -> usize {
        self.records.iter().map(|records| records.episodes(PolicyId::Last)).sum()
    }
}
