//! The second driver of a comparison, next to the tested policy (the current or the best one): an expert (a shipped policy),
//! the best policy so far, a policy that the user opens, a policy with a map, or a classical driver.
//!
//! In: a command. Out: [`OpenedFiles::policy`] or [`OpenedFiles::driver`], and the mode Compare.

use bevy::prelude::World;

use super::active_mode::{ActiveMode, restart_demo, set_mode};
use super::evaluations::Evaluations;
use super::notices::{NoticeTopic, Notices, notify};
use super::open::{OpenedFiles, check_can_drive, check_driver};
use super::session_policy;
use super::training_run::TrainingRun;
use crate::agent::DriverKind;
use crate::app::app_status::Severity;
use crate::app::commands::{PolicySource, SessionMode};
use crate::drivers::DriverConfig;
use crate::policy::Policy;
use crate::run::folder::RunConfig;
use crate::run::shipped::ShippedPolicy;
use crate::run::{RunError, policy_card, shipped};

/// What the user can do while a robot drives.
const GOAL_HINT: &str = "Click on the floor to set the goal";

/// Lets a shipped policy drive next to the tested one. Returns a confirmation.
///
/// # Errors
/// No shipped policy can drive here, or the tested one cannot.
pub(super) fn open_expert(world: &mut World) -> Result<String, RunError> {
    let config = &world.resource::<TrainingRun>().config;
    let expert = expert_here(config)?;
    let (name, here) = (expert_name(expert), config.scenario_title());
    let mut text = format!("The {name} drives next to the tested policy.");
    if expert.trained_in != here {
        text += &format!(" It was not trained in {here}.");
    }
    text += &format!(" {GOAL_HINT}");
    compare_with(world, (capitalized(&name), expert.policy.clone()))?;
    Ok(text)
}

/// Lets the classical driver `name`, with its default parameters, drive next to the tested policy. Returns a confirmation.
///
/// # Errors
/// There is no such driver, or the tested policy cannot drive here.
pub(super) fn open_driver(world: &mut World, name: &str) -> Result<String, RunError> {
    let unknown = || RunError::InvalidInput(format!("{name}: no such driver"));
    let driver = DriverConfig::shipped(name).ok_or_else(unknown)?;
    compare_with_driver(world, driver.title().into(), DriverKind::Classical(driver))
}

/// Lets `driver` drive next to the tested policy. Returns a confirmation.
///
/// # Errors
/// The driver or the tested policy cannot drive here.
pub(super) fn compare_with_driver(
    world: &mut World,
    name: String,
    driver: DriverKind,
) -> Result<String, RunError> {
    let text = format!("{name} drives next to the tested policy. {}", driver.class().about());
    compare(world, |opened| opened.driver = Some((name, driver)))?;
    Ok(text)
}

/// Lets the tested policy (the current or the best one) drive next to itself: once without and once with a map that it builds.
/// Returns a confirmation.
///
/// # Errors
/// The policy was trained with plugin sensors.
pub(super) fn open_with_map(world: &mut World) -> Result<String, RunError> {
    let run = world.resource::<TrainingRun>();
    let best = world.resource::<Evaluations>().best(&run.trainer_state).is_some();
    let (source, name) = match run.tested {
        PolicySource::Best if best => (PolicySource::Best, "Best policy with a map"),
        _ => (PolicySource::Current, "Current policy with a map"),
    };
    let (_, policy) = session_policy::policy(world, source)?;
    compare_with_map(world, name, policy)
}

/// Lets a shipped policy, with a map that it builds, drive next to the tested policy. Returns a confirmation.
///
/// # Errors
/// No shipped policy can drive here.
pub(super) fn open_expert_with_map(world: &mut World) -> Result<String, RunError> {
    let expert = expert_here(&world.resource::<TrainingRun>().config)?;
    let name = capitalized(&expert_name(expert));
    compare_with_map(world, &format!("{name} with a map"), expert.policy.clone())
}

/// Lets `policy`, called `name` and with a map that it builds, drive next to the tested policy. Returns a confirmation.
///
/// # Errors
/// It cannot drive here.
pub(super) fn compare_with_map(world: &mut World, name: &str, policy: Policy) -> Result<String, RunError> {
    let driver = DriverKind::Policy(policy_card::driving(policy, true)?);
    check_driver(&world.resource::<TrainingRun>().config, name, &driver)?;
    compare_with_driver(world, name.into(), driver)
}

/// Lets the best policy of the training so far drive next to the current one, which becomes the tested policy.
///
/// # Errors
/// No policy has been evaluated yet.
pub(super) fn open_best(world: &mut World) -> Result<(), RunError> {
    let (_, policy) = session_policy::policy(world, PolicySource::Best)?;
    let before = std::mem::replace(&mut world.resource_mut::<TrainingRun>().tested, PolicySource::Current);
    compare_with(world, ("Best so far".into(), policy))
        .inspect_err(|_| world.resource_mut::<TrainingRun>().tested = before)
}

/// The shipped policy that was trained in the scenario of `config`, or else the general policy, or else the first one that can
/// drive there.
pub(crate) fn expert(config: &RunConfig) -> Option<&'static ShippedPolicy> {
    expert_among(shipped::policies(), config)
}

fn expert_among<'a>(all: &'a [ShippedPolicy], config: &RunConfig) -> Option<&'a ShippedPolicy> {
    let at_home = all.iter().filter(|shipped| shipped.is_at_home_in(config));
    let general = all.iter().filter(|shipped| shipped.is_general());
    at_home
        .chain(general)
        .chain(all)
        .find(|shipped| check_can_drive(config, shipped.scenario_from, &shipped.policy).is_ok())
}

