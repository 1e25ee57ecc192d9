//! The card of a policy that is about to be saved.

use super::{angles_rad, sensor};
use crate::policy::card::{Action, Card, Example, Program, TrainedSet, Training, inputs, q_value_formula};
use crate::policy::{Policy, Scratch};
use crate::run::folder::RunConfig;
use crate::run::provenance::{COMMIT, VERSION, scenario_json, set_crc32c};
use crate::scenario::Scenario;

/// Gives `policy`, which the run of `config` has trained for these env steps and gradient steps, its card.
/// `success_rate` is the rate in its evaluation, 0 to 1; `None` if it was not evaluated.
pub fn attach(
    policy: &mut Policy,
    config: &RunConfig,
    (env_steps, gradient_steps): (u64, u64),
    success_rate: Option<f64>,
) {
    let training = Training {
        scenario_from: config.scenario_from.clone(),
        scenario_set: config.scenario_set.as_ref().map(|set| TrainedSet {
            name: set.name.clone(),
            scenarios: config.member_names().map(String::from).collect(),
            crc32c: set_crc32c(set),
        }),
        preset: config.preset_name(),
        seed: config.seed,
        init: config.transfer.as_ref().map(|transfer| transfer.policy.clone()),
        env_steps,
        gradient_steps,
        success_rate,
    };
    // No scenario makes the JSON fail: it has only structs, lists, strings and numbers.
    policy.card = card(policy, config, training).ok().map(Box::new);
}

fn card(policy: &Policy, config: &RunConfig, training: Training) -> Result<Card, serde_json::Error> {
    let RunConfig { scenario, preset, .. } = config;
    let Scenario { lidar, task, .. } = scenario;
    let sensors: Vec<(&str, usize)> = config.sensors.iter().map(sensor).collect();
    let readings = sensors.iter().map(|(_, width)| width).sum();
    let q_values = |observation: &[f32]| policy.q_values(observation, &mut Scratch::default()).to_vec();
    let json = scenario_json(scenario)?;
    Ok(Card {
        program: this_program(),
        training,
        inputs: inputs(preset.observation, &angles_rad(lidar), &sensors),
        activation: policy.shape().activation.name().into(),
        q_values: q_value_formula(policy.shape().dueling).into(),
        actions: actions(scenario),
        control_period_s: task.control_period_s,
        example: Example::new(preset.observation, (lidar.beams, lidar.max_range_m), readings, q_values),
        scenario_crc32c: json.crc32c(),
        scenario: json,
    })
}

/// The actions of the robot of `scenario`.
pub(super) fn actions(scenario: &Scenario) -> Vec<Action> {
    let motions = scenario.robot.motions.iter();
    motions.map(|motion| Action { v_m_s: motion.v_m_s, w_rad_s: motion.w_rad_s }).collect()
}

fn this_program() -> Program {
    Program { name: "wayfield".into(), version: VERSION.into(), commit: COMMIT.map(String::from) }
}
