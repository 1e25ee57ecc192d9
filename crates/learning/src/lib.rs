//! Deep Q-learning in plain Rust: double dueling DQN with prioritized replay (PER-D3QN), without Bevy.
//!
//! A [`Learner`] stores the experiences of any environment with a flat observation and discrete actions, trains a Q-network
//! on them, and computes Q-values to act on. Every part of the algorithm is an option of [`LearningConfig`]. A learner can
//! be saved and restored exactly ([`Learner::save`]), and its network exported as a [`Policy`]. All randomness comes from
//! seeded streams: the same seed gives the same bits on any number of threads.
//!
//! "The paper" is Li, Yue, Shangguan and Jin, [*Navigation of Mobile Robots Based on Deep Reinforcement Learning: Reward
//! Function Optimization and Knowledge Transfer*](https://doi.org/10.1007/s12555-021-0642-7) (2023), which wayfield reproduces.
//!
//! # Example
//!
//! A training loop in a corridor of five cells with a reward at its right end:
//!
//! ```
//! use wayfield_learning::*;
//!
//! /// Action 0 moves left, action 1 moves right. Moving right from the last cell ends the episode with a reward of 1.
//! #[derive(Default)]
//! struct Corridor {
//!     cell: usize,
//! }
//!
//! impl Corridor {
//!     const CELLS: usize = 5;
//!
//!     fn observation(&self) -> [f32; 1] {
//!         [self.cell as f32 / Self::CELLS as f32]
//!     }
//!
//!     /// The reward, and whether the episode has terminated.
//!     fn step(&mut self, action: usize) -> (f32, bool) {
//!         self.cell = if action == 1 { self.cell + 1 } else { self.cell.saturating_sub(1) };
//!         let terminated = self.cell == Self::CELLS;
//!         (f32::from(u8::from(terminated)), terminated)
//!     }
//! }
//!
//! let config = LearningConfig {
//!     network: NetworkConfig { hidden: vec![32], ..NetworkConfig::default() },
//!     gamma: 0.9,
//!     optimizer: Optimizer::Adam { beta1: 0.9, beta2: 0.999, epsilon: 1e-8 },
//!     learning_rate: Schedule::Constant(3e-3),
//!     replay: ReplayConfig { capacity: 10_000, learning_starts: 200, sampling: Sampling::Uniform },
//!     target_update: TargetUpdate::Soft { tau: 0.02 },
//!     exploration: Exploration::Linear { start: 1.0, end: 0.1, env_steps: 2_000 },
//!     ..LearningConfig::default()
//! };
//! let (inputs, actions, num_envs, seed) = (1, 2, 1, 42);
//! let mut learner = Learner::new(&config, inputs, actions, num_envs, seed)?;
//! let mut random = stream(seed, "exploration", 0);
//!
//! let (mut corridor, mut q) = (Corridor::default(), Vec::new());
//! for _ in 0..4_000 {
//!     let observation = corridor.observation();
//!     learner.q_values(&observation, 1, &mut q);
//!     let (action, _) = epsilon_greedy(&q, learner.epsilon(), &mut random);
//!     let (reward, terminated) = corridor.step(action);
//!     let next_observation = &corridor.observation();
//!     learner.store(&Experience {
//!         env_index: 0,
//!         observation: &observation,
//!         action,
//!         reward,
//!         next_observation,
//!         terminated,
//!         truncated: false,
//!     });
//!     learner.train()?;
//!     if terminated {
//!         learner.episode_ended();
//!         corridor = Corridor::default();
//!     }
//! }
//!
//! // The greedy action is to move right in every cell. Its value is the discounted reward, 0.9^(steps to the end - 1).
//! for cell in 0..Corridor::CELLS {
//!     learner.q_values(&Corridor { cell }.observation(), 1, &mut q);
//!     assert_eq!(greedy(&q), 1, "in cell {cell}: {q:?}");
//!     let expected = 0.9_f32.powi((Corridor::CELLS - 1 - cell) as i32);
//!     assert!((q[1] - expected).abs() < 0.1, "in cell {cell}: {} instead of {expected}", q[1]);
//! }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Modules
//!
//! The public types are at the top level, except for the replay buffer and its sum tree.
//!
//! | module | purpose |
//! |---|---|
//! | `config` | the options, their defaults (Table 1 of the paper) and their ranges |
//! | `learner` | storing experiences; the gradient step with TD targets and target network |
//! | `network`, `ops`, `matmul` | the Q-network: parameters, forward pass, gradient; only `network` and `ops` use dfdx |
//! | `thread_pool` | the threads of large matrix products |
//! | `optimizer` | RMSProp and Adam, weight decay, gradient clipping |
//! | [`replay`], `state_ring` | the replay buffer: rings of states and transitions, uniform and prioritized sampling |
//! | [`sum_tree`] | proportional sampling in O(log n) |
//! | `n_step` | n-step returns |
//! | `mirror` | mirrored transitions in a batch |
//! | `exploration` | epsilon-greedy actions and the decay of epsilon |
//! | `divergence` | errors for non-finite values, warnings about Q-values above any possible return |
//! | `checkpoint`, `framing` | saving a learner to a file, and restoring it exactly |
//! | [`limits`] | limits on the config, and on the size of a learner's memory and checkpoint |

mod checkpoint;
mod config;
mod divergence;
mod exploration;
#[doc(hidden)]
pub mod framing;
mod learner;
pub mod limits;
#[cfg(any(test, target_arch = "wasm32"))]
mod matmul;
mod mirror;
mod n_step;
mod network;
mod ops;
mod optimizer;
pub mod replay;
mod state_ring;
pub mod sum_tree;
#[cfg(not(target_arch = "wasm32"))]
mod thread_pool;

pub use checkpoint::CheckpointError;
pub use config::{
    ConfigError, Exploration, LearningConfig, Loss, NetworkConfig, Optimizer, ReplayConfig, Sampling,
    Schedule, TargetUpdate,
};
pub use divergence::{DivergenceError, Overestimate};
pub use exploration::epsilon_greedy;
pub use learner::{Experience, Learner, LoadWeightsError, UpdateStats};
pub use mirror::{Mirror, MirrorError};
pub use network::QNetwork;
pub use wayfield_policy::{Activation, NetworkShape, ParameterView, Policy, PolicyError, greedy};
pub use wayfield_random::{Stream, stream};
