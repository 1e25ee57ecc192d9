//! The cost of a gradient step and of a forward pass of the paper's network, on one core.
//!
//! `cargo bench --bench learner`: 28 inputs, two hidden layers of 64, 5 actions.

#[path = "support/allocator.rs"]
mod allocator;

use divan::{Bencher, counter::ItemsCount};
use wayfield::learning::{
    Experience, Exploration, Learner, LearningConfig, Loss, NetworkConfig, Optimizer, ReplayConfig, Sampling,
    Schedule, TargetUpdate,
};
use wayfield::random::{normal, stream, uniform_index};

const INPUTS: usize = 28;
const ACTIONS: usize = 5;

fn main() {
    divan::main();
}

fn config(dueling: bool, batch_size: usize) -> LearningConfig {
    LearningConfig {
        network: NetworkConfig { hidden: vec![64, 64], dueling, ..NetworkConfig::default() },
        double: true,
        gamma: 0.99,
        n_step: 1,
        reward_scale: 0.01,
        loss: Loss::MeanSquared,
        optimizer: Optimizer::RmsProp { smoothing: 0.9, epsilon: 1e-7 },
        learning_rate: Schedule::Constant(0.000_25),
        batch_size,
        replay: ReplayConfig {
            capacity: 100_000,
            learning_starts: 20_000,
            sampling: Sampling::Prioritized {
                alpha: 0.6,
                beta: Schedule::Constant(0.4),
                importance_weights: true,
                epsilon: 1e-3,
            },
        },
        train_freq: 1,
        gradient_steps: 1,
        target_update: TargetUpdate::Hard { every: 2000 },
        exploration: Exploration::PerEpisode { start: 1.0, decay: 0.99, end: 0.05 },
        ..LearningConfig::default()
    }
}

/// A learner with `learning_starts` experiences in its replay buffer, and random observations for further experiences.
struct Bench {
    learner: Learner,
    observations: Vec<Vec<f32>>,
    step: usize,
}

impl Bench {
    fn new(config: &LearningConfig) -> Self {
        let learner = Learner::new(config, INPUTS, ACTIONS, 1, 1).expect("a valid config");
        let mut noise = stream(1, "bench", 0);
        let observations = (0..1000).map(|_| (0..INPUTS).map(|_| normal(&mut noise)).collect()).collect();
        let mut bench = Self { learner, observations, step: 0 };
        while bench.learner.pending_updates() == 0 {
            bench.store();
        }
        bench
    }

    fn store(&mut self) {
        let mut noise = stream(2, "bench", self.step as u64);
        let n = self.observations.len();
        self.learner.store(&Experience {
            env_index: 0,
            observation: &self.observations[self.step % n],
            action: uniform_index(&mut noise, ACTIONS),
            reward: normal(&mut noise),
            next_observation: &self.observations[(self.step + 1) % n],
            terminated: self.step.is_multiple_of(100),
            truncated: false,
        });
        self.step += 1;
    }
}

/// One stored experience and one gradient step.
#[divan::bench(
    args = [(64, false), (64, true), (128, false), (128, true)],
    sample_count = 200,
    sample_size = 20
)]
fn gradient_step(bencher: Bencher, (batch_size, dueling): (usize, bool)) {
    let mut bench = Bench::new(&config(dueling, batch_size));
    bencher.counter(ItemsCount::new(1_usize)).bench_local(|| {
        bench.store();
        bench.learner.train().expect("no divergence")
    });
}

/// The Q-values of `n` observations.
#[divan::bench(args = [1, 16, 64, 256])]
fn forward(bencher: Bencher, n: usize) {
    let learner = Learner::new(&config(true, 64), INPUTS, ACTIONS, 1, 1).expect("a valid config");
    let mut noise = stream(1, "bench", 0);
    let observations: Vec<f32> = (0..n * INPUTS).map(|_| normal(&mut noise)).collect();
    let mut q = Vec::new();
    bencher.counter(ItemsCount::new(n)).bench_local(|| learner.q_values(&observations, n, &mut q));
}
