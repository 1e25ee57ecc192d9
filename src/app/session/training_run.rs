//! The training run in the app: its configuration, its progress, and the wall time spent on it.
//!
//! The learner itself is [`ActiveLearner`](crate::agent::ActiveLearner); the curves are
//! [`TrainingHistory`](super::TrainingHistory).

use bevy::platform::time::Instant;
use bevy::prelude::*;

use crate::app::commands::PolicySource;
use crate::policy::Policy;
use crate::run::checkpoint::TrainerState;
use crate::run::folder::RunConfig;

/// Number of env steps beyond which a training run may not be discarded without confirmation.
const MAX_ENV_STEPS_TO_DISCARD: u64 = 20_000;

/// Wall time in s beyond which a training run may not be discarded without confirmation: a slow run takes few steps, but the
/// user's time counts.
const MAX_WALL_S_TO_DISCARD: f64 = 60.0;

/// A point in time of the training run. The default is its start.
#[derive(Clone, Copy, Debug, Default)]
struct Moment {
    env_steps: u64,
    wall_s: f64,
}

/// The training run.
#[derive(Resource)]
pub struct TrainingRun {
    /// Configuration with every name and file resolved. Its scenario includes all later changes: moved objects, edits, and
    /// changes of its file.
    pub config: RunConfig,
    /// Progress apart from the learner: evaluation results, best policy, milestones.
    pub trainer_state: TrainerState,
    /// Policy from whose weights training started, if any.
    pub initial_policy: Option<Policy>,
    /// Whether training cannot continue because of a fault, such as a non-finite number. A scenario without room for a start or a
    /// goal does not count, because the user can change it.
    pub has_failed: bool,
    /// When the policy or the run was saved last; the start of the run if neither was.
    saved_at: Moment,
    /// The policy that Test, Drive and Compare use: the current or the best one.
    pub tested: PolicySource,
    started: Instant,
    /// Wall time in s spent before `started`, if the run was resumed.
    previous_wall_s: f64,
}

impl TrainingRun {
    /// A run whose wall clock starts now.
    pub(super) fn new(
        config: RunConfig,
        initial_policy: Option<Policy>,
        trainer_state: TrainerState,
    ) -> Self {
        let previous_wall_s = trainer_state.wall_s;
        let started = Instant::now();
        Self {
            config,
            trainer_state,
            initial_policy,
            has_failed: false,
            tested: PolicySource::Current,
            saved_at: Moment::default(),
            started,
            previous_wall_s,
        }
    }

    /// Wall time in s spent on the run so far.
    pub(super) fn wall_s(&self) -> f64 {
        self.previous_wall_s + self.started.elapsed().as_secs_f64()
    }

    /// Whether the run, now at `env_steps`, has trained long enough to be worth keeping, saved or not.
    #[must_use]
    pub fn is_worth_keeping(&self, env_steps: u64) -> bool {
        self.is_long_since(Moment::default(), env_steps)
    }

    /// Whether replacing this run at `env_steps` would lose training worth keeping: all training since the last save, or since
    /// the start if the run was never saved.
    #[must_use]
    pub fn would_lose_training(&self, env_steps: u64) -> bool {
        self.is_long_since(self.saved_at, env_steps)
    }

    /// Whether so much training has happened since `since` that it may not be discarded without confirmation. The run is now at
    /// `env_steps`.
    fn is_long_since(&self, since: Moment, env_steps: u64) -> bool {
        let steps = env_steps.saturating_sub(since.env_steps);
        steps > MAX_ENV_STEPS_TO_DISCARD || steps > 0 && self.wall_s() - since.wall_s > MAX_WALL_S_TO_DISCARD
    }

    /// Records that the policy or the run was saved at `env_steps`.
    pub(super) fn mark_saved(&mut self, env_steps: u64) {
        self.saved_at = Moment { env_steps, wall_s: self.wall_s() };
    }
}
