//! The plan: the trainings that the selected figures and tables need, each once.
//!
//! In: experiments, and which of their figures and tables are selected. Out: a [`RunPlan`]: the trainings, each listed
//! before those that start from its weights, and the trainings of every arm, condition and seed.
//!
//! Arms of different experiments are often the same training, or one is the beginning of the other: figure 8's DQN is
//! the first 800 episodes of figure 9's. Schedules depend on the steps taken and not on the budget, so the longer
//! training gives exactly the same results for both.

use std::collections::{BTreeMap, BTreeSet};

use super::experiment::{Arm, TestRule, TestedPolicy};
use super::run_config::{run_config, run_name, save_policy_after};
use super::selected::{ExperimentSource, SelectedExperiment, TestPoint};
use crate::run::RunError;
use crate::run::folder::{RunConfig, RunFolder, Transfer};
use crate::run::preset::Budget;
use crate::scenario::printable;

/// A training and its tests.
#[derive(Clone, Debug)]
pub struct Training {
    /// The name of the run's folder. Equal configurations have equal names.
    pub name: String,
    /// The configuration of the run.
    pub config: RunConfig,
    /// The index of the training whose weights this one starts from.
    pub origin: Option<usize>,
    /// The policies to test, with their tests.
    pub tests: BTreeSet<(PolicyId, TestRule)>,
}

/// One of a training's policies.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PolicyId {
    /// The policy after a number of episodes of the training.
    AfterEpisodes(u64),
    /// The best policy by the evaluations during training.
    Best,
}

/// An arm under a condition with a seed: its trainings, one per stage that is needed.
#[derive(Clone, Debug)]
pub struct ArmRun {
    /// For each stage, the index into [`RunPlan::trainings`] and the number of that training's episodes which belong to
    /// the stage (`None`: all).
    pub stages: Vec<(usize, Option<u64>)>,
}

impl ArmRun {
    /// The number of episodes of all stages but the last.
    #[must_use]
    pub fn episodes_before_last_stage(&self) -> u64 {
        let earlier = self.stages.split_last().map_or(&[][..], |(_, earlier)| earlier);
        earlier.iter().filter_map(|(_, length)| *length).sum()
    }

    /// The stage in which the arm completes `after` episodes, as an index into `stages`, and the number of episodes
    /// within that stage. `None` if the arm is shorter, or if the length of a stage is not given in episodes.
    #[must_use]
    pub fn stage_at(&self, after: u64) -> Option<(usize, u64)> {
        let mut before = 0;
        for (index, (_, length)) in self.stages.iter().enumerate() {
            let length = (*length)?;
            if after <= before + length {
                return Some((index, after - before));
            }
            before += length;
        }
        None
    }
}

/// All trainings to run.
#[derive(Debug, Default)]
pub struct RunPlan {
    /// Every training once, each before those that start from it.
    pub trainings: Vec<Training>,
    /// The arm runs by experiment, condition and arm (indices) and seed (from 1).
    pub arm_runs: BTreeMap<(usize, usize, usize, u64), ArmRun>,
}

impl RunPlan {
    /// The plan for the selected experiments.
    ///
    /// # Errors
    /// A scenario or preset is invalid, or an arm is too short for a figure or table.
    pub fn new(selected: &[SelectedExperiment]) -> Result<Self, RunError> {
        let mut plan = Self::default();
        for (index, selected) in selected.iter().enumerate() {
            let experiment = &selected.source.experiment;
            let needed = selected.needed_episodes();
            let points = selected.test_points();
            let needs_route = selected.needs_benchmark_route();
            for condition in 0..experiment.conditions.len().max(1) {
                for (arm_index, arm) in experiment.arms.iter().enumerate() {
                    for seed in 1..=experiment.seeds {
                        let arm_run = plan.arm_run(&selected.source, condition, arm, seed, needed)?;
                        if needs_route {
                            plan.check_benchmark_route(&arm_run, arm, &selected.source)?;
                        }
                        plan.add_tests(&arm_run, arm, &points, &selected.source)?;
                        plan.arm_runs.insert((index, condition, arm_index, seed), arm_run);
                    }
                }
            }
        }
        Ok(plan)
    }

