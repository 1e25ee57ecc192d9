//! The plan: which trainings the experiments need, each once.
//!
//! In: experiments, and which of their figures and tables are wanted. Out: [`RunPlan`]: a list of trainings, each before
//! those that start from its weights, and for each arm, condition and seed the trainings that it consists of.
//!
//! Arms of different experiments often are the same training, or one is the beginning of the other (figure 8's DQN is
//! the first 800 episodes of figure 9's). Schedules depend on the steps taken and not on the budget, so the longer
//! training serves both, to the bit.

use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

use super::experiment::{Arm, Claim, Experiment, FigureKind, Stage, TableKind, TestRule, TestedPolicy};
use crate::run::folder::{RunConfig, Transfer};
use crate::run::preset::Budget;
use crate::run::{RunError, shipped};
use crate::scenario::{self, FileError, to_ron};
use crate::simulation::Extensions;

/// An experiment, and where it comes from.
#[derive(Clone, Debug)]
pub struct ExperimentSource {
    /// Its file, or its path in the project for a shipped one.
    pub from: String,
    /// The experiment.
    pub experiment: Experiment,
}

/// An experiment, and which of its figures and tables are wanted.
#[derive(Clone, Debug)]
pub struct SelectedExperiment {
    /// The experiment and where it comes from.
    pub source: ExperimentSource,
    /// Indices of the wanted figures.
    pub figures: Vec<usize>,
    /// Indices of the wanted tables.
    pub tables: Vec<usize>,
}

/// One training, and what is wanted of it.
#[derive(Clone, Debug)]
pub struct Training {
    /// The name of its folder; the same for the same configuration.
    pub name: String,
    /// All that a run is told.
    pub config: RunConfig,
    /// The training whose weights it starts from.
    pub origin: Option<usize>,
    /// What is tested.
    pub tests: BTreeSet<(PolicyId, TestRule)>,
}

/// Which policy of a training is meant.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum PolicyId {
    /// As it stands after so many episodes of the training.
    AfterEpisodes(u64),
    /// The best by the training's own evaluations.
    Best,
}

/// After so many episodes, over all stages or of the last alone.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Mark {
    after: u64,
    of_last_stage: bool,
}

/// An arm under a condition with a seed: its trainings, one for each stage that is needed.
#[derive(Clone, Debug)]
pub struct ArmRun {
    /// Index into [`RunPlan::trainings`], and how many of its episodes belong to the stage (none: all of it).
    pub stages: Vec<(usize, Option<u64>)>,
}

impl ArmRun {
    /// The episodes of all stages but the last.
    #[must_use]
    pub fn episodes_before_last_stage(&self) -> u64 {
        let earlier = self.stages.split_last().map_or(&[][..], |(_, earlier)| earlier);
        earlier.iter().filter_map(|(_, length)| *length).sum()
    }

    /// The stage in which the arm has had `after` episodes in all, as an index into `stages`, and how many of the
    /// stage's own those are. None if it never has so many, or a stage before is not counted in episodes.
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

/// What there is to do.
#[derive(Debug, Default)]
pub struct RunPlan {
    /// Every training once, each before those that start from it.
    pub trainings: Vec<Training>,
    /// By experiment, condition, arm (indices) and seed (from 1).
    pub arm_runs: BTreeMap<(usize, usize, usize, u64), ArmRun>,
}

impl RunPlan {
    /// The plan for `selected`.
    ///
    /// # Errors
    /// A scenario or preset cannot be used.
    pub fn new(selected: &[SelectedExperiment]) -> Result<Self, RunError> {
        let mut plan = Self::default();
        for (index, selected) in selected.iter().enumerate() {
            let experiment = &selected.source.experiment;
            let needed = selected.needed_episodes();
            let marks = selected.marks();
            for condition in 0..experiment.conditions.len().max(1) {
                for (arm_index, arm) in experiment.arms.iter().enumerate() {
                    for seed in 1..=experiment.seeds {
                        let chain = plan.arm_run(&selected.source, condition, arm, seed, needed)?;
                        plan.tests(&chain, arm, &marks, experiment.test, &selected.source)?;
                        plan.arm_runs.insert((index, condition, arm_index, seed), chain);
                    }
                }
            }
        }
        Ok(plan)
    }

