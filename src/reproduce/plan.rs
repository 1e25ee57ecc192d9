//! The plan: the training runs that the selected figures and tables need, each once.
//!
//! In: experiments, and which of their figures and tables are selected. Out: a [`RunPlan`]: the training runs, each listed
//! before those that start from its weights, and the training runs of every arm, condition and seed.
//!
//! Arms of different experiments are often the same training run, or one is the beginning of the other: figure 8's DQN is
//! the first 800 episodes of figure 9's. Schedules depend on the steps taken and not on the budget, so the longer
//! training gives exactly the same results for both.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::arm_run::{ArmRun, PolicyId};
use super::elsewhere::{self, FinishedRun};
use super::experiment::{Arm, TestRule, TestedPolicy};
use super::policy_test::policy_file;
use super::run_config::{run_config, run_name, save_policy_after};
use super::selected::{ExperimentSource, SelectedExperiment};
use super::test_point::{TestPoint, amount, difference, shorter};
use crate::run::RunError;
use crate::run::folder::{RunConfig, RunFolder, Transfer};
use crate::run::preset::Budget;
use crate::scenario::printable;

/// A training run and its tests.
#[derive(Clone, Debug)]
pub struct PlannedRun {
    /// The name of the run's folder. Equal configurations have equal names.
    pub name: String,
    /// The configuration of the run.
    pub config: RunConfig,
    /// The index of the training run whose weights this one starts from.
    pub origin: Option<usize>,
    /// The policies to test, with their tests.
    pub tests: BTreeSet<(PolicyId, TestRule)>,
    /// The finished run, if it was trained elsewhere.
    pub elsewhere: Option<FinishedRun>,
}

impl PlannedRun {
    /// The folder with the records and policies of the run. `runs` is the folder of the report's own runs.
    #[must_use]
    pub fn folder(&self, runs: &Path) -> PathBuf {
        self.elsewhere.as_ref().map_or_else(|| runs.join(&self.name), |run| run.folder.clone())
    }
}

/// All training runs.
#[derive(Debug, Default)]
pub struct RunPlan {
    /// Every training run once, each before those that start from it.
    pub training_runs: Vec<PlannedRun>,
    /// The arm runs by experiment, condition and arm (indices) and seed.
    pub arm_runs: BTreeMap<(usize, usize, usize, u64), ArmRun>,
}

impl RunPlan {
    /// The plan for the selected experiments.
    ///
    /// # Errors
    /// A scenario or preset is invalid, an arm is too short for a figure or table, or a run of an arm is unusable.
    pub fn new(selected: &[SelectedExperiment]) -> Result<Self, RunError> {
        let mut plan = Self::default();
        for (index, selected) in selected.iter().enumerate() {
            let experiment = &selected.source.experiment;
            let needs_route = selected.needs_benchmark_route();
            for condition in 0..experiment.conditions.len().max(1) {
                for (arm_index, arm) in experiment.arms.iter().enumerate() {
                    let points = selected.points(&arm.name);
                    for (seed, arm_run) in plan.arm(selected, condition, arm)? {
                        if needs_route {
                            plan.check_benchmark_route(&arm_run, arm, &selected.source)?;
                        }
                        plan.add_tests(&arm_run, arm, &points, &selected.source)?;
                        plan.arm_runs.insert((index, condition, arm_index, seed), arm_run);
                    }
                }
            }
            elsewhere::check_scenarios(&plan, index, &selected.source)?;
        }
        Ok(plan)
    }

    /// The runs of an arm, by seed; without stages if the arm is not needed.
    fn arm(
        &mut self,
        selected: &SelectedExperiment,
        condition: usize,
        arm: &Arm,
    ) -> Result<Vec<(u64, ArmRun)>, RunError> {
        let source = &selected.source;
        let seeds = source.experiment.seeds.list().into_iter();
        if !selected.needs(&arm.name) {
            return Ok(seeds.map(|seed| (seed, ArmRun { stages: Vec::new() })).collect());
        }
        let needed = selected.needed_length(&arm.name);
        if arm.runs.is_empty() {
            return seeds
                .map(|seed| Ok((seed, self.arm_run(source, condition, arm, seed, needed)?)))
                .collect();
        }
        let runs = elsewhere::read(source, arm)?.into_iter();
        Ok(runs.map(|(config, run)| (config.seed, self.add_finished(config, run))).collect())
    }

    /// The training runs of an arm; only the first `needed` episodes or env steps, if given.
    fn arm_run(
        &mut self,
        source: &ExperimentSource,
        condition: usize,
        arm: &Arm,
        seed: u64,
        needed: Option<Budget>,
    ) -> Result<ArmRun, RunError> {
        let mut arm_run = ArmRun { stages: Vec::new() };
        let mut needed = needed.filter(|_| arm.policy == TestedPolicy::After);
        for stage in &arm.stages {
            let mut config = run_config(&source.from, &source.experiment, condition, (arm, stage), seed)?;
            let budget = config.preset.budget;
            let length = needed.and_then(|needed| shorter(needed, budget)).unwrap_or(budget);
            if amount(length) == 0 {
                break;
            }
            config.preset.budget = length;
            needed = needed.and_then(|needed| difference(needed, length));
            let origin = arm_run.stages.last().copied();
            let training = self.add_training(config, origin, stage.epsilon, arm.policy)?;
            arm_run.stages.push((training, length));
        }
        Ok(arm_run)
    }

