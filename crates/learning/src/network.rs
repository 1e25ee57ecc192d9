//! The Q-network: fully connected layers and a plain or dueling head (fig. 5 of the paper).
//!
//! In: observations, row-major. Out: Q-values, or V and A; in training, the gradient of the TD loss with respect to all
//! parameters. All parameters are stored in one flat vector, and copied to the dfdx tensors after each change. The
//! optimizer, the target network, policy files and checkpoints use only the flat vector.

use dfdx::prelude::*;
use wayfield_policy::{Activation, NetworkShape, Policy};

use super::config::ConfigError;
pub(crate) use super::ops::Regression;
use super::ops::{Dense, LayerNorm, Rows, activate, dueling, rows, td_loss, values};
use wayfield_policy::range::within;
use wayfield_random::{Stream, uniform};

/// The maximum number of rows of one forward pass. Larger batches are split, so that the matrix products stay below the size
/// at which gemm starts threads: at this size, threads cost more than they gain.
const CHUNK_ROWS: usize = 128;

/// A network that maps observations to Q-values.
#[derive(Clone)]
pub struct QNetwork {
    shape: NetworkShape,
    parameters: Vec<f32>,
    layers: Vec<Layer>,
    device: Cpu,
}

/// A hidden layer or the head.
#[derive(Debug, Clone)]
struct Layer {
    dense: Dense,
    norm: Option<LayerNorm>,
    /// `None` for the head.
    activation: Option<Activation>,
}

impl Layer {
    /// Layer number `i` of a network of `shape`, with all parameters 0.
    fn zeros(shape: &NetworkShape, i: usize, (inputs, outputs): (usize, usize), device: &Cpu) -> Self {
        let units = || device.zeros_like(&(outputs,));
        let is_hidden = i < shape.hidden.len();
        Self {
            dense: Dense { weight: device.zeros_like(&(outputs, inputs)), bias: units() },
            norm: (is_hidden && shape.layer_norm).then(|| LayerNorm { scale: units(), shift: units() }),
            activation: is_hidden.then_some(shape.activation),
        }
    }

    /// The layer's output. `input_gradient`: see [`Dense::forward`].
    fn forward<T: Tape<f32, Cpu>>(&self, x: Rows<T>, input_gradient: bool) -> Rows<T> {
        // Without a norm, a ReLU is computed inside the dense layer, which saves a pass over the units.
        let relu = self.norm.is_none() && self.activation == Some(Activation::Relu);
        let mut y = self.dense.forward(x, relu, input_gradient);
        if let Some(norm) = &self.norm {
            y = norm.forward(y);
        }
        match self.activation.filter(|_| !relu) {
            Some(activation) => activate(activation, y),
            None => y,
        }
    }
}

/// The result of one gradient computation. Its buffers are reused.
#[derive(Debug, Clone, Default)]
pub(crate) struct Gradient {
    /// The derivatives of the loss with respect to the parameters, in the order of [`QNetwork::parameters`].
    pub values: Vec<f32>,
    /// The TD errors Q(s, a) - y, one per transition.
    pub td_errors: Vec<f32>,
    /// Q(s, a), one per transition.
    pub q: Vec<f32>,
    /// The weighted mean loss over the batch.
    pub loss: f32,
}

impl QNetwork {
    /// A network with weights and biases drawn uniformly from [-b, b], where b = 1/sqrt(inputs of the layer), like PyTorch's
    /// `Linear`. Layer normalizations start with scale 1 and shift 0.
    ///
    /// # Errors
    /// See [`NetworkShape::check`].
    pub fn new(shape: NetworkShape, stream: &mut Stream) -> Result<Self, ConfigError> {
        shape.check()?;
        let mut parameters = Vec::with_capacity(shape.parameter_count());
        for (i, (inputs, outputs)) in shape.layers().enumerate() {
            let bound = 1.0 / (inputs as f32).sqrt();
            parameters.extend((0..(inputs + 1) * outputs).map(|_| uniform(stream, -bound, bound)));
            if shape.layer_norm && i < shape.hidden.len() {
                parameters.extend(std::iter::repeat_n(1.0, outputs));
                parameters.extend(std::iter::repeat_n(0.0, outputs));
            }
        }
        Self::from_parameters(shape, parameters)
    }

    /// A network with these parameters, in the order of [`NetworkShape::parameters`].
    ///
    /// # Errors
    /// See [`NetworkShape::check`]; or the number of parameters does not match the shape.
    pub fn from_parameters(shape: NetworkShape, parameters: Vec<f32>) -> Result<Self, ConfigError> {
        shape.check()?;
        let count = shape.parameter_count();
        within("network.parameters", parameters.len(), count..=count)?;
        let device = Cpu::default();
        let layers = shape.layers().enumerate();
        let layers = layers.map(|(i, sizes)| Layer::zeros(&shape, i, sizes, &device)).collect();
        let mut network = Self { shape, parameters, layers, device };
        network.refresh();
        Ok(network)
    }

    /// The network with the weights of `policy`.
    ///
    /// # Errors
    /// See [`NetworkShape::check`].
    pub fn from_policy(policy: &Policy) -> Result<Self, ConfigError> {
        Self::from_parameters(policy.shape().clone(), policy.parameters().to_vec())
    }

