//! The learner without a simulation: double dueling DQN with uniform replay in a corridor of five cells.
//!
//! `cargo run --release --no-default-features --example learner_alone`

use wayfield_learning::{
    Experience, Exploration, Learner, LearningConfig, NetworkConfig, Optimizer, ReplayConfig, Sampling,
    Schedule, TargetUpdate, epsilon_greedy, greedy,
};
use wayfield_random::stream;

/// The number of cells. The agent starts in the middle; action 0 moves left, action 1 right. Both ends terminate the
/// episode; the right end gives a reward of 1.
const CELLS: usize = 5;

fn observation(cell: usize) -> [f32; CELLS] {
    std::array::from_fn(|k| f32::from(k == cell))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let config = LearningConfig {
        network: NetworkConfig { hidden: vec![32], ..NetworkConfig::default() },
        gamma: 0.9,
        optimizer: Optimizer::Adam { beta1: 0.9, beta2: 0.999, epsilon: 1e-8 },
        learning_rate: Schedule::Constant(3e-3),
        replay: ReplayConfig { capacity: 10_000, learning_starts: 200, sampling: Sampling::Uniform },
        target_update: TargetUpdate::Soft { tau: 0.02 },
        exploration: Exploration::Linear { start: 1.0, end: 0.1, env_steps: 2_000 },
        ..LearningConfig::default()
    };
    let mut learner = Learner::new(&config, CELLS, 2, 1, 7)?;
    let mut noise = stream(7, "corridor", 0);
    let (mut cell, mut q) = (CELLS / 2, Vec::new());
    for _ in 0..4_000 {
        learner.q_values(&observation(cell), 1, &mut q);
        let (action, _) = epsilon_greedy(&q, learner.epsilon(), &mut noise);
        let next = if action == 1 { cell + 1 } else { cell - 1 };
        let terminated = next == 0 || next == CELLS - 1;
        learner.store(&Experience {
            env_index: 0,
            observation: &observation(cell),
            action,
            reward: f32::from(next == CELLS - 1),
            next_observation: &observation(next),
            terminated,
            truncated: false,
        });
        learner.train()?;
        cell = if terminated { CELLS / 2 } else { next };
    }
    for cell in 1..CELLS - 1 {
        learner.q_values(&observation(cell), 1, &mut q);
        println!("cell {cell}: Q(left) {:.2}, Q(right) {:.2}", q[0], q[1]);
        assert_eq!(greedy(&q), 1, "the learned policy moves right, to the reward");
    }
    Ok(())
}
