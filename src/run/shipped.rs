//! The shipped scenarios, level generators, sets, suites, presets, experiments and trained policies, compiled into the program.
//!
//! In: a file's path or a shipped name, as given after `--scenario` or `--preset`. Out: the scenario, set or preset.

mod source;

use std::path::Path;
use std::sync::LazyLock;

pub use self::source::Source;
pub use self::source::split_seed;
use super::folder::RunConfig;
use super::policy_card;
use super::preset::Preset;
use crate::policy::Policy;
use crate::scenario::{
    FileError, LevelGenerator, Scenario, ScenarioSet, closest_name, path_exists, read_text,
};

/// A shipped file.
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
const GENERATORS: &[Shipped] = shipped!(
    "scenarios/generators": "clutter", "rooms", "traffic", "mixed", "pedestrians", "circle-crossing"
);
/// The level generators of the set `general`.
const GENERAL_GENERATORS: &[Shipped] = shipped!(
    "scenarios/generators": "general/clutter-small", "general/clutter-fine", "general/clutter-noisy", "general/clutter-fast",
    "general/clutter-agile", "general/caves-fine", "general/caves-fast", "general/rooms-small",
    "general/rooms-noisy", "general/traffic-small", "general/traffic-agile", "general/traffic-noisy",
    "general/mixed-small", "general/mixed-noisy", "general/crowd-small", "general/crowd-agile",
    "general/crossing-small", "general/crossing-agile", "general/orbits-small", "general/orbits-agile"
);
const SETS: &[Shipped] = shipped!("scenarios/sets": "general");
const SUITES: &[Shipped] =
    shipped!("scenarios/suites": "shipped", "validation", "general", "circle-crossing");
const PRESETS: &[Shipped] =
    shipped!("assets/presets": "fast", "general", "dqn", "per_d3qn", "per_d3qn_tuned");

const EXPERIMENTS: &[Shipped] = shipped!("assets/experiments": "fig8", "fig9", "fig10", "best", "ablation", "conditions", "hard", "transfer");

/// Trained policies, by the name of their scenario or set (`assets/policies/README.md`).
const POLICIES: &[(&str, &[u8])] = &[
    ("scenario-1", include_bytes!("../../assets/policies/scenario-1.safetensors")),
    ("scenario-2", include_bytes!("../../assets/policies/scenario-2.safetensors")),
    ("general", include_bytes!("../../assets/policies/general.safetensors")),
];

/// A shipped policy.
pub struct ShippedPolicy {
    /// The shipped name of the scenario or the set that it was trained in.
    pub scenario_from: &'static str,
    /// The name that its card gives that scenario.
    pub trained_in: String,
    /// The scenario as its card has it.
    pub scenario: Option<Scenario>,
    /// The policy.
    pub policy: Policy,
}

impl ShippedPolicy {
    /// Whether it is the general policy, which drives every robot with every LIDAR.
    #[must_use]
    pub fn is_general(&self) -> bool {
        policy_card::fits_every_robot(&self.policy)
    }

    /// Whether it was trained in exactly the scenario of `config`.
    #[must_use]
    pub fn is_at_home_in(&self, config: &RunConfig) -> bool {
        let is_scenario = config.scenario_set.is_none() && self.scenario.as_ref() == Some(&config.scenario);
        !self.is_general() && is_scenario
    }
}

/// The shipped policies.
pub fn policies() -> &'static [ShippedPolicy] {
    static READ: LazyLock<Vec<ShippedPolicy>> = LazyLock::new(|| {
        let read = |&(scenario_from, bytes): &(&'static str, &[u8])| {
            let policy = Policy::from_bytes(bytes).ok()?;
            let trained_in = policy_card::scenario_name(&policy).unwrap_or_else(|| scenario_from.into());
            let scenario = policy_card::own_scenario(&policy).ok().flatten();
            Some(ShippedPolicy { scenario_from, trained_in, scenario, policy })
        };
        POLICIES.iter().filter_map(read).collect()
    });
    &READ
}

/// The shipped policy with the name `path`; `None` if there is none, or a file with this path.
pub fn policy(path: &Path) -> Option<&'static Policy> {
    let is_file = path_exists(path) && !path.is_dir();
    let named = policies().iter().find(|shipped| path == Path::new(shipped.scenario_from));
    named.filter(|_| !is_file).map(|shipped| &shipped.policy)
}

