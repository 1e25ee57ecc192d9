//! The training run in the app: its configuration, its progress, and the wall time spent on it.
//!
//! The learner itself is [`ActiveLearner`](crate::agent::ActiveLearner), the curves are [`TrainingHistory`](super::TrainingHistory).

use bevy::platform::time::Instant;
use bevy::prelude::*;

use crate::app::commands::PolicySource;
use crate::policy::Policy;
use crate::run::checkpoint::TrainerState;
use crate::run::folder::RunConfig;

/// Maximum number of env steps of a training that may be discarded without a confirmation.
const MIN_ENV_STEPS_WORTH_KEEPING: u64 = 20_000;

/// The training run.
#[derive(Resource)]
pub struct TrainingRun {
    /// Configuration with every name and file resolved. Its scenario follows each change made by hand or in the editor.
    pub config: RunConfig,
    /// Progress apart from the learner: evaluation results, best policy, milestones.
    pub trainer_state: TrainerState,
    /// Policy whose weights the training started from, if any.
    pub initial_policy: Option<Policy>,
    /// Whether the training met non-finite numbers and cannot continue.
    pub has_failed: bool,
    /// The policy that Test, Drive and Compare use: the current or the best one.
    pub tested: PolicySource,
    /// Env steps at the last save of the policy or the run.
    pub saved_at: Option<u64>,
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
            saved_at: None,
            started,
            previous_wall_s,
        }
    }

    /// Wall time in s spent on the run so far.
    pub(super) fn wall_s(&self) -> f64 {
        self.previous_wall_s + self.started.elapsed().as_secs_f64()
    }

    /// Whether an unsaved training worth keeping would be lost if another one replaced it at `env_steps`.
    #[must_use]
    pub fn would_lose_training(&self, env_steps: u64) -> bool {
        env_steps > MIN_ENV_STEPS_WORTH_KEEPING && self.saved_at != Some(env_steps)
    }
}
