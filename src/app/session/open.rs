//! Files opened in the app: a run or its checkpoint, a policy, a scenario, a map, a preset, a classical driver.
//!
//! In: a path. Out: training that resumes or starts, or a second driver to compare with; otherwise a notice with the
//! error.

use std::path::{Path, PathBuf};

use bevy::prelude::*;

use super::comparison::{compare_with, compare_with_driver, compare_with_map, open_driver};
use super::notices::{NoticeTopic, notify};
use super::saved_run::SavedRun;
use super::start_training;
use super::training_run::TrainingRun;
use crate::agent::{ActiveLearner, DriverKind};
use crate::app::app_status::{Choice, Severity};
use crate::drivers::{DriverConfig, DrivingPolicy};
use crate::policy::Policy;
use crate::run::folder::{RunConfig, RunFolder};
use crate::run::policy_card::WITH_MAP;
use crate::run::preset::Preset;
use crate::run::{RunError, evaluate, policy_card, scenario_set, shipped};
use crate::scenario::{LevelGenerator, Scenario, SetMember, path_exists, read_text, resemblance, utf8_path};

/// The kinds of files that can be opened.
const OPENABLE: &str = "a policy (.safetensors), a scenario, a preset or a classical driver (.ron), a map (.yaml, .sdf, .world), or a run folder";

/// The files that the user has opened. A new training run keeps them.
#[derive(Resource, Default)]
pub struct OpenedFiles {
    /// A second policy to compare with, and its name.
    pub policy: Option<(String, Policy)>,
    /// A classical driver, or a policy with a map, to compare with instead of `policy`, and its name.
    pub driver: Option<(String, DriverKind)>,
    /// The user's own scenarios.
    pub scenarios: Vec<Choice>,
    /// The user's own presets.
    pub presets: Vec<Choice>,
    /// A path that the user has tried to open once; a second attempt opens it and discards the unsaved training. `None` again
    /// after a save.
    pub(super) requested_once: Option<PathBuf>,
}

/// Opens the file at `path`, and reports the result or the error.
pub(super) fn open_or_notify(world: &mut World, path: &Path) {
    let topic = NoticeTopic::File(path.display().to_string());
    match open(world, path) {
        Ok(text) => notify(world, topic, Severity::Info, text),
        Err(error) => {
            notify(world, topic, Severity::Error, error.to_string());
            #[cfg(not(target_arch = "wasm32"))]
            if path.extension().is_some_and(|extension| extension == "ron") {
                use super::file_watch::{RetryAction, retry_when_fixed};
                retry_when_fixed(world, &path.display().to_string(), RetryAction::Open);
            }
        }
    }
}

/// Checks that opening `path` loses no unsaved training, or that the user has confirmed the loss by asking twice.
///
/// # Errors
/// Unsaved training would be lost, and the user asks for the first time.
fn confirm_by_repeating(world: &mut World, path: &Path) -> Result<(), RunError> {
    let learner = &world.resource::<ActiveLearner>().0;
    let (env_steps, episodes) = (learner.env_steps(), learner.episodes());
    let would_lose = world.resource::<TrainingRun>().would_lose_training(env_steps);
    let requested_once = &mut world.resource_mut::<OpenedFiles>().requested_once;
    if !would_lose || requested_once.as_deref() == Some(path) {
        *requested_once = None;
        return Ok(());
    }
    *requested_once = Some(path.into());
    Err(RunError::InvalidInput(format!(
        "The unsaved training run of {episodes} episodes would be lost\nhelp: save the {} first, or open {} again",
        if cfg!(target_arch = "wasm32") { "policy" } else { "run" },
        path.display()
    )))
}

