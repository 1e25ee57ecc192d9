//! The policy file: a network and its card in the safetensors format, which PyTorch and others can read.
//!
//! Writing is deterministic: the same policy always gives the same bytes. Reading validates everything, so bytes from an
//! untrusted source give an error, never a panic.

use std::collections::{BTreeMap, HashMap};

use safetensors::tensor::{Dtype, SafeTensors, TensorView};
use serde::{Deserialize, Serialize};

use crate::card::{Card, CardError};
use crate::limits::MAX_HEADER_BYTES;
use crate::network::{NetworkShape, Scratch, Weights, forward, greedy};
use crate::range::ConfigError;

/// The version of the file format. It is raised when older readers would misread newer files.
const VERSION: u32 = 2;

/// The version without a card. It is still read, and it is written for a policy that has no card.
const VERSION_WITHOUT_CARD: u32 = 1;

/// The only key in the file's metadata. The safetensors crate writes metadata in the random order of a hash map, so only
/// a single key keeps the bytes reproducible.
const KEY: &str = "wayfield";

/// A trained Q-network with its card: observations in, an action out.
#[derive(Debug, Clone, PartialEq)]
pub struct Policy {
    shape: NetworkShape,
    parameters: Vec<f32>,
    /// The same parameters, as a forward pass reads them.
    weights: Weights,
    /// What the inputs and actions mean, and what the policy was trained with. `None` in files of format version 1.
    pub card: Option<Box<Card>>,
    /// The metadata of a file of format version 1, as text by key: the encoding of the observation, the scenario's name, ...
    /// Not written for a policy with a card.
    pub metadata: BTreeMap<String, String>,
}

/// The contents of the metadata under [`KEY`], as JSON.
#[derive(Debug, Serialize, Deserialize)]
struct Header<N, C> {
    version: u32,
    network: N,
    card: C,
}

/// Like [`Header`], in format version 1.
#[derive(Debug, Serialize, Deserialize)]
struct HeaderWithoutCard<N, M> {
    version: u32,
    network: N,
    metadata: M,
}

/// The part of a header that determines how the rest is read.
#[derive(Deserialize)]
struct HeaderVersion {
    version: Option<u64>,
}

