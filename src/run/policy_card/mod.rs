//! Policy cards: reading policies, writing their cards, and comparing a card with the scenario in which its policy is used.
//!
//! In: a policy's file; the run's configuration, its counters, the success rate of the policy. Out: a policy, or a
//! [`Card`] without dates or times, so that equal runs have equal files.

mod common;
mod differences;
mod write;

use std::path::Path;
use std::sync::Arc;

use serde::Deserialize;

use super::RunError;
use crate::drivers::DrivingPolicy;
use crate::limits::MAX_POLICY_BYTES;
use crate::policy::{ActionSet, Card, Encoding, Policy};
use crate::scenario::{Lidar, Scenario, diagnostics, read_bytes, value_diagnostics};
use crate::task::{ObservationLayout, ObservationSlice};

pub use common::common_scenario;
pub use differences::{check_actions, differing_parts, fits_every_robot, note, warning};
pub use write::attach;

/// The metadata key for the encoding of observations, `scaled` or `raw`, in policies without a card. Without this key, it is
/// `scaled`.
const ENCODING: &str = "encoding";

/// The metadata key for the plugin sensors and their widths, such as `speed:2, bumper:1`, in policies without a card. Without
/// this key, there are none.
const SENSORS: &str = "sensors";

/// The suffix that gives a policy a map, wherever the user names a policy or a driver.
pub const WITH_MAP: &str = "+map";

/// Reads the policy in the file at `path`, and checks that its card agrees with its network and its scenario.
///
/// # Errors
/// The file cannot be read, is not a policy, or has a card that contradicts itself.
pub fn read(path: &Path) -> Result<Policy, RunError> {
    read_unnamed(path).map_err(|why| RunError::invalid_input(path, why))
}

/// Like [`read`], with a message that does not name the file.
///
/// # Errors
/// The file cannot be read, is not a policy, or has a card that contradicts itself.
pub fn read_unnamed(path: &Path) -> Result<Policy, String> {
    let with_help = |why: String| format!("{why}; help: give the policy.safetensors of a run");
    if path.is_dir() {
        return Err("is a folder; help: give the policy.safetensors in it".into());
    }
    let bytes = read_bytes(path, MAX_POLICY_BYTES + 1)
        .map_err(|error| with_help(format!("can't be read ({error})")))?;
    if bytes.len() as u64 > MAX_POLICY_BYTES {
        return Err(with_help(format!("is larger than {MAX_POLICY_BYTES} bytes")));
    }
    let policy = Policy::from_bytes(&bytes).map_err(|error| match error.to_string() {
        message if message.contains("help:") => message,
        message => with_help(message),
    })?;
    trained_scenario(&policy).map_err(|error| error.to_string())?;
    Ok(policy)
}

/// The scenario that `policy` was trained in; `None` without a card. Each of its values is valid, but whether they fit together
/// is not checked.
///
/// # Errors
/// The scenario is invalid, or the card contradicts it.
pub fn trained_scenario(policy: &Policy) -> Result<Option<Scenario>, RunError> {
    let Some(card) = &policy.card else { return Ok(None) };
    let scenario = parse_scenario(card)?;
    if let Some(diagnostic) = value_diagnostics(&scenario).first() {
        return Err(contradiction(&format!("has an invalid scenario: {diagnostic}")));
    }
    let has_same_beams = card.observation.is_some() || card.angles_rad() == angles_rad(&scenario.lidar);
    let agrees = has_same_beams
        && card.control_period_s == scenario.task.control_period_s
        && card.actions == write::actions(&scenario, &card.action_set());
    if !agrees {
        return Err(contradiction("has beams, actions or a control period other than those of its scenario"));
    }
    Ok(Some(scenario))
}

/// The scenario that `policy` was trained in, for use if the user names none; `None` without a card.
///
/// # Errors
/// The scenario is invalid, or the card contradicts it.
pub fn own_scenario(policy: &Policy) -> Result<Option<Scenario>, RunError> {
    let Some(scenario) = trained_scenario(policy)? else { return Ok(None) };
    match diagnostics(&scenario).first() {
        Some(diagnostic) => Err(RunError::InvalidInput(format!(
            "the scenario on the policy's card is invalid: {diagnostic}; help: give another one with --scenario"
        ))),
        None => Ok(Some(scenario)),
    }
}

/// The name of the scenario, or of the set of scenarios, that `policy` was trained in, if it is recorded.
#[must_use]
pub fn scenario_name(policy: &Policy) -> Option<String> {
    #[derive(Deserialize)]
    struct Name {
        name: String,
    }
    let name = match &policy.card {
        Some(card) => match &card.training.scenario_set {
            Some(set) => set.name.clone(),
            None => serde_json::from_str::<Name>(card.scenario.text()).ok()?.name,
        },
        None => policy.metadata.get("scenario")?.clone(),
    };
    Some(printable(&name))
}