/// Opens a run's folder or its checkpoint, a policy, a scenario, a map, a preset or a classical driver. Returns a confirmation
/// for the user.
pub(super) fn open(world: &mut World, path: &Path) -> Result<String, RunError> {
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    if path.is_dir() {
        return resume(world, path, path);
    }
    if let Some(policy) = name.strip_suffix(WITH_MAP)
        && !path_exists(path)
    {
        let policy = read_policy(&path.with_file_name(policy))?;
        return compare_with_map(world, &name, policy);
    }
    if let Some(policy) = shipped::policy(path) {
        return open_policy(world, path, policy.clone());
    }
    match path.extension().and_then(|extension| extension.to_str()) {
        Some("bin") => {
            let folder = path.parent().and_then(Path::parent);
            let folder =
                folder.filter(|folder| path_exists(&folder.join(RunFolder::CONFIG_FILE))).ok_or_else(
                    || RunError::invalid_input(path, format!("not part of a run\nhelp: open {OPENABLE}")),
                )?;
            resume(world, path, folder)
        }
        Some("safetensors") => open_policy(world, path, policy_card::read(path)?),
        Some("ron") => open_ron(world, path),
        Some(_) if crate::import::is_map_or_world(path) => open_map_or_world(world, path),
        Some(_) if crate::import::is_image(path) => {
            let advice = if cfg!(target_arch = "wasm32") {
                "together with it"
            } else {
                "that names it, or import it with wayfield --import FILE --resolution METRES"
            };
            let why = format!("an image does not state its scale\nhelp: open the map (.yaml) {advice}");
            Err(RunError::invalid_input(path, why))
        }
        None if !path_exists(path) && DriverConfig::shipped(&name).is_some() => open_driver(world, &name),
        _ => Err(RunError::invalid_input(path, format!("cannot be opened\nhelp: open {OPENABLE}"))),
    }
}

/// Reads the policy in the file at `path`, or the shipped one with this name.
fn read_policy(path: &Path) -> Result<Policy, RunError> {
    shipped::policy(path).map_or_else(|| policy_card::read(path), |policy| Ok(policy.clone()))
}

/// Lets `policy`, which is called `path`, drive next to the tested policy.
fn open_policy(world: &mut World, path: &Path, policy: Policy) -> Result<String, RunError> {
    let config = &world.resource::<TrainingRun>().config;
    check_can_drive(config, &path.display().to_string(), &policy)?;
    let name = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy().into_owned();
    let text = format!("{name} drives next to the tested policy");
    compare_with(world, (name, policy))?;
    Ok(text)
}

/// Whether the text of a file that is not a valid scenario is meant as a preset.
pub(super) fn is_preset(text: &str) -> bool {
    resemblance::<Preset>(text, "Preset") > resemblance::<Scenario>(text, "Scenario")
}

/// Whether the text of a file is meant as a set of scenarios, or as a level generator, which is the set of its levels.
pub(super) fn is_set(text: &str) -> bool {
    scenario_set::looks_like(text) || LevelGenerator::looks_like(text)
}

/// Resumes the run in `folder`. `path` is what the user opened: the folder itself, or its checkpoint.
fn resume(world: &mut World, path: &Path, folder: &Path) -> Result<String, RunError> {
    let extensions = world.resource::<TrainingRun>().config.extensions.clone();
    let saved = SavedRun::from_folder(folder, &extensions)?;
    confirm_by_repeating(world, path)?;
    saved.start(world);
    let name = folder.file_name().unwrap_or(folder.as_os_str()).to_string_lossy();
    Ok(format!("Resumed the run {name}"))
}

/// Starts training in the map or the Gazebo world at `path`.
fn open_map_or_world(world: &mut World, path: &Path) -> Result<String, RunError> {
    let from = utf8_path(path)?;
    shipped::scenario(from)?;
    confirm_by_repeating(world, path)?;
    let RunConfig { preset_from, seed, .. } = &world.resource::<TrainingRun>().config;
    let (preset_from, seed) = (preset_from.clone(), *seed);
    start_training::start_training(world, from, &preset_from, seed)?;
    let config = &world.resource::<TrainingRun>().config;
    Ok(format!("Training started in {}", config.scenario_title()))
}

/// Starts training with a scenario, a set of scenarios or a preset; or lets a classical driver drive.
fn open_ron(world: &mut World, path: &Path) -> Result<String, RunError> {
    let from = utf8_path(path)?.to_owned();
    let text = read_text(path)?;
    if DriverConfig::looks_like(&text) {
        let driver = DriverConfig::parse(&text, path)?;
        let file = path.file_name().unwrap_or(path.as_os_str()).to_string_lossy();
        return compare_with_driver(
            world,
            format!("{}, {file}", driver.title()),
            DriverKind::Classical(driver),
        );
    }
    let RunConfig { scenario_from, preset_from, seed, .. } = &world.resource::<TrainingRun>().config;
    let (scenario_from, preset_from, seed) = (scenario_from.clone(), preset_from.clone(), *seed);
    if is_set(&text) {
        shipped::scenario_or_set(&from)?;
        confirm_by_repeating(world, path)?;
        start_training::start_training(world, &from, &preset_from, seed)?;
        let config = &world.resource::<TrainingRun>().config;
        return Ok(format!("Training started in the scenarios of {}", config.scenario_title()));
    }
    match Scenario::parse(&text, path) {
        Ok(scenario) => {
            confirm_by_repeating(world, path)?;
            start_training::start_training(world, &from, &preset_from, seed)?;
            Ok(format!("Training started in {}", scenario.name))
        }
        Err(error) => {
            let is_preset = is_preset(&text);
            let preset =
                Preset::parse(&text, path).map_err(|as_preset| if is_preset { as_preset } else { error })?;
            confirm_by_repeating(world, path)?;
            let scenario_from = preset.scenario.unwrap_or(scenario_from);
            start_training::start_training(world, &scenario_from, &from, seed)?;
            let preset = world.resource::<TrainingRun>().config.preset_name();
            Ok(format!("Training started with the preset {preset}"))
        }
    }
}

