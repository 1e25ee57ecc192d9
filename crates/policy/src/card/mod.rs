//! The policy card: what a policy's inputs and outputs mean, and what it was trained with, as JSON in the policy file.
//!
//! The card is complete: with it, the tensors and `docs/policy-file.md`, a program in any language can drive a robot as the
//! policy was trained to. Its [`Example`] lets such a program check itself.

mod check;
mod inputs;

use serde::{Deserialize, Serialize};
use serde_json::value::RawValue;

pub use check::CardError;
pub use inputs::{Input, Quantity, inputs};

use crate::actions::{ActionSet, RelativeMotion};
use crate::observation::{self, Encoding};

/// The Q-values as a formula of the output tensors, as the card gives it.
#[must_use]
pub fn q_value_formula(dueling: bool) -> &'static str {
    if dueling { "value + advantage - mean(advantage)" } else { "output" }
}

/// Everything that gives a policy's numbers their meaning.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Card {
    /// The program that wrote the policy.
    pub program: Program,
    /// How the policy was trained.
    pub training: Training,
    /// The encoding of the observations, if it is not the paper's: [`Encoding::Sectors`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub observation: Option<Encoding>,
    /// The network's inputs, in their order.
    pub inputs: Vec<Input>,
    /// The activation of the hidden layers: [`Activation::name`](crate::Activation::name).
    pub activation: String,
    /// The Q-values as a formula of the output tensors: [`q_value_formula`].
    pub q_values: String,
    /// The actions, in the order of the Q-values. An action is held for one control period.
    pub actions: Vec<Action>,
    /// The actions in units of the robot's limits, if they are not the scenario's motions; `actions` then gives them for the
    /// robot in training.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub relative_actions: Option<Vec<RelativeMotion>>,
    /// The time between two decisions, in s.
    pub control_period_s: f32,
    /// An observation with its Q-values.
    pub example: Example,
    /// The CRC-32C of the scenario's bytes, as eight hexadecimal digits.
    pub scenario_crc32c: String,
    /// The scenario of the training run: robot, LIDAR with its noise and delay, rules, obstacles, and every other field.
    pub scenario: RawJson,
}

/// A version of a program.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
pub struct Program {
    /// The program's name.
    pub name: String,
    /// The program's version.
    pub version: String,
    /// The Git commit that the program was built from, with `-dirty` appended if files had been changed; null if unknown.
    pub commit: Option<String>,
}

/// The set of scenarios that a policy was trained in.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct TrainedSet {
    /// The set's name.
    pub name: String,
    /// The names of its scenarios.
    pub scenarios: Vec<String>,
    /// The CRC-32C of the set and its scenarios as JSON, as eight hexadecimal digits.
    pub crc32c: String,
}

/// How a policy was trained.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Training {
    /// The scenario's file or shipped name, as the user gave it.
    pub scenario_from: String,
    /// The set of scenarios that the episodes were drawn from; missing if all had the card's scenario. With a set, the card's
    /// scenario is its first.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub scenario_set: Option<TrainedSet>,
    /// The preset's name.
    pub preset: String,
    /// The seed of the run.
    pub seed: u64,
    /// The policy file that the training started from; null for random weights.
    pub init: Option<String>,
    /// The env steps so far.
    pub env_steps: u64,
    /// The gradient steps so far.
    pub gradient_steps: u64,
    /// The success rate in the evaluation that selected the policy, 0 to 1; null if it was not evaluated.
    pub success_rate: Option<f64>,
}

/// A commanded motion of the robot.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Action {
    /// Linear speed along the heading, in m/s.
    pub v_m_s: f32,
    /// Angular speed, counterclockwise positive, in rad/s.
    pub w_rad_s: f32,
}

/// An observation, the measurements it was encoded from, and what the network makes of it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Example {
    /// A range for each beam, in m.
    pub ranges_m: Vec<f32>,
    /// The angle from the heading to the goal, left positive, in rad.
    pub goal_bearing_rad: f32,
    /// The distance to the goal, in m.
    pub goal_distance_m: f32,
    /// The readings of plugin sensors.
    pub sensor_readings: Vec<f32>,
    /// The network's inputs.
    pub observation: Vec<f32>,
    /// The network's Q-values, one per action.
    pub q_values: Vec<f32>,
    /// The index of the greedy action.
    pub action: usize,
}

impl Example {
    /// An arbitrary observation of eq. (8) for a `lidar` (number of beams, maximum range in m): the ranges vary from beam to
    /// beam, and the goal is behind the robot to the right. `q_values` computes the Q-values.
    pub fn new(
        encoding: Encoding,
        lidar: (usize, f32),
        sensor_readings: usize,
        q_values: impl FnOnce(&[f32]) -> Vec<f32>,
    ) -> Self {
        let observe = |ranges_m: &[f32], bearing_rad: f32, distance_m: f32| {
            let mut observation = vec![0.0; observation::width(ranges_m.len())];
            observation::encode(encoding, ranges_m, bearing_rad, distance_m, &mut observation);
            observation
        };
        Self::observed(observe, lidar, sensor_readings, q_values)
    }

    /// Like [`new`](Self::new), with another observation: `observe` encodes the ranges in m, and the goal's bearing in rad and
    /// distance in m.
    pub fn observed(
        observe: impl FnOnce(&[f32], f32, f32) -> Vec<f32>,
        (beams, max_range_m): (usize, f32),
        sensor_readings: usize,
        q_values: impl FnOnce(&[f32]) -> Vec<f32>,
    ) -> Self {
        let ranges_m: Vec<f32> = (0..beams)
            .map(|beam| {
                max_range_m * (0.25 + 0.75 * ((beam * 7 + 3) % (beams + 1)) as f32 / (beams + 1) as f32)
            })
            .collect();
        let sensor_readings: Vec<f32> = (0..sensor_readings).map(|k| 0.5 / (k + 1) as f32).collect();
        let (goal_bearing_rad, goal_distance_m) = (-2.0, 1.5);
        let mut observation = observe(&ranges_m, goal_bearing_rad, goal_distance_m);
        observation.extend(&sensor_readings);
        let q_values = q_values(&observation);
        let action = crate::greedy(&q_values);
        Self { ranges_m, goal_bearing_rad, goal_distance_m, sensor_readings, observation, q_values, action }
    }
}

impl Card {
    /// The motions that the policy chooses among.
    #[must_use]
    pub fn action_set(&self) -> ActionSet {
        self.relative_actions.clone().map_or(ActionSet::Robot, ActionSet::Relative)
    }
}

/// JSON that this crate carries and does not read: a scenario.
#[derive(Debug, Clone, Serialize, Deserialize)]
#[serde(transparent)]
pub struct RawJson(Box<RawValue>);

impl RawJson {
    /// The JSON in `text`.
    ///
    /// # Errors
    /// `text` is not JSON.
    pub fn new(text: String) -> Result<Self, serde_json::Error> {
        RawValue::from_string(text).map(Self)
    }

    /// The text.
    #[must_use]
    pub fn text(&self) -> &str {
        self.0.get()
    }

    /// The CRC-32C of the text, as eight hexadecimal digits.
    #[must_use]
    pub fn crc32c(&self) -> String {
        format!("{:08x}", crc32c::crc32c(self.text().as_bytes()))
    }
}

impl PartialEq for RawJson {
    fn eq(&self, other: &Self) -> bool {
        self.text() == other.text()
    }
}
