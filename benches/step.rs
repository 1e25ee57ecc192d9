//! One control step of world and task (physics, LIDAR, reward, restarts) with random actions; and the same with
//! everything in, the forward pass of a greedy agent too.
//!
//! `cargo bench --bench step`; items are environment steps.

#[path = "support/allocator.rs"]
mod allocator;
#[path = "../tests/common/mod.rs"]
mod common;

use std::collections::BTreeMap;
use std::sync::Arc;

use bevy::ecs::message::Messages;
use bevy::prelude::*;
use common::Lab;
use divan::Bencher;
use divan::counter::ItemsCount;
use wayfield::agent::{ActionSelection, AgentPlugin, GreedyPolicy};
use wayfield::control_step::{ControlStep, ControlStepPlugin};
use wayfield::learning::{NetworkShape, Policy, QNetwork};
use wayfield::random;
use wayfield::scenario::Scenario;
use wayfield::sim::{self, SimPlugin};
use wayfield::task::{Encoding, EpisodeEnded, RewardConfig, TaskMode, TaskPlugin, observation};

fn main() {
    divan::main();
}

const ARENAS: [usize; 4] = [1, 16, 64, 256];

#[divan::bench(args = ARENAS)]
fn still_obstacles(bencher: Bencher, arenas: usize) {
    control_step(bencher, &common::four_cylinders(), arenas);
}

#[divan::bench(args = ARENAS)]
fn moving_obstacles(bencher: Bencher, arenas: usize) {
    control_step(bencher, &common::moving_obstacles(), arenas);
}

/// The network is Table 1's (28-64-64, dueling) with its first weights: it drives badly, at the same cost.
#[divan::bench(args = ARENAS)]
fn everything_in(bencher: Bencher, arenas: usize) {
    let scenario = Arc::new(common::four_cylinders());
    let shape = NetworkShape {
        inputs: observation::width(scenario.lidar.beams),
        hidden: vec![64, 64],
        actions: scenario.robot.motions.len(),
        dueling: true,
    };
    let network = QNetwork::new(shape, &mut random::stream(1, "weights", 0)).expect("the shape is sound");
    let mut app = App::new();
    app.add_plugins((
        MinimalPlugins,
        ControlStepPlugin,
        TaskPlugin {
            observation: Encoding::Scaled,
            reward: RewardConfig::default(),
            mode: TaskMode::Continuing,
        },
        SimPlugin,
        AgentPlugin { action_selection: ActionSelection::Greedy, seed: 1, arenas },
    ));
    app.insert_resource(GreedyPolicy(Policy { network, metadata: BTreeMap::new() }));
    app.finish();
    app.cleanup();
    app.update();
    let world = app.world_mut();
    sim::spawn_arenas(world, &scenario, arenas, 1);
    for _ in 0..200 {
        world.run_schedule(ControlStep);
    }
    bencher.counter(ItemsCount::new(arenas)).bench_local(|| {
        world.run_schedule(ControlStep);
        world.resource_mut::<Messages<EpisodeEnded>>().drain().count()
    });
}

fn control_step(bencher: Bencher, scenario: &Scenario, arenas: usize) {
    let mut lab = Lab::new(scenario, arenas, 1);
    let mut action_streams = common::action_streams(arenas);
    // Into the middle of things: episodes at all ages.
    for _ in 0..200 {
        lab.step(&common::random_actions(&mut action_streams));
    }
    bencher.counter(ItemsCount::new(arenas)).bench_local(|| {
        lab.step(&common::random_actions(&mut action_streams));
        lab.take_ended_episodes().len()
    });
}
