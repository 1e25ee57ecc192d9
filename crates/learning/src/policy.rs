//! A policy: a trained network with its metadata, as safetensors bytes.
//!
//! In: a network and whatever a user needs to know about it (observation order and units, scenario, seed), as
//! text by key. Out: a safetensors file's bytes, which PyTorch and others can read; and back, with every
//! doubt about foreign bytes answered by an error. The same policy always gives the same bytes.

use std::collections::{BTreeMap, HashMap};

use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use serde::{Deserialize, Serialize};

use super::network::{NetworkShape, QNetwork};

/// The version of the layout below; raised when an older reader would misread a newer file.
const VERSION: u32 = 1;

/// The one metadata key. The safetensors crate writes metadata in a hash map's random order; one key has one
/// order.
const KEY: &str = "wayfield";

/// A trained network and what is needed to use it.
#[derive(Debug, Clone, PartialEq)]
pub struct Policy {
    /// Observations to Q-values; to act is to take the largest.
    pub network: QNetwork,
    /// Anything a user should know, by key.
    pub metadata: BTreeMap<String, String>,
}

/// The JSON text under [`KEY`].
#[derive(Debug, Serialize, Deserialize)]
struct Header {
    version: u32,
    network: NetworkShape,
    metadata: BTreeMap<String, String>,
}

/// Why bytes are not a policy, or a policy is not for this learner.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PolicyError {
    /// Not safetensors, or a damaged file.
    #[error("not a safetensors file: {0}")]
    NotSafetensors(String),
    /// safetensors, but not of wayfield.
    #[error("not a wayfield policy: {0}")]
    NotWayfield(String),
    /// Of a later wayfield.
    #[error("policy format version {found}, but this wayfield reads version {VERSION}; use a newer wayfield")]
    Version {
        /// The file's version.
        found: u64,
    },
    /// The network's sizes are absurd.
    #[error("the policy's network cannot be: {0}")]
    InvalidShape(String),
    /// A tensor is not there.
    #[error("the policy lacks the tensor `{name}` (f32, {expected:?})")]
    MissingTensor {
        /// The tensor.
        name: String,
        /// The shape it should have.
        expected: Vec<usize>,
    },
    /// A tensor has another type or shape.
    #[error("the policy's tensor `{name}` is {found}, expected {expected}")]
    TensorMismatch {
        /// The tensor.
        name: String,
        /// Type and shape it should have.
        expected: String,
        /// Type and shape it has.
        found: String,
    },
    /// A weight is NaN or infinite.
    #[error("the policy's tensor `{name}` holds {value} at {index}; it was saved from a diverged run")]
    NotFinite {
        /// The tensor.
        name: String,
        /// Where in it.
        index: usize,
        /// What is there.
        value: f32,
    },
    /// The policy's network is not the learner's.
    #[error(
        "the policy's network is {found}, but the preset's is {expected}; train with the policy's own shape"
    )]
    NetworkMismatch {
        /// The learner's.
        expected: String,
        /// The policy's.
        found: String,
    },
    /// Epsilon is no probability.
    #[error("epsilon {0} is out of range; give 0 to 1")]
    InvalidEpsilon(f32),
}

impl Policy {
    /// The policy as the bytes of a safetensors file: one f32 tensor per [`NetworkShape::parameters`] name,
    /// weights outputs x inputs.
    ///
    /// # Errors
    /// A weight is not finite.
    pub fn to_bytes(&self) -> Result<Vec<u8>, PolicyError> {
        let shape = self.network.shape();
        let bytes: Vec<u8> = self.network.parameters().iter().flat_map(|v| v.to_le_bytes()).collect();
        let mut tensors = Vec::new();
        self.check_finite()?;
        for view in shape.parameters() {
            let bytes = &bytes[view.range.start * 4..view.range.end * 4];
            let tensor = TensorView::new(Dtype::F32, view.shape, bytes).map_err(not_safetensors)?;
            tensors.push((view.name, tensor));
        }
        let header = Header { version: VERSION, network: shape.clone(), metadata: self.metadata.clone() };
        let header = serde_json::to_string(&header).map_err(|e| PolicyError::NotWayfield(e.to_string()))?;
        let metadata = HashMap::from([(KEY.to_string(), header)]);
        safetensors::serialize(tensors, Some(metadata)).map_err(not_safetensors)
    }

    /// Whether all weights are finite.
    ///
    /// # Errors
    /// Which is not, and where.
    pub fn check_finite(&self) -> Result<(), PolicyError> {
        let weights = self.network.parameters();
        let views = self.network.shape().parameters();
        views.iter().try_for_each(|view| finite(&view.name, &weights[view.range.clone()]))
    }

    /// The policy in the bytes of a safetensors file. Takes no more memory than a few times the bytes given.
    ///
    /// # Errors
    /// Whatever is wrong with the file, see [`PolicyError`].
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, PolicyError> {
        let Header { network: shape, metadata, .. } = header(bytes)?;
        shape.check().map_err(|e| PolicyError::InvalidShape(e.to_string()))?;
        let tensors = SafeTensors::deserialize(bytes).map_err(not_safetensors)?;
        let mut parameters = Vec::new();
        for view in shape.parameters() {
            let tensor = tensors.tensor(&view.name).map_err(|_| PolicyError::MissingTensor {
                name: view.name.clone(),
                expected: view.shape.clone(),
            })?;
            if tensor.dtype() != Dtype::F32 || tensor.shape() != view.shape {
                return Err(PolicyError::TensorMismatch {
                    name: view.name,
                    expected: format!("F32 {:?}", view.shape),
                    found: format!("{:?} {:?}", tensor.dtype(), tensor.shape()),
                });
            }
            let start = parameters.len();
            parameters.extend(tensor.data().as_chunks().0.iter().map(|&bytes| f32::from_le_bytes(bytes)));
            finite(&view.name, &parameters[start..])?;
        }
        let network = QNetwork::from_parameters(shape, parameters)
            .map_err(|e| PolicyError::InvalidShape(e.to_string()))?;
        Ok(Self { network, metadata })
    }
}

/// The header in the file's metadata; its version is looked at before the rest.
fn header(bytes: &[u8]) -> Result<Header, PolicyError> {
    let (_, metadata) = SafeTensors::read_metadata(bytes).map_err(not_safetensors)?;
    let text = metadata.metadata().as_ref().and_then(|map| map.get(KEY));
    let text = text.ok_or_else(|| PolicyError::NotWayfield(format!("it has no `{KEY}` metadata")))?;
    let not_wayfield = |e: serde_json::Error| PolicyError::NotWayfield(format!("its metadata: {e}"));
    let value: serde_json::Value = serde_json::from_str(text).map_err(not_wayfield)?;
    match value.get("version").and_then(serde_json::Value::as_u64) {
        Some(version) if version == u64::from(VERSION) => serde_json::from_value(value).map_err(not_wayfield),
        Some(found) => Err(PolicyError::Version { found }),
        None => Err(PolicyError::NotWayfield("its metadata has no version".into())),
    }
}

fn finite(name: &str, values: &[f32]) -> Result<(), PolicyError> {
    match values.iter().position(|v| !v.is_finite()) {
        Some(index) => Err(PolicyError::NotFinite { name: name.into(), index, value: values[index] }),
        None => Ok(()),
    }
}

fn not_safetensors(error: safetensors::SafeTensorError) -> PolicyError {
    PolicyError::NotSafetensors(error.to_string())
}
