//! The agent: two plugins over the learner.
//!
//! In: observations and outcomes. Out: actions, and a learner that knows more.
//!
//! | plugin | responsible for |
//! |---|---|
//! | [`AgentPlugin`] | `Decide`: observations -> actions, exploring or greedy (`decide.rs`) |
//! | [`TrainingPlugin`] | `Remember` and `Learn`: transitions -> replay buffer -> gradient steps (`train.rs`) |

mod decide;
mod train;

use bevy::prelude::*;

pub use decide::{Acting, Decisions, Driver, Drivers, GreedyPolicy};
pub use train::{Trainer, TrainingFault, TrainingStats, TrainingWarning};

use crate::control_step::{ControlSet, ControlStep};
use crate::task::numbers_are_sound;

/// Responsible for choosing each arena's motion.
pub struct AgentPlugin {
    /// Exploring with the learner, or greedy with a fixed policy.
    pub acting: Acting,
    /// The run's seed: arena k explores by its own stream of it.
    pub seed: u64,
    /// How many arenas there are.
    pub arenas: usize,
}

impl Plugin for AgentPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(self.acting)
            .insert_resource(Decisions::new(self.seed, self.arenas))
            .add_systems(ControlStep, decide::decide.in_set(ControlSet::Decide));
    }
}

/// Responsible for remembering transitions and learning from them.
///
/// Insert the learner as [`Trainer`] before the first step.
pub struct TrainingPlugin;

impl Plugin for TrainingPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<TrainingStats>()
            .init_resource::<TrainingFault>()
            .init_resource::<TrainingWarning>()
            .add_systems(
                ControlStep,
                (train::remember.in_set(ControlSet::Remember), train::learn.in_set(ControlSet::Learn))
                    .run_if(resource_equals(Acting::Exploring).and_then(numbers_are_sound)),
            );
    }
}
