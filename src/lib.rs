//! wayfield: a LIDAR robot learns to navigate, in a Bevy world, by prioritized-replay double dueling DQN.
//!
//! The system of Li, Yue, Shangguan and Jin, *Navigation of Mobile Robots Based on Deep Reinforcement Learning:
//! Reward Function Optimization and Knowledge Transfer* (IJCAS 21(2), 2023). The rooms, from the ground up; each
//! imports only from those above it:
//!
//! | room | what lives there |
//! |---|---|
//! | [`random`] | named, seeded streams of random numbers |
//! | [`scenario`] | what a world is: the RON schema, its checks, its loader |
//! | [`learning`] | what learning is: network, replay buffer, update rules; no Bevy |
//! | [`control_step`] | the schedule of one control step, and its sets |
//! | [`task`] | the Markov decision process: observation, reward, the end of episodes |
//! | [`world`] | the world alive in the ECS: arenas, rapier, robot, obstacles, LIDAR |
//! | [`agent`] | observations -> actions, transitions -> learner |
//! | [`report`] | figures, tables, statistics, pages: drawn and written, not computed here |
//! | [`run`] | what a user does without a window: train, evaluate, resume |
//! | [`reproduce`] | the paper's figures and tables: many runs, one report |
//! | `app` | the window: watch it learn, and take a hand in it (with the feature `gui`) |
//! | [`cli`] | the command line |
//!
//! The browser's build leaves out `cli`, `reproduce` and what only they use; in its place `app` has a door of its own.

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
#[cfg(not(target_arch = "wasm32"))]
pub mod reproduce;
pub mod run;
pub mod sim;
pub mod simulation;
pub mod task;
