//! The task: the Markov decision process of the paper, as pure functions with thin systems over them.
//!
//! In: poses and LIDAR scans, written by [`world`](crate::sim). Out: observations (eq. 8), rewards (eqs. 3 and
//! 7), what ended and why, and new starts and targets.
//!
//! | file | duty |
//! |---|---|
//! | `state.rs` | the components of an arena that the task is about |
//! | `observation.rs` | eq. (8): what the policy sees, in which order and units |
//! | `reward.rs` | eqs. (3) to (7), term by term |
//! | `judge.rs` | collision, target, time limit: what a step was worth |
//! | `begin.rs` | where episodes start and targets lie |
//! | `fault.rs` | what went wrong in a step |

mod begin;
mod fault;
mod judge;
pub mod observation;
pub mod reward;
mod state;

use std::sync::Arc;

use bevy::prelude::*;

pub use begin::Places;
pub use fault::{Fault, TaskFault, numbers_are_sound};
pub use judge::{EpisodeEnd, EpisodeEnded, Outcome, Outcomes};
pub use observation::{Encoding, Observations};
pub use reward::{Potential, RewardConfig, RewardKind, RewardTerms};
pub use state::{
    Arena, ArenaState, Clock, Drive, Episode, Pose, Restart, Room, Scan, Streams, Target, wrap_angle,
};

use crate::control_step::{Begin, BeginSet, ControlSet, ControlStep, ScanWritten};
use crate::scenario::Scenario;

/// The world description that is being driven in, shared read-only by all systems.
#[derive(Resource, Clone, Debug)]
pub struct CurrentScenario(pub Arc<Scenario>);

/// The chosen motion of each arena, as an index into [`Robot::motions`](crate::scenario::Robot); eq. (9).
#[derive(Resource, Clone, Debug, Default)]
pub struct Actions(pub Vec<usize>);

/// What happens when the target is reached or the episode ends.
#[derive(Resource, Clone, Copy, Debug, PartialEq, Eq)]
pub enum TaskMode {
    /// The paper's training: a reached target is redrawn and the episode goes on; an ended episode begins anew.
    Continuing,
    /// One navigation: whatever ends it, the arena stands still from then on.
    SingleNavigation,
}

/// Responsible for observations, rewards, the end of episodes, and starts and targets.
pub struct TaskPlugin {
    /// In which units observations are made.
    pub observation: Encoding,
    /// How rewards are computed.
    pub reward: RewardConfig,
    /// Whether arenas go on after a target or an end.
    pub mode: TaskMode,
}

impl Plugin for TaskPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(self.observation)
            .insert_resource(self.reward.clone())
            .insert_resource(self.mode)
            .init_resource::<Observations>()
            .init_resource::<Actions>()
            .init_resource::<Outcomes>()
            .init_resource::<Places>()
            .init_resource::<TaskFault>()
            .add_message::<EpisodeEnded>()
            .add_systems(
                ControlStep,
                (
                    observation::observe_next.in_set(ControlSet::Sense).after(ScanWritten),
                    (judge::judge, fault::look_for_faults).chain().in_set(ControlSet::Judge),
                    (judge::close_episodes.run_if(numbers_are_sound), observation::advance, begin::run_begin)
                        .chain()
                        .in_set(ControlSet::Restart),
                ),
            )
            .add_systems(
                Begin,
                (
                    begin::draw.in_set(BeginSet::Draw),
                    (observation::observe_first, begin::settle).chain().in_set(BeginSet::Observe),
                ),
            );
    }
}
