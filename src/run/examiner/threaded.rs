//! The examiner where there are threads.
//!
//! In: policies, in order. Out: their examinations, in the same order.

use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::thread;

use bevy::platform::time::Instant;

use super::{Candidate, Examination};
use crate::run::RunError;
use crate::run::evaluate::{Evaluation, Evaluator};
use crate::scenario::Scenario;
use crate::task::Places;

/// The examiner, seen from the training loop.
pub struct Examiner {
    candidates: Sender<Candidate>,
    examinations: Receiver<Examination>,
    /// Candidates handed in whose examination was not taken yet.
    waiting: usize,
}

impl Examiner {
    /// An examiner who drives `navigations` navigations of `scenario` with each policy, always the same ones, of
    /// `seed`.
    #[must_use]
    pub fn new(scenario: &Arc<Scenario>, navigations: usize, seed: u64) -> Self {
        let (candidates, inbox) = channel::<Candidate>();
        let (outbox, examinations) = channel();
        let scenario = scenario.clone();
        thread::spawn(move || {
            let mut evaluator = Evaluator::new(&scenario, navigations);
            for candidate in inbox {
                let driven = evaluator.run(&candidate.policy, seed, navigations, Places::Drawn);
                let result = driven.map(|driven| Evaluation::of(&driven, navigations, &scenario.task, seed));
                if outbox.send(Examination { candidate, result, done: Instant::now() }).is_err() {
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
    pub fn hand_in(&mut self, candidate: Candidate) -> Result<(), RunError> {
        self.candidates.send(candidate).map_err(|_| died())?;
        self.waiting += 1;
        Ok(())
    }

    /// The next examination: if it is done by now, or, if `wait`, as soon as it is. None if no candidate is waiting,
    /// or none is done.
    ///
    /// # Errors
    /// The examiner's thread has died.
    pub fn take(&mut self, wait: bool) -> Result<Option<Examination>, RunError> {
        use std::sync::mpsc::TryRecvError;
        if self.waiting == 0 {
            return Ok(None);
        }
        let examination = if wait {
            self.examinations.recv().map_err(|_| died())?
        } else {
            match self.examinations.try_recv() {
                Ok(examination) => examination,
                Err(TryRecvError::Empty) => return Ok(None),
                Err(TryRecvError::Disconnected) => return Err(died()),
            }
        };
        self.waiting -= 1;
        Ok(Some(examination))
    }
}

fn died() -> RunError {
    RunError::Failed("the evaluation of a policy ended unexpectedly (its own message stands above)".into())
}
