//! What a training starts with: a learner, new or from a policy's weights.
//!
//! In: a run's configuration, and the policy that it names, if any. Out: the learner; or what does not fit.

use super::folder::RunConfig;
use super::{RunError, evaluate, policy_card};
use crate::learning::{Learner, Policy};
use crate::task::{Encoding, observation};

/// A learner as `config` asks for, starting from `policy` if there is one.
///
/// # Errors
/// The configuration or the policy does not fit.
pub fn create_learner(config: &RunConfig, policy: Option<&Policy>) -> Result<Learner, RunError> {
    let inputs = observation::width(config.scenario.lidar.beams);
    let actions = config.scenario.robot.motions.len();
    let preset = &config.preset;
    preset
        .check_memory(&config.scenario)
        .map_err(|error| RunError::InvalidInput(format!("{}: {error}", config.preset_from)))?;
    let mut learner = Learner::new(&preset.learning, inputs, actions, preset.arenas, config.seed)
        .map_err(|error| RunError::InvalidInput(format!("{}: {error}", config.preset_from)))?;
    if let (Some(policy), Some(transfer)) = (policy, &config.transfer) {
        evaluate::check_compatible(policy, &config.scenario)?;
        same_encoding(policy, preset.observation)
            .map_err(|error| RunError::InvalidInput(format!("{}: {error}", transfer.policy)))?;
        learner
            .load_weights(policy, transfer.epsilon)
            .map_err(|error| RunError::InvalidInput(format!("{}: {error}", transfer.policy)))?;
    }
    Ok(learner)
}

/// Whether `policy` was trained to see what a preset with `observation` will show it.
fn same_encoding(policy: &Policy, observation: Encoding) -> Result<(), RunError> {
    let own = policy_card::encoding(policy)?;
    if own == observation {
        return Ok(());
    }
    Err(RunError::InvalidInput(format!(
        "the policy was trained with {} observations, but the preset's are {}: start from it with a preset that says \
         `observation: {own:?}`",
        policy_card::encoding_name(own),
        policy_card::encoding_name(observation)
    )))
}
