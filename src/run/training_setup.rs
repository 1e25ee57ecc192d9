//! The start of a training: its learner, new or from a policy's weights, and its simulation.
//!
//! In: a run's configuration, and the policy to start from, if any. Out: the learner, the simulation; or an error that
//! says what does not fit.

use std::sync::Arc;

use bevy::prelude::*;

use super::folder::RunConfig;
use super::preset::Preset;
use super::{RunError, evaluate, policy_card};
use crate::agent::{
    ActionSelection, ActiveLearner, Decisions, TrainingFault, TrainingStats, TrainingWarning,
};
use crate::learning::Learner;
use crate::policy::{Encoding, Policy};
use crate::scenario::Scenario;
use crate::sim::spawn_arenas;
use crate::simulation::{Extensions, Simulation, SimulationBuilder};
use crate::task::{EpisodeEnded, EpisodeSetup, ObservationLayout, TaskFault, TaskMode};

/// A simulation in which `learner` trains as `preset` says, in its arenas of `scenario`.
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

/// Starts a training in `world`, in place of whatever went on there.
pub fn start_training(
    world: &mut World,
    scenario: &Arc<Scenario>,
    preset: &Preset,
    seed: u64,
    learner: Learner,
) {
    world.resource_mut::<ObservationLayout>().encoding = preset.observation;
    world.insert_resource(preset.reward.clone());
    world.insert_resource(TaskMode::Continuing);
    world.insert_resource(EpisodeSetup::Random);
    world.insert_resource(TaskFault::default());
    world.insert_resource(ActionSelection::EpsilonGreedy);
    world.insert_resource(Decisions::new(seed, preset.arenas));
    world.insert_resource(TrainingStats::default());
    world.insert_resource(TrainingFault::default());
    world.insert_resource(TrainingWarning::default());
    world.insert_resource(ActiveLearner(learner));
    world.resource_mut::<Messages<EpisodeEnded>>().clear();
    spawn_arenas(world, scenario, preset.arenas, seed);
}

/// A learner as `config` asks for, starting from `policy` if there is one.
///
/// # Errors
/// The configuration or the policy does not fit.
pub fn create_learner(config: &RunConfig, policy: Option<&Policy>) -> Result<Learner, RunError> {
    let inputs = config.observation_layout().width(config.scenario.lidar.beams);
    let actions = config.scenario.robot.motions.len();
    let preset = &config.preset;
    preset
        .check_memory(&config.scenario)
        .map_err(|error| RunError::InvalidInput(format!("{}: {error}", config.preset_from)))?;
    let mut learner = Learner::new(&preset.learning, inputs, actions, preset.arenas, config.seed)
        .map_err(|error| RunError::InvalidInput(format!("{}: {error}", config.preset_from)))?;
    if let (Some(policy), Some(transfer)) = (policy, &config.transfer) {
        evaluate::check_compatible(policy, &config.scenario, &config.observation_layout())?;
        same_encoding(policy, preset.observation)
            .map_err(|error| RunError::InvalidInput(format!("{}: {error}", transfer.policy)))?;
        learner
            .load_weights(policy, transfer.epsilon)
            .map_err(|error| RunError::InvalidInput(format!("{}: {error}", transfer.policy)))?;
    }
    Ok(learner)
}

/// Whether `policy` was trained to see what a preset with `observation` will show it.
fn same_encoding(policy: &Policy, observation: Encoding) -> Result<(), RunError> {
    let own = policy_card::encoding(policy)?;
    if own == observation {
        return Ok(());
    }
    Err(RunError::InvalidInput(format!(
        "the policy was trained with {} observations, but the preset's are {}: start from it with a preset that says \
         `observation: {own:?}`",
        policy_card::encoding_name(own),
        policy_card::encoding_name(observation)
    )))
}
