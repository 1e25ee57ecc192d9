//! The task: the Markov decision process of the paper, as pure functions with thin systems over them.
//!
//! In: poses and LIDAR scans, written by [`world`](crate::sim). Out: observations (eq. 8), rewards (eqs. 3 and
//! 7), what ended and why, and new starts and goals.
//!
//! | file | duty |
//! |---|---|
//! | `state.rs` | the components of an arena that the task is about |
//! | `observation.rs` | eq. (8): what the policy sees, in which order and units |
//! | `reward.rs` | eqs. (3) to (7), term by term |
//! | `outcome.rs` | collision, goal, time limit: what a step was worth |
//! | `reset.rs` | where episodes start and goals lie |
//! | `fault.rs` | what went wrong in a step |

mod fault;
pub mod observation;
mod outcome;
mod reset;
pub mod reward;
mod state;

use std::sync::Arc;

use bevy::prelude::*;

pub use fault::{Fault, TaskFault, step_is_finite};
pub use observation::{Encoding, Observations};
pub use outcome::{EpisodeEnd, EpisodeEnded, StepOutcome, StepOutcomes};
pub use reset::EpisodeSetup;
pub use reward::{Potential, RewardConfig, RewardKind, RewardTerms};
pub use state::{
    Arena, ArenaLayout, ArenaState, Clock, Episode, Goal, PendingReset, Pose, Scan, Streams, Twist,
    wrap_angle,
};

use crate::control_step::{ControlSet, ControlStep, Reset, ResetSet, ScanWritten};
use crate::scenario::Scenario;

/// The world description that is being driven in, shared read-only by all systems.
#[derive(Resource, Clone, Debug)]
pub struct CurrentScenario(pub Arc<Scenario>);

/// The chosen motion of each arena, as an index into [`Robot::motions`](crate::scenario::Robot); eq. (9).
#[derive(Resource, Clone, Debug, Default)]
pub struct Actions(pub Vec<usize>);

/// What happens when the goal is reached or the episode ends.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub enum TaskMode {
    /// The paper's training: a reached goal is redrawn and the episode goes on; an ended episode begins anew.
    Continuing,
    /// One navigation: whatever ends it, the arena stands still from then on.
    SingleGoal,
}

/// Responsible for observations, rewards, the end of episodes, and starts and goals.
pub struct TaskPlugin {
    /// In which units observations are made.
    pub observation: Encoding,
    /// How rewards are computed.
    pub reward: RewardConfig,
    /// Whether arenas go on after a goal or an end.
    pub mode: TaskMode,
}

impl Plugin for TaskPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(self.observation)
            .insert_resource(self.reward.clone())
            .insert_resource(self.mode)
            .init_resource::<Observations>()
            .init_resource::<Actions>()
            .init_resource::<StepOutcomes>()
            .init_resource::<EpisodeSetup>()
            .init_resource::<TaskFault>()
            .add_message::<EpisodeEnded>()
            .add_systems(
                ControlStep,
                (
                    observation::observe_next.in_set(ControlSet::Sense).after(ScanWritten),
                    (outcome::compute_outcomes, fault::detect_faults).chain().in_set(ControlSet::Reward),
                    (outcome::close_episodes.run_if(step_is_finite), observation::advance, reset::run_reset)
                        .chain()
                        .in_set(ControlSet::Reset),
                ),
            )
            .add_systems(
                Reset,
                (
                    reset::draw.in_set(ResetSet::Draw),
                    (observation::observe_first, reset::clear_pending_resets)
                        .chain()
                        .in_set(ResetSet::Observe),
                ),
            );
    }
}
