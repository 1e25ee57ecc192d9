//! The policy core: everything needed to drive a robot with a trained wayfield policy, and nothing else.
//!
//! The crate depends on neither Bevy nor dfdx, and with a reused [`Scratch`] a decision allocates no memory. The Python
//! package, the ONNX export and the browser build use it; the app and the learner share its file format and observation
//! encoding.
//!
//! "The paper" is Li, Yue, Shangguan and Jin, [*Navigation of Mobile Robots Based on Deep Reinforcement Learning: Reward
//! Function Optimization and Knowledge Transfer*](https://doi.org/10.1007/s12555-021-0642-7) (2023), which wayfield reproduces.
//!
//! | module | purpose |
//! |---|---|
//! | [`observation`] | the network's inputs, from LIDAR scans and a goal |
//! | [`actions`] | the motions that a policy chooses among |
//! | [`decision`] | the choice of an action by its Q-value |
//! | [`network`] | the shape of a Q-network, and its forward pass |
//! | [`activation`] | the activation functions of the hidden layers |
//! | [`card`] | the policy card: what the inputs and actions mean, and what the policy was trained with |
//! | [`file`](mod@file) | the policy file: safetensors with a card |
//! | [`limits`] | the largest sizes that a policy file may have |
//! | [`range`] | range checks for numbers |
//!
//! # Example
//!
//! Choose an action for a scan of 24 ranges and a goal 2 m away, 90 degrees to the left:
//!
//! ```
//! use wayfield_policy::{Activation, Encoding, NetworkShape, Policy, Scratch, observation};
//!
//! // `Policy::from_bytes(&std::fs::read("policy.safetensors")?)` reads a trained policy.
//! let shape = NetworkShape {
//!     inputs: observation::width(24),
//!     hidden: vec![8],
//!     actions: 5,
//!     dueling: true,
//!     layer_norm: false,
//!     activation: Activation::Relu,
//! };
//! let parameters = vec![0.01; shape.parameter_count()];
//! let policy = Policy::new(shape, parameters)?;
//!
//! let ranges_m = [3.5; 24];
//! let mut input = [0.0; observation::width(24)];
//! observation::encode(Encoding::Scaled, &ranges_m, std::f32::consts::FRAC_PI_2, 2.0, &mut input);
//! let action = policy.act(&input, &mut Scratch::default());
//! assert!(action < 5);
//! # Ok::<(), wayfield_policy::PolicyError>(())
//! ```

pub mod actions;
pub mod activation;
pub mod card;
pub mod decision;
pub mod file;
pub mod limits;
pub mod network;
pub mod observation;
pub mod range;

pub use actions::{ActionSet, MotionLimits, RelativeMotion};
pub use activation::Activation;
pub use card::Card;
pub use decision::Decider;
pub use file::{Policy, PolicyError};
pub use network::{NetworkShape, ParameterView, Scratch, greedy};
pub use observation::Encoding;
pub use range::ConfigError;
