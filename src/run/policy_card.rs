//! The card of a policy: what its user needs to know, kept in the policy's own file.
//!
//! In: the run's configuration, its counters, the success rate in the evaluation that made the policy the best. Out: text by key, the same
//! bytes for the same run (no dates, no times).

use std::collections::BTreeMap;

use super::folder::RunConfig;
use crate::scenario::Scenario;
use crate::task::observation;

/// What a user of a policy needs to know: what goes in, what comes out, where it comes from. `success_rate` (0 to 1)
/// is that of its evaluation, if it had one.
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
        (
            "observation",
            format!(
                "{} LIDAR ranges / {} m (beam 0 ahead, counterclockwise); bearing of the target / pi rad (left \
                 positive); its distance / {} m; the smallest range / {} m; the number of its beam / {}",
                lidar.beams,
                observation::RANGE_SCALE_M,
                observation::DISTANCE_SCALE_M,
                observation::RANGE_SCALE_M,
                lidar.beams
            ),
        ),
        ("actions", motions.join("; ")),
        ("control_period_s", task.control_period_s.to_string()),
        ("lidar_max_range_m", lidar.max_range_m.to_string()),
    ]
    .into_iter()
    .map(|(key, value)| (key.to_string(), value))
    .collect();
    if let Some(rate) = success_rate {
        metadata.insert("success_rate".into(), rate.to_string());
    }
    metadata
}
