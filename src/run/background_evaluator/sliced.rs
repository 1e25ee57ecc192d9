//! The examiner where there is one thread: he works in slices, whenever he is asked.
//!
//! In: policies, in order. Out: their examinations, in the same order, with the same numbers as from a thread.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use bevy::platform::time::Instant;

use super::{Candidate, EvalResult};
use crate::run::RunError;
use crate::run::evaluate::{Evaluation, EvaluationRun, Evaluator};
use crate::scenario::Scenario;
use crate::simulation::Extensions;
use crate::task::EpisodeSetup;

/// So long he works when asked, or one control step if that is longer.
const SLICE: Duration = Duration::from_millis(3);

/// The examiner, seen from the training loop.
pub struct BackgroundEvaluator {
    scenario: Arc<Scenario>,
    episodes: usize,
    seed: u64,
    waiting: VecDeque<Candidate>,
    /// His world, and what is being driven in it.
    evaluator: Evaluator,
    drive: Option<EvaluationRun>,
}

impl BackgroundEvaluator {
    /// An examiner who drives `episodes` episodes of `scenario` with each policy, always the same ones, of
    /// `seed`.
    #[must_use]
    pub fn new(scenario: &Arc<Scenario>, episodes: usize, seed: u64, extensions: &Extensions) -> Self {
        // At once: to build a world takes longer than any slice.
        let evaluator = Evaluator::with_extensions(scenario, episodes, extensions);
        let scenario = scenario.clone();
        Self { scenario, episodes, seed, waiting: VecDeque::new(), evaluator, drive: None }
    }

    /// Hands in a candidate.
    ///
    /// # Errors
    /// None here.
    pub fn submit(&mut self, candidate: Candidate) -> Result<(), RunError> {
        self.waiting.push_back(candidate);
        Ok(())
    }

    /// The next examination: if a slice of work gets it done, or, if `wait`, whatever it takes. None if no
    /// candidate is waiting, or none is done.
    ///
    /// # Errors
    /// None here.
    pub fn poll(&mut self, wait: bool) -> Result<Option<EvalResult>, RunError> {
        let Some(candidate) = self.waiting.front() else { return Ok(None) };
        let began = Instant::now();
        let (scenario, count, evaluator) = (&self.scenario, self.episodes, &mut self.evaluator);
        let result = loop {
            let went_on = match &mut self.drive {
                Some(drive) => evaluator.step(drive),
                None => evaluator
                    .start(&candidate.policy, self.seed, count, EpisodeSetup::Random)
                    .map(|drive| self.drive = Some(drive))
                    .map(|()| false),
            };
            match went_on {
                Ok(false) if wait || began.elapsed() < SLICE => {}
                Ok(false) => return Ok(None),
                Ok(true) => {
                    let driven = self.drive.take().map_or_else(Vec::new, |drive| drive.episodes);
                    break Ok(Evaluation::from_episodes(&driven, count, &scenario.task, self.seed));
                }
                Err(error) => {
                    self.drive = None;
                    break Err(error);
                }
            }
        };
        let examined = self.waiting.pop_front();
        Ok(examined.map(|candidate| EvalResult { candidate, result, done: Instant::now() }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::background_evaluator::threaded;
    use crate::run::shipped;

    #[test]
    fn in_small_batches_the_same_navigations_are_driven() {
        let scenario = Arc::new(shipped::scenario("scenario-2").expect("shipped"));
        let (_, policy) = &shipped::policies()[1];
        let driven = |side_by_side| {
            Evaluator::new(&scenario, side_by_side).run(policy, 4, 40, EpisodeSetup::Random).expect("drives")
        };
        assert_eq!(driven(16), driven(40));
    }

    #[test]
    fn slices_come_to_what_a_thread_comes_to() {
        let scenario = Arc::new(shipped::scenario("scenario-1").expect("shipped"));
        let (_, policy) = &shipped::policies()[0];
        let candidate = || Candidate { policy: policy.clone(), env_steps: 0, episodes: 0, gradient_steps: 0 };
        let mut there = threaded::BackgroundEvaluator::new(&scenario, 40, 3, &Extensions::default());
        there.submit(candidate()).expect("handed in");
        let expected = there.poll(true).expect("alive").expect("handed in").result.expect("drives");
        let mut here = BackgroundEvaluator::new(&scenario, 40, 3, &Extensions::default());
        here.submit(candidate()).expect("handed in");
        let examined = loop {
            if let Some(eval_result) = here.poll(false).expect("none") {
                break eval_result.result.expect("drives");
            }
        };
        assert_eq!(examined, expected);
        assert!(here.poll(true).expect("none").is_none(), "nobody waits");
    }
}