    /// A policy with this network's weights, without a policy card.
    #[must_use]
    pub fn to_policy(&self) -> Policy {
        Policy::new(self.shape.clone(), self.parameters.clone())
            .expect("`from_parameters` checks the shape and the number of parameters")
    }

    /// The sizes and kinds of the layers.
    #[must_use]
    pub fn shape(&self) -> &NetworkShape {
        &self.shape
    }

    /// All parameters in one flat slice; [`NetworkShape::parameters`] names its parts.
    #[must_use]
    pub fn parameters(&self) -> &[f32] {
        &self.parameters
    }

    /// Modifies the parameters in place.
    pub fn update(&mut self, change: impl FnOnce(&mut [f32])) {
        change(&mut self.parameters);
        self.refresh();
    }

    /// Copies the flat parameters into the tensors.
    fn refresh(&mut self) {
        let mut rest = self.parameters.as_slice();
        let mut take = |length| rest.split_off(..length).unwrap_or_default();
        for Layer { dense: Dense { weight, bias }, norm, .. } in &mut self.layers {
            let (outputs, inputs) = *weight.shape();
            weight.copy_from(take(outputs * inputs));
            bias.copy_from(take(outputs));
            if let Some(LayerNorm { scale, shift }) = norm {
                scale.copy_from(take(outputs));
                shift.copy_from(take(outputs));
            }
        }
    }

    /// Writes the Q-values of `n` observations (row-major, n x inputs) into `out` (row-major, n x actions).
    pub fn q_values(&self, observations: &[f32], n: usize, out: &mut Vec<f32>) {
        self.in_chunks(observations, n, self.shape.actions, out, |head| {
            if self.shape.dueling { dueling(head) } else { head }
        });
    }

    /// Writes V and A of `n` observations into `out`: row-major, n x (1 + actions), V first. The mean of A is subtracted, so
    /// that Q = V + A. For a network without a dueling head, V is the mean Q-value.
    pub fn value_and_advantage(&self, observations: &[f32], n: usize, out: &mut Vec<f32>) {
        let mut head = Vec::new();
        let width = self.shape.actions + usize::from(self.shape.dueling);
        self.in_chunks(observations, n, width, &mut head, |head| head);
        out.clear();
        for row in head.chunks_exact(width) {
            let advantages = &row[usize::from(self.shape.dueling)..];
            let mean = advantages.iter().sum::<f32>() / self.shape.actions as f32;
            out.push(if self.shape.dueling { row[0] } else { mean });
            out.extend(advantages.iter().map(|a| a - mean));
        }
    }

    /// Runs the network on chunks of rows, applies `finish` to the output of the last layer, and writes the resulting rows
    /// into `out` (row-major, n x `width`).
    fn in_chunks(
        &self,
        observations: &[f32],
        n: usize,
        width: usize,
        out: &mut Vec<f32>,
        finish: impl Fn(Rows) -> Rows,
    ) {
        let inputs = self.shape.inputs;
        out.resize(n * width, 0.0);
        let chunks = observations[..n * inputs].chunks(CHUNK_ROWS * inputs);
        for (observations, out) in chunks.zip(out.chunks_mut(CHUNK_ROWS * width)) {
            let x = rows(&self.device, observations.to_vec(), observations.len() / inputs, inputs);
            finish(self.head(x)).copy_into(out);
        }
    }

    /// The output of the last layer, before the dueling combination.
    fn head<T: Tape<f32, Cpu>>(&self, x: Rows<T>) -> Rows<T> {
        self.layers.iter().enumerate().fold(x, |x, (i, layer)| layer.forward(x, i > 0))
    }

    /// Writes the loss of the regression of Q(s, a) on the TD targets, and the gradient of that loss, into `out`. The
    /// observations are row-major, n x inputs, where n is the number of transitions.
    pub(crate) fn gradient(&self, observations: &[f32], regression: Regression<'_>, out: &mut Gradient) {
        let x = rows(&self.device, observations.to_vec(), regression.actions.len(), self.shape.inputs);
        let head = self.head(x.leaky_traced());
        let q = if self.shape.dueling { dueling(head) } else { head };
        let loss = td_loss(q, regression, &mut out.td_errors, &mut out.q);
        out.loss = values(&loss)[0];
        let grads = loss.backward();
        out.values.resize(self.parameters.len(), 0.0);
        let mut rest = out.values.as_mut_slice();
        let mut take = |length| rest.split_off_mut(..length).unwrap_or_default();
        for Layer { dense: Dense { weight, bias }, norm, .. } in &self.layers {
            let (outputs, inputs) = *weight.shape();
            grads.get(weight).copy_into(take(outputs * inputs));
            grads.get(bias).copy_into(take(outputs));
            if let Some(LayerNorm { scale, shift }) = norm {
                grads.get(scale).copy_into(take(outputs));
                grads.get(shift).copy_into(take(outputs));
            }
        }
    }
}

impl PartialEq for QNetwork {
    /// Equality of shape and parameters. The tensors are copies of the parameters.
    fn eq(&self, other: &Self) -> bool {
        self.shape == other.shape && self.parameters == other.parameters
    }
}

impl std::fmt::Debug for QNetwork {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("QNetwork").field("shape", &self.shape).finish_non_exhaustive()
    }
}

#[cfg(test)]
mod gradient_tests;
#[cfg(test)]
mod tests;