/// Checks that `policy`, called `name`, can drive in the scenario of `config`, or in all scenarios of its set.
///
/// # Errors
/// The reason why the policy cannot drive there.
pub(super) fn check_can_drive(config: &RunConfig, name: &str, policy: &Policy) -> Result<(), RunError> {
    let check = || {
        let layout = config.observation_layout();
        evaluate::check_compatible(policy, &config.scenario, &layout)?;
        if !policy_card::fits_every_robot(policy) {
            let members = config.scenario_set.iter().flat_map(|set| &set.members);
            members.map(task_of).try_for_each(|task| evaluate::check_compatible(policy, &task, &layout))?;
        }
        if matches_training(config, policy)? { Ok(()) } else { policy_card::check_without_sensors(policy) }
    };
    check().map_err(|error: RunError| RunError::InvalidInput(format!("{name}: {error}")))
}

/// Robot, LIDAR and rules of a member of a set, in a scenario without anything else.
fn task_of(member: &SetMember) -> Scenario {
    let (robot, lidar, task) = member.source.task();
    let (robot, lidar, task) = (robot.clone(), lidar.clone(), task.clone());
    Scenario { name: member.name.clone(), robot, lidar, task, ..Scenario::default() }
}

/// Whether `policy` has the observations and actions of the training run `config`. Otherwise it drives like a classical driver,
/// from percepts (scan, goal and speed).
pub(super) fn matches_training(config: &RunConfig, policy: &Policy) -> Result<bool, RunError> {
    let own = (policy_card::encoding(policy)?, policy_card::action_set(policy));
    Ok(own == (config.preset.observation, config.preset.actions.clone()))
}

/// Checks that `driver`, called `name`, can drive in the scenario of `config`: a policy must fit; a classical driver always does.
///
/// # Errors
/// The reason why it cannot drive there.
pub(super) fn check_driver(config: &RunConfig, name: &str, driver: &DriverKind) -> Result<(), RunError> {
    let DriverKind::Policy(DrivingPolicy { policy, .. }) = driver else { return Ok(()) };
    check_can_drive(config, name, policy)?;
    policy_card::check_without_sensors(policy)
        .map_err(|error| RunError::InvalidInput(format!("{name}: {error}")))
}

/// Adds the current scenario (or set of scenarios) and the current preset to the lists in [`OpenedFiles`], unless
/// they are shipped.
pub(super) fn list_user_files(world: &mut World) {
    let config = &world.resource::<TrainingRun>().config;
    let RunConfig { scenario_from, preset_from, scenario, preset, .. } = config;
    let is_shipped = shipped::is_scenario(scenario_from)
        || shipped::is_level_generator(scenario_from)
        || shipped::is_set(scenario_from);
    let scenario = (!is_shipped).then(|| Choice {
        from: scenario_from.clone(),
        title: config.scenario_title().into(),
        about: match &config.scenario_set {
            Some(_) => format!("Scenarios: {}", config.member_names().collect::<Vec<_>>().join(", ")),
            None => scenario.about.clone(),
        },
    });
    let preset = (!shipped::is_preset(preset_from)).then(|| Choice {
        from: preset_from.clone(),
        title: config.preset_name(),
        about: preset.about.clone(),
    });
    let opened = world.resource_mut::<OpenedFiles>().into_inner();
    add(&mut opened.scenarios, scenario);
    add(&mut opened.presets, preset);
}

fn add(choices: &mut Vec<Choice>, choice: Option<Choice>) {
    let Some(choice) = choice else { return };
    choices.retain(|other| other.from != choice.from);
    choices.push(choice);
}