    /// The trainings of an arm; only the first `needed` episodes, if given.
    fn arm_run(
        &mut self,
        source: &ExperimentSource,
        condition: usize,
        arm: &Arm,
        seed: u64,
        needed: Option<u64>,
    ) -> Result<ArmRun, RunError> {
        let mut arm_run = ArmRun { stages: Vec::new() };
        let mut before = 0;
        for stage in &arm.stages {
            let mut config = run_config(&source.from, &source.experiment, condition, stage, seed)?;
            let mut length = None;
            if let Budget::Episodes(n) = config.preset.budget {
                let wanted = match needed.filter(|_| arm.policy == TestedPolicy::AtEpisode) {
                    Some(needed) => n.min(needed.saturating_sub(before)),
                    None => n,
                };
                if wanted == 0 {
                    break;
                }
                config.preset.budget = Budget::Episodes(wanted);
                before += wanted;
                length = Some(wanted);
            }
            let origin = arm_run.stages.last().copied();
            let training = self.add_training(config, origin, stage.epsilon, arm.policy)?;
            arm_run.stages.push((training, length));
        }
        Ok(arm_run)
    }

    /// The index of the training with this configuration. An existing training is made longer if necessary.
    fn add_training(
        &mut self,
        mut config: RunConfig,
        origin: Option<(usize, Option<u64>)>,
        epsilon: Option<f32>,
        tested: TestedPolicy,
    ) -> Result<usize, RunError> {
        if let Some((training, length)) = origin {
            let earlier = &mut self.trainings[training];
            let file = match length {
                Some(episodes) => {
                    save_policy_after(&mut earlier.config, episodes);
                    RunFolder::policy_after_file(episodes)
                }
                None => "policy-last.safetensors".into(),
            };
            config.transfer = Some(Transfer { policy: format!("{}/{file}", earlier.name), epsilon });
        }
        let name = run_name(&config, tested)?;
        if let Some(index) = self.trainings.iter().position(|training| training.name == name) {
            let budget = &mut self.trainings[index].config.preset.budget;
            if let (Budget::Episodes(a), Budget::Episodes(b)) = (*budget, config.preset.budget) {
                *budget = Budget::Episodes(a.max(b));
            }
            return Ok(index);
        }
        let origin = origin.map(|(training, _)| training);
        self.trainings.push(Training { name, config, origin, tests: BTreeSet::new() });
        Ok(self.trainings.len() - 1)
    }

    /// Checks that the scenario of every stage of an arm has a benchmark route.
    fn check_benchmark_route(
        &self,
        arm_run: &ArmRun,
        arm: &Arm,
        source: &ExperimentSource,
    ) -> Result<(), RunError> {
        let scenarios = arm_run.stages.iter().map(|&(training, _)| &self.trainings[training].config.scenario);
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

    /// Adds the tests of an arm to its trainings.
    fn add_tests(
        &mut self,
        arm_run: &ArmRun,
        arm: &Arm,
        points: &BTreeSet<TestPoint>,
        source: &ExperimentSource,
    ) -> Result<(), RunError> {
        let rule = source.experiment.test;
        if arm.policy == TestedPolicy::Best {
            if let Some((training, _)) = arm_run.stages.last().filter(|_| !points.is_empty()) {
                self.trainings[*training].tests.insert((PolicyId::Best, rule));
            }
            return Ok(());
        }
        for &TestPoint { after, of_last_stage } in points {
            let after = if of_last_stage { arm_run.episodes_before_last_stage() + after } else { after };
            let Some((stage, episodes)) = arm_run.stage_at(after) else {
                return Err(RunError::InvalidInput(format!(
                    "{}: a figure or table needs arm \"{}\" after {after} episodes, but its stages are shorter or not \
                     counted in episodes; help: give them `budget: Episodes(...)`, or the arm `policy: Best`",
                    source.from, arm.name
                )));
            };
            let training = &mut self.trainings[arm_run.stages[stage].0];
            save_policy_after(&mut training.config, episodes);
            training.tests.insert((PolicyId::AfterEpisodes(episodes), rule));
        }
        Ok(())
    }
}
