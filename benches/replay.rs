//! The cost of the replay buffer at the paper's size of 1,000,000 transitions.
//!
//! `cargo bench --bench replay`.

#[path = "support/allocator.rs"]
mod allocator;

use divan::{Bencher, counter::ItemsCount};
use wayfield::learning::replay::{Batch, ReplayBuffer, Transition};
use wayfield::learning::sum_tree::SumTree;
use wayfield::learning::{ReplayConfig, Sampling, Schedule};
use wayfield::random::{stream, uniform_01, uniform_index};

const CAPACITY: usize = 1_000_000;

fn main() {
    divan::main();
}

fn full_tree() -> SumTree {
    let mut tree = SumTree::new(CAPACITY);
    let mut noise = stream(1, "bench", 0);
    tree.set_all((0..CAPACITY).map(|_| f64::from(uniform_01(&mut noise)) + 0.01));
    tree
}

#[divan::bench]
fn sum_tree_set(bencher: Bencher) {
    let mut tree = full_tree();
    let mut noise = stream(2, "bench", 0);
    bencher.bench_local(|| {
        tree.set(uniform_index(&mut noise, CAPACITY), f64::from(uniform_01(&mut noise)) + 0.01);
    });
}

#[divan::bench]
fn sum_tree_find(bencher: Bencher) {
    let tree = full_tree();
    let mut noise = stream(2, "bench", 0);
    bencher.bench_local(|| tree.find(tree.total() * f64::from(uniform_01(&mut noise))));
}

/// Draws a batch of 64 from a full buffer. With prioritized sampling, also updates its priorities.
#[divan::bench(args = [false, true], sample_size = 10)]
fn sample_64(bencher: Bencher, prioritized: bool) {
    let beta = Schedule::Constant(0.4);
    let sampling = if prioritized {
        Sampling::Prioritized { alpha: 0.6, beta, importance_weights: true, epsilon: 1e-3 }
    } else {
        Sampling::Uniform
    };
    let config = ReplayConfig { capacity: CAPACITY, learning_starts: 0, sampling };
    let mut replay = ReplayBuffer::new(&config, 28, 2);
    let mut state = replay.push_state(&[0.0; 28]);
    for i in 0..CAPACITY {
        let next = replay.push_state(&[i as f32; 28]);
        replay.push(&Transition {
            state,
            action: 0,
            reward: 1.0,
            discount: 0.99,
            next,
            terminated: false,
            truncated: false,
        });
        state = next;
    }
    let mut noise = stream(2, "bench", 0);
    let mut batch = Batch::default();
    bencher.counter(ItemsCount::new(64_usize)).bench_local(|| {
        replay.sample(64, 0, &mut noise, &mut batch);
        let errors: Vec<f32> = batch.slots.iter().map(|_| uniform_01(&mut noise)).collect();
        replay.update_priorities(&batch.slots, &errors);
    });
}
