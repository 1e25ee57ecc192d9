//! The background evaluator: evaluates policies while training continues.
//!
//! In: candidate policies. Out: their evaluations, in the same order. Evaluations use a separate simulation
//! and separate random streams, so that a run's result does not depend on how fast they are.
//!
//! The evaluator has its own thread (`threaded.rs`). If no thread can be started, as in a browser or when the process limit
//! is reached, it works in time slices on the caller's thread (`sliced.rs`).

mod sliced;
#[cfg(not(target_arch = "wasm32"))]
mod threaded;

use std::sync::Arc;

use bevy::platform::time::Instant;

use super::RunError;
use super::evaluate::Evaluation;
use crate::policy::Policy;
use crate::scenario::Scenario;
use crate::simulation::Extensions;
use sliced::SlicedEvaluator;
#[cfg(not(target_arch = "wasm32"))]
use threaded::ThreadedEvaluator;

/// The evaluator of a training run.
pub enum BackgroundEvaluator {
    /// An evaluator with its own thread.
    #[cfg(not(target_arch = "wasm32"))]
    Threaded(ThreadedEvaluator),
    /// An evaluator that works when it is polled.
    Sliced(Box<SlicedEvaluator>),
}

impl BackgroundEvaluator {
    /// An evaluator that evaluates each policy in the same `episodes` of `scenario`, unless the candidate has its own.
    #[must_use]
    pub fn new(scenario: &Arc<Scenario>, episodes: EpisodeSet, extensions: &Extensions) -> Self {
        #[cfg(not(target_arch = "wasm32"))]
        if let Ok(evaluator) = ThreadedEvaluator::start(scenario, episodes, extensions) {
            return Self::Threaded(evaluator);
        }
        Self::Sliced(Box::new(SlicedEvaluator::new(scenario, episodes, extensions)))
    }

    /// Whether [`poll`](Self::poll) does the work itself, on the caller's thread.
    #[must_use]
    pub fn runs_on_caller_thread(&self) -> bool {
        matches!(self, Self::Sliced(_))
    }

    /// Submits a candidate.
    ///
    /// # Errors
    /// The evaluator's thread has panicked.
    pub fn submit(&mut self, candidate: Candidate) -> Result<(), RunError> {
        match self {
            #[cfg(not(target_arch = "wasm32"))]
            Self::Threaded(evaluator) => evaluator.submit(candidate),
            Self::Sliced(evaluator) => {
                evaluator.submit(candidate);
                Ok(())
            }
        }
    }

    /// The next result; `None` if it is not ready or no candidate is pending. With `wait`, waits until it is ready.
    ///
    /// # Errors
    /// The evaluator's thread has panicked.
    pub fn poll(&mut self, wait: bool) -> Result<Option<EvalResult>, RunError> {
        match self {
            #[cfg(not(target_arch = "wasm32"))]
            Self::Threaded(evaluator) => evaluator.poll(wait),
            Self::Sliced(evaluator) => Ok(evaluator.poll(wait)),
        }
    }
}

/// The episodes of an evaluation: their number, and the seed from which they are drawn.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct EpisodeSet {
    /// Number of episodes.
    pub count: usize,
    /// The seed of their starts, goals and obstacles.
    pub seed: u64,
}

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
    /// The episodes of a test; `None` for an evaluation, which uses the evaluator's episodes.
    pub test: Option<EpisodeSet>,
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
