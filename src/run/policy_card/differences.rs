//! The comparison of a card with the scenario in which its policy is used.
//!
//! A policy is rejected if an action turns or drives the other way in the scenario, or if the actions are in another order.
//! Other differences in the robot, the LIDAR or the rules can make sense (a test of robustness, transfer): they give a
//! warning that lists the values on the card and in the scenario.

use super::{angles_rad, parse_scenario, printable, scenario_name, write};
use crate::policy::card::Action;
use crate::policy::{ActionSet, Policy};
use crate::run::RunError;
use crate::scenario::{OdometryDrift, Ranged, Robot, Scenario, Slip, field_names};

/// The maximum number of differences in a warning.
const MAX_LISTED: usize = 12;

/// Checks that no action of `policy` is reversed or has another index in `scenario`.
///
/// # Errors
/// The first such action, as the card and as the scenario have it.
pub fn check_actions(policy: &Policy, scenario: &Scenario) -> Result<(), RunError> {
    let Some(card) = policy.card.as_ref().filter(|card| card.relative_actions.is_none()) else {
        return Ok(());
    };
    let here = write::actions(scenario, &ActionSet::Robot);
    let is_reversed = |k: &usize| {
        let (card, here) = (&card.actions[*k], &here[*k]);
        card.v_m_s * here.v_m_s < 0.0 || card.w_rad_s * here.w_rad_s < 0.0
    };
    let indices = || 0..card.actions.len().min(here.len());
    let reordered = || {
        indices().find(|k| card.actions[*k] != here[*k]).filter(|_| sorted(&card.actions) == sorted(&here))
    };
    let Some(k) = indices().find(is_reversed).or_else(reordered) else { return Ok(()) };
    Err(RunError::InvalidInput(format!(
        "the policy's card says that action {k} is {}, but in \"{}\" it is {}; help: list the robot's motions in the order \
         of the card, which `wayfield --card` prints",
        motion(&card.actions[k]),
        printable(&scenario.name),
        motion(&here[k])
    )))
}

fn sorted(actions: &[Action]) -> Vec<Action> {
    let mut sorted = actions.to_vec();
    sorted.sort_by(|a, b| a.v_m_s.total_cmp(&b.v_m_s).then(a.w_rad_s.total_cmp(&b.w_rad_s)));
    sorted
}

/// Whether `policy` can drive every robot with every LIDAR: its inputs are sectors of a scan, and its actions are in units of the
/// robot's limits.
#[must_use]
pub fn fits_every_robot(policy: &Policy) -> bool {
    policy.card.as_ref().is_some_and(|card| card.observation.is_some() && card.relative_actions.is_some())
}

/// A warning for the user of `policy` in `scenario`: the settings in which the card and the scenario differ, with both values,
/// or that there is no card. `None` if nothing differs.
///
/// # Errors
/// The card's scenario cannot be read.
pub fn warning(policy: &Policy, scenario: &Scenario) -> Result<Option<String>, RunError> {
    let name = printable(&scenario.name);
    let Some(card) = &policy.card else {
        return Ok(Some(format!(
            "this policy has no card (wayfield 0.1.0 wrote none), so it is unknown whether the robot, the LIDAR and the \
             control period of \"{name}\" are those it was trained with"
        )));
    };
    if fits_every_robot(policy) {
        return Ok(None);
    }
    let differences = differences(&parse_scenario(card)?, scenario);
    if differences.is_empty() {
        return Ok(None);
    }
    let mut lines = vec![format!("\"{name}\" differs from what this policy was trained with:")];
    lines.extend(differences.iter().take(MAX_LISTED).map(|difference| format!("  {difference}")));
    if differences.len() > MAX_LISTED {
        lines.push(format!("  and {} more", differences.len() - MAX_LISTED));
    }
    Ok(Some(lines.join("\n")))
}

/// A note that `policy` was trained in a scenario other than `scenario`; `None` if it was not, or if nothing is recorded.
#[must_use]
pub fn note(policy: &Policy, scenario: &Scenario) -> Option<String> {
    let trained = scenario_name(policy)?;
    let name = printable(&scenario.name);
    if trained != name {
        return Some(format!("this policy was trained in {trained} and is tested in {name}"));
    }
    let card = policy.card.as_ref()?;
    let trained = parse_scenario(card).ok();
    let is_same = trained.as_ref() == Some(scenario);
    let differing = trained.map(|trained| differing_parts(&trained, scenario)).unwrap_or_default();
    (!is_same).then(|| format!("this policy was trained in another version of {name}{differing}"))
}

