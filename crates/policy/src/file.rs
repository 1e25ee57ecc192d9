//! The policy file: a network and its metadata in the safetensors format, which PyTorch and others can read.
//!
//! Writing is deterministic: the same policy always gives the same bytes. Reading validates everything, so bytes from an
//! untrusted source give an error, never a panic.

use std::collections::{BTreeMap, HashMap};

use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use serde::{Deserialize, Serialize};

use crate::network::{NetworkShape, Scratch, forward, greedy};
use crate::range::ConfigError;

/// The version of the file format. It is raised when older readers would misread newer files.
const VERSION: u32 = 1;

/// The only key in the file's metadata. The safetensors crate writes metadata in the random order of a hash map, so only
/// a single key keeps the bytes reproducible.
const KEY: &str = "wayfield";

/// A trained Q-network with its metadata: observations in, an action out.
#[derive(Debug, Clone, PartialEq)]
pub struct Policy {
    shape: NetworkShape,
    parameters: Vec<f32>,
    /// The metadata, as text by key: the scenario, the seed, the order and units of the observation, ...
    pub metadata: BTreeMap<String, String>,
}

/// The contents of the metadata under [`KEY`], as JSON.
#[derive(Debug, Serialize, Deserialize)]
struct Header {
    version: u32,
    network: NetworkShape,
    metadata: BTreeMap<String, String>,
}

/// The reason that a policy cannot be built, written or read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PolicyError {
    /// The file is damaged or in another format than safetensors.
    #[error("not a safetensors file: {0}")]
    NotSafetensors(String),
    /// The safetensors file was written by another program.
    #[error("not a wayfield policy: {0}")]
    NotWayfield(String),
    /// The file was written by another version of wayfield.
    #[error(
        "policy format version {found}, but this wayfield reads version {VERSION}; help: use a newer wayfield"
    )]
    Version {
        /// The file's version.
        found: u64,
    },
    /// The network's sizes are out of range.
    #[error("the policy's network is invalid: {0}")]
    InvalidShape(#[from] ConfigError),
    /// A tensor is missing.
    #[error("the policy lacks the tensor `{name}` (f32, {expected:?})")]
    MissingTensor {
        /// The tensor's name.
        name: String,
        /// The expected shape.
        expected: Vec<usize>,
    },
    /// A tensor has another type or shape.
    #[error("the policy's tensor `{name}` is {found}, expected {expected}")]
    TensorMismatch {
        /// The tensor's name.
        name: String,
        /// The expected type and shape.
        expected: String,
        /// The actual type and shape.
        found: String,
    },
    /// A weight is NaN or infinite.
    #[error(
        "the policy's tensor `{name}` has the value {value} at index {index}; help: use a policy from a run that did not diverge"
    )]
    NonFinite {
        /// The tensor's name.
        name: String,
        /// The weight's index in the tensor, row-major.
        index: usize,
        /// The weight.
        value: f32,
    },
}

impl Policy {
    /// A policy from a network's `shape` and flat `parameters`, in the order of [`NetworkShape::parameters`].
    ///
    /// # Errors
    /// A size is out of range, or the number of parameters is not [`NetworkShape::parameter_count`].
    pub fn new(
        shape: NetworkShape,
        parameters: Vec<f32>,
        metadata: BTreeMap<String, String>,
    ) -> Result<Self, PolicyError> {
        shape.check()?;
        let expected = shape.parameter_count();
        if parameters.len() != expected {
            let problem = format!("has {} elements; help: give {expected} for {shape}", parameters.len());
            return Err(ConfigError { field: "network.parameters".into(), problem }.into());
        }
        Ok(Self { shape, parameters, metadata })
    }

    /// The network's sizes.
    #[must_use]
    pub fn shape(&self) -> &NetworkShape {
        &self.shape
    }

    /// All parameters as one flat slice; [`NetworkShape::parameters`] gives each tensor's name, shape and range in it.
    #[must_use]
    pub fn parameters(&self) -> &[f32] {
        &self.parameters
    }

