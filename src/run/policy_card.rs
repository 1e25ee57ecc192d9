//! The policy card: metadata in a policy file that describe the policy's inputs, actions and origin.
//!
//! In: the run's configuration, its counters, the success rate of the policy. Out: texts by key, without
//! dates or times, so that equal runs have equal files. The card is for people; the program itself uses only
//! [`ENCODING`] and [`SENSORS`].

use std::collections::BTreeMap;
use std::path::Path;

use super::RunError;
use super::folder::RunConfig;
use crate::limits::MAX_POLICY_BYTES;
use crate::policy::Policy;
use crate::policy::observation::{DISTANCE_SCALE_M, Encoding, RANGE_SCALE_M};
use crate::scenario::{Lidar, Scenario, read_bytes};
use crate::task::{ObservationLayout, ObservationSlice};

/// The key for the encoding of the observations: `scaled` or `raw`. A policy without it is `scaled`.
pub const ENCODING: &str = "encoding";

/// The key for the plugin sensors in the observation with their widths, such as `speed:2, bumper:1`. A policy
/// without it uses no plugin sensors.
pub const SENSORS: &str = "sensors";

/// The policy in the file at `path`.
///
/// # Errors
/// The file cannot be read, or is not a policy.
pub fn read(path: &Path) -> Result<Policy, RunError> {
    let invalid_input = |why: String| {
        RunError::invalid_input(path, format!("{why}; help: give the policy.safetensors of a run"))
    };
    if path.is_dir() {
        return Err(RunError::invalid_input(path, "is a folder; help: give the policy.safetensors in it"));
    }
    let bytes = read_bytes(path, MAX_POLICY_BYTES + 1)
        .map_err(|error| invalid_input(format!("can't be read ({error})")))?;
    if bytes.len() as u64 > MAX_POLICY_BYTES {
        return Err(RunError::invalid_input(
            path,
            format!("is larger than {MAX_POLICY_BYTES} bytes; help: give the policy.safetensors of a run"),
        ));
    }
    Policy::from_bytes(&bytes).map_err(|error| match error.to_string() {
        message if message.contains("help:") => RunError::invalid_input(path, message),
        message => invalid_input(message),
    })
}

/// The encoding of the observations that `policy` was trained with.
///
/// # Errors
/// The card has an encoding that this version does not support.
pub fn encoding(policy: &Policy) -> Result<Encoding, RunError> {
    match policy.metadata.get(ENCODING).map(String::as_str) {
        None | Some("scaled") => Ok(Encoding::Scaled),
        Some("raw") => Ok(Encoding::Raw),
        Some(other) => Err(RunError::InvalidInput(format!(
            "the policy's observations are encoded as \"{other}\", which this version does not know (it knows scaled \
             and raw); help: use a newer wayfield"
        ))),
    }
}

/// Checks that `policy` was trained with the plugin sensors of `layout`.
///
/// # Errors
/// The sensors differ. The message names both.
pub fn check_sensors(policy: &Policy, layout: &ObservationLayout) -> Result<(), RunError> {
    let recorded = policy.metadata.get(SENSORS).map_or("", String::as_str);
    let present = sensors(layout.slices());
    if recorded == present {
        return Ok(());
    }
    let named =
        |sensors: &str| if sensors.is_empty() { "no sensor plugin".into() } else { format!("`{sensors}`") };
    Err(RunError::InvalidInput(format!(
        "the policy was trained with {}, but this simulation has {}; help: add the same plugins, in the same order",
        named(recorded),
        named(&present)
    )))
}

fn sensors(slices: &[ObservationSlice]) -> String {
    let parts: Vec<String> = slices.iter().map(|slice| format!("{}:{}", slice.name, slice.width)).collect();
    parts.join(", ")
}

/// The name of `encoding` on the card.
#[must_use]
pub fn encoding_name(encoding: Encoding) -> &'static str {
    match encoding {
        Encoding::Scaled => "scaled",
        Encoding::Raw => "raw",
    }
}

/// The order and units of the network's inputs, as text.
fn observation(encoding: Encoding, lidar: &Lidar) -> String {
    let beams = lidar.beams;
    match encoding {
        Encoding::Scaled => format!(
            "{beams} LIDAR ranges / {RANGE_SCALE_M} m (beam 0 ahead, counterclockwise); bearing of the goal / pi rad \
             (left positive); its distance / {DISTANCE_SCALE_M} m; the smallest range / {RANGE_SCALE_M} m; the number of \
             its beam / {beams}"
        ),
        Encoding::Raw => format!(
            "{beams} LIDAR ranges in m (beam 0 ahead, counterclockwise); bearing of the goal in rad (left positive); \
             its distance in m; the smallest range in m; the number of its beam, from 0"
        ),
    }
}

/// The card of a policy. `success_rate` is the rate in its evaluation, 0 to 1; `None` if it was not evaluated.
#[must_use]
pub fn metadata(
    config: &RunConfig,
    (env_steps, gradient_steps): (u64, u64),
    success_rate: Option<f64>,
) -> BTreeMap<String, String> {
    let Scenario { name, lidar, robot, task, .. } = &config.scenario;
    let motions: Vec<String> =
        robot.motions.iter().map(|m| format!("{} m/s {} rad/s", m.v_m_s, m.w_rad_s)).collect();
    let mut metadata: BTreeMap<String, String> = [
        ("wayfield", config.version.clone()),
        ("scenario", name.clone()),
        ("preset", config.preset_name()),
        ("seed", config.seed.to_string()),
        ("env_steps", env_steps.to_string()),
        ("gradient_steps", gradient_steps.to_string()),
        (ENCODING, encoding_name(config.preset.observation).into()),
        ("observation", observation(config.preset.observation, lidar)),
        ("actions", motions.join("; ")),
        ("control_period_s", task.control_period_s.to_string()),
        ("lidar_max_range_m", lidar.max_range_m.to_string()),
    ]
    .into_iter()
    .map(|(key, value)| (key.to_string(), value))
    .collect();
    if !config.sensors.is_empty() {
        metadata.insert(SENSORS.into(), sensors(&config.sensors));
    }
    if let Some(rate) = success_rate {
        metadata.insert("success_rate".into(), rate.to_string());
    }
    metadata
}
