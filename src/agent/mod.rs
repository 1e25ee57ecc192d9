//! The agent: two plugins over the learner.
//!
//! In: observations and outcomes. Out: actions, and a learner that knows more.
//!
//! | plugin | responsible for |
//! |---|---|
//! | [`AgentPlugin`] | `Decide`: observations -> actions, exploring or greedy (`decide.rs`) |
//! | [`TrainingPlugin`] | `Store` and `Learn`: transitions -> replay buffer -> gradient steps (`train.rs`) |

mod decide;
mod train;

use bevy::prelude::*;

pub use decide::{ActionSelection, ActionSource, ActionSources, Decisions, GreedyPolicy};
pub use train::{ActiveLearner, TrainingFault, TrainingStats, TrainingWarning};

use crate::control_step::{ControlSet, ControlStep};
use crate::task::step_is_finite;

/// Responsible for choosing each arena's motion.
pub struct AgentPlugin {
    /// How actions are selected.
    pub action_selection: ActionSelection,
    /// The run's seed: arena k explores by its own stream of it.
    pub seed: u64,
    /// How many arenas there are.
    pub arenas: usize,
}

impl Plugin for AgentPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(self.action_selection)
            .insert_resource(Decisions::new(self.seed, self.arenas))
            .add_systems(ControlStep, decide::decide.in_set(ControlSet::Decide));
    }
}

/// Responsible for remembering transitions and learning from them.
///
/// Insert the learner as [`ActiveLearner`] before the first step.
pub struct TrainingPlugin;

impl Plugin for TrainingPlugin {
    fn build(&self, app: &mut App) {
        app.init_resource::<TrainingStats>()
            .init_resource::<TrainingFault>()
            .init_resource::<TrainingWarning>()
            .add_systems(
                ControlStep,
                (train::store.in_set(ControlSet::Store), train::learn.in_set(ControlSet::Learn))
                    .run_if(resource_equals(ActionSelection::EpsilonGreedy).and_then(step_is_finite)),
            );
    }
}