    /// The Q-values of one `observation`, one per action. A `scratch` that has been used before makes this free of
    /// allocations.
    ///
    /// # Panics
    /// If `observation` is shorter than `shape().inputs`.
    pub fn q_values<'a>(&self, observation: &[f32], scratch: &'a mut Scratch) -> &'a [f32] {
        forward(&self.shape, &self.parameters, &observation[..self.shape.inputs], scratch)
    }

    /// The greedy action for one `observation`: the index of the largest Q-value.
    ///
    /// # Panics
    /// If `observation` is shorter than `shape().inputs`.
    pub fn act(&self, observation: &[f32], scratch: &mut Scratch) -> usize {
        greedy(self.q_values(observation, scratch))
    }

    /// The policy as the bytes of a safetensors file: one f32 tensor per entry of [`NetworkShape::parameters`]; weight
    /// matrices are `[outputs, inputs]`.
    ///
    /// # Errors
    /// A weight is not finite.
    pub fn to_bytes(&self) -> Result<Vec<u8>, PolicyError> {
        self.check_finite()?;
        let bytes: Vec<u8> = self.parameters.iter().flat_map(|value| value.to_le_bytes()).collect();
        let mut tensors = Vec::new();
        for view in self.shape.parameters() {
            let bytes = &bytes[view.range.start * 4..view.range.end * 4];
            let tensor = TensorView::new(Dtype::F32, view.shape, bytes).map_err(not_safetensors)?;
            tensors.push((view.name, tensor));
        }
        let (network, metadata) = (self.shape.clone(), self.metadata.clone());
        let header = serde_json::to_string(&Header { version: VERSION, network, metadata })
            .map_err(|error| PolicyError::NotWayfield(error.to_string()))?;
        safetensors::serialize(tensors, Some(HashMap::from([(KEY.to_string(), header)])))
            .map_err(not_safetensors)
    }

    /// The policy in the bytes of a safetensors file. Memory use is at most a few times the length of `bytes`.
    ///
    /// # Errors
    /// The file is not a usable policy; [`PolicyError`] lists the reasons.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, PolicyError> {
        let Header { network: shape, metadata, .. } = read_header(bytes)?;
        shape.check()?;
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
            check_all_finite(&view.name, &parameters[start..])?;
        }
        Self::new(shape, parameters, metadata)
    }

    /// Checks that all weights are finite.
    ///
    /// # Errors
    /// The first weight that is NaN or infinite.
    pub fn check_finite(&self) -> Result<(), PolicyError> {
        let views = self.shape.parameters();
        views.iter().try_for_each(|view| check_all_finite(&view.name, &self.parameters[view.range.clone()]))
    }
}

/// The header in the file's metadata. Its version is checked before the rest.
fn read_header(bytes: &[u8]) -> Result<Header, PolicyError> {
    let (_, metadata) = SafeTensors::read_metadata(bytes).map_err(not_safetensors)?;
    let text = metadata.metadata().as_ref().and_then(|map| map.get(KEY));
    let text = text.ok_or_else(|| PolicyError::NotWayfield(format!("its metadata has no key `{KEY}`")))?;
    let not_wayfield = |error: serde_json::Error| PolicyError::NotWayfield(format!("its metadata: {error}"));
    let value: serde_json::Value = serde_json::from_str(text).map_err(not_wayfield)?;
    match value.get("version").and_then(serde_json::Value::as_u64) {
        Some(version) if version == u64::from(VERSION) => serde_json::from_value(value).map_err(not_wayfield),
        Some(found) => Err(PolicyError::Version { found }),
        None => Err(PolicyError::NotWayfield("its metadata has no version".into())),
    }
}

fn check_all_finite(name: &str, values: &[f32]) -> Result<(), PolicyError> {
    match values.iter().position(|value| !value.is_finite()) {
        Some(index) => Err(PolicyError::NonFinite { name: name.into(), index, value: values[index] }),
        None => Ok(()),
    }
}

fn not_safetensors(error: safetensors::SafeTensorError) -> PolicyError {
    PolicyError::NotSafetensors(error.to_string())
}
