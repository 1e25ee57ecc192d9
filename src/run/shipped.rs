//! The scenarios, presets, experiments and trained policies that come with the program, by name: they work from any folder.
//!
//! In: what the user typed after `--scenario` or `--preset`: a file's path, or a shipped name. Out: the thing itself.

use std::path::Path;
use std::sync::LazyLock;

use super::preset::Preset;
use crate::policy::Policy;
use crate::scenario::{FileError, Scenario, closest_name, path_exists};

/// A file of the project, compiled in.
struct Shipped {
    name: &'static str,
    path: &'static str,
    text: &'static str,
}

macro_rules! shipped {
    ($folder:literal: $($name:literal),+ $(,)?) => {
        &[$(Shipped {
            name: $name,
            path: concat!($folder, "/", $name, ".ron"),
            text: include_str!(concat!("../../", $folder, "/", $name, ".ron")),
        }),+]
    };
}

const SCENARIOS: &[Shipped] = shipped!(
    "scenarios": "scenario-1", "scenario-2", "empty", "corridor", "doorway", "slalom", "random-field", "u-trap", "crossing",
    "crowd", "hall", "maze"
);
const PRESETS: &[Shipped] = shipped!("assets/presets": "fast", "dqn", "per_d3qn", "per_d3qn_tuned");

const EXPERIMENTS: &[Shipped] = shipped!("assets/experiments": "fig8", "fig9", "fig10", "best", "ablation", "conditions", "hard", "transfer");

/// Experts: what a training has come to in the scenario of that name (`assets/policies/README.md`).
const POLICIES: &[(&str, &[u8])] = &[
    ("scenario-1", include_bytes!("../../assets/policies/scenario-1.safetensors")),
    ("scenario-2", include_bytes!("../../assets/policies/scenario-2.safetensors")),
];

/// The trained policies that come with the program, by the name of the scenario that each learnt in. (A test sees to it
/// that each can be read, and drives well.)
pub fn policies() -> &'static [(&'static str, Policy)] {
    static READ: LazyLock<Vec<(&str, Policy)>> = LazyLock::new(|| {
        POLICIES.iter().filter_map(|(name, bytes)| Some((*name, Policy::from_bytes(bytes).ok()?))).collect()
    });
    &READ
}

/// The experiments that come with the program: path in the project, text. Parsing them is the business of the room
/// that carries them out.
pub fn experiments() -> impl Iterator<Item = (&'static str, &'static str)> {
    EXPERIMENTS.iter().map(|file| (file.path, file.text))
}

/// Whether a scenario of this name is shipped.
pub fn is_scenario(name: &str) -> bool {
    SCENARIOS.iter().any(|file| file.name == name)
}

/// Whether a preset of this name is shipped.
pub fn is_preset(name: &str) -> bool {
    PRESETS.iter().any(|file| file.name == name)
}

/// The text of the shipped scenario of that name.
pub fn scenario_text(name: &str) -> Option<&'static str> {
    SCENARIOS.iter().find(|file| file.name == name).map(|file| file.text)
}

/// Whether `scenario` is the paper's Scenario I as it is shipped.
pub fn is_paper_scenario_1(scenario: &Scenario) -> bool {
    static FIRST: LazyLock<Option<Scenario>> = LazyLock::new(|| scenarios().next().map(|(_, first)| first));
    FIRST.as_ref() == Some(scenario)
}

/// The shipped scenarios, by name. (A test sees to it that each can be read.)
pub fn scenarios() -> impl Iterator<Item = (&'static str, Scenario)> {
    SCENARIOS.iter().filter_map(|file| Some((file.name, Scenario::parse(file.text, file.path).ok()?)))
}

/// The shipped presets, by name. (A test sees to it that each can be read.)
pub fn presets() -> impl Iterator<Item = (&'static str, Preset)> {
    PRESETS.iter().filter_map(|file| Some((file.name, Preset::parse(file.text, file.path).ok()?)))
}

/// The scenario at the path `wanted`, or the shipped one of that name.
///
/// # Errors
/// With file, line, column and mend, as [`Scenario::load`].
pub fn scenario(wanted: &str) -> Result<Scenario, FileError> {
    match find(SCENARIOS, wanted) {
        Some(file) => Scenario::parse(file.text, file.path),
        None => Scenario::load(wanted).map_err(|error| with_names(error, wanted, SCENARIOS)),
    }
}

/// The preset at the path `wanted`, or the shipped one of that name.
///
/// # Errors
/// With file, line, column and mend, as [`Preset::load`].
pub fn preset(wanted: &str) -> Result<Preset, FileError> {
    match find(PRESETS, wanted) {
        Some(file) => Preset::parse(file.text, file.path),
        None => Preset::load(wanted).map_err(|error| with_names(error, wanted, PRESETS)),
    }
}

/// A shipped file is meant if no file of the user's has that path, and the name (or the path it has in the project)
/// is one of those shipped.
fn find<'a>(files: &'a [Shipped], wanted: &str) -> Option<&'a Shipped> {
    // (A folder that happens to be called `hall` is no scenario.)
    let path = Path::new(wanted);
    if path_exists(path) && !path.is_dir() {
        return None;
    }
    files.iter().find(|file| file.name == wanted || file.path == wanted)
}

/// For a name that is neither a file nor shipped: the error also says what is shipped.
fn with_names(error: FileError, wanted: &str, files: &[Shipped]) -> FileError {
    if path_exists(Path::new(wanted)) {
        return error;
    }
    let names: Vec<&str> = files.iter().map(|file| file.name).collect();
    if wanted.contains(['/', '\\', '.']) {
        let shipped = names.join(", ");
        return FileError::for_file(
            error.path(),
            format!("{}; shipped by name: {shipped}", error.problems()[0].message),
        );
    }
    let fix = match closest_name(wanted, names.iter().copied()) {
        Some(name) => format!("did you mean `{name}`?"),
        None => "give a file's path or a shipped name.".into(),
    };
    let message =
        format!("no such file, and nothing of that name is shipped: {fix} Shipped: {}", names.join(", "));
    FileError::for_file(Path::new(wanted), message)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    use crate::run::evaluate::{Evaluation, Evaluator};
    use crate::task::EpisodeSetup;

    #[test]
    fn everything_shipped_loads_by_name() {
        for file in SCENARIOS {
            if let Err(error) = scenario(file.name) {
                panic!("{error}");
            }
        }
        for file in PRESETS {
            if let Err(error) = preset(file.name) {
                panic!("{error}");
            }
        }
    }

    #[test]
    fn the_experts_are_experts() {
        assert_eq!(policies().len(), POLICIES.len(), "each can be read");
        for (name, policy) in policies() {
            let scenario = Arc::new(scenario(name).expect("shipped"));
            assert_eq!(policy.metadata.get("scenario"), Some(&scenario.name), "{name}");
            let episodes = 500;
            let driven = Evaluator::new(&scenario, episodes)
                .run(policy, 5, episodes, EpisodeSetup::Random)
                .expect("it fits its scenario");
            let rate = Evaluation::from_episodes(&driven, episodes, &scenario.task, 5).success_rate;
            assert!(rate >= 0.98, "{name}: {rate}");
        }
    }

    #[test]
    fn a_mistyped_name_is_answered_with_the_nearest() {
        let error = preset("fsat").unwrap_err().to_string();
        assert_eq!(
            error,
            "fsat: no such file, and nothing of that name is shipped: did you mean `fast`? \
             Shipped: fast, dqn, per_d3qn, per_d3qn_tuned"
        );
    }
}
