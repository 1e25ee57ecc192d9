//! The headless app: the rooms' plugins, put together.
//!
//! In: a scenario, arenas, a seed. Out: an [`App`] whose world runs [`ControlStep`]
//! as often as its caller likes. The windowed app will add the same plugins.

use std::sync::Arc;

use bevy::prelude::*;

use super::RunError;
use crate::agent::{Acting, AgentPlugin, Trainer, TrainingFault, TrainingPlugin};
use crate::control_step::{ControlStep, ControlStepPlugin};
use crate::learning::Learner;
use crate::scenario::Scenario;
use crate::task::{Encoding, RewardConfig, TaskFault, TaskMode, TaskPlugin};
use crate::world::{WorldPlugin, populate};

/// An app in which `learner` trains in `arenas` arenas of `scenario`, every arena at its first observation.
pub fn training(
    scenario: &Arc<Scenario>,
    observation: Encoding,
    reward: &RewardConfig,
    arenas: usize,
    seed: u64,
    learner: Learner,
) -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        ControlStepPlugin,
        TaskPlugin { observation, reward: reward.clone(), mode: TaskMode::Continuing },
        WorldPlugin,
        AgentPlugin { acting: Acting::Exploring, seed, arenas },
        TrainingPlugin,
    ))
    .insert_resource(Trainer(learner));
    ready(app, scenario, arenas, seed)
}

/// An app in which fixed policies make single navigations in `arenas` arenas of `scenario`. Whoever puts in a policy
/// puts in its [`Encoding`] too.
pub fn navigating(scenario: &Arc<Scenario>, arenas: usize) -> App {
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        ControlStepPlugin,
        TaskPlugin {
            observation: Encoding::default(),
            reward: RewardConfig::default(),
            mode: TaskMode::SingleNavigation,
        },
        WorldPlugin,
        AgentPlugin { acting: Acting::Greedy, seed: 0, arenas },
    ));
    ready(app, scenario, arenas, 0)
}

fn ready(mut app: App, scenario: &Arc<Scenario>, arenas: usize, seed: u64) -> App {
    app.finish();
    app.cleanup();
    app.update();
    populate(app.world_mut(), scenario, arenas, seed);
    app
}

/// One control step in all arenas.
///
/// # Errors
/// No place was found for a start or target; or learning diverged.
pub fn step(app: &mut App) -> Result<(), RunError> {
    let world = app.world_mut();
    world.run_schedule(ControlStep);
    if let Some(problem) = &world.resource::<TaskFault>().0 {
        return Err(RunError::Failed(problem.clone()));
    }
    if let Some(diverged) = world.get_resource::<TrainingFault>().and_then(|fault| fault.0.as_ref()) {
        return Err(RunError::Failed(diverged.to_string()));
    }
    Ok(())
}