/// The shipped experiments: path in the project, text. [`reproduce`](crate::reproduce) parses them.
pub fn experiments() -> impl Iterator<Item = (&'static str, &'static str)> {
    EXPERIMENTS.iter().map(|file| (file.path, file.text))
}

/// Whether `name` is a shipped scenario.
pub fn is_scenario(name: &str) -> bool {
    SCENARIOS.iter().any(|file| file.name == name)
}

/// Whether `name` is a shipped level generator, other than those of the set `general`.
pub fn is_level_generator(name: &str) -> bool {
    GENERATORS.iter().any(|file| file.name == name)
}

/// Whether `name` is a shipped set of scenarios.
pub fn is_set(name: &str) -> bool {
    SETS.iter().any(|file| file.name == name)
}

/// Whether `name` is a shipped preset.
pub fn is_preset(name: &str) -> bool {
    PRESETS.iter().any(|file| file.name == name)
}

/// Whether `wanted` is the name or the project path of a shipped scenario, level generator, set, suite or preset, or the name of a
/// shipped policy, and no file of the user.
pub fn is_any(wanted: &str) -> bool {
    let kinds = [SCENARIOS, GENERATORS, GENERAL_GENERATORS, SETS, SUITES, PRESETS];
    let is_policy = POLICIES.iter().any(|(name, _)| *name == wanted);
    is_policy || kinds.iter().any(|files| find(files, wanted).is_some())
}

/// The names of the shipped presets.
pub fn preset_names() -> impl Iterator<Item = &'static str> {
    PRESETS.iter().map(|file| file.name)
}

/// The path in the project, and the text, of the shipped preset `name`.
pub fn preset_text(name: &str) -> Option<(&'static str, &'static str)> {
    PRESETS.iter().find(|file| file.name == name).map(|file| (file.path, file.text))
}

/// The title of the shipped preset `name`, to be displayed.
pub fn preset_title(name: &str) -> Option<&'static str> {
    match name {
        "fast" => Some("Fast"),
        "general" => Some("General"),
        "dqn" => Some("DQN"),
        "per_d3qn" => Some("PER-D3QN"),
        "per_d3qn_tuned" => Some("PER-D3QN, tuned"),
        _ => None,
    }
}

/// The text of the shipped scenario `name`.
pub fn scenario_text(name: &str) -> Option<&'static str> {
    SCENARIOS.iter().find(|file| file.name == name).map(|file| file.text)
}

/// The text of the shipped suite with the name or project path `wanted`, and its path in the project, unless the user has a file
/// at that path.
pub fn suite_text(wanted: &str) -> Option<(&'static str, &'static str)> {
    find(SUITES, wanted).map(|file| (file.text, file.path))
}

/// Whether `scenario` is the paper's Scenario I, so that the paper's numbers apply: whether everything but its name and
/// description is as in the shipped file.
pub fn is_paper_scenario_1(scenario: &Scenario) -> bool {
    static FIRST: LazyLock<Option<Scenario>> = LazyLock::new(|| scenarios().next().map(|(_, first)| first));
    FIRST.as_ref().is_some_and(|first| {
        // Every field is named, so that a new one is not forgotten.
        let Scenario {
            name: _,
            about: _,
            enclosure,
            walls,
            obstacles,
            generators,
            robot,
            lidar,
            task,
            starts,
            goals,
            benchmark_route,
        } = scenario;
        (enclosure, walls, obstacles, generators)
            == (&first.enclosure, &first.walls, &first.obstacles, &first.generators)
            && (robot, lidar, task) == (&first.robot, &first.lidar, &first.task)
            && (starts, goals, benchmark_route) == (&first.starts, &first.goals, &first.benchmark_route)
    })
}

/// The shipped scenarios, by name.
pub fn scenarios() -> impl Iterator<Item = (&'static str, Scenario)> {
    SCENARIOS.iter().filter_map(|file| Some((file.name, Scenario::parse(file.text, file.path).ok()?)))
}

/// The shipped presets, by name.
pub fn presets() -> impl Iterator<Item = (&'static str, Preset)> {
    PRESETS.iter().filter_map(|file| Some((file.name, Preset::parse(file.text, file.path).ok()?)))
}

/// The shipped level generators, by name, without those of the set `general`.
pub fn level_generators() -> impl Iterator<Item = (&'static str, LevelGenerator)> {
    GENERATORS.iter().filter_map(|file| Some((file.name, LevelGenerator::parse(file.text, file.path).ok()?)))
}