    /// The trainings of an arm, up to `needed` episodes if not all are.
    fn arm_run(
        &mut self,
        source: &ExperimentSource,
        condition: usize,
        arm: &Arm,
        seed: u64,
        needed: Option<u64>,
    ) -> Result<ArmRun, RunError> {
        let mut chain = ArmRun { stages: Vec::new() };
        let mut before = 0;
        for stage in &arm.stages {
            let mut config = config(source, condition, stage, seed)?;
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
            let origin = chain.stages.last().copied();
            let training = self.add(config, origin, stage.epsilon, arm.policy)?;
            chain.stages.push((training, length));
        }
        Ok(chain)
    }

    /// The index of the training that `config` describes, which becomes longer if need be.
    fn add(
        &mut self,
        mut config: RunConfig,
        origin: Option<(usize, Option<u64>)>,
        epsilon: Option<f32>,
        tested: TestedPolicy,
    ) -> Result<usize, RunError> {
        let mut from = None;
        if let Some((training, length)) = origin {
            let earlier = &mut self.trainings[training];
            let file = match length {
                Some(episodes) => {
                    keep(&mut earlier.config, episodes);
                    crate::run::folder::RunFolder::policy_after_file(episodes)
                }
                None => "policy-last.safetensors".into(),
            };
            config.transfer = Some(Transfer { policy: format!("{}/{file}", earlier.name), epsilon });
            from = Some(training);
        }
        let name = name(&config, tested)?;
        if let Some(index) = self.trainings.iter().position(|training| training.name == name) {
            let budget = &mut self.trainings[index].config.preset.budget;
            if let (Budget::Episodes(a), Budget::Episodes(b)) = (*budget, config.preset.budget) {
                *budget = Budget::Episodes(a.max(b));
            }
            return Ok(index);
        }
        self.trainings.push(Training { name, config, origin: from, tests: BTreeSet::new() });
        Ok(self.trainings.len() - 1)
    }

    /// Notes what is tested of an arm.
    fn tests(
        &mut self,
        chain: &ArmRun,
        arm: &Arm,
        marks: &BTreeSet<Mark>,
        rule: TestRule,
        source: &ExperimentSource,
    ) -> Result<(), RunError> {
        if arm.policy == TestedPolicy::Best {
            if let Some((training, _)) = chain.stages.last().filter(|_| !marks.is_empty()) {
                self.trainings[*training].tests.insert((PolicyId::Best, rule));
            }
            return Ok(());
        }
        for &Mark { after, of_last_stage } in marks {
            let mark = if of_last_stage { chain.episodes_before_last_stage() + after } else { after };
            let Some((stage, episodes)) = chain.stage_at(mark) else {
                return Err(RunError::InvalidInput(format!(
                    "{}: a figure or table looks at arm \"{}\" after {mark} episodes, but its stages are not all counted \
                     in episodes or are not so long: give them `budget: Episodes(...)`, or the arm `policy: Best`",
                    source.from, arm.name
                )));
            };
            let training = &mut self.trainings[chain.stages[stage].0];
            keep(&mut training.config, episodes);
            training.tests.insert((PolicyId::AfterEpisodes(episodes), rule));
        }
        Ok(())
    }
}

impl SelectedExperiment {
    /// How many episodes of an arm are needed; None for all.
    fn needed_episodes(&self) -> Option<u64> {
        let curves = self.picked_figures().any(|figure| matches!(figure, FigureKind::LearningCurves { .. }));
        let marks = self.marks();
        // The last stage begins when all before it are over.
        let of_last_stage = marks.iter().any(|mark| mark.of_last_stage);
        if curves || of_last_stage { None } else { marks.last().map(|mark| mark.after) }
    }

    fn picked_figures(&self) -> impl Iterator<Item = &FigureKind> {
        self.figures.iter().map(|&i| &self.source.experiment.figures[i].draw)
    }

