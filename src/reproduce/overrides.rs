//! The changes that a stage or a condition makes to its scenario and preset.

use serde::{Deserialize, Serialize};

use crate::learning::{Sampling, Schedule};
use crate::run::preset::Preset;
use crate::scenario::{Quantity, Scenario};
use crate::task::{Encoding, RewardKind};

/// Fields to change; fields that are not given keep their value.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields, default)]
pub struct Override {
    /// Another scenario: a file or the name of a shipped scenario. The other changes apply to it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub scenario: Option<String>,
    /// Scenario: `lidar.noise_std_m`, in m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub lidar_noise_std_m: Option<f32>,
    /// Scenario: `robot.actuator_lag_s`, in s.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub actuator_lag_s: Option<f32>,
    /// Scenario: `speed_rad_s` of every orbiting obstacle, in rad/s. Without such obstacles it has no effect.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub orbit_speed_rad_s: Option<f32>,
    /// Scenario: `task.collision_range_m`, the paper's l_c, in m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub collision_range_m: Option<f32>,
    /// Scenario: `task.max_episode_steps`, in control steps.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub max_episode_steps: Option<u32>,
    /// Preset: `reward.kind`, eq. (3) or eq. (7).
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reward: Option<RewardKind>,
    /// Preset: `reward.l_r_m`, the range of the repulsion, in m.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub l_r_m: Option<f32>,
    /// Preset: `observation`, scaled or raw.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub observation: Option<Encoding>,
    /// Preset: `learning.double`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub double: Option<bool>,
    /// Preset: `learning.network.dueling`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dueling: Option<bool>,
    /// Preset: `learning.replay.sampling`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sampling: Option<Sampling>,
    /// Preset: `alpha` of prioritized sampling. With uniform sampling, this and the next two have no effect.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub alpha: Option<f32>,
    /// Preset: `beta` of prioritized sampling.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beta: Option<Schedule>,
    /// Preset: `importance_weights` of prioritized sampling.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub importance_weights: Option<bool>,
}

impl Override {
    /// Changes the scenario and the preset.
    pub fn apply(&self, scenario: &mut Scenario, preset: &mut Preset) {
        set(&mut scenario.lidar.noise_std_m, self.lidar_noise_std_m);
        set(&mut scenario.robot.actuator_lag_s, self.actuator_lag_s);
        if let Some(speed) = self.orbit_speed_rad_s {
            for obstacle in &mut scenario.obstacles {
                if let Some(speed_rad_s) = obstacle.motion.number_mut(Quantity::AngularSpeed) {
                    *speed_rad_s = speed;
                }
            }
        }
        set(&mut scenario.task.collision_range_m, self.collision_range_m);
        set(&mut scenario.task.max_episode_steps, self.max_episode_steps);
        set(&mut preset.reward.kind, self.reward);
        set(&mut preset.reward.l_r_m, self.l_r_m);
        set(&mut preset.observation, self.observation);
        let learning = &mut preset.learning;
        set(&mut learning.double, self.double);
        set(&mut learning.network.dueling, self.dueling);
        set(&mut learning.replay.sampling, self.sampling);
        if let Sampling::Prioritized { alpha, beta, importance_weights, .. } = &mut learning.replay.sampling {
            set(alpha, self.alpha);
            set(beta, self.beta);
            set(importance_weights, self.importance_weights);
        }
    }
}

fn set<T>(field: &mut T, value: Option<T>) {
    if let Some(value) = value {
        *field = value;
    }
}
