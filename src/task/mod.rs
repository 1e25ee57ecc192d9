//! The task: the Markov decision process of the paper, as pure functions with thin systems over them.
//!
//! In: poses and LIDAR scans, written by [`sim`](crate::sim). Out: observations (eq. 8), rewards (eqs. 3 and 7), ended
//! episodes, and new starts and goals.
//!
//! | file | purpose |
//! |---|---|
//! | `state.rs` | the components of an arena |
//! | `arena_state.rs` | the state of an arena in a checkpoint, and its check |
//! | `observation.rs` | observations and their layout: eq. (8), then plugins' sensors |
//! | `reward.rs` | the reward of eqs. (3) to (7), term by term |
//! | `outcome.rs` | the outcome of a step: reward, collision, goal, time limit |
//! | `reset.rs` | new starts and goals |
//! | `scenario_pool.rs` | sets of scenarios, from which episodes draw |
//! | `level_progress.rs` | level sampling by learning progress |
//! | `fault.rs` | the faults of a step, and the detection of non-finite numbers |
//! | `extension.rs` | sensors and reward terms of plugins |

mod arena_state;
mod extension;
mod fault;
mod level_progress;
pub mod observation;
mod outcome;
mod reset;
mod reward;
mod scenario_pool;
mod state;

use std::sync::Arc;

use bevy::prelude::*;

pub use arena_state::ArenaState;
pub use extension::{ExtraRewards, RewardTerm, SimulationAppExt};
pub(crate) use fault::step_is_finite;
pub use fault::{Fault, TaskFault};
pub use level_progress::{LevelProgress, LevelResults, LevelSampling};
pub use observation::{
    Encoding, ObservationLayout, ObservationSlice, Observations, PredictionDropout, ScanMemory,
    SensorReadings, SensorSlice,
};
pub use outcome::{EpisodeEnd, EpisodeEnded, StepOutcome, StepOutcomes};
pub use reset::EpisodeSetup;
pub use reward::{Attraction, GoalDistance, Potential, RewardConfig, RewardKind, RewardLengths, RewardTerms};
pub use scenario_pool::{ArenaScenario, ScenarioChoice, ScenarioPool};
pub use state::{
    Arena, ArenaLayout, Clock, Episode, EstimatedPose, Goal, PathLengths, Pedestrians, PendingReset, Pose,
    Scan, Streams, Twist, wrap_angle,
};

use crate::control_step::{ControlSet, ControlStep, Reset, ResetSet, RewardSet, SenseSet};
use crate::drivers::{action_motion, action_motions};
use crate::policy::ActionSet;
use crate::scenario::{Motion, Robot, Scenario};

/// The scenario that the arenas were spawned with. An arena's own is in its [`ArenaLayout`].
#[derive(Resource, Clone, Debug)]
pub struct CurrentScenario(pub Arc<Scenario>);

/// The motions that actions stand for: those of the scenario's robot, unless the policy has its own.
#[derive(Resource, Clone, Debug, Default, PartialEq)]
pub struct ActiveActionSet(pub ActionSet);

impl ActiveActionSet {
    /// The motion of `robot` that `action` stands for.
    ///
    /// # Panics
    /// There is no such action.
    #[must_use]
    pub fn motion(&self, action: usize, robot: &Robot) -> Motion {
        action_motion(&self.0, action, robot)
    }

    /// The motions of all actions of `robot`.
    #[must_use]
    pub fn motions(&self, robot: &Robot) -> Vec<Motion> {
        action_motions(&self.0, robot)
    }
}

/// The action of each arena: an index into the motions of the [`ActiveActionSet`], eq. (9).
#[derive(Resource, Clone, Debug, Default)]
pub struct Actions(pub Vec<usize>);

/// For each arena, the motion that is commanded instead of the one that its action selects. Without an element, or with `None`,
/// the action in [`Actions`] selects the motion.
#[derive(Resource, Clone, Debug, Default)]
pub struct CommandedMotions(pub Vec<Option<Motion>>);

/// Whether an arena whose step was terminal or truncated waits, inactive, until the caller restarts it
/// ([`restart_arenas`](crate::sim::restart_arenas)).
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DeferResets(pub bool);

/// What happens when the goal is reached, and after an episode has ended.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum TaskMode {
    /// The paper's training: a reached goal is replaced by a new one and the episode continues. An ended episode is
    /// followed by a new one.
    #[default]
    Continuing,
    /// Reaching the goal ends the episode. An ended episode is followed by a new one.
    Episodic,
    /// Reaching the goal ends the episode. After its episode, an arena is inactive.
    SingleGoal,
}

/// Computes observations and rewards, ends episodes, and draws new starts and goals.
#[derive(Default)]
pub(crate) struct TaskPlugin {
    /// The encoding of the observations.
    pub observation: Encoding,
    /// The parameters of the reward.
    pub reward: RewardConfig,
    /// What happens when the goal is reached, and after an episode.
    pub mode: TaskMode,
}

impl Plugin for TaskPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(ObservationLayout::new(self.observation, Vec::new()))
            .insert_resource(self.reward.clone())
            .insert_resource(self.mode)
            .init_resource::<PredictionDropout>()
            .init_resource::<DeferResets>()
            .init_resource::<Observations>()
            .init_resource::<Actions>()
            .init_resource::<ActiveActionSet>()
            .init_resource::<CommandedMotions>()
            .init_resource::<StepOutcomes>()
            .init_resource::<ExtraRewards>()
            .init_resource::<EpisodeSetup>()
            .init_resource::<TaskFault>()
            .add_message::<EpisodeEnded>()
            .add_systems(
                ControlStep,
                (
                    observation::observe_next.in_set(SenseSet::Observe),
                    outcome::compute_outcomes.in_set(RewardSet::Outcome),
                    fault::detect_faults.in_set(RewardSet::Sum),
                    (
                        (outcome::close_episodes, level_progress::record).chain().run_if(step_is_finite),
                        observation::advance,
                        reset::run_reset,
                    )
                        .chain()
                        .in_set(ControlSet::Reset),
                ),
            )
            .add_systems(
                Reset,
                (
                    (scenario_pool::draw_scenarios, reset::draw).chain().in_set(ResetSet::Draw),
                    (observation::observe_first, reset::clear_pending_resets)
                        .chain()
                        .in_set(ResetSet::Observe),
                ),
            );
    }
}
