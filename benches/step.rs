//! The cost of a control step: physics, LIDAR, reward and resets, with random actions or with a greedy agent.
//!
//! `cargo bench --bench step`; items are env steps.

#[path = "support/allocator.rs"]
mod allocator;
#[path = "../tests/common/mod.rs"]
mod common;

use std::sync::Arc;

use bevy::ecs::message::Messages;
use divan::Bencher;
use divan::counter::ItemsCount;
use wayfield::agent::{ActionSelection, GreedyPolicy};
use wayfield::control_step::ControlStep;
use wayfield::env::{VecEnv, VecEnvConfig};
use wayfield::learning::{Activation, NetworkShape, QNetwork};
use wayfield::random;
use wayfield::scenario::Scenario;
use wayfield::simulation::SimulationBuilder;
use wayfield::task::{EpisodeEnded, TaskMode, observation};

fn main() {
    divan::main();
}

const ARENAS: [usize; 4] = [1, 16, 64, 256];

#[divan::bench(args = ARENAS)]
fn static_obstacles(bencher: Bencher, arenas: usize) {
    control_step(bencher, &common::four_cylinders(), arenas);
}

#[divan::bench(args = ARENAS)]
fn moving_obstacles(bencher: Bencher, arenas: usize) {
    control_step(bencher, &common::moving_obstacles(), arenas);
}

/// 277 static circles: `large_worlds::barn`.
#[divan::bench(args = ARENAS)]
fn barn(bencher: Bencher, arenas: usize) {
    control_step(bencher, &common::large_worlds::barn(), arenas);
}

/// 764 static shapes, including the enclosure's four sides, on 50 m x 50 m: `large_worlds::office`.
#[divan::bench(args = ARENAS)]
fn office(bencher: Bencher, arenas: usize) {
    control_step(bencher, &common::large_worlds::office(), arenas);
}

/// With the forward pass of the network of the paper's Table 1 (28-64-64, dueling). Its weights are untrained, which does not
/// change the cost.
#[divan::bench(args = ARENAS)]
fn with_greedy_agent(bencher: Bencher, arenas: usize) {
    let scenario = Arc::new(common::four_cylinders());
    let shape = NetworkShape {
        inputs: observation::width(scenario.lidar.beams),
        hidden: vec![64, 64],
        actions: scenario.robot.motions.len(),
        dueling: true,
        layer_norm: false,
        activation: Activation::Relu,
    };
    let network = QNetwork::new(shape, &mut random::stream(1, "weights", 0)).expect("a valid shape");
    let mut simulation =
        SimulationBuilder::new(&scenario).arenas(arenas).seed(1).agent(ActionSelection::Greedy).build();
    let world = simulation.world_mut();
    world.insert_resource(GreedyPolicy(network));
    for _ in 0..200 {
        world.run_schedule(ControlStep);
    }
    bencher.counter(ItemsCount::new(arenas)).bench_local(|| {
        world.run_schedule(ControlStep);
        world.resource_mut::<Messages<EpisodeEnded>>().drain().count()
    });
}

fn control_step(bencher: Bencher, scenario: &Scenario, num_envs: usize) {
    let config = VecEnvConfig { num_envs, mode: TaskMode::Continuing, ..VecEnvConfig::default() };
    let mut env = VecEnv::new(scenario, config).expect("free space for starts and goals");
    let mut streams = common::action_streams(num_envs);
    // Runs until the arenas are at all stages of an episode.
    for _ in 0..200 {
        env.step(&common::random_actions(&mut streams)).expect("a valid step");
    }
    bencher
        .counter(ItemsCount::new(num_envs))
        .bench_local(|| env.step(&common::random_actions(&mut streams)).expect("a valid step").ended.len());
}