    /// When somebody looks at a policy or a curve.
    fn marks(&self) -> BTreeSet<Mark> {
        let experiment = &self.source.experiment;
        let mut marks = BTreeSet::new();
        let over_all = |after| Mark { after, of_last_stage: false };
        let of_claim = |claim: &Claim| Mark { after: claim.after, of_last_stage: claim.of_last_stage };
        for figure in self.figures.iter().map(|&i| &experiment.figures[i]) {
            match &figure.draw {
                FigureKind::LearningCurves { .. } => {}
                FigureKind::DotPlot { after, .. } | FigureKind::BenchmarkRoute { after } => {
                    marks.insert(over_all(*after));
                }
            }
            marks.extend(figure.claims.iter().map(of_claim));
        }
        for table in self.tables.iter().map(|&i| &experiment.tables[i]) {
            match &table.show {
                TableKind::Seeds { after, .. }
                | TableKind::Rounds { after, .. }
                | TableKind::Measures { after, .. } => {
                    marks.insert(over_all(*after));
                }
                TableKind::Contrast { after, of_last_stage, .. } => {
                    marks.extend(after.iter().map(|&after| Mark { after, of_last_stage: *of_last_stage }));
                }
            }
            marks.extend(table.claims.iter().map(of_claim));
        }
        marks
    }
}

fn keep(config: &mut RunConfig, episodes: u64) {
    if !config.save_policy_after_episodes.contains(&episodes) {
        config.save_policy_after_episodes.push(episodes);
        config.save_policy_after_episodes.sort_unstable();
    }
}

/// All that a run of `stage` is told, its origin aside.
fn config(
    source: &ExperimentSource,
    condition: usize,
    stage: &Stage,
    seed: u64,
) -> Result<RunConfig, RunError> {
    let experiment = &source.experiment;
    let beside = |name: &str| beside(&source.from, name);
    // An experiment from a stranger must not have a pipe or a device read, which may never end.
    let read_for_ever = |name: &str| {
        let path = beside(name);
        let path = Path::new(&path);
        (path.exists() && !path.is_file() && !path.is_dir())
            .then(|| RunError::invalid_input(path, format!("{} names it, but it is no file", source.from)))
    };
    let condition = experiment.conditions.get(condition).map(|condition| &condition.overrides);
    let scenario_from =
        condition.and_then(|change| change.scenario.as_ref()).or(stage.overrides.scenario.as_ref());
    let scenario_from = scenario_from.unwrap_or(&stage.scenario).clone();
    if let Some(error) = [&scenario_from, &stage.preset].into_iter().find_map(|name| read_for_ever(name)) {
        return Err(error);
    }
    let mut scenario = shipped::scenario(&beside(&scenario_from))?;
    let mut preset = shipped::preset(&beside(&stage.preset))?;
    preset.budget = stage.budget.unwrap_or(preset.budget);
    preset.evaluation = experiment.evaluation.unwrap_or(preset.evaluation);
    stage.overrides.apply(&mut scenario, &mut preset);
    if let Some(condition) = condition {
        condition.apply(&mut scenario, &mut preset);
    }
    let diagnostics = scenario::diagnostics(&scenario).into_iter().chain(preset.diagnostics());
    if let Some(finding) = diagnostics.into_iter().next() {
        let changed = format!("what is changed in {scenario_from} or {}", stage.preset);
        return Err(FileError::for_file(Path::new(&source.from), format!("{changed}: {finding}")).into());
    }
    Ok(RunConfig {
        version: env!("CARGO_PKG_VERSION").into(),
        seed,
        scenario_from,
        preset_from: stage.preset.clone(),
        transfer: None,
        save_policy_after_episodes: Vec::new(),
        sensors: Vec::new(),
        reward_terms: Vec::new(),
        extensions: Extensions::default(),
        scenario,
        preset,
    })
}

/// The path of a file that lies beside the experiment, or `name` as it is.
fn beside(experiment: &str, name: &str) -> String {
    let path: PathBuf = Path::new(experiment).parent().unwrap_or(Path::new("")).join(name);
    if path.is_file() { path.display().to_string() } else { name.into() }
}

/// A name for the run of `config`: the same for the same configuration. A longer run of so many episodes is the same
/// run, unless the best policy of all of it is what is tested.
fn name(config: &RunConfig, tested: TestedPolicy) -> Result<String, RunError> {
    let mut identity = config.clone();
    identity.save_policy_after_episodes.clear();
    if tested == TestedPolicy::AtEpisode && matches!(identity.preset.budget, Budget::Episodes(_)) {
        identity.preset.budget = Budget::Episodes(1);
    }
    let text = to_ron(&identity).map_err(|error| RunError::Failed(error.to_string()))?;
    let mark = crc32c::crc32c(text.as_bytes());
    let (scenario, preset) = (config.scenario_name(), config.preset_name());
    Ok(format!("{preset}-{scenario}-{mark:08x}-seed{}", config.seed))
}
