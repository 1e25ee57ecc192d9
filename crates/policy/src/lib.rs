//! The policy core: everything needed to drive a robot with a trained wayfield policy, and nothing else.
//!
//! No Bevy, no dfdx, no allocation per decision. The Python package, the ONNX export, the ROS 2 node and the
//! browser stand on this crate; the app and the learner use its file format and its observation encoding.
//!
//! | module | duty |
//! |---|---|
//! | [`observation`] | a LIDAR scan and a goal become the numbers that the network takes |
//! | [`network`] | the shape of a Q-network, and its forward pass |
//! | [`file`] | a policy as safetensors bytes, with its metadata |
//!
//! # Example
//!
//! Decide what to do with a scan of 24 ranges, for a goal 2 m away and 90 degrees to the left:
//!
//! ```
//! use wayfield_policy::{Encoding, NetworkShape, Policy, Scratch, observation};
//!
//! // `Policy::from_bytes(&std::fs::read("policy.safetensors")?)` reads a trained one.
//! let shape = NetworkShape { inputs: observation::width(24), hidden: vec![8], actions: 5, dueling: true };
//! let parameters = vec![0.01; shape.parameter_count()];
//! let policy = Policy::new(shape, parameters, Default::default())?;
//!
//! let ranges_m = [3.5; 24];
//! let mut input = [0.0; observation::width(24)];
//! observation::encode(Encoding::Scaled, &ranges_m, std::f32::consts::FRAC_PI_2, 2.0, &mut input);
//! let action = policy.act(&input, &mut Scratch::default());
//! assert!(action < 5);
//! # Ok::<(), wayfield_policy::PolicyError>(())
//! ```

pub mod file;
pub mod network;
pub mod observation;

pub use file::{Policy, PolicyError};
pub use network::{NetworkShape, ParameterView, Scratch, ShapeError, greedy};
pub use observation::Encoding;
