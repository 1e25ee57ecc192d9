//! A restored learner continues exactly as the saved one would have. A damaged file is an error.

use wayfield_learning::{
    Activation, CheckpointError, Experience, Exploration, Learner, LearningConfig, Loss, Mirror,
    NetworkConfig, Optimizer, QNetwork, ReplayConfig, Sampling, Schedule, TargetUpdate, epsilon_greedy,
};
use wayfield_random::{Stream, normal, stream, uniform_01};

const INPUTS: usize = 4;
const ACTIONS: usize = 3;
const NUM_ENVS: usize = 3;

fn config(sampling: Sampling, n_step: usize) -> LearningConfig {
    LearningConfig {
        network: NetworkConfig { hidden: vec![8, 8], dueling: n_step == 1, ..NetworkConfig::default() },
        n_step,
        batch_size: 16,
        optimizer: if n_step == 1 {
            Optimizer::RmsProp { smoothing: 0.9, epsilon: 1e-7 }
        } else {
            Optimizer::Adam { beta1: 0.9, beta2: 0.999, epsilon: 1e-8 }
        },
        learning_rate: Schedule::Linear { from: 1e-3, to: 1e-4, env_steps: 2000 },
        // Less than the number of env steps, so that the ring buffers wrap around.
        replay: ReplayConfig { capacity: 150, learning_starts: 50, sampling },
        train_freq: 4,
        gradient_steps: 2,
        target_update: if n_step == 1 {
            TargetUpdate::Hard { every: 7 }
        } else {
            TargetUpdate::Soft { tau: 0.01 }
        },
        exploration: Exploration::PerEpisode { start: 1.0, decay: 0.99, end: 0.05 },
        ..LearningConfig::default()
    }
}

fn configs() -> [LearningConfig; 3] {
    let beta = Schedule::Linear { from: 0.4, to: 1.0, env_steps: 1000 };
    let prioritized = Sampling::Prioritized { alpha: 0.6, beta, importance_weights: true, epsilon: 1e-3 };
    [config(Sampling::Uniform, 1), config(prioritized, 1), config(prioritized, 3)]
}

/// An environment with random observations. Actions depend on the Q-values, so any difference between two learners soon
/// changes the experiences.
#[derive(Clone)]
struct NoiseEnv {
    observations: [[f32; INPUTS]; NUM_ENVS],
    random: Stream,
}

impl NoiseEnv {
    fn new() -> Self {
        Self { observations: [[0.5; INPUTS]; NUM_ENVS], random: stream(9, "test", 0) }
    }

    fn run(&mut self, learner: &mut Learner, rounds: usize) {
        let mut q = Vec::new();
        for _ in 0..rounds {
            for env_index in 0..NUM_ENVS {
                let observation = self.observations[env_index];
                learner.q_values(&observation, 1, &mut q);
                let (action, _) = epsilon_greedy(&q, learner.epsilon(), &mut self.random);
                let next = std::array::from_fn(|_| normal(&mut self.random) + action as f32);
                // The episodes are so short that transitions are also removed because the state ring is full.
                let (terminated, truncated) =
                    (uniform_01(&mut self.random) < 0.1, uniform_01(&mut self.random) < 0.4);
                learner.store(&Experience {
                    env_index,
                    observation: &observation,
                    action,
                    reward: next[0],
                    next_observation: &next,
                    terminated,
                    truncated,
                });
                self.observations[env_index] = next;
                if terminated || truncated {
                    learner.episode_ended();
                    self.observations[env_index] = [normal(&mut self.random); INPUTS];
                }
            }
            learner.train().expect("no divergence");
        }
    }
}

fn saved(learner: &Learner) -> Vec<u8> {
    let mut bytes = Vec::new();
    learner.save(&mut bytes).expect("memory can be written");
    bytes
}

fn restored(config: &LearningConfig, bytes: &[u8]) -> Result<Learner, CheckpointError> {
    Learner::restore(config, INPUTS, ACTIONS, NUM_ENVS, bytes)
}

#[test]
fn a_restored_learner_continues_with_the_same_bits() {
    for (number, config) in configs().iter().enumerate() {
        for rounds in [0, 3, 40, 200] {
            let mut env = NoiseEnv::new();
            let mut one = Learner::new(config, INPUTS, ACTIONS, NUM_ENVS, 5).expect("a valid config");
            env.run(&mut one, rounds);
            let bytes = saved(&one);
            let mut two = restored(config, &bytes).expect("a valid checkpoint");
            assert_eq!(saved(&two), bytes, "config {number}: saving again gives the same file");

            let mut other_env = env.clone();
            env.run(&mut one, 150);
            other_env.run(&mut two, 150);
            assert!(one.gradient_steps() > 100, "the learner has taken gradient steps in between");
            assert_eq!(saved(&one), saved(&two), "config {number}, saved after {rounds} rounds");
        }
    }
}

