//! The examiner: evaluates policies on a thread of its own, while training goes on; in a browser, which has one thread,
//! in slices whenever he is asked.
//!
//! In: policies, in order. Out: their examinations, in the same order. An evaluation changes nothing of what is
//! learnt and has a world and streams of its own, so a run's result does not depend on how quick the examiner is.

use std::sync::Arc;

use bevy::platform::time::Instant;

use super::RunError;
use super::evaluate::Evaluation;
use crate::learning::Policy;
use crate::scenario::Scenario;

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
pub struct Examination {
    /// Who was examined.
    pub candidate: Candidate,
    /// How it did.
    pub result: Result<Evaluation, RunError>,
    /// When that was known.
    pub done: Instant,
}

#[cfg(target_arch = "wasm32")]
pub use sliced::Examiner;
#[cfg(not(target_arch = "wasm32"))]
pub use threaded::Examiner;

#[cfg(not(target_arch = "wasm32"))]
mod threaded {
    //! He has a thread.

    use std::sync::mpsc::{Receiver, Sender, channel};
    use std::thread;

    use super::super::evaluate::Evaluator;
    use super::*;
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
}

#[cfg(target_arch = "wasm32")]
mod sliced {
    //! He has the time that he is given.

    use std::collections::VecDeque;
    use std::time::Duration;

    use super::super::evaluate::{Drive, Evaluator};
    use super::*;
    use crate::task::Places;

    /// So long he works when asked, or one control step if that is longer.
    const SLICE: Duration = Duration::from_millis(3);

    /// The examiner, seen from the training loop.
    pub struct Examiner {
        scenario: Arc<Scenario>,
        navigations: usize,
        seed: u64,
        waiting: VecDeque<Candidate>,
        /// His world, and what is being driven in it.
        evaluator: Option<Evaluator>,
        drive: Option<Drive>,
    }

    impl Examiner {
        /// An examiner who drives `navigations` navigations of `scenario` with each policy, always the same ones, of
        /// `seed`.
        #[must_use]
        pub fn new(scenario: &Arc<Scenario>, navigations: usize, seed: u64) -> Self {
            let scenario = scenario.clone();
            Self { scenario, navigations, seed, waiting: VecDeque::new(), evaluator: None, drive: None }
        }

        /// Hands in a candidate.
        ///
        /// # Errors
        /// None here.
        pub fn hand_in(&mut self, candidate: Candidate) -> Result<(), RunError> {
            self.waiting.push_back(candidate);
            Ok(())
        }

        /// The next examination: if a slice of work gets it done, or, if `wait`, whatever it takes. None if no
        /// candidate is waiting, or none is done.
        ///
        /// # Errors
        /// None here.
        pub fn take(&mut self, wait: bool) -> Result<Option<Examination>, RunError> {
            let Some(candidate) = self.waiting.front() else { return Ok(None) };
            let began = Instant::now();
            let (scenario, count) = (&self.scenario, self.navigations);
            let evaluator = self.evaluator.get_or_insert_with(|| Evaluator::new(scenario, count));
            let result = loop {
                let went_on = match &mut self.drive {
                    Some(drive) => evaluator.go_on(drive),
                    None => evaluator
                        .start(&candidate.policy, self.seed, count, Places::Drawn)
                        .map(|drive| self.drive = Some(drive))
                        .map(|()| false),
                };
                match went_on {
                    Ok(false) if wait || began.elapsed() < SLICE => {}
                    Ok(false) => return Ok(None),
                    Ok(true) => {
                        let driven = self.drive.take().map_or_else(Vec::new, |drive| drive.navigations);
                        break Ok(Evaluation::of(&driven, count, &scenario.task, self.seed));
                    }
                    Err(error) => {
                        self.drive = None;
                        break Err(error);
                    }
                }
            };
            let examined = self.waiting.pop_front();
            Ok(examined.map(|candidate| Examination { candidate, result, done: Instant::now() }))
        }
    }
}