/// The scenario in the file `wanted`, which may be the `config.ron` of a run, or the shipped scenario of that name. For a
/// level generator, it is the level that `wanted` names ([`Source::load`]), or level 0.
///
/// # Errors
/// As for [`Source::load`]; also if it is a set of scenarios. The message names its scenarios.
pub fn scenario(wanted: &str) -> Result<Scenario, FileError> {
    Source::load(wanted)?.into_scenario(wanted)
}

/// The scenario `wanted`, as for [`scenario`]; or, if `wanted` is the file of a set of scenarios or the `config.ron` of a run
/// with a set, the first scenario of the set, and the set. A level generator is the set of its levels.
///
/// # Errors
/// As for [`Source::load`]; or a scenario of the set cannot be used.
pub fn scenario_or_set(wanted: &str) -> Result<(Scenario, Option<ScenarioSet>), FileError> {
    match Source::load(wanted)? {
        Source::Scenario(scenario) => Ok((scenario, None)),
        Source::Set(first, set) => Ok((*first, Some(set))),
        Source::Levels(generator) => {
            let set = ScenarioSet::of_levels(generator.clone());
            Ok((Source::Levels(generator).into_scenario(wanted)?, Some(set)))
        }
    }
}

/// The preset in the file `wanted`, which may be the `config.ron` of a run, or the shipped preset of that name.
///
/// # Errors
/// As for [`Preset::load`]. For an unknown name, the message names the closest shipped one.
pub fn preset(wanted: &str) -> Result<Preset, FileError> {
    match find(PRESETS, wanted) {
        Some(file) => Preset::parse(file.text, file.path),
        None => user_file(wanted, PRESETS, |text| Preset::parse(text, wanted), |config| config.preset),
    }
}

/// Reads the user's file `wanted` with `parse`; if it is the `config.ron` of a run, returns `part` of it.
fn user_file<T>(
    wanted: &str,
    shipped: &[Shipped],
    parse: impl Fn(&str) -> Result<T, FileError>,
    part: fn(RunConfig) -> T,
) -> Result<T, FileError> {
    let text = read_text(wanted).map_err(|error| with_names(error, wanted, shipped))?;
    if RunConfig::looks_like(&text) {
        return RunConfig::parse(&text, Path::new(wanted)).map(part);
    }
    parse(&text)
}

/// The shipped file with the name or project path `wanted`, unless the user has a file at that path.
fn find<'a>(files: &'a [Shipped], wanted: &str) -> Option<&'a Shipped> {
    // A folder that happens to be called `hall` does not hide the shipped scenario.
    let path = Path::new(wanted);
    if path_exists(path) && !path.is_dir() {
        return None;
    }
    files.iter().find(|file| file.name == wanted || file.path == wanted)
}