/// The reason that a policy cannot be built, written or read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum PolicyError {
    /// The file is damaged, or not in the safetensors format.
    #[error("not a safetensors file: {0}")]
    NotSafetensors(String),
    /// The safetensors file has no valid wayfield header, for example because another program wrote it.
    #[error("not a wayfield policy: {0}")]
    NotWayfield(String),
    /// The file has a format version that this wayfield does not read.
    #[error(
        "policy format version {found}, but this wayfield reads versions {VERSION_WITHOUT_CARD} and {VERSION}; help: use a newer wayfield"
    )]
    Version {
        /// The file's format version.
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
    /// A tensor has the wrong type or shape.
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
    /// The card contradicts the network or itself.
    #[error("the policy's card {0}")]
    Card(#[from] CardError),
}

impl Policy {
    /// A policy without a card, from a network's `shape` and flat `parameters`, in the order of
    /// [`NetworkShape::parameters`].
    ///
    /// # Errors
    /// A size is out of range, or the number of parameters is not [`NetworkShape::parameter_count`].
    pub fn new(shape: NetworkShape, parameters: Vec<f32>) -> Result<Self, PolicyError> {
        shape.check()?;
        let expected = shape.parameter_count();
        if parameters.len() != expected {
            let problem = format!("has {} elements; help: give {expected} for {shape}", parameters.len());
            return Err(ConfigError { field: "network.parameters".into(), problem }.into());
        }
        let weights = Weights::new(&shape, &parameters);
        Ok(Self { shape, parameters, weights, card: None, metadata: BTreeMap::new() })
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
        forward(&self.shape, &self.weights, &observation[..self.shape.inputs], scratch)
    }

    /// The greedy action for one `observation`: the index of the largest Q-value.
    ///
    /// # Panics
    /// If `observation` is shorter than `shape().inputs`.
    pub fn act(&self, observation: &[f32], scratch: &mut Scratch) -> usize {
        greedy(self.q_values(observation, scratch))
    }

    /// The CRC-32C of the weights, as eight hexadecimal digits. Test results identify their policy by it.
    #[must_use]
    pub fn weights_crc32c(&self) -> String {
        let append = |crc, value: &f32| crc32c::crc32c_append(crc, &value.to_le_bytes());
        format!("{:08x}", self.parameters.iter().fold(0, append))
    }

    /// The policy as the bytes of a safetensors file: one f32 tensor per entry of [`NetworkShape::parameters`]; weight
    /// matrices are `[outputs, inputs]`.
    ///
    /// # Errors
    /// A weight is not finite, or the card does not describe the network.
    pub fn to_bytes(&self) -> Result<Vec<u8>, PolicyError> {
        self.check_finite()?;
        let header = self.header()?;
        let bytes: Vec<u8> = self.parameters.iter().flat_map(|value| value.to_le_bytes()).collect();
        let mut tensors = Vec::new();
        for view in self.shape.parameters() {
            let bytes = &bytes[view.range.start * 4..view.range.end * 4];
            let tensor = TensorView::new(Dtype::F32, view.shape, bytes).map_err(not_safetensors)?;
            tensors.push((view.name, tensor));
        }
        safetensors::serialize(tensors, Some(HashMap::from([(KEY.to_string(), header)])))
            .map_err(not_safetensors)
    }

    /// Reads the policy in the bytes of a safetensors file. Memory use is at most a few times the length of `bytes`.
    ///
    /// # Errors
    /// The file is not a usable policy; [`PolicyError`] lists the reasons.
    pub fn from_bytes(bytes: &[u8]) -> Result<Self, PolicyError> {
        let (shape, card, metadata) = read_header(bytes)?;
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
        if let Some(card) = &card {
            card.check(&shape, &parameters)?;
        }
        Ok(Self { card, metadata, ..Self::new(shape, parameters)? })
    }

    /// The header as JSON, which the file's metadata has under the key `wayfield`.
    ///
    /// # Errors
    /// The card does not describe the network.
    pub fn header(&self) -> Result<String, PolicyError> {
        let network = &self.shape;
        let header = match &self.card {
            Some(card) => {
                card.check(network, &self.parameters)?;
                serde_json::to_string(&Header { version: VERSION, network, card })
            }
            None => serde_json::to_string(&HeaderWithoutCard {
                version: VERSION_WITHOUT_CARD,
                network,
                metadata: &self.metadata,
            }),
        };
        header.map_err(|error| PolicyError::NotWayfield(error.to_string()))
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

/// A policy without its weights.
type Described = (NetworkShape, Option<Box<Card>>, BTreeMap<String, String>);

/// The network, the card and the metadata in the file's header.
fn read_header(bytes: &[u8]) -> Result<Described, PolicyError> {
    let (_, metadata) = SafeTensors::read_metadata(bytes).map_err(not_safetensors)?;
    let text = metadata.metadata().as_ref().and_then(|map| map.get(KEY));
    let text = text.ok_or_else(|| PolicyError::NotWayfield(format!("its metadata has no key `{KEY}`")))?;
    if text.len() > MAX_HEADER_BYTES {
        let problem = format!("its metadata has {} bytes, more than {MAX_HEADER_BYTES}", text.len());
        return Err(PolicyError::NotWayfield(problem));
    }
    let not_wayfield = |error: serde_json::Error| PolicyError::NotWayfield(format!("its metadata: {error}"));
    match serde_json::from_str::<HeaderVersion>(text).map_err(not_wayfield)?.version {
        Some(found) if found == u64::from(VERSION) => {
            let Header { network, card, .. } = serde_json::from_str(text).map_err(not_wayfield)?;
            Ok((network, Some(card), BTreeMap::new()))
        }
        Some(found) if found == u64::from(VERSION_WITHOUT_CARD) => {
            let HeaderWithoutCard { network, metadata, .. } =
                serde_json::from_str(text).map_err(not_wayfield)?;
            Ok((network, None, metadata))
        }
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
