//! The agent: selects actions, and trains the learner.
//!
//! In: observations and outcomes. Out: actions, and an updated learner.
//!
//! | file | responsible for |
//! |---|---|
//! | `decide.rs` | `Decide`: observations -> actions, epsilon-greedy or greedy |
//! | `drive.rs` | `Decide`: the actions of classical drivers, of policies used as drivers, and of the user |
//! | `train.rs` | `Store` and `Learn`: transitions -> replay buffer -> gradient steps |

mod decide;
mod drive;
mod train;

use bevy::prelude::*;

pub use decide::{ActionSelection, ActionSource, ActionSources, Decisions, GreedyPolicy};
pub use drive::{DriverKind, DriverSource};
pub use train::{ActiveLearner, TrainingFault, TrainingStats, TrainingWarning};

use crate::control_step::{ControlSet, ControlStep};
use crate::task::step_is_finite;

/// Selects the action of every arena.
pub(crate) struct AgentPlugin {
    /// The method that selects actions.
    pub action_selection: ActionSelection,
    /// The run's seed. Arena k explores with the random stream ("exploration", k) of this seed.
    pub seed: u64,
    /// The number of arenas.
    pub arenas: usize,
}

impl Plugin for AgentPlugin {
    fn build(&self, app: &mut App) {
        app.insert_resource(self.action_selection)
            .insert_resource(Decisions::new(self.seed, self.arenas))
            .add_systems(
                ControlStep,
                (decide::decide, drive::drive.run_if(resource_equals(ActionSelection::PerArena)))
                    .chain()
                    .in_set(ControlSet::Decide),
            );
    }
}

/// Stores transitions in the replay buffer and takes gradient steps.
///
/// Insert the learner as [`ActiveLearner`] before the first step.
pub(crate) struct TrainingPlugin;

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
