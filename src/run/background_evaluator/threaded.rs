//! The examiner where there are threads.
//!
//! In: policies, in order. Out: their examinations, in the same order.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use bevy::platform::time::Instant;

use super::{Candidate, EvalResult};
use crate::run::RunError;
use crate::run::evaluate::{Evaluation, Evaluator};
use crate::scenario::Scenario;
use crate::simulation::Extensions;
use crate::task::EpisodeSetup;

/// The examiner, seen from the training loop.
pub struct BackgroundEvaluator {
    candidates: Sender<Candidate>,
    examinations: Receiver<EvalResult>,
    /// Candidates handed in whose examination was not taken yet.
    waiting: usize,
}

impl BackgroundEvaluator {
    /// An examiner who drives `episodes` episodes of `scenario` with each policy, always the same ones, of
    /// `seed`.
    #[must_use]
    pub fn new(scenario: &Arc<Scenario>, episodes: usize, seed: u64, extensions: &Extensions) -> Self {
        let (candidates, inbox) = channel::<Candidate>();
        let (outbox, examinations) = channel();
        let (scenario, extensions) = (scenario.clone(), extensions.clone());
        thread::spawn(move || {
            let mut evaluator = Evaluator::with_extensions(&scenario, episodes, &extensions);
            for candidate in inbox {
                let driven = evaluator.run(&candidate.policy, seed, episodes, EpisodeSetup::Random);
                let result =
                    driven.map(|driven| Evaluation::from_episodes(&driven, episodes, &scenario.task, seed));
                if outbox.send(EvalResult { candidate, result, done: Instant::now() }).is_err() {
                    return;
                }
            }
        });
        Self { candidates, examinations, waiting: 0 }
    }

    /// Hands in a candidate.
    ///
    /// # Errors
    /// The examiner's thread has died.
    pub fn submit(&mut self, candidate: Candidate) -> Result<(), RunError> {
        self.candidates.send(candidate).map_err(|_| died())?;
        self.waiting += 1;
        Ok(())
    }

    /// The next examination: if it is done by now, or, if `wait`, as soon as it is. None if no candidate is waiting,
    /// or none is done.
    ///
    /// # Errors
    /// The examiner's thread has died.
    pub fn poll(&mut self, wait: bool) -> Result<Option<EvalResult>, RunError> {
        use std::sync::mpsc::TryRecvError;
        if self.waiting == 0 {
            return Ok(None);
        }
        let eval_result = if wait {
            self.examinations.recv().map_err(|_| died())?
        } else {
            match self.examinations.try_recv() {
                Ok(eval_result) => eval_result,
                Err(TryRecvError::Empty) => return Ok(None),
                Err(TryRecvError::Disconnected) => return Err(died()),
            }
        };
        self.waiting -= 1;
        Ok(Some(eval_result))
    }
}

fn died() -> RunError {
    RunError::Failed("the evaluation of a policy ended unexpectedly (its own message stands above)".into())
}