#[test]
fn equal_seeds_give_equal_bits_and_different_seeds_differ() {
    for config in &configs() {
        let run = |seed| {
            let mut learner = Learner::new(config, INPUTS, ACTIONS, NUM_ENVS, seed).expect("a valid config");
            NoiseEnv::new().run(&mut learner, 200);
            saved(&learner)
        };
        assert_eq!(run(5), run(5));
        assert_ne!(run(5), run(6));
    }
}

#[test]
fn the_epsilon_of_a_transfer_is_saved() {
    let config = &configs()[0];
    let mut learner = Learner::new(config, INPUTS, ACTIONS, NUM_ENVS, 5).expect("a valid config");
    let policy = Learner::new(config, INPUTS, ACTIONS, NUM_ENVS, 6).expect("a valid config").policy();
    learner.load_weights(&policy, Some(0.5)).expect("the same shape");
    let network = QNetwork::from_policy(&policy).expect("a valid shape");
    assert_eq!(learner.network(), &network, "the learner starts with the policy's weights");
    assert_eq!(learner.target_network(), &network);
    assert_eq!(learner.epsilon(), 0.5);
    assert_eq!(restored(config, &saved(&learner)).expect("a valid checkpoint").epsilon(), 0.5);
}

#[test]
fn a_damaged_file_is_an_error_and_never_a_panic() {
    let config = &configs()[2];
    let mut learner = Learner::new(config, INPUTS, ACTIONS, NUM_ENVS, 5).expect("a valid config");
    NoiseEnv::new().run(&mut learner, 60);
    let bytes = saved(&learner);
    for length in (0..bytes.len()).step_by(7) {
        assert!(restored(config, &bytes[..length]).is_err(), "the first {length} of {} bytes", bytes.len());
    }
    let mut damaged = bytes.clone();
    for at in (0..bytes.len()).filter(|at| *at < 1500 || at % 5 == 0) {
        for flip in [0x01, 0x80, 0xFF] {
            damaged[at] ^= flip;
            assert!(restored(config, &damaged).is_err(), "byte {at} of {} changed by {flip:#x}", bytes.len());
            damaged[at] = bytes[at];
        }
    }
    assert!(matches!(restored(config, b"{ some: json }  "), Err(CheckpointError::NotCheckpoint)));
}

#[test]
fn a_version_1_checkpoint_is_read_and_written_back_bit_for_bit() {
    // Saved by a version whose configs had no options for layer normalization, activation and the like.
    let bytes = include_bytes!("fixtures/checkpoint-version-1.bin");
    let config = &configs()[2];
    let mut learner = restored(config, bytes).expect("a valid checkpoint");
    assert!(learner.env_steps() == 60 && learner.gradient_steps() > 0);
    assert!(saved(&learner) == bytes, "saving again gives the same file");
    NoiseEnv::new().run(&mut learner, 20);
}

/// Asserts that a learner with this config continues from its checkpoint with the same bits, and that no config of `others`
/// can restore the checkpoint.
fn assert_exact_and_rejected_by(config: &LearningConfig, others: &[LearningConfig]) {
    let mut one = Learner::new(config, INPUTS, ACTIONS, NUM_ENVS, 5).expect("a valid config");
    let mut env = NoiseEnv::new();
    env.run(&mut one, 60);
    let bytes = saved(&one);
    let mut two = restored(config, &bytes).expect("a valid checkpoint");
    env.clone().run(&mut one, 100);
    env.run(&mut two, 100);
    assert_eq!(saved(&one), saved(&two));
    for other in others {
        let error = restored(other, &bytes).expect_err("another config");
        assert!(matches!(error, CheckpointError::ConfigMismatch { field: "learning" }), "{error}");
    }
}

#[test]
fn a_version_2_checkpoint_is_exact_and_belongs_to_its_config() {
    for plain in configs() {
        let mut config = plain.clone();
        (config.network.layer_norm, config.network.activation) = (true, Activation::Elu);
        (config.max_gradient_norm, config.weight_decay) = (Some(0.5), 0.01);
        config.learning_rate = Schedule::Step { from: 1e-3, factor: 0.5, every_env_steps: 100 };
        let mut tanh = config.clone();
        tanh.network.activation = Activation::Tanh;
        let mut unclipped = config.clone();
        unclipped.max_gradient_norm = None;
        assert_exact_and_rejected_by(&config, &[plain, tanh, unclipped]);
    }
}

