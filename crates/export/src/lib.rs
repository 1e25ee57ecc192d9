//! Exports of a trained policy for programs without wayfield: an ONNX file, and a Hugging Face model card.
//!
//! The ONNX file takes measurements in metres and radians, and gives Q-values, the greedy action and its velocities.
//! Everything in between is part of its graph: the encoding of the observation, the network, and the choice of the action. An
//! observation by sectors is encoded outside: it contains what the robot has seen before, and a graph has no memory.
//!
//! | module | contents |
//! |---|---|
//! | `onnx` | from a policy to the bytes of an ONNX file |
//! | `graph` | the writer of graphs: nodes, weights, inputs and outputs |
//! | `model_card` | the page for Hugging Face |
//! | `results` | the results of a test, which the page lists |
//!
//! # Example
//!
//! ```no_run
//! let policy = wayfield_policy::Policy::from_bytes(&std::fs::read("policy.safetensors")?)?;
//! std::fs::write("policy.onnx", wayfield_export::to_onnx(&policy)?)?;
//! std::fs::write("README.md", wayfield_export::model_card(&policy, "policy.onnx", &[])?)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod graph;
mod model_card;
mod onnx;
mod results;

use serde::Deserialize;
use wayfield_policy::{Card, Policy, PolicyError};

pub use model_card::{MODEL_CARD_MARK, model_card};
pub use onnx::{IR_VERSION, OPSET, to_onnx};
pub use results::EvalResults;

/// The reason why a policy cannot be exported.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum ExportError {
    /// The policy has no card, so the meaning of its numbers is unknown.
    #[error(
        "has no card (wayfield 0.1.0 wrote none), so its inputs and actions are unknown; help: train the policy again"
    )]
    NoCard,
    /// The scenario on the card cannot be read.
    #[error("the policy's card has an unreadable scenario: {0}; help: use the file as wayfield wrote it")]
    Scenario(String),
    /// A text is not the results of a test.
    #[error("not the results of a test: {0}; help: give the output of --eval with --json and one policy")]
    Results(String),
    /// The results are those of another policy.
    #[error(
        "the results are those of another policy: its weights have the checksum {tested}, not {exported}; help: test the \
         policy that is exported"
    )]
    OtherPolicy {
        /// The checksum of the weights of the policy that was tested.
        tested: String,
        /// The checksum of the weights of the policy that is exported.
        exported: String,
    },
    /// The results are those of the policy with a map.
    #[error(
        "the results are those of the policy with a map, which is not exported; help: test the policy without +map"
    )]
    WithMap,
    /// The policy contradicts its card.
    #[error(transparent)]
    Policy(#[from] PolicyError),
}

/// What an export needs of the scenario on a card.
#[derive(Deserialize)]
struct TrainedScenario {
    name: String,
    lidar: TrainedLidar,
}

#[derive(Deserialize)]
struct TrainedLidar {
    max_range_m: f32,
}

/// The card of `policy`, and the scenario on it. If the policy was trained on a set of scenarios, the scenario has the set's name.
fn described(policy: &Policy) -> Result<(&Card, TrainedScenario), ExportError> {
    let card = policy.card.as_deref().ok_or(ExportError::NoCard)?;
    let mut scenario: TrainedScenario = serde_json::from_str(card.scenario.text())
        .map_err(|error| ExportError::Scenario(error.to_string()))?;
    if let Some(set) = &card.training.scenario_set {
        scenario.name.clone_from(&set.name);
    }
    Ok((card, scenario))
}