    /// Adds a run that was trained elsewhere. A copy of it in another folder counts as the same run, because the test results of
    /// both would be in the same folder.
    fn add_finished(&mut self, config: RunConfig, run: FinishedRun) -> ArmRun {
        let length = config.preset.budget;
        let known =
            |training: &PlannedRun| training.elsewhere.as_ref().is_some_and(|known| known.name == run.name);
        let index = self.training_runs.iter().position(known).unwrap_or_else(|| {
            let (name, tests) = (run.name.clone(), BTreeSet::new());
            self.training_runs.push(PlannedRun { name, config, origin: None, tests, elsewhere: Some(run) });
            self.training_runs.len() - 1
        });
        ArmRun { stages: vec![(index, length)] }
    }

    /// The index of the training run with this configuration. An existing one is made longer if necessary.
    fn add_training(
        &mut self,
        mut config: RunConfig,
        origin: Option<(usize, Budget)>,
        epsilon: Option<f32>,
        tested: TestedPolicy,
    ) -> Result<usize, RunError> {
        if let Some((training, length)) = origin {
            let earlier = &mut self.training_runs[training];
            save_policy_after(&mut earlier.config, length);
            let file = RunFolder::policy_after_file(length);
            config.transfer = Some(Transfer { policy: format!("{}/{file}", earlier.name), epsilon });
        }
        let name = run_name(&config, tested)?;
        if let Some(index) = self.training_runs.iter().position(|training| training.name == name) {
            let budget = &mut self.training_runs[index].config.preset.budget;
            // Both are in the same unit, which is part of the name.
            *budget = (*budget).max(config.preset.budget);
            return Ok(index);
        }
        let origin = origin.map(|(training, _)| training);
        self.training_runs.push(PlannedRun { name, config, origin, tests: BTreeSet::new(), elsewhere: None });
        Ok(self.training_runs.len() - 1)
    }

    /// Checks that the scenario of every stage of an arm has a benchmark route.
    fn check_benchmark_route(
        &self,
        arm_run: &ArmRun,
        arm: &Arm,
        source: &ExperimentSource,
    ) -> Result<(), RunError> {
        let scenarios =
            arm_run.stages.iter().map(|&(training, _)| &self.training_runs[training].config.scenario);
        match scenarios.into_iter().find(|scenario| scenario.benchmark_route.is_none()) {
            None => Ok(()),
            Some(scenario) => Err(RunError::InvalidInput(format!(
                "{}: a figure, table or claim is about the benchmark route, but {}, the scenario of arm \"{}\", has none; \
                 help: write a `benchmark_route` into the scenario, or remove the figure, table or claim",
                source.from,
                printable(&scenario.name),
                arm.name
            ))),
        }
    }

    /// Adds the tests of an arm to its training runs. `points` maps each point to whether a policy is needed there.
    fn add_tests(
        &mut self,
        arm_run: &ArmRun,
        arm: &Arm,
        points: &BTreeMap<TestPoint, bool>,
        source: &ExperimentSource,
    ) -> Result<(), RunError> {
        for (&point, &needs_policy) in points {
            let Some((index, policy)) = arm_run.policy(&self.training_runs, arm.policy, point) else {
                return Err(too_short(arm, point, source));
            };
            if !needs_policy {
                continue;
            }
            let training = &mut self.training_runs[index];
            training.tests.insert((policy, source.experiment.test));
            match (&training.elsewhere, policy) {
                (None, PolicyId::After(length)) => save_policy_after(&mut training.config, length),
                (Some(run), policy) => {
                    run.check_policy(&policy_file(policy), &source.from, &arm.name, &point.words())?;
                }
                (None, _) => {}
            }
        }
        Ok(())
    }
}

/// The error for an arm whose training does not reach `point`.
fn too_short(arm: &Arm, point: TestPoint, source: &ExperimentSource) -> RunError {
    let (why, help) = if !arm.runs.is_empty() {
        ("one of its runs is shorter", "leave `after` out, to test the last policy")
    } else if matches!(point.after, Some(Budget::EnvSteps(_))) {
        ("its stages are shorter or not counted in the same unit", "give them `budget: EnvSteps(...)`")
    } else {
        ("its stages are shorter or not counted in the same unit", "give them `budget: Episodes(...)`")
    };
    RunError::InvalidInput(format!(
        "{}: a figure or table needs arm \"{}\" after {}, but {why}; help: {help}, or give the arm `policy: Best`",
        source.from,
        arm.name,
        point.words()
    ))
}
