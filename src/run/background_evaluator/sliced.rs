//! The background evaluator on a single thread: it works in time slices whenever it is polled.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::Duration;

use bevy::platform::time::Instant;

use super::{Candidate, EpisodeSet, EvalResult};
use crate::run::evaluate::{EvaluationRun, Evaluator};
use crate::scenario::Scenario;
use crate::simulation::Extensions;
use crate::task::EpisodeSetup;

/// Duration of a time slice, in which an evaluation is started or at least one control step is taken.
const SLICE: Duration = Duration::from_millis(3);

/// The evaluator, with the state of the evaluation in progress.
pub struct SlicedEvaluator {
    episodes: EpisodeSet,
    pending: VecDeque<Candidate>,
    evaluator: Evaluator,
    run: Option<EvaluationRun>,
}

impl SlicedEvaluator {
    /// An evaluator that evaluates each policy in the same `episodes` of `scenario`, unless the candidate has its own.
    #[must_use]
    pub fn new(scenario: &Arc<Scenario>, episodes: EpisodeSet, extensions: &Extensions) -> Self {
        // Built here, because building a simulation takes longer than a slice.
        let evaluator = Evaluator::with_extensions(scenario, episodes.count, extensions);
        Self { episodes, pending: VecDeque::new(), evaluator, run: None }
    }

    /// Submits a candidate.
    pub fn submit(&mut self, candidate: Candidate) {
        self.pending.push_back(candidate);
    }

    /// Works for one time slice, or until the result is ready if `wait` is set. Returns the next result, or
    /// `None` if it is not ready or no candidate is pending.
    pub fn poll(&mut self, wait: bool) -> Option<EvalResult> {
        let candidate = self.pending.front()?;
        let began = Instant::now();
        let evaluator = &mut self.evaluator;
        let EpisodeSet { count, seed } = candidate.test.unwrap_or(self.episodes);
        let result = loop {
            let is_done = match &mut self.run {
                Some(run) => evaluator.step(run),
                None => evaluator.start(&candidate.policy, seed, count, EpisodeSetup::Random).map(|run| {
                    self.run = Some(run);
                    false
                }),
            };
            match is_done {
                Ok(false) if wait || began.elapsed() < SLICE => {}
                Ok(false) => return None,
                Ok(true) => {
                    let episodes = self.run.take().map_or_else(Vec::new, |run| run.episodes);
                    break Ok(evaluator.evaluation(&episodes, count, seed));
                }
                Err(error) => {
                    self.run = None;
                    break Err(error);
                }
            }
        };
        let candidate = self.pending.pop_front()?;
        Some(EvalResult { candidate, result, done: Instant::now() })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::run::background_evaluator::threaded::ThreadedEvaluator;
    use crate::run::evaluate::Evaluation;
    use crate::run::shipped;

    #[test]
    fn the_number_of_parallel_arenas_does_not_change_the_episodes() {
        let scenario = Arc::new(shipped::scenario("scenario-2").expect("shipped"));
        let policy = &shipped::policies()[1].policy;
        let episodes = |arenas| {
            Evaluator::new(&scenario, arenas).run(policy, 4, 40, EpisodeSetup::Random).expect("episodes")
        };
        assert_eq!(episodes(16), episodes(40));
    }

    #[test]
    fn slices_and_a_thread_give_the_same_evaluation() {
        let scenario = Arc::new(shipped::scenario("scenario-1").expect("shipped"));
        let policy = &shipped::policies()[0].policy;
        let candidate =
            || Candidate { policy: policy.clone(), env_steps: 0, episodes: 0, gradient_steps: 0, test: None };
        let episodes = EpisodeSet { count: 40, seed: 3 };
        let mut threaded =
            ThreadedEvaluator::start(&scenario, episodes, &Extensions::default()).expect("a thread");
        threaded.submit(candidate()).expect("submitted");
        let expected =
            threaded.poll(true).expect("no panic").expect("a result").result.expect("an evaluation");
        let mut sliced = SlicedEvaluator::new(&scenario, episodes, &Extensions::default());
        sliced.submit(candidate());
        let evaluation = loop {
            if let Some(done) = sliced.poll(false) {
                break done.result.expect("an evaluation");
            }
        };
        assert_eq!(evaluation, expected);

        // A test has its own episodes, and more of them than run in parallel.
        let test = EpisodeSet { count: 100, seed: 4 };
        let tested =
            Evaluator::new(&scenario, 40).run(policy, 4, 100, EpisodeSetup::Random).expect("episodes");
        threaded.submit(Candidate { test: Some(test), ..candidate() }).expect("submitted");
        sliced.submit(Candidate { test: Some(test), ..candidate() });
        for result in [threaded.poll(true).expect("no panic"), sliced.poll(true)] {
            let evaluation = result.expect("a result").result.expect("an evaluation");
            assert_eq!(evaluation, Evaluation::from_episodes(&tested, 100, &scenario.task, 4));
        }
        assert!(sliced.poll(true).is_none(), "no candidate is pending");
    }
}
