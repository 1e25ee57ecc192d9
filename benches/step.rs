//! One control step of world and task (physics, LIDAR, reward, restarts; no agent), with random actions.
//!
//! `cargo bench --bench step`; items are environment steps.

#[path = "../tests/common/mod.rs"]
mod common;

use common::Lab;
use divan::Bencher;
use divan::counter::ItemsCount;
use wayfield::scenario::Scenario;

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
    control_step(bencher, &common::moving(), arenas);
}

fn control_step(bencher: Bencher, scenario: &Scenario, arenas: usize) {
    let mut lab = Lab::new(scenario, arenas, 1);
    let mut drivers = common::drivers(arenas);
    // Into the middle of things: episodes at all ages.
    for _ in 0..200 {
        lab.step(&common::random_actions(&mut drivers));
    }
    bencher.counter(ItemsCount::new(arenas)).bench_local(|| {
        lab.step(&common::random_actions(&mut drivers));
        lab.ended().len()
    });
}
