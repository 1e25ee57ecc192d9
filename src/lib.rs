//! wayfield trains a mobile robot with a LIDAR to drive to a goal among obstacles, without a map. It is a [Bevy]
//! simulation with [rapier] physics, a double dueling DQN with prioritized replay, and an app to watch both.
//!
//! It implements Li, Yue, Shangguan and Jin, [*Navigation of Mobile Robots Based on Deep Reinforcement Learning: Reward
//! Function Optimization and Knowledge Transfer*](https://doi.org/10.1007/s12555-021-0642-7) (2023). Equation and table
//! numbers in these pages refer to that paper.
//!
//! # Install and run
//!
//! From a clone of the repository, with a stable Rust toolchain and a C compiler:
//!
//! ```sh
//! cargo train                # train without a window; writes a run folder
//! cargo run --release        # open the app
//! ```
//!
//! In another crate, add this repository as a dependency. The library alone needs no window: set
//! `default-features = false`.
//!
//! # Quick start
//!
//! Sixteen robots in the paper's Scenario I turn towards their goals and ignore the obstacles:
//!
//! ```
//! use wayfield::env::{VecEnv, VecEnvConfig};
//! use wayfield::run::shipped;
//!
//! let scenario = shipped::scenario("scenario-1")?;
//! let mut env = VecEnv::new(&scenario, VecEnvConfig { num_envs: 16, ..VecEnvConfig::default() })?;
//! env.reset(7)?;
//! let (mut actions, mut goals) = ([2; 16], 0);
//! for _ in 0..500 {
//!     for (action, observation) in actions.iter_mut().zip(env.observations().chunks_exact(28)) {
//!         // Element 24 is the goal's bearing / pi, left positive. Actions: 0 turns left, 2 drives straight, 4 turns right.
//!         *action = if observation[24] > 0.05 { 0 } else if observation[24] < -0.05 { 4 } else { 2 };
//!     }
//!     let step = env.step(&actions)?;
//!     goals += step.outcomes.iter().filter(|outcome| outcome.reached).count();
//! }
//! assert!(goals > 0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The repository's `examples/` show headless training, the evaluation of a policy, a custom sensor, a custom reward term
//! and the learner without a simulation.
//!
//! # Crates
//!
//! These crates do not depend on Bevy. This crate re-exports all but `wayfield_orca`, `wayfield_ron_patch` and
//! `wayfield_protobuf`.
//!
//! | crate | contents |
//! |---|---|
//! | [`wayfield_random`] | named, seeded streams of random numbers |
//! | [`wayfield_policy`] | policy files, the encoding of observations, the forward pass |
//! | [`wayfield_drivers`] | drivers: classical ones (potential field, DWA, A*, ORCA), and policies with or without a map |
//! | [`wayfield_export`] | a policy as an ONNX file, and its model card |
//! | [`wayfield_import`] | scenarios from ROS maps, images, SDF worlds, BARN worlds and the stages of turtlebot3_drlnav |
//! | `wayfield_protobuf` | a writer and a reader of protobuf messages |
//! | [`wayfield_scenario`] | scenarios: the RON schema, its checks, geometry, generators |
//! | `wayfield_orca` | optimal reciprocal collision avoidance (ORCA), used by pedestrians and by the driver `orca` |
//! | `wayfield_ron_patch` | a RON writer that keeps comments |
//! | [`wayfield_learning`] | the learner: Q-network, replay buffer, update rules |
//! | [`wayfield_planner`] | time-optimal paths, and lower bounds on the number of steps |
//! | [`wayfield_report`] | figures, tables, statistics and report pages |
//!
//! # Modules
//!
//! Each module uses only those above it.
//!
//! | module | contents |
//! |---|---|
//! | [`limits`] | the limits of files and of the numbers in them |
//! | [`control_step`] | the schedule of a control step, and its sets |
//! | [`task`] | the Markov decision process: observation, reward, termination, starts and goals |
//! | [`sim`] | arenas, physics, robot, obstacles and LIDAR in the ECS |
//! | [`agent`] | the choice of actions, and training |
//! | [`simulation`] | [`SimulationBuilder`](simulation::SimulationBuilder): a simulation from a scenario, a seed and plugins |
//! | [`env`](mod@env) | [`VecEnv`](env::VecEnv): a vectorized environment with Gymnasium's interface |
//! | [`run`] | training, evaluation, run folders and checkpoints |
//! | [`reproduce`] | the paper's figures and tables |
//! | `app` | the app (feature `gui`) |
//! | [`cli`] | the command line |
//!
//! # Extension points
//!
//! - A **sensor** adds a named slice to the observation: [`add_sensor`](task::SimulationAppExt::add_sensor).
//! - A **reward term** is added to the reward and logged by name:
//!   [`add_reward_term`](task::SimulationAppExt::add_reward_term).
//! - Any other Bevy system can run in the sets of a [`ControlStep`](control_step::ControlStep).
//! - [`Extensions`](simulation::Extensions) passes such plugins to training, evaluation and environments.
//! - [`cli::main`] runs the whole command line with such plugins, from your own `main`.
//!
//! # Features
//!
//! | feature | contents |
//! |---|---|
//! | `gui` (default) | the app, with Bevy's renderer and egui |
//!
//! The build for the browser (`wasm32`) has no [`cli`] and no [`reproduce`].
//!
//! [Bevy]: https://bevyengine.org
//! [rapier]: https://rapier.rs

pub use wayfield_drivers as drivers;
pub use wayfield_export as export;
pub use wayfield_import as import;
pub use wayfield_learning as learning;
pub use wayfield_planner as planner;
pub use wayfield_policy as policy;
pub use wayfield_random as random;
pub use wayfield_report as report;
pub use wayfield_scenario as scenario;

pub mod agent;
#[cfg(feature = "gui")]
pub mod app;
#[cfg(not(target_arch = "wasm32"))]
pub mod cli;
pub mod control_step;
pub mod env;
#[cfg(test)]
mod format_docs;
#[cfg(test)]
mod generated_section;
pub mod limits;
#[cfg(not(target_arch = "wasm32"))]
pub mod reproduce;
pub mod run;
pub mod sim;
pub mod simulation;
pub mod task;
