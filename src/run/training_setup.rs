//! The start of a training run: its learner (with random weights or a policy's) and its simulation.
//!
//! In: a run's configuration, and the policy to start from, if any. Out: the learner and the simulation.

use std::sync::Arc;

use bevy::prelude::*;

use super::folder::RunConfig;
use super::preset::Preset;
use super::{RunError, evaluate, mirror, policy_card};
use crate::agent::{
    ActionSelection, ActiveLearner, Decisions, TrainingFault, TrainingStats, TrainingWarning,
};
use crate::learning::Learner;
use crate::policy::{Encoding, Policy};
use crate::scenario::Scenario;
use crate::sim::spawn_arenas;
use crate::simulation::{Extensions, Simulation, SimulationBuilder};
use crate::task::{
    ActiveActionSet, CommandedMotions, EpisodeEnded, EpisodeSetup, LevelProgress, ObservationLayout,
    PredictionDropout, ScenarioPool, TaskFault, TaskMode,
};

/// A simulation in which `learner` trains with `preset` in parallel arenas of `scenario`.
#[must_use]
pub fn training(
    scenario: &Arc<Scenario>,
    preset: &Preset,
    seed: u64,
    learner: Learner,
    extensions: &Extensions,
) -> Simulation {
    let mut simulation = SimulationBuilder::new(scenario).training().extensions(extensions).build_empty();
    start_training(simulation.world_mut(), scenario, preset, seed, learner);
    simulation
}

/// Starts a training run in `world`, replacing the current one if there is one.
pub fn start_training(
    world: &mut World,
    scenario: &Arc<Scenario>,
    preset: &Preset,
    seed: u64,
    learner: Learner,
) {
    world.resource_mut::<ObservationLayout>().encoding = preset.observation;
    world.insert_resource(PredictionDropout(preset.prediction_dropout));
    world.insert_resource(ActiveActionSet(preset.actions.clone()));
    world.insert_resource(preset.reward.clone());
    world.insert_resource(TaskMode::Continuing);
    world.insert_resource(EpisodeSetup::Random);
    world.insert_resource(TaskFault::default());
    world.insert_resource(ActionSelection::EpsilonGreedy);
    // A driver that is replaced may have commanded motions instead of actions.
    world.resource_mut::<CommandedMotions>().0.clear();
    world.insert_resource(Decisions::new(seed, preset.arenas));
    world.insert_resource(TrainingStats::default());
    world.insert_resource(TrainingFault::default());
    world.insert_resource(TrainingWarning::default());
    world.insert_resource(ActiveLearner(learner));
    world.resource_mut::<Messages<EpisodeEnded>>().clear();
    let pool = world.get_resource::<ScenarioPool>();
    match pool.and_then(|pool| LevelProgress::new(preset.levels, pool)) {
        Some(progress) => world.insert_resource(progress),
        None => drop(world.remove_resource::<LevelProgress>()),
    }
    spawn_arenas(world, scenario, preset.arenas, seed);
}

/// The learner of `config`, with the weights of `policy` if there is one.
///
/// # Errors
/// The configuration needs too much memory, its observations or actions have no mirror image although the preset needs one, a
/// scenario of its set does not fit the preset, or the policy does not fit the configuration.
pub fn create_learner(config: &RunConfig, policy: Option<&Policy>) -> Result<Learner, RunError> {
    let inputs = config.observation_layout().width(config.scenario.lidar.beams);
    let preset = &config.preset;
    let actions = preset.actions.len(config.scenario.robot.motions.len());
    if let Some((_, why)) = config.scenario_set.as_ref().and_then(|set| set.misfit(preset.fit())) {
        return Err(RunError::InvalidInput(format!("{}: a scenario {why}", config.scenario_from)));
    }
    config
        .check_memory()
        .map_err(|error| RunError::InvalidInput(format!("{}: {error}", config.preset_from)))?;
    let mut learner = Learner::new(&preset.learning, inputs, actions, preset.arenas, config.seed)
        .map_err(|error| RunError::InvalidInput(format!("{}: {error}", config.preset_from)))?;
    set_mirror(&mut learner, config)?;
    if let (Some(policy), Some(transfer)) = (policy, &config.transfer) {
        evaluate::check_compatible(policy, &config.scenario, &config.observation_layout())?;
        check_encoding(policy, preset.observation)
            .map_err(|error| RunError::InvalidInput(format!("{}: {error}", transfer.policy)))?;
        learner
            .load_weights(policy, transfer.epsilon)
            .map_err(|error| RunError::InvalidInput(format!("{}: {error}", transfer.policy)))?;
    }
    Ok(learner)
}

