//! The policies of the session: the current one, the best one so far, and the opened one.
//!
//! In: a [`PolicySource`]. Out: the policy, and a name that describes its origin.

use bevy::prelude::World;

use super::evaluations::Evaluations;
use super::open::OpenedFiles;
use super::training_run::TrainingRun;
use crate::agent::ActiveLearner;
use crate::app::commands::PolicySource;
use crate::policy::Policy;
use crate::report::format::number;
use crate::run::{RunError, metrics};

/// The origin of the policy from `source` in a few words, and the policy.
///
/// # Errors
/// There is no such policy, or it cannot be read.
pub(super) fn policy(world: &World, source: PolicySource) -> Result<(String, Policy), RunError> {
    let run = world.resource::<TrainingRun>();
    let origin = |env_steps: u64| {
        let steps = number(env_steps as f64, 0);
        format!("{}, {steps} steps, seed {}", run.config.scenario_title(), run.config.seed)
    };
    let missing = |why: &str| RunError::InvalidInput(why.into());
    match source {
        PolicySource::Current => {
            let env_steps = world.resource::<ActiveLearner>().0.env_steps();
            Ok((origin(env_steps), metrics::policy(&run.config, world)))
        }
        PolicySource::Best => {
            let best = run.trainer_state.best.as_ref().ok_or_else(|| {
                missing("No policy has been evaluated yet\nhelp: wait for the first evaluation")
            })?;
            let policy =
                Policy::from_bytes(&best.bytes).map_err(|error| RunError::Failed(error.to_string()))?;
            let row = world.resource::<Evaluations>().best(&run.trainer_state);
            Ok((origin(row.map_or(0, |row| row.env_steps)), policy))
        }
        PolicySource::Opened => (world.resource::<OpenedFiles>().policy.clone())
            .ok_or_else(|| missing("No policy has been opened\nhelp: open a policy file first")),
    }
}
