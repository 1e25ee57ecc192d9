//! Runs that were trained elsewhere, as the training runs of an arm.
//!
//! In: the folders that an arm names. Out: their runs, which are finished and differ only in the seed.
//! The folders are never written to.

use std::path::PathBuf;

use super::arm_run::PolicyId;
use super::experiment::Arm;
use super::plan::RunPlan;
use super::run_config::resolve_folder;
use super::selected::ExperimentSource;
use crate::run::RunError;
use crate::run::folder::{RunConfig, RunFolder};
use crate::run::metric_rows::Summary;
use crate::run::preset::Budget;
use crate::scenario::{printable, quoted, read_text};

/// A run that was trained elsewhere and is finished.
#[derive(Clone, Debug, PartialEq)]
pub struct FinishedRun {
    /// The run's folder.
    pub folder: PathBuf,
    /// A name for the folder of its test results. If another run replaces it in the same folder, the name differs.
    pub name: String,
    /// The number of finished episodes.
    episodes: u64,
    /// The number of env steps.
    env_steps: u64,
}

impl FinishedRun {
    /// Opens the run in `folder`. Returns its configuration, too.
    ///
    /// # Errors
    /// It is not a run, or is not finished. The message is about `folder`.
    fn open(folder: PathBuf) -> Result<(RunConfig, Self), RunError> {
        let invalid = |why: &str| RunError::invalid_input(&folder, why);
        if !folder.join(RunFolder::CONFIG_FILE).is_file() {
            return Err(invalid(
                "holds no run (there is no config.ron); help: give the folder of a finished run, relative to the \
                 experiment's file or to the working directory",
            ));
        }
        let (_, config) = RunFolder::open(&folder)?;
        // A run that was resumed with a larger budget and killed has the summary of its earlier end.
        let has_budget = |summary: &Summary| match config.preset.budget {
            Budget::Episodes(n) => summary.episodes >= n,
            Budget::EnvSteps(n) => summary.env_steps >= n,
        };
        let finished = |summary: &Summary| summary.finished && has_budget(summary);
        let Some(summary) = Summary::read(&folder).filter(finished) else {
            let why = format!("this run is not finished; help: finish it with --resume {}", quoted(&folder));
            return Err(invalid(&why));
        };
        let records = [RunFolder::CONFIG_FILE, "summary.json"]
            .map(|name| read_text(folder.join(name)).unwrap_or_default());
        let hash = crc32c::crc32c(records.concat().as_bytes());
        let name = format!(
            "elsewhere-{}-{}-{hash:08x}-seed{}",
            config.preset_name(),
            config.scenario_name(),
            config.seed
        );
        let (episodes, env_steps) = (summary.episodes, summary.env_steps);
        Ok((config, Self { folder, name, episodes, env_steps }))
    }

    /// A finished run for tests; its folder does not exist.
    #[cfg(test)]
    pub fn example(name: &str) -> Self {
        Self { folder: name.into(), name: name.into(), episodes: 0, env_steps: 0 }
    }

    /// The policy after a number of episodes or env steps, or at the end; `None` if the run is shorter.
    #[must_use]
    pub fn policy_at(&self, after: Option<Budget>) -> Option<PolicyId> {
        let Some(after) = after else { return Some(PolicyId::Last) };
        let (wanted, length) = match after {
            Budget::Episodes(n) => (n, self.episodes),
            Budget::EnvSteps(n) => (n, self.env_steps),
        };
        match wanted.cmp(&length) {
            std::cmp::Ordering::Less => Some(PolicyId::After(after)),
            std::cmp::Ordering::Equal => Some(PolicyId::Last),
            std::cmp::Ordering::Greater => None,
        }
    }

    /// Checks that the run has the policy `file`, which `arm` of the experiment `from` needs: the one after `when`.
    ///
    /// # Errors
    /// The file is missing.
    pub fn check_policy(&self, file: &str, from: &str, arm: &str, when: &str) -> Result<(), RunError> {
        if self.folder.join(file).is_file() {
            return Ok(());
        }
        let why = format!(
            "has no policy after {when}, which {from} needs for arm \"{arm}\"; help: leave `after` out, to test the last \
             policy, or give the arm `policy: Best`"
        );
        Err(RunError::invalid_input(&self.folder, why))
    }
}

