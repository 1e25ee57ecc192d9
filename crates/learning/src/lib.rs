//! Learning: a prioritized-replay double dueling deep Q-network (PER-D3QN), readable as plain Rust.
//!
//! In: transitions (observation, action, reward, next observation) from any environment, and a
//! [`LearningConfig`] whose every algorithm choice is a switch. Out: Q-values to act by, a [`Policy`] to
//! keep, and statistics of each training. Nothing here knows of Bevy, of robots or of clocks; all randomness
//! comes from the named streams of [`wayfield_random`], so one seed gives the same bits, always.
//!
//! | file | duty |
//! |---|---|
//! | [`config`] | what can be chosen, and which values make sense |
//! | [`network`] | the Q-network: parameters, forward pass, gradient (with `ops`, the only users of dfdx) |
//! | [`optimizer`] | RMSProp and Adam with visible moments |
//! | [`replay`] | the replay buffer: state ring, transition ring, uniform and prioritized sampling |
//! | [`sum_tree`] | proportional sampling in O(log n) |
//! | [`n_step`] | returns over n steps, one accumulator per arena |
//! | [`exploration`] | epsilon-greedy and its schedules |
//! | [`learner`] | the agent's update rule: when to train, the TD target, the target network |
//! | [`divergence`] | numbers that are none, and Q-values beyond any return |
//! | [`checkpoint`] | everything a learner is, to the bit, in a file |

pub mod checkpoint;
pub mod config;
pub mod divergence;
pub mod exploration;
pub mod learner;
#[cfg(any(test, target_arch = "wasm32"))]
mod matmul;
pub mod n_step;
pub mod network;
mod ops;
pub mod optimizer;
pub mod replay;
mod state_ring;
pub mod sum_tree;

pub use checkpoint::CheckpointError;
pub use config::{
    ConfigError, Exploration, LearningConfig, Loss, NetworkConfig, Optimizer, ReplayConfig, Sampling,
    Schedule, TargetUpdate,
};
pub use divergence::{DivergenceError, Overestimate};
pub use exploration::epsilon_greedy;
pub use learner::{Experience, Learner, LoadWeightsError, MAX_STORED_FLOATS, UpdateStats};
pub use network::QNetwork;
pub use wayfield_policy::{NetworkShape, ParameterView, Policy, PolicyError, greedy};
