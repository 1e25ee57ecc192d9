//! The background evaluator: evaluates policies while training continues.
//!
//! In: candidate policies. Out: their evaluations, in the same order. Evaluations use a separate simulation
//! and separate random streams, so that a run's result does not depend on how fast they are.
//!
//! Natively the evaluator has a thread (`threaded.rs`). A browser build has only one thread, so there the
//! evaluator works in time slices (`sliced.rs`).

#[cfg(any(test, target_arch = "wasm32"))]
mod sliced;
#[cfg(not(target_arch = "wasm32"))]
mod threaded;

#[cfg(target_arch = "wasm32")]
pub use sliced::BackgroundEvaluator;
#[cfg(not(target_arch = "wasm32"))]
pub use threaded::BackgroundEvaluator;

use bevy::platform::time::Instant;

use super::RunError;
use super::evaluate::Evaluation;
use crate::policy::Policy;

/// Whether [`BackgroundEvaluator::poll`] does the work itself, on the caller's thread.
pub const RUNS_ON_CALLER_THREAD: bool = cfg!(target_arch = "wasm32");

/// A policy to evaluate, and its position in the run.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The policy, with its card, which defines the encoding of its observations.
    pub policy: Policy,
    /// Env steps of the run so far.
    pub env_steps: u64,
    /// Finished episodes of the run so far.
    pub episodes: u64,
    /// Gradient steps of the run so far.
    pub gradient_steps: u64,
}

/// The result of evaluating a candidate.
#[derive(Debug)]
pub struct EvalResult {
    /// The candidate.
    pub candidate: Candidate,
    /// The evaluation, or the error that ended it.
    pub result: Result<Evaluation, RunError>,
    /// When the evaluation ended.
    pub done: Instant,
}