/// Reads the finished runs of `arm`, which must differ only in the seed.
///
/// # Errors
/// A folder holds no finished run, two runs have the same seed, or they differ in more than the seed.
pub fn read(source: &ExperimentSource, arm: &Arm) -> Result<Vec<(RunConfig, FinishedRun)>, RunError> {
    let open = |name: &String| FinishedRun::open(resolve_folder(&source.from, name));
    let runs = arm.runs.iter().map(open).collect::<Result<Vec<_>, _>>()?;
    for (index, run) in runs.iter().enumerate() {
        if let Some(problem) = runs[..index].iter().find_map(|earlier| difference(earlier, run)) {
            let why = format!("{problem} ({}, arm \"{}\")", source.from, arm.name);
            return Err(RunError::invalid_input(&run.1.folder, why));
        }
    }
    Ok(runs)
}

/// Why a run cannot be in the same arm as an `earlier` one.
fn difference(earlier: &(RunConfig, FinishedRun), run: &(RunConfig, FinishedRun)) -> Option<String> {
    let other = printable(&earlier.1.folder.display().to_string()).into_owned();
    let (earlier, config) = (&earlier.0, &run.0);
    let separate = "help: the runs of an arm may differ only in the seed, so give this run an arm of its own";
    if earlier.scenario.name != config.scenario.name {
        let (this, that) = (&config.scenario.name, &earlier.scenario.name);
        return Some(format!("is a run in \"{this}\", but {other} is one in \"{that}\"; {separate}"));
    }
    let transfer_epsilon = |config: &RunConfig| config.transfer.as_ref().map(|transfer| transfer.epsilon);
    if earlier.scenario != config.scenario
        || earlier.scenario_set != config.scenario_set
        || earlier.preset != config.preset
        || earlier.sensors != config.sensors
        || earlier.reward_terms != config.reward_terms
        || transfer_epsilon(earlier) != transfer_epsilon(config)
    {
        return Some(format!(
            "has different settings from {other} (compare their config.ron files); {separate}"
        ));
    }
    let seed = config.seed;
    (earlier.seed == seed)
        .then(|| format!("has the same seed as {other}: {seed}; help: leave one of them out"))
}

/// Checks that arms with runs from elsewhere are only compared with arms in a scenario of the same name.
///
/// # Errors
/// A claim or table compares arms that end in different scenarios.
pub fn check_scenarios(plan: &RunPlan, index: usize, source: &ExperimentSource) -> Result<(), RunError> {
    let arms = &source.experiment.arms;
    let scenario = |name: &str| {
        let arm = arms.iter().position(|arm| arm.name == name)?;
        let (_, run) = plan.arm_runs.range((index, 0, arm, 0)..=(index, 0, arm, u64::MAX)).next()?;
        Some(&plan.training_runs[run.stages.last()?.0].config.scenario.name)
    };
    let has_runs = |name: &str| arms.iter().any(|arm| arm.name == name && !arm.runs.is_empty());
    for (better, than) in source.experiment.compared_arms() {
        let (Some(first), Some(second)) = (scenario(better), scenario(than)) else { continue };
        if (has_runs(better) || has_runs(than)) && first != second {
            return Err(RunError::InvalidInput(format!(
                "{}: arm \"{better}\" is compared with \"{than}\", but their runs are in different scenarios: \"{first}\" \
                 and \"{second}\"; help: give both arms runs in the same scenario",
                source.from,
            )));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::folder::Transfer;
    use crate::scenario::{ScenarioSet, SetMember, SetSource};

    #[test]
    fn the_runs_of_an_arm_may_differ_only_in_the_seed() {
        let run = |seed: u64, change: fn(&mut RunConfig)| {
            let mut config = RunConfig::resolve("empty", "fast", seed).expect("shipped");
            change(&mut config);
            let name = format!("run-{seed}");
            (config, FinishedRun { folder: PathBuf::from(&name), name, episodes: 1, env_steps: 1 })
        };
        let earlier = run(1, |_| {});
        assert_eq!(difference(&earlier, &run(2, |_| {})), None);
        let changes: [fn(&mut RunConfig); 5] = [
            |config| config.scenario.robot.radius_m = 0.11,
            |config| {
                let source = SetSource::Scenario(Box::new(config.scenario.clone()));
                let members = vec![SetMember { name: "member".into(), share: 1.0, source }];
                config.scenario_set = Some(ScenarioSet { name: "set".into(), members });
            },
            |config| config.preset.arenas = 3,
            |config| config.reward_terms = vec!["term".into()],
            |config| config.transfer = Some(Transfer { policy: "a".into(), epsilon: None }),
        ];
        for (number, change) in changes.into_iter().enumerate() {
            let problem = difference(&earlier, &run(2, change)).expect("a difference");
            assert!(problem.contains("has different settings from run-1"), "change {number}: {problem}");
        }
        let problem = difference(&earlier, &run(1, |_| {})).expect("the same seed");
        assert!(problem.contains("has the same seed as run-1: 1"), "{problem}");
    }
}
