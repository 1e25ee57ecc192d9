//! The configuration of a stage's training run, and the name of its folder.

use std::path::{Path, PathBuf};

use super::experiment::{Arm, Experiment, Stage, TestedPolicy};
use super::quick::shorten_training;
use crate::run::folder::RunConfig;
use crate::run::preset::Budget;
use crate::run::{RunError, shipped};
use crate::scenario::{FileError, to_ron};

/// The configuration of a `stage` of `arm` under a condition, without its transfer. `from` is the experiment's file.
///
/// # Errors
/// The scenario or the preset cannot be read, or is invalid before or after the overrides.
pub fn run_config(
    from: &str,
    experiment: &Experiment,
    condition: usize,
    (arm, stage): (&Arm, &Stage),
    seed: u64,
) -> Result<RunConfig, RunError> {
    let condition = experiment.conditions.get(condition).filter(|condition| condition.changes(arm, stage));
    let scenario_from =
        condition.and_then(|condition| condition.scenario.as_ref()).unwrap_or(&stage.scenario).clone();
    for name in [&scenario_from, &stage.preset] {
        check_no_pipe(from, name)?;
    }
    let scenario = shipped::scenario(&resolve(from, &scenario_from));
    let (mut scenario, mut preset) = match (scenario, shipped::preset(&resolve(from, &stage.preset))) {
        (Ok(scenario), Ok(preset)) => (scenario, preset),
        (Err(scenario), Err(preset)) => return Err(scenario.with_problems_of(preset).into()),
        (Err(error), _) | (_, Err(error)) => return Err(error.into()),
    };
    preset.budget = stage.budget.unwrap_or(preset.budget);
    preset.evaluation = experiment.evaluation.unwrap_or(preset.evaluation);
    // The experiment tests its policies itself.
    preset.evaluation.final_episodes = 0;
    let owners = [
        Some((format!("arm \"{}\"", arm.name), &stage.overrides)),
        condition.map(|condition| (format!("condition \"{}\"", condition.name), &condition.overrides)),
        Some(("all stages".into(), &experiment.overrides)),
    ];
    let mut problems = Vec::new();
    for (owner, overrides) in owners.into_iter().flatten() {
        let context = format!("{owner}, {scenario_from} with {}", stage.preset);
        let (mut changed, mut changed_preset) = (scenario.clone(), preset.clone());
        match overrides.apply(&mut changed, &mut changed_preset) {
            Ok(()) => (scenario, preset) = (changed, changed_preset),
            Err(errors) => {
                problems.extend(errors.iter().map(|error| format!("overrides of {context}: {error}")));
            }
        }
    }
    if !problems.is_empty() {
        return Err(FileError::for_file(Path::new(from), problems.join("\n")).into());
    }
    if experiment.is_quick {
        shorten_training(&mut preset);
    }
    Ok(RunConfig::new((scenario_from, scenario), (stage.preset.clone(), preset), seed))
}

/// The name of a run's folder: equal configurations have equal names. The name depends on the budget only if the best
/// policy is tested. Otherwise a longer run contains the shorter one.
///
/// # Errors
/// The configuration cannot be written as RON.
pub fn run_name(config: &RunConfig, tested: TestedPolicy) -> Result<String, RunError> {
    // A report can be continued by a program of the same version from another commit.
    let mut identity = RunConfig { commit: None, ..config.clone() };
    identity.save_policy_after.clear();
    if tested == TestedPolicy::After {
        identity.preset.budget = match identity.preset.budget {
            Budget::Episodes(_) => Budget::Episodes(1),
            Budget::EnvSteps(_) => Budget::EnvSteps(1),
        };
    }
    let text = to_ron(&identity).map_err(|error| RunError::Failed(error.to_string()))?;
    let hash = crc32c::crc32c(text.as_bytes());
    let (scenario, preset) = (config.scenario_name(), config.preset_name());
    Ok(format!("{preset}-{scenario}-{hash:08x}-seed{}", config.seed))
}

/// Adds a number of episodes or env steps after which the policy is saved.
pub fn save_policy_after(config: &mut RunConfig, after: Budget) {
    if !config.save_policy_after.contains(&after) {
        config.save_policy_after.push(after);
        config.save_policy_after.sort_unstable();
    }
}

/// The path of a file relative to the experiment's folder if it exists there, else `name` itself. `name` may end with the seed
/// of a level, such as `:17`.
pub fn resolve(experiment: &str, name: &str) -> String {
    let path = resolve_as(experiment, name, Path::is_file);
    match shipped::split_seed(&path) {
        (file, Some(seed)) => format!("{}:{seed}", resolve_as(experiment, file, Path::is_file)),
        (_, None) => path,
    }
}

/// [`resolve`] for a folder.
pub fn resolve_folder(experiment: &str, name: &str) -> PathBuf {
    resolve_as(experiment, name, Path::is_dir).into()
}

fn resolve_as(experiment: &str, name: &str, exists: fn(&Path) -> bool) -> String {
    let path: PathBuf = Path::new(experiment).parent().unwrap_or(Path::new("")).join(name);
    if exists(&path) { path.display().to_string() } else { name.into() }
}

/// Checks that a file is not a pipe or device: an untrusted experiment might name one, and reading it might never end.
fn check_no_pipe(experiment: &str, name: &str) -> Result<(), RunError> {
    let path = resolve(experiment, name);
    let (file, _) = shipped::split_seed(&path);
    let path = Path::new(file);
    if path.exists() && !path.is_file() && !path.is_dir() {
        return Err(RunError::invalid_input(
            path,
            format!("{experiment} names it, but it is not a file; help: name a file"),
        ));
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_and_a_level_of_a_file_are_relative_to_the_experiment() {
        let folder = tempfile::tempdir().expect("a folder");
        let mine = folder.path().join("mine.ron");
        std::fs::write(&mine, "()").expect("written");
        let experiment = folder.path().join("experiment.ron").display().to_string();
        let resolved = |name: &str| resolve(&experiment, name);
        assert_eq!(resolved("mine.ron"), mine.display().to_string());
        assert_eq!(resolved("mine.ron:17"), format!("{}:17", mine.display()));
        assert_eq!(resolved("other.ron:17"), "other.ron:17");
        assert_eq!(resolved("clutter:17"), "clutter:17");
    }

    #[cfg(unix)]
    #[test]
    fn a_device_is_refused_with_and_without_a_seed() {
        for name in ["/dev/null", "/dev/null:17"] {
            assert!(check_no_pipe("experiment.ron", name).is_err(), "{name}");
        }
    }
}
