//! A NaN is reported in the step in which it occurs, with its cause, and that step is not stored.

use std::sync::Arc;

use bevy::prelude::*;
use wayfield::agent::ActiveLearner;
use wayfield::run::{shipped, training_setup};
use wayfield::simulation::{Extensions, Simulation};
use wayfield::task::{Arena, Goal};

/// A training run in three arenas of Scenario I, after ten steps.
fn three_arenas() -> Simulation {
    let mut config = wayfield::run::folder::RunConfig::resolve("scenario-1", "fast", 5).expect("shipped");
    config.preset.arenas = 3;
    let learner = training_setup::create_learner(&config, None).expect("a learner");
    let scenario = Arc::new(shipped::scenario("scenario-1").expect("shipped"));
    let mut simulation =
        training_setup::training(&scenario, &config.preset, 5, learner, &Extensions::default());
    for _ in 0..10 {
        simulation.step().expect("a valid step");
    }
    simulation
}

#[test]
fn a_nan_goal_is_reported_in_the_next_step() {
    let mut simulation = three_arenas();
    let world = simulation.world_mut();
    let mut arenas = world.query::<(&Arena, &mut Goal)>();
    for (_, mut goal) in arenas.iter_mut(world).filter(|(arena, _)| arena.0 == 1) {
        goal.y_m = f32::NAN;
    }
    assert_eq!(world.resource::<ActiveLearner>().0.env_steps(), 30);
    let error = wayfield::simulation::step(world).expect_err("the goal is NaN").to_string();
    assert!(error.starts_with("arena 1, step 11: the goal lies at ("), "{error}");
    assert!(error.contains("NaN m)"), "{error}");
    assert_eq!(world.resource::<ActiveLearner>().0.env_steps(), 30, "no transition of that step is stored");
}
