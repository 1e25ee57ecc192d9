//! The background evaluator on a separate thread.

use std::io;
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, TryRecvError, channel};
use std::thread;

use bevy::platform::time::Instant;

use super::{Candidate, EpisodeSet, EvalResult};
use crate::run::RunError;
use crate::run::evaluate::Evaluator;
use crate::scenario::Scenario;
use crate::simulation::Extensions;
use crate::task::EpisodeSetup;

/// The training loop's handle to the evaluator thread.
pub struct ThreadedEvaluator {
    candidates: Sender<Candidate>,
    results: Receiver<EvalResult>,
    /// Number of submitted candidates whose results have not been polled.
    pending: usize,
}

impl ThreadedEvaluator {
    /// Starts an evaluator that evaluates each policy in the same `episodes` of `scenario`, unless the candidate has its own.
    ///
    /// # Errors
    /// The thread cannot be started.
    pub fn start(
        scenario: &Arc<Scenario>,
        episodes: EpisodeSet,
        extensions: &Extensions,
    ) -> io::Result<Self> {
        let (candidates, inbox) = channel::<Candidate>();
        let (outbox, results) = channel();
        let (scenario, extensions) = (scenario.clone(), extensions.clone());
        thread::Builder::new().name("evaluator".into()).spawn(move || {
            let mut evaluator = Evaluator::with_extensions(&scenario, episodes.count, &extensions);
            for candidate in inbox {
                let EpisodeSet { count, seed } = candidate.test.unwrap_or(episodes);
                let episodes = evaluator.run(&candidate.policy, seed, count, EpisodeSetup::Random);
                let result = episodes.map(|episodes| evaluator.evaluation(&episodes, count, seed));
                if outbox.send(EvalResult { candidate, result, done: Instant::now() }).is_err() {
                    return;
                }
            }
        })?;
        Ok(Self { candidates, results, pending: 0 })
    }

    /// Submits a candidate.
    ///
    /// # Errors
    /// The evaluator thread has panicked.
    pub fn submit(&mut self, candidate: Candidate) -> Result<(), RunError> {
        self.candidates.send(candidate).map_err(|_| panicked())?;
        self.pending += 1;
        Ok(())
    }

    /// The next result; `None` if no candidate is pending. If the result is not ready, waits for it if `wait` is
    /// set, and otherwise returns `None`.
    ///
    /// # Errors
    /// The evaluator thread has panicked.
    pub fn poll(&mut self, wait: bool) -> Result<Option<EvalResult>, RunError> {
        if self.pending == 0 {
            return Ok(None);
        }
        let result = if wait {
            self.results.recv().map_err(|_| panicked())?
        } else {
            match self.results.try_recv() {
                Ok(result) => result,
                Err(TryRecvError::Empty) => return Ok(None),
                Err(TryRecvError::Disconnected) => return Err(panicked()),
            }
        };
        self.pending -= 1;
        Ok(Some(result))
    }
}

fn panicked() -> RunError {
    RunError::Failed("the evaluation of a policy panicked (see the message above)".into())
}