fn expert_here(config: &RunConfig) -> Result<&'static ShippedPolicy, RunError> {
    expert(config).ok_or_else(|| {
        let why = "No shipped policy can drive here: they were trained with another LIDAR, another robot or other \
                   observations";
        RunError::InvalidInput(why.into())
    })
}

/// The name of a shipped policy within a sentence.
pub(crate) fn expert_name(expert: &ShippedPolicy) -> String {
    if expert.is_general() { "general policy".into() } else { format!("{} expert", expert.trained_in) }
}

/// `name` with a capital letter at the start.
fn capitalized(name: &str) -> String {
    let mut rest = name.chars();
    rest.next().map_or_else(String::new, |first| first.to_uppercase().chain(rest).collect())
}

/// A text about where `policy` was trained, with "new here" if not in the scenario of `config`; empty if its card names none.
pub(super) fn origin(config: &RunConfig, policy: &Policy) -> String {
    let here = config.scenario_title();
    match policy_card::scenario_name(policy) {
        Some(there) if there == here => format!("Trained in {there}"),
        Some(there) => format!("Trained in {there}, new here"),
        None => String::new(),
    }
}

/// Warns if the second policy of a comparison was trained with other settings than those of the current scenario. In any
/// `mode` but Compare, removes the warning.
pub(super) fn warn_in_comparison(world: &mut World, mode: SessionMode) {
    world.resource_mut::<Notices>().remove(&NoticeTopic::Comparison);
    let OpenedFiles { policy: Some((name, policy)), driver: None, .. } = world.resource::<OpenedFiles>()
    else {
        return;
    };
    if mode != SessionMode::Compare {
        return;
    }
    let warning = policy_card::warning(policy, &world.resource::<TrainingRun>().config.scenario);
    if let Some(text) = warning.unwrap_or_else(|error| Some(error.to_string())) {
        let text = format!("{name}: {text}");
        notify(world, NoticeTopic::Comparison, Severity::Warning, text);
    }
}

/// Lets `policy` drive next to the tested policy.
pub(super) fn compare_with(world: &mut World, policy: (String, Policy)) -> Result<(), RunError> {
    compare(world, |opened| (opened.policy, opened.driver) = (Some(policy), None))
}

/// Starts the comparison with the second driver that `choose` puts into the opened files. After an error, the files are as before.
fn compare(world: &mut World, choose: impl FnOnce(&mut OpenedFiles)) -> Result<(), RunError> {
    let opened = &mut *world.resource_mut::<OpenedFiles>();
    let before = (opened.policy.clone(), opened.driver.clone());
    choose(opened);
    let compared = match world.resource::<ActiveMode>().mode() {
        SessionMode::Compare => restart_demo(world),
        _ => set_mode(world, SessionMode::Compare),
    };
    if compared.is_err() {
        let opened = &mut *world.resource_mut::<OpenedFiles>();
        (opened.policy, opened.driver) = before;
    }
    compared
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::policy::{ActionSet, RelativeMotion};
    use crate::run::training_setup;
    use crate::scenario::Scenario;
    use crate::task::Encoding;

    /// An untrained policy that fits every robot.
    fn general() -> ShippedPolicy {
        let mut config = RunConfig::resolve("empty", "fast", 1).expect("shipped");
        config.preset.observation =
            Encoding::Sectors { count: 12, earlier_steps: 0, free_paths: false, predicted_paths: false };
        config.preset.actions = ActionSet::Relative(vec![RelativeMotion { speed: 1.0, turn: 0.0 }]);
        let learner = training_setup::create_learner(&config, None).expect("a learner");
        let mut policy = learner.policy();
        policy_card::attach(&mut policy, &config, (0, 0), None);
        ShippedPolicy { scenario_from: "general", trained_in: "General".into(), scenario: None, policy }
    }

    #[test]
    fn the_general_policy_drives_where_no_other_policy_was_trained() {
        let specialists = shipped::policies().iter().filter(|policy| !policy.is_general());
        let clone = |policy: &ShippedPolicy| ShippedPolicy {
            scenario_from: policy.scenario_from,
            trained_in: policy.trained_in.clone(),
            scenario: policy.scenario.clone(),
            policy: policy.policy.clone(),
        };
        let mut all: Vec<ShippedPolicy> = specialists.map(clone).collect();
        let name = |all: &[ShippedPolicy], config: &RunConfig| expert_among(all, config).map(expert_name);
        let in_scenario = |from: &str| RunConfig::resolve(from, "fast", 1).expect("shipped");
        let mut changed = in_scenario("scenario-1");
        changed.scenario.obstacles[0].position_m.x += 0.1;
        let mut other_robot = in_scenario("maze");
        other_robot.scenario = Scenario {
            lidar: crate::scenario::Lidar { beams: 90, ..Default::default() },
            ..other_robot.scenario
        };
        assert_eq!(name(&all, &in_scenario("maze")).as_deref(), Some("Scenario I expert"));
        assert_eq!(name(&all, &other_robot), None);
        all.push(general());
        assert_eq!(name(&all, &in_scenario("scenario-2")).as_deref(), Some("Scenario II expert"));
        for config in [in_scenario("maze"), in_scenario("clutter"), changed, other_robot] {
            assert_eq!(name(&all, &config).as_deref(), Some("general policy"), "{}", config.scenario_title());
        }
        assert_eq!(capitalized("general policy"), "General policy");
    }
}