/// The encoding of the observations that `policy` was trained with.
///
/// # Errors
/// The policy has an encoding that this version does not support.
pub fn encoding(policy: &Policy) -> Result<Encoding, RunError> {
    let unknown = |how: &str, known: &str| {
        RunError::InvalidInput(format!(
            "the policy's observations are encoded {how}, which this version does not know (it knows {known}); help: use a newer \
             wayfield"
        ))
    };
    if let Some(card) = &policy.card {
        return card
            .encoding()
            .ok_or_else(|| unknown("in the way that its card describes", "scaled, raw and sectors"));
    }
    match policy.metadata.get(ENCODING).map(String::as_str) {
        None | Some("scaled") => Ok(Encoding::Scaled),
        Some("raw") => Ok(Encoding::Raw),
        Some(other) => Err(unknown(&format!("as \"{}\"", printable(other)), "scaled and raw")),
    }
}

/// `policy` as a driver that gets percepts ([`Percept`](crate::drivers::Percept)), with or without a map that it builds.
///
/// # Errors
/// The policy has an encoding that this version does not support.
pub fn driving(policy: Policy, has_map: bool) -> Result<DrivingPolicy, RunError> {
    let (encoding, actions) = (encoding(&policy)?, action_set(&policy));
    Ok(DrivingPolicy { policy: Arc::new(policy), encoding, actions, has_map })
}

/// Checks that `policy` was trained without plugin sensors, whose readings are not part of percepts.
///
/// # Errors
/// It was trained with some; the message names them.
pub fn check_without_sensors(policy: &Policy) -> Result<(), RunError> {
    let sensors = recorded_sensors(policy);
    if sensors.is_empty() {
        return Ok(());
    }
    Err(RunError::InvalidInput(format!(
        "the policy was trained with `{}`, whose readings are not available here; help: test it with --eval, without a map",
        printable(&sensors)
    )))
}

/// The motions that `policy` chooses among.
#[must_use]
pub fn action_set(policy: &Policy) -> ActionSet {
    policy.card.as_ref().map_or(ActionSet::Robot, |card| card.action_set())
}

/// Checks that `policy` was trained with the plugin sensors of `layout`.
///
/// # Errors
/// The sensors differ. The message names both.
pub fn check_sensors(policy: &Policy, layout: &ObservationLayout) -> Result<(), RunError> {
    let recorded = recorded_sensors(policy);
    let present = describe_sensors(layout.slices().iter().map(sensor));
    if recorded == present {
        return Ok(());
    }
    let named = |sensors: &str| match sensors {
        "" => "no sensor plugin".into(),
        sensors => format!("`{}`", printable(sensors)),
    };
    Err(RunError::InvalidInput(format!(
        "the policy was trained with {}, but this simulation has {}; help: add the same plugins, in the same order",
        named(&recorded),
        named(&present)
    )))
}

/// The plugin sensors that `policy` was trained with, as text.
fn recorded_sensors(policy: &Policy) -> String {
    match &policy.card {
        Some(card) => describe_sensors(card.sensors()),
        None => policy.metadata.get(SENSORS).cloned().unwrap_or_default(),
    }
}

/// The adjective for observations with `encoding`, in messages.
#[must_use]
pub fn encoding_name(encoding: Encoding) -> &'static str {
    match encoding {
        Encoding::Scaled => "scaled",
        Encoding::Raw => "raw",
        Encoding::Sectors { .. } => "sector",
    }
}

fn parse_scenario(card: &Card) -> Result<Scenario, RunError> {
    serde_json::from_str(card.scenario.text())
        .map_err(|error| contradiction(&format!("has an unreadable scenario: {error}")))
}

/// The error for a card that contradicts itself.
fn contradiction(why: &str) -> RunError {
    RunError::InvalidInput(format!(
        "the policy's card {}; help: use the file as wayfield wrote it",
        printable(why)
    ))
}

/// The directions of the beams of `lidar`, in rad, as on a card.
fn angles_rad(lidar: &Lidar) -> Vec<f32> {
    (0..lidar.beams).map(|beam| lidar.beam_angle_rad(beam) as f32).collect()
}

/// The name and width of a sensor's slice.
fn sensor(slice: &ObservationSlice) -> (&str, usize) {
    (&slice.name, slice.width)
}

/// The sensors as text, without those of width 0, which add nothing to the observation.
fn describe_sensors<'a>(sensors: impl IntoIterator<Item = (&'a str, usize)>) -> String {
    let sensors = sensors.into_iter().filter(|(_, width)| *width > 0);
    let parts: Vec<String> = sensors.map(|(name, width)| format!("{name}:{width}")).collect();
    parts.join(", ")
}

/// At most 200 characters of `text` from a card, made safe to print.
fn printable(text: &str) -> String {
    const MAX_CHARS: usize = 200;
    let end = text.char_indices().nth(MAX_CHARS).map(|(at, _)| at);
    let short = crate::scenario::printable(&text[..end.unwrap_or(text.len())]).into_owned();
    if end.is_some() { short + "…" } else { short }
}
