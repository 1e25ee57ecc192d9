//! The card of a policy that is about to be saved.

use super::{angles_rad, sensor};
use crate::drivers::sector_observer;
use crate::policy::card::{Action, Card, Example, Program, TrainedSet, Training, inputs, q_value_formula};
use crate::policy::observation::Sensed;
use crate::policy::{ActionSet, Encoding, Policy, Scratch};
use crate::run::folder::RunConfig;
use crate::run::provenance::{COMMIT, VERSION, scenario_json, set_crc32c};
use crate::scenario::Scenario;
use crate::task::ActiveActionSet;

/// Gives `policy` its card. The run of `config` has trained it for these env steps and gradient steps. `success_rate` is the
/// rate in its evaluation, 0 to 1; `None` if it was not evaluated.
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
    // A scenario can always be written as JSON: it has no maps, whose keys might not be strings.
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
        observation: preset.observation.sectors().map(|_| preset.observation),
        inputs: inputs(preset.observation, &angles_rad(lidar), &sensors),
        activation: policy.shape().activation.name().into(),
        q_values: q_value_formula(policy.shape().dueling).into(),
        actions: actions(scenario, &preset.actions),
        relative_actions: match &preset.actions {
            ActionSet::Robot => None,
            ActionSet::Relative(motions) => Some(motions.clone()),
        },
        control_period_s: task.control_period_s,
        example: example(preset.observation, scenario, readings, q_values),
        scenario_crc32c: json.crc32c(),
        scenario: json,
    })
}

/// An example of an observation in `scenario`.
fn example(
    encoding: Encoding,
    scenario: &Scenario,
    readings: usize,
    q_values: impl FnOnce(&[f32]) -> Vec<f32>,
) -> Example {
    let lidar = (scenario.lidar.beams, scenario.lidar.max_range_m);
    let Some(sectors) = encoding.sectors() else {
        return Example::new(encoding, lidar, readings, q_values);
    };
    let observe = |ranges_m: &[f32], bearing_rad: f32, distance_m: f32| {
        let mut observer = sector_observer(sectors, scenario);
        observer.sense(&Sensed { ranges_m, pose: (0.0, 0.0, 0.0), twist: (0.0, 0.0) });
        let mut observation = vec![0.0; sectors.width()];
        observer.encode((bearing_rad, distance_m), &mut observation);
        observation
    };
    Example::observed(observe, lidar, readings, q_values)
}

/// The actions of a policy with `action_set` for the robot of `scenario`.
pub(super) fn actions(scenario: &Scenario, action_set: &ActionSet) -> Vec<Action> {
    let motions = ActiveActionSet(action_set.clone()).motions(&scenario.robot).into_iter();
    motions.map(|motion| Action { v_m_s: motion.v_m_s, w_rad_s: motion.w_rad_s }).collect()
}

fn this_program() -> Program {
    Program { name: "wayfield".into(), version: VERSION.into(), commit: COMMIT.map(String::from) }
}