/// Gives the `learner` of `config` the mirror of its observations and actions, if the preset has `learning.mirror`.
///
/// # Errors
/// The observations or the actions have no mirror image.
pub(super) fn set_mirror(learner: &mut Learner, config: &RunConfig) -> Result<(), RunError> {
    let Some(mirror) = mirror::of_run(config)? else { return Ok(()) };
    learner
        .set_mirror(mirror)
        .map_err(|error| RunError::InvalidInput(format!("{}: {error}", config.preset_from)))
}

/// Checks that `policy` was trained with the preset's encoding of observations.
fn check_encoding(policy: &Policy, expected: Encoding) -> Result<(), RunError> {
    let encoding = policy_card::encoding(policy)?;
    if encoding == expected {
        return Ok(());
    }
    let [trained, here] = [encoding, expected].map(policy_card::encoding_name);
    let other = if trained == here { "other " } else { "" };
    Err(RunError::InvalidInput(format!(
        "the policy was trained with {trained} observations, but the preset has {other}{here} observations; help: use a preset \
         with `observation: {}`",
        ron::to_string(&encoding).unwrap_or_default()
    )))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::policy::observation::Quantity;
    use crate::run::shipped;
    use crate::task::Observations;

    /// How many predicted paths differ from free paths in the first 20 control steps of a training run with moving obstacles.
    fn predictions(prediction_dropout: f32) -> usize {
        const ARENAS: usize = 32;
        let scenario = shipped::scenario("crowd").expect("it is shipped");
        let encoding =
            Encoding::Sectors { count: 36, earlier_steps: 3, free_paths: true, predicted_paths: true };
        let mut preset =
            Preset { arenas: ARENAS, observation: encoding, prediction_dropout, ..Preset::default() };
        preset.learning.network.hidden = vec![8];
        assert_eq!(preset.diagnostics(), []);
        let config = RunConfig::new(("crowd".into(), scenario), ("mine".into(), preset), 1);
        let learner = create_learner(&config, None).expect("a learner");
        let mut simulation =
            training(&Arc::new(config.scenario.clone()), &config.preset, 1, learner, &Extensions::default());
        let layout = config.observation_layout().encoding.sectors().expect("by sectors");
        let columns: Vec<_> = layout.columns().collect();
        let mut count = 0;
        for _ in 0..20 {
            simulation.step().expect("it simulates");
            let observations = simulation.world().resource::<Observations>();
            for row in observations.current.chunks(observations.width) {
                let all = |quantity: Quantity| {
                    columns
                        .iter()
                        .zip(row)
                        .filter(move |(c, _)| c.quantity == quantity)
                        .map(|(_, value)| *value)
                };
                let pairs = all(Quantity::PredictedNearness).zip(all(Quantity::CollisionNearness));
                count += pairs.filter(|(predicted, free)| predicted != free).count();
            }
        }
        count
    }

    #[test]
    fn the_error_for_another_encoding_gives_that_of_the_policy_in_preset_syntax() {
        let general = shipped::policies().iter().find(|policy| policy.is_general()).expect("shipped");
        let error =
            check_encoding(&general.policy, Encoding::Scaled).expect_err("another encoding").to_string();
        let (_, fix) = error.split_once("help: use a preset with `observation: ").expect("a fix");
        let encoding: Encoding = ron::from_str(fix.trim_end_matches('`')).expect("RON");
        assert_eq!(policy_card::encoding(&general.policy), Ok(encoding), "{error}");
    }

    #[test]
    fn predictions_of_the_given_fraction_of_moving_things_are_left_out_in_training() {
        let all = predictions(0.0);
        assert!(all > 500, "{all}");
        let half = predictions(0.5);
        assert!((all / 4..=3 * all / 4).contains(&half), "{half} of {all}");
        assert_eq!(predictions(1.0), 0);
    }
}