#[test]
fn a_learner_with_a_mirror_continues_with_the_same_bits() {
    let mirror = || {
        let inputs = vec![(1, 1.0), (0, 1.0), (2, -1.0), (3, 1.0)];
        Mirror::new(inputs, vec![2, 1, 0]).expect("an involution")
    };
    for plain in configs() {
        let config = LearningConfig { mirror: true, ..plain.clone() };
        let mut one = Learner::new(&config, INPUTS, ACTIONS, NUM_ENVS, 5).expect("a valid config");
        one.set_mirror(mirror()).expect("the same sizes");
        let mut env = NoiseEnv::new();
        env.run(&mut one, 60);
        let bytes = saved(&one);
        let mut two = restored(&config, &bytes).expect("a valid checkpoint");
        two.set_mirror(mirror()).expect("the same sizes");
        env.clone().run(&mut one, 100);
        env.run(&mut two, 100);
        assert!(saved(&one) == saved(&two), "the restored learner mirrors the same transitions");
        let error = restored(&plain, &bytes).expect_err("another config");
        assert!(matches!(error, CheckpointError::ConfigMismatch { field: "learning" }), "{error}");
        let mut unmirrored = Learner::new(&plain, INPUTS, ACTIONS, NUM_ENVS, 5).expect("a valid config");
        NoiseEnv::new().run(&mut unmirrored, 60);
        assert!(unmirrored.network() != restored(&config, &bytes).expect("a valid checkpoint").network());
    }
}

#[test]
fn a_learner_with_advantage_learning_continues_with_the_same_bits() {
    for plain in configs() {
        let config = LearningConfig { advantage_learning: 0.5, ..plain.clone() };
        let other = LearningConfig { advantage_learning: 0.25, ..plain.clone() };
        assert_exact_and_rejected_by(&config, &[plain, other]);
    }
}

#[test]
fn a_learner_with_quantiles_continues_with_the_same_bits() {
    for plain in configs() {
        let plain = LearningConfig { loss: Loss::Huber { delta: 1.0 }, ..plain };
        let config = LearningConfig { quantiles: 4, ..plain.clone() };
        let other = LearningConfig { quantiles: 5, ..plain.clone() };
        assert_exact_and_rejected_by(&config, &[plain, other]);
    }
}

#[test]
fn a_mirror_of_another_size_is_rejected() {
    let mut learner = Learner::new(&configs()[0], INPUTS, ACTIONS, NUM_ENVS, 5).expect("a valid config");
    let mirror = Mirror::new(vec![(0, 1.0); 1], vec![0, 2, 1]).expect("an involution");
    let error = learner.set_mirror(mirror).expect_err("one input").to_string();
    assert!(error.contains("(1, 3)") && error.contains("(4, 3)"), "{error}");
}

#[test]
fn a_checkpoint_of_another_config_is_rejected() {
    let [uniform, prioritized, _] = configs();
    let learner = Learner::new(&uniform, INPUTS, ACTIONS, NUM_ENVS, 5).expect("a valid config");
    let bytes = saved(&learner);
    let error = restored(&prioritized, &bytes).expect_err("another sampling");
    assert!(matches!(error, CheckpointError::ConfigMismatch { field: "learning" }), "{error}");
    let error = Learner::restore(&uniform, INPUTS, ACTIONS, NUM_ENVS + 1, bytes.as_slice())
        .expect_err("more environments");
    assert!(matches!(error, CheckpointError::ConfigMismatch { field: "num_envs" }), "{error}");
}

#[test]
fn pending_updates_are_saved_and_restored() {
    for config in configs() {
        // Two gradient steps after each of the env steps 52, 56, and so on. 1000 env steps fill the buffer several times.
        for (env_steps, pending) in [(90, 20), (1000, 476)] {
            let mut learner = Learner::new(&config, INPUTS, ACTIONS, NUM_ENVS, 5).expect("a valid config");
            for step in 0..env_steps {
                learner.store(&Experience {
                    env_index: 0,
                    observation: &[step as f32; INPUTS],
                    action: 0,
                    reward: 1.0,
                    next_observation: &[step as f32 + 1.0; INPUTS],
                    terminated: step % 9 == 8,
                    truncated: false,
                });
            }
            assert_eq!(learner.pending_updates(), pending);
            let mut again = restored(&config, &saved(&learner)).expect("a valid checkpoint");
            assert_eq!(again.train().expect("no divergence"), learner.train().expect("no divergence"));
        }
    }
}
