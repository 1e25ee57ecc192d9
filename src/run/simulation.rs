//! The rooms' plugins, put together; and the headless app, which has nothing else.
//!
//! In: a scenario, arenas, a seed. Out: an [`App`] whose world runs [`ControlStep`] as often as its caller likes. The
//! app with a window adds the same plugins ([`add_training_plugins`]) and begins trainings by the same [`start_training`].

use std::sync::Arc;

use bevy::prelude::*;

use super::RunError;
use super::preset::Preset;
use crate::agent::{
    ActionSelection, ActiveLearner, AgentPlugin, Decisions, TrainingFault, TrainingPlugin, TrainingStats,
    TrainingWarning,
};
use crate::control_step::{ControlStep, ControlStepPlugin};
use crate::learning::Learner;
use crate::scenario::Scenario;
use crate::sim::{SimPlugin, spawn_arenas};
use crate::task::{Encoding, EpisodeEnded, EpisodeSetup, RewardConfig, TaskFault, TaskMode, TaskPlugin};

/// An app in which `learner` trains as `preset` says in its arenas of `scenario`, every arena at its first observation.
pub fn training_app(scenario: &Arc<Scenario>, preset: &Preset, seed: u64, learner: Learner) -> App {
    let mut app = App::new();
    app.add_plugins(MinimalPlugins);
    add_training_plugins(&mut app);
    make_ready(&mut app);
    start_training(app.world_mut(), scenario, preset, seed, learner);
    app
}

/// Adds the plugins of a training, which waits for [`start_training`].
pub fn add_training_plugins(app: &mut App) {
    app.add_plugins((
        ControlStepPlugin,
        TaskPlugin {
            observation: Encoding::default(),
            reward: RewardConfig::default(),
            mode: TaskMode::Continuing,
        },
        SimPlugin,
        AgentPlugin { action_selection: ActionSelection::EpsilonGreedy, seed: 0, arenas: 0 },
        TrainingPlugin,
    ));
}

/// Begins a training in place of whatever goes on in `world`.
pub fn start_training(
    world: &mut World,
    scenario: &Arc<Scenario>,
    preset: &Preset,
    seed: u64,
    learner: Learner,
) {
    world.insert_resource(preset.observation);
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

/// An app in which fixed policies make single episodes in `arenas` arenas of `scenario`. Whoever puts in a policy
/// puts in its [`Encoding`] too.
pub fn evaluation_app(scenario: &Arc<Scenario>, arenas: usize) -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        ControlStepPlugin,
        TaskPlugin {
            observation: Encoding::default(),
            reward: RewardConfig::default(),
            mode: TaskMode::SingleGoal,
        },
        SimPlugin,
        AgentPlugin { action_selection: ActionSelection::Greedy, seed: 0, arenas },
    ));
    make_ready(&mut app);
    spawn_arenas(app.world_mut(), scenario, arenas, 0);
    app
}

/// What an app's own runner would do before its first step.
fn make_ready(app: &mut App) {
    app.finish();
    app.cleanup();
    app.update();
}

/// One control step in all arenas.
///
/// # Errors
/// No place was found for a start or target; or a number is NaN or infinite: the message says which, where and when.
pub fn step(world: &mut World) -> Result<(), RunError> {
    world.run_schedule(ControlStep);
    if let Some(problem) = &world.resource::<TaskFault>().0 {
        return Err(RunError::Failed(problem.to_string()));
    }
    // (Who only drives does not learn: what broke down then is no hindrance now.)
    let learns = *world.resource::<ActionSelection>() == ActionSelection::EpsilonGreedy;
    let fault = world.get_resource::<TrainingFault>().filter(|_| learns);
    if let Some(diverged) = fault.and_then(|fault| fault.0.as_ref()) {
        return Err(RunError::Failed(diverged.to_string()));
    }
    Ok(())
}
