//! The examiner: evaluates policies on a thread of its own, while training goes on. (A browser's build has one thread,
//! and an examiner who works in slices: `background_evaluator/sliced.rs`.)
//!
//! In: policies, in order. Out: their examinations, in the same order. An evaluation changes nothing of what is
//! learnt and has a world and streams of its own, so a run's result does not depend on how quick the examiner is.

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

/// Whether who asks for an examination works at it meanwhile, and does not only look whether it is done.
pub const RUNS_ON_CALLER_THREAD: bool = cfg!(target_arch = "wasm32");

/// A policy, and when in the run it was taken.
#[derive(Clone, Debug)]
pub struct Candidate {
    /// The policy, with its card: by that it is shown what it was trained to see.
    pub policy: Policy,
    /// Env steps of the run by then.
    pub env_steps: u64,
    /// Episodes by then.
    pub episodes: u64,
    /// Gradient steps by then.
    pub gradient_steps: u64,
}

/// What came of examining a candidate.
#[derive(Debug)]
pub struct EvalResult {
    /// Who was examined.
    pub candidate: Candidate,
    /// How it did.
    pub result: Result<Evaluation, RunError>,
    /// When that was known.
    pub done: Instant,
}
