//! The Q-network: fully connected layers and a plain or dueling head (fig. 5 of the paper).
//!
//! In: observations, row-major. Out: Q-values, or V and A; in training, the gradient of the TD loss with respect to all
//! parameters. All parameters are stored in one flat vector, and copied to the dfdx tensors after each change. The
//! optimizer, the target network, policy files and checkpoints use only the flat vector.

use dfdx::prelude::*;
use wayfield_policy::{Activation, NetworkShape, Policy};

use super::config::ConfigError;
use super::limits::MAX_QUANTILES;
pub(crate) use super::ops::Regression;
use super::ops::{
    Dense, LayerNorm, Rows, activate, dueling, mean_of_quantiles, quantile_loss, rows, td_loss, values,
};
use wayfield_policy::limits::MAX_PARAMETERS;
use wayfield_policy::range::within;
use wayfield_random::{Stream, uniform};

/// The maximum number of rows of one forward pass without a gradient. Larger batches are split, so that the matrix products stay
/// below the size at which gemm starts threads: at this size, threads cost more than they gain.
const CHUNK_ROWS: usize = 128;

/// A network that maps observations to Q-values, or to quantiles of returns, whose means are the Q-values.
#[derive(Clone)]
pub struct QNetwork {
    /// The shape for one quantile.
    shape: NetworkShape,
    /// The number of quantiles; each has a head of its own on the last hidden layer. If it is 1, the head gives the
    /// Q-values.
    quantiles: usize,
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
    /// The TD errors Q(s, a) - y, one per transition. With quantiles, y is the mean of its targets.
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
        Self::with_quantiles(shape, 1, stream)
    }

    /// Like [`QNetwork::new`], with this number of quantiles.
    pub(crate) fn with_quantiles(
        shape: NetworkShape,
        quantiles: usize,
        stream: &mut Stream,
    ) -> Result<Self, ConfigError> {
        shape.check()?;
        within("quantiles", quantiles, 1..=max_quantiles(&shape))?;
        let mut parameters = Vec::with_capacity(shape.parameter_count());
        for (i, (inputs, outputs)) in layers(&shape, quantiles).enumerate() {
            let bound = 1.0 / (inputs as f32).sqrt();
            parameters.extend((0..(inputs + 1) * outputs).map(|_| uniform(stream, -bound, bound)));
            if shape.layer_norm && i < shape.hidden.len() {
                parameters.extend(std::iter::repeat_n(1.0, outputs));
                parameters.extend(std::iter::repeat_n(0.0, outputs));
            }
        }
        Ok(Self::with_parameters(shape, quantiles, parameters))
    }

    /// A network with these parameters, in the order of [`NetworkShape::parameters`].
    ///
    /// # Errors
    /// See [`NetworkShape::check`]; or the number of parameters does not match the shape.
    pub fn from_parameters(shape: NetworkShape, parameters: Vec<f32>) -> Result<Self, ConfigError> {
        shape.check()?;
        let count = shape.parameter_count();
        within("network.parameters", parameters.len(), count..=count)?;
        Ok(Self::with_parameters(shape, 1, parameters))
    }

    fn with_parameters(shape: NetworkShape, quantiles: usize, parameters: Vec<f32>) -> Self {
        let device = Cpu::default();
        let layers = layers(&shape, quantiles).enumerate();
        let layers = layers.map(|(i, sizes)| Layer::zeros(&shape, i, sizes, &device)).collect();
        let mut network = Self { shape, quantiles, parameters, layers, device };
        network.refresh();
        network
    }

    /// The network with the weights of `policy`.
    ///
    /// # Errors
    /// See [`NetworkShape::check`].
    pub fn from_policy(policy: &Policy) -> Result<Self, ConfigError> {
        Self::from_parameters(policy.shape().clone(), policy.parameters().to_vec())
    }

    /// A policy with this network's weights, without a policy card. Its head has the mean weights of all quantiles, so its
    /// Q-values are their means.
    #[must_use]
    pub fn to_policy(&self) -> Policy {
        let (hidden, weights, biases) = self.split_head();
        let mut parameters = hidden.to_vec();
        for heads in [weights, biases] {
            let size = heads.len() / self.quantiles;
            let mean = |at: usize| match self.quantiles {
                1 => heads[at],
                n => heads[at..].iter().step_by(size).sum::<f32>() / n as f32,
            };
            parameters.extend((0..size).map(mean));
        }
        Policy::new(self.shape.clone(), parameters)
            .expect("`with_parameters` gets a valid shape and its number of parameters")
    }

    /// Replaces all parameters by those of a policy of the same shape. Each quantile gets the policy's head.
    pub(crate) fn load(&mut self, policy: &Policy) {
        let (inputs, outputs) = head_size(&self.shape);
        let (hidden, head) = policy.parameters().split_at(policy.parameters().len() - (inputs + 1) * outputs);
        let (weights, biases) = head.split_at(inputs * outputs);
        let n = self.quantiles;
        self.update(|parameters| {
            let all = hidden.iter().chain(weights.iter().cycle().take(n * weights.len()));
            let all = all.chain(biases.iter().cycle().take(n * biases.len()));
            parameters.iter_mut().zip(all).for_each(|(to, from)| *to = *from);
        });
    }

    /// The parameters of the hidden layers, the weights of all heads, the biases of all heads.
    fn split_head(&self) -> (&[f32], &[f32], &[f32]) {
        let (inputs, outputs) = head_size(&self.shape);
        let heads = (inputs + 1) * outputs * self.quantiles;
        let (hidden, heads) = self.parameters.split_at(self.parameters.len() - heads);
        let (weights, biases) = heads.split_at(inputs * outputs * self.quantiles);
        (hidden, weights, biases)
    }

    /// The name, as in [`NetworkShape::parameters`], of the tensor that contains the parameter with this index in
    /// [`Self::parameters`]. It is the same for all quantiles.
    pub(crate) fn parameter_name(&self, index: usize) -> String {
        let (inputs, outputs) = head_size(&self.shape);
        let (hidden, weights) = (self.split_head().0.len(), inputs * outputs);
        let index = match index.checked_sub(hidden) {
            None => index,
            Some(at) if at < weights * self.quantiles => hidden + at % weights,
            Some(at) => hidden + weights + (at - weights * self.quantiles) % outputs,
        };
        let views = self.shape.parameters();
        views.into_iter().find(|view| view.range.contains(&index)).map_or(String::new(), |view| view.name)
    }

    /// The sizes and kinds of the layers.
    #[must_use]
    pub fn shape(&self) -> &NetworkShape {
        &self.shape
    }

    /// The number of quantiles; 1 if the network has Q-values.
    #[must_use]
    pub fn quantiles(&self) -> usize {
        self.quantiles
    }

    /// All parameters in one flat slice; [`NetworkShape::parameters`] names its parts. With several quantiles, the
    /// head's part contains the weights of all heads, then the biases of all heads.
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
        self.in_chunks(observations, n, self.shape.actions, out, |heads| {
            let head = mean_of_quantiles(heads, self.quantiles);
            if self.shape.dueling { dueling(head) } else { head }
        });
    }

    /// Writes the quantiles of the returns of all actions for `n` observations into `out`: row-major, n x quantiles x actions.
    pub fn quantile_values(&self, observations: &[f32], n: usize, out: &mut Vec<f32>) {
        let width = self.quantiles * self.shape.actions;
        self.in_chunks(observations, n, width, out, |heads| self.quantile_rows(heads));
    }

    /// The quantiles of all actions, from the output of the last layer. Each of the n rows has the outputs of all heads; each of
    /// the n * quantiles rows of the result has one value per action.
    fn quantile_rows<T: Tape<f32, Cpu>>(&self, heads: Rows<T>) -> Rows<T> {
        let (n, width) = *heads.shape();
        let heads = match self.quantiles {
            1 => heads,
            count => heads.reshape_like(&(n * count, width / count)),
        };
        if self.shape.dueling { dueling(heads) } else { heads }
    }

    /// Writes V and A of `n` observations into `out`: row-major, n x (1 + actions), V first. The mean of A is subtracted, so
    /// that Q = V + A. For a network without a dueling head, V is the mean Q-value.
    pub fn value_and_advantage(&self, observations: &[f32], n: usize, out: &mut Vec<f32>) {
        let mut head = Vec::new();
        let width = self.shape.actions + usize::from(self.shape.dueling);
        self.in_chunks(observations, n, width, &mut head, |heads| mean_of_quantiles(heads, self.quantiles));
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

    /// Writes the loss of the regression of Q(s, a), or of its quantiles, on the TD targets, and the gradient of that loss,
    /// into `out`. The observations are row-major, n x inputs, where n is the number of transitions.
    pub(crate) fn gradient(&self, observations: &[f32], regression: Regression<'_>, out: &mut Gradient) {
        let x = rows(&self.device, observations.to_vec(), regression.actions.len(), self.shape.inputs);
        let head = self.quantile_rows(self.head(x.leaky_traced()));
        let loss = if self.quantiles == 1 {
            td_loss(head, regression, &mut out.td_errors, &mut out.q)
        } else {
            quantile_loss(head, self.quantiles, regression, &mut out.td_errors, &mut out.q)
        };
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

/// The inputs and outputs of the head of one quantile.
fn head_size(shape: &NetworkShape) -> (usize, usize) {
    (shape.hidden.last().copied().unwrap_or(shape.inputs), shape.actions + usize::from(shape.dueling))
}

/// The inputs and outputs of all layers; the last one has the heads of all quantiles.
fn layers(shape: &NetworkShape, quantiles: usize) -> impl Iterator<Item = (usize, usize)> + '_ {
    let heads = move |i| if i == shape.hidden.len() { quantiles } else { 1 };
    shape.layers().enumerate().map(move |(i, (inputs, outputs))| (inputs, outputs * heads(i)))
}

/// The largest number of quantiles with which the network has at most [`MAX_PARAMETERS`] parameters.
fn max_quantiles(shape: &NetworkShape) -> usize {
    let (inputs, outputs) = head_size(shape);
    let more = MAX_PARAMETERS.saturating_sub(shape.parameter_count()) / ((inputs + 1) * outputs);
    (1 + more).min(MAX_QUANTILES)
}

impl PartialEq for QNetwork {
    /// Equality of shape, quantiles and parameters. The tensors are copies of the parameters.
    fn eq(&self, other: &Self) -> bool {
        self.shape == other.shape && self.quantiles == other.quantiles && self.parameters == other.parameters
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