/// The end of a message about two scenarios with the same name: the fields in which they differ, such as
/// ", which differs in `robot`, `lidar`"; empty if none do.
#[must_use]
pub fn differing_parts(one: &Scenario, other: &Scenario) -> String {
    let [one, other] = [one, other].map(|scenario| serde_json::to_value(scenario).unwrap_or_default());
    let names = field_names::<Scenario>().iter().filter(|name| one.get(name) != other.get(name));
    let names: Vec<String> = names.map(|name| format!("`{name}`")).collect();
    if names.is_empty() { String::new() } else { format!(", which differs in {}", names.join(", ")) }
}

/// Every setting in which `trained` and `here` differ, with both values.
fn differences(trained: &Scenario, here: &Scenario) -> Vec<String> {
    let mut differences = Vec::new();
    let mut differ = |setting: &str, card: &str, here: &str| {
        differences.push(format!("{setting}: {card} on its card, {here} here"));
    };
    let actions = |scenario: &Scenario| write::actions(scenario, &ActionSet::Robot);
    for (k, (card, here)) in actions(trained).iter().zip(&actions(here)).enumerate() {
        if card != here {
            differ(&format!("action {k}"), &motion(card), &motion(here));
        }
    }
    for ((setting, card, unit), (_, here, _)) in settings(trained).into_iter().zip(settings(here)) {
        if card != here {
            let with_unit = |value: &str| format!("{value} {unit}").trim_end().to_owned();
            differ(setting, &with_unit(&card), &with_unit(&here));
        }
    }
    if trained.robot.shape != here.robot.shape {
        let [card, here] = [trained, here].map(|scenario| body(&scenario.robot));
        differ("robot shape", &card, &here);
    }
    if angles_rad(&trained.lidar) != angles_rad(&here.lidar) {
        let [card, here] = [trained, here].map(|scenario| scenario.lidar.field_of_view_rad);
        differ("LIDAR field of view", &format!("{card} rad"), &format!("{here} rad"));
    }
    differences
}

/// The settings that give a policy's numbers their meaning, apart from actions, robot shape and beam directions: name, value
/// and unit.
fn settings(scenario: &Scenario) -> [(&'static str, String, &'static str); 13] {
    let Scenario { robot, lidar, task, .. } = scenario;
    [
        ("control period", task.control_period_s.to_string(), "s"),
        ("robot radius", robot.radius_m.to_string(), "m"),
        ("actuator lag", robot.actuator_lag_s.to_string(), "s"),
        ("acceleration limit", limit(robot.max_acceleration_m_s2, "m/s^2"), ""),
        ("angular acceleration limit", limit(robot.max_angular_acceleration_rad_s2, "rad/s^2"), ""),
        ("wheel slip", slip(robot.slip), ""),
        ("odometry", odometry(robot.odometry_drift.as_ref()), ""),
        ("LIDAR range", lidar.max_range_m.to_string(), "m"),
        ("LIDAR noise", lidar.noise_std_m.to_string(), "m"),
        ("LIDAR dropout", percent(lidar.dropout), "%"),
        ("LIDAR latency", lidar.latency_steps.to_string(), "steps"),
        ("goal radius", task.goal_radius_m.to_string(), "m"),
        ("collision range", task.collision_range_m.to_string(), "m"),
    ]
}

/// The shape of a robot, as in a scenario's file.
fn body(robot: &Robot) -> String {
    robot.shape.as_ref().map_or_else(|| "a disc".into(), |shape| ron::to_string(shape).unwrap_or_default())
}

fn slip(slip: Option<Slip>) -> String {
    slip.map_or_else(
        || "none".into(),
        |Slip { forward, turning, std }| {
            format!("forward {forward}, turning {turning}, standard deviation {std}")
        },
    )
}

fn odometry(drift: Option<&OdometryDrift>) -> String {
    drift.map_or_else(
        || "exact".into(),
        |OdometryDrift { distance_error, rotation_error, heading_drift_rad_m }| {
            format!("errors {distance_error} m/m, {rotation_error} rad/rad, {heading_drift_rad_m} rad/m")
        },
    )
}

fn limit(limit: Option<f32>, unit: &str) -> String {
    limit.map_or_else(|| "none".into(), |limit| format!("{limit} {unit}"))
}

fn percent(fraction: Ranged<f32>) -> String {
    // Moves the decimal point: a product with 100 is rounded, and 0.013 would become 1.3000001.
    let percent = |fraction: f32| format!("{fraction}e2").parse::<f32>().unwrap_or(100.0 * fraction);
    match fraction {
        Ranged::Number(fraction) => percent(fraction).to_string(),
        Ranged::Range(low, high) => Ranged::Range(percent(low), percent(high)).to_string(),
    }
}

fn motion(action: &Action) -> String {
    format!("{} m/s {} rad/s", action.v_m_s, action.w_rad_s)
}