/// Adds the shipped names to the error for a missing file.
fn with_names(error: FileError, wanted: &str, files: &[Shipped]) -> FileError {
    if path_exists(Path::new(wanted)) {
        return error;
    }
    let names: Vec<&str> = files.iter().map(|file| file.name).collect();
    if wanted.contains(['/', '\\', '.']) {
        let shipped = names.join(", ");
        return FileError::for_file(
            error.path(),
            format!("{}; shipped names: {shipped}", error.problems()[0].message),
        );
    }
    let fix = match closest_name(wanted, names.iter().copied()) {
        Some(name) => format!("did you mean `{name}`?"),
        None => "give a file's path or a shipped name".into(),
    };
    let message = format!("no such file or shipped name; help: {fix} (shipped: {})", names.join(", "));
    FileError::for_file(Path::new(wanted), message)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Arc;

    use crate::run::evaluate::{Evaluation, Evaluator};
    use crate::run::settings::Settings;
    use crate::run::suite::Suite;
    use crate::task::EpisodeSetup;

    #[test]
    fn everything_shipped_loads_by_name() {
        for file in SCENARIOS {
            if let Err(error) = scenario(file.name) {
                panic!("{error}");
            }
        }
        assert_eq!(level_generators().count(), GENERATORS.len(), "every level generator is valid");
        for file in GENERAL_GENERATORS {
            assert!(matches!(Source::load(file.name), Ok(Source::Levels(_))), "{}", file.name);
        }
        for file in SETS {
            assert!(matches!(Source::load(file.name), Ok(Source::Set(..))), "{}", file.name);
        }
        for file in SUITES {
            if let Err(error) = Suite::load(file.name, &Settings::default(), None) {
                panic!("{error}");
            }
        }
        for file in PRESETS {
            if let Err(error) = preset(file.name) {
                panic!("{error}");
            }
            assert!(preset_title(file.name).is_some(), "{} has a title", file.name);
        }
    }

    #[test]
    fn the_shipped_policies_of_one_scenario_succeed_in_at_least_98_percent_of_episodes() {
        assert_eq!(policies().len(), POLICIES.len(), "every policy can be read");
        let of_one_scenario = policies().iter().filter(|policy| !policy.is_general());
        for ShippedPolicy { scenario_from: name, policy, .. } in of_one_scenario {
            let scenario = Arc::new(scenario(name).expect("shipped"));
            let own = policy_card::own_scenario(policy).expect("a valid card");
            assert_eq!(own.as_ref(), Some(&*scenario), "{name}: the card has the shipped scenario");
            let count = 500;
            let episodes = Evaluator::new(&scenario, count)
                .run(policy, 5, count, EpisodeSetup::Random)
                .expect("the policy fits its scenario");
            let rate = Evaluation::from_episodes(&episodes, count, &scenario.task, 5).success_rate;
            assert!(rate >= 0.98, "{name}: {rate}");
        }
    }

    /// `policy` with the card that this version writes. Its training data and its program stay as they were.
    fn with_current_card(policy: &Policy) -> Policy {
        let mut policy = policy.clone();
        let card = policy.card.take().expect("a card");
        let training = &card.training;
        let config = RunConfig::resolve(&training.scenario_from, &training.preset, training.seed);
        let steps = (training.env_steps, training.gradient_steps);
        policy_card::attach(&mut policy, &config.expect("shipped"), steps, training.success_rate);
        policy.card.as_mut().expect("a card").program = card.program.clone();
        policy
    }

    #[test]
    fn the_cards_of_the_shipped_policies_are_up_to_date() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("assets/policies");
        for (name, _) in POLICIES {
            // The file itself: a program that was built before the file was replaced contains the old policy.
            let path = folder.join(format!("{name}.safetensors"));
            let bytes = std::fs::read(&path).expect("a file");
            let policy = Policy::from_bytes(&bytes).expect("a policy");
            let current = with_current_card(&policy).to_bytes().expect("a valid card");
            if std::env::var_os("WAYFIELD_RENEW").is_some() {
                std::fs::write(path, current).expect("a writable file");
            } else {
                assert!(current == bytes, "{name}: the card is out of date; help: cargo xtask policies");
            }
        }
    }

    #[test]
    fn the_commands_in_the_readme_of_the_policies_are_those_on_their_cards() {
        let readme = include_str!("../../assets/policies/README.md");
        for ShippedPolicy { scenario_from, policy, .. } in policies() {
            let training = &policy.card.as_ref().expect("a card").training;
            let options = match *scenario_from {
                "scenario-1" => String::new(),
                "general" => " --preset general".into(),
                other => format!(" --scenario {other}"),
            };
            let command = format!("`cargo train{options} --seed {}`", training.seed);
            assert!(readme.contains(&command), "{scenario_from}: {command}");
        }
    }

    #[test]
    fn the_paper_s_scenario_is_recognized_by_its_contents_not_by_its_name() {
        let paper_scenario = scenario("scenario-1").expect("shipped");
        assert!(is_paper_scenario_1(&paper_scenario));
        let renamed = Scenario { name: "Office".into(), about: String::new(), ..paper_scenario.clone() };
        assert!(is_paper_scenario_1(&renamed));
        let changes: [fn(&mut Scenario); 5] = [
            |s| s.obstacles[0].position_m.x += 0.01,
            |s| s.task.goal_radius_m = 0.3,
            |s| s.robot.radius_m = 0.11,
            |s| s.lidar.noise_std_m = 0.01.into(),
            |s| s.benchmark_route = None,
        ];
        for (number, change) in changes.into_iter().enumerate() {
            let mut changed = paper_scenario.clone();
            change(&mut changed);
            assert!(!is_paper_scenario_1(&changed), "change {number}");
        }
        assert!(scenarios().skip(1).all(|(_, other)| !is_paper_scenario_1(&other)));
    }

    #[test]
    fn the_error_for_a_mistyped_name_suggests_the_closest_one() {
        let error = preset("fsat").unwrap_err().to_string();
        assert_eq!(
            error,
            "fsat: no such file or shipped name; help: did you mean `fast`? (shipped: fast, general, dqn, per_d3qn, per_d3qn_tuned)"
        );
    }
}
