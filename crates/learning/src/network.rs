//! The Q-network: fully connected layers with ReLU, then Q-values, plain or dueling (fig. 5).
//!
//! In: observations, row-major. Out: Q-values (or V and A); and for training the gradient of the TD loss with
//! respect to all parameters. The parameters are one flat vector, owned here, so that optimizer, target
//! network, policy files and checkpoints need to know nothing of tensors; dfdx's tensors mirror it.

use std::collections::BTreeMap;

use dfdx::prelude::*;
use wayfield_policy::{NetworkShape, Policy};

use super::config::{ConfigError, within};
pub use super::ops::Regression;
use super::ops::{Dense, Rows, dueling, rows, td_loss, values};
use wayfield_random::{Stream, uniform};

/// Rows of one forward pass. Larger batches go in pieces of this many: the products then stay below the size
/// at which gemm would hand work to other threads, which costs more than it gains here.
const PIECE: usize = 128;

/// A network from observations to Q-values.
#[derive(Clone)]
pub struct QNetwork {
    shape: NetworkShape,
    parameters: Vec<f32>,
    layers: Vec<Dense>,
    device: Cpu,
}

/// What one gradient computation yields; reused from step to step.
#[derive(Debug, Clone, Default)]
pub struct Gradient {
    /// The loss's derivative by each parameter, in the order of [`QNetwork::parameters`].
    pub values: Vec<f32>,
    /// TD errors Q(s, a) - y, one per transition.
    pub td_errors: Vec<f32>,
    /// Q(s, a), one per transition.
    pub q: Vec<f32>,
    /// The loss: the weighted mean over the batch.
    pub loss: f32,
}

impl QNetwork {
    /// A network with weights and biases drawn evenly from +-1/sqrt(inputs of the layer), as PyTorch's
    /// `Linear`.
    ///
    /// # Errors
    /// See [`NetworkShape::check`].
    pub fn new(shape: NetworkShape, stream: &mut Stream) -> Result<Self, ConfigError> {
        shape.check()?;
        let mut parameters = Vec::with_capacity(shape.parameter_count());
        for (inputs, outputs) in shape.layers() {
            let bound = 1.0 / (inputs as f32).sqrt();
            parameters.extend((0..(inputs + 1) * outputs).map(|_| uniform(stream, -bound, bound)));
        }
        Self::from_parameters(shape, parameters)
    }

    /// A network with these parameters, in the order of [`NetworkShape::parameters`].
    ///
    /// # Errors
    /// See [`NetworkShape::check`]; or not as many parameters as the shape has.
    pub fn from_parameters(shape: NetworkShape, parameters: Vec<f32>) -> Result<Self, ConfigError> {
        shape.check()?;
        let count = shape.parameter_count();
        within("network.parameters", parameters.len(), count..=count)?;
        let device = Cpu::default();
        let layers = shape.layers().map(|(inputs, outputs)| Dense {
            weight: device.zeros_like(&(outputs, inputs)),
            bias: device.zeros_like(&(outputs,)),
        });
        let layers = layers.collect();
        let mut network = Self { shape, parameters, layers, device };
        network.refresh();
        Ok(network)
    }

    /// The network of `policy`.
    ///
    /// # Errors
    /// See [`NetworkShape::check`].
    pub fn from_policy(policy: &Policy) -> Result<Self, ConfigError> {
        Self::from_parameters(policy.shape().clone(), policy.parameters().to_vec())
    }

    /// A policy with this network's weights and `metadata`.
    #[must_use]
    pub fn to_policy(&self, metadata: BTreeMap<String, String>) -> Policy {
        Policy::new(self.shape.clone(), self.parameters.clone(), metadata)
            .expect("the shape and the number of parameters were checked when the network was made")
    }

    /// The network's sizes.
    #[must_use]
    pub fn shape(&self) -> &NetworkShape {
        &self.shape
    }

    /// All parameters, flat; [`NetworkShape::parameters`] names the pieces.
    #[must_use]
    pub fn parameters(&self) -> &[f32] {
        &self.parameters
    }

    /// Changes the parameters in place by `change`.
    pub fn update(&mut self, change: impl FnOnce(&mut [f32])) {
        change(&mut self.parameters);
        self.refresh();
    }

    /// Copies the flat parameters into the tensors that compute.
    fn refresh(&mut self) {
        let mut rest = self.parameters.as_slice();
        for Dense { weight, bias } in &mut self.layers {
            let (outputs, inputs) = *weight.shape();
            let (head, tail) = rest.split_at(outputs * inputs);
            weight.copy_from(head);
            let (head, tail) = tail.split_at(outputs);
            bias.copy_from(head);
            rest = tail;
        }
    }

    /// The Q-values of `n` observations (row-major, n x inputs) into `out` (row-major, n x actions).
    pub fn q_values(&self, observations: &[f32], n: usize, out: &mut Vec<f32>) {
        self.in_pieces(observations, n, self.shape.actions, out, |head| {
            if self.shape.dueling { dueling(head) } else { head }
        });
    }

    /// V and A of `n` observations into `out`: row-major, n x (1 + actions), V first. A plain network has no
    /// V of its own; there V is the mean Q-value and A what each differs by, which is what a dueling head
    /// converges to. A is given with its mean taken out, so that Q = V + A either way.
    pub fn value_and_advantage(&self, observations: &[f32], n: usize, out: &mut Vec<f32>) {
        let mut head = Vec::new();
        let width = self.shape.actions + usize::from(self.shape.dueling);
        self.in_pieces(observations, n, width, &mut head, |head| head);
        out.clear();
        for row in head.chunks_exact(width) {
            let advantages = &row[usize::from(self.shape.dueling)..];
            let mean = advantages.iter().sum::<f32>() / self.shape.actions as f32;
            out.push(if self.shape.dueling { row[0] } else { mean });
            out.extend(advantages.iter().map(|a| a - mean));
        }
    }

    fn in_pieces(
        &self,
        observations: &[f32],
        n: usize,
        width: usize,
        out: &mut Vec<f32>,
        finish: impl Fn(Rows) -> Rows,
    ) {
        let inputs = self.shape.inputs;
        out.resize(n * width, 0.0);
        let pieces = observations[..n * inputs].chunks(PIECE * inputs);
        for (observations, out) in pieces.zip(out.chunks_mut(PIECE * width)) {
            let x = rows(&self.device, observations.to_vec(), observations.len() / inputs, inputs);
            finish(self.head(x)).copy_into(out);
        }
    }

    /// The last layer's output of a batch, before the dueling combination.
    fn head<T: Tape<f32, Cpu>>(&self, x: Rows<T>) -> Rows<T> {
        let last = self.layers.len() - 1;
        self.layers.iter().enumerate().fold(x, |x, (i, layer)| layer.forward(x, i < last, i > 0))
    }

    /// The loss of regressing Q(s, a) on targets, and its gradient, for observations row-major, n x inputs,
    /// where n is the number of actions in `on`.
    pub fn gradient(&self, observations: &[f32], on: Regression<'_>, out: &mut Gradient) {
        let x = rows(&self.device, observations.to_vec(), on.actions.len(), self.shape.inputs);
        let head = self.head(x.leaky_traced());
        let q = if self.shape.dueling { dueling(head) } else { head };
        let loss = td_loss(q, on, &mut out.td_errors, &mut out.q);
        out.loss = values(&loss)[0];
        let grads = loss.backward();
        out.values.resize(self.parameters.len(), 0.0);
        let mut rest = out.values.as_mut_slice();
        for Dense { weight, bias } in &self.layers {
            let (outputs, inputs) = *weight.shape();
            let (head, tail) = rest.split_at_mut(outputs * inputs);
            grads.get(weight).copy_into(head);
            let (head, tail) = tail.split_at_mut(outputs);
            grads.get(bias).copy_into(head);
            rest = tail;
        }
    }
}

impl PartialEq for QNetwork {
    /// Equal shape and equal parameters.
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
mod tests {
    use super::*;
    use crate::config::NetworkConfig;
    use wayfield_random::stream;

    fn shape(hidden: &[usize], actions: usize, dueling: bool) -> NetworkShape {
        let config = NetworkConfig { hidden: hidden.to_vec(), dueling };
        config.shape(2, actions).expect("a sound shape")
    }

    #[test]
    fn a_dueling_head_is_value_plus_advantage_less_the_mean_advantage() {
        // No hidden layer. V = x + 2y, A = (x, 2x, 6x) + (0, 0, 3); at (1, 10): V = 21, A = (1, 2, 9), mean
        // 4.
        let weights = [[1.0, 2.0], [1.0, 0.0], [2.0, 0.0], [6.0, 0.0]].concat();
        let parameters = [weights, vec![0.0, 0.0, 0.0, 3.0]].concat();
        let network = QNetwork::from_parameters(shape(&[], 3, true), parameters).expect("as many as it has");
        let mut out = Vec::new();
        network.q_values(&[1.0, 10.0], 1, &mut out);
        assert_eq!(out, [18.0, 19.0, 26.0], "Q = 21 + (1, 2, 9) - 4");
        network.value_and_advantage(&[1.0, 10.0], 1, &mut out);
        assert_eq!(out, [21.0, -3.0, -2.0, 5.0], "V, then A with its mean taken out");
    }

    #[test]
    fn a_hidden_layer_is_weights_bias_and_relu() {
        // h = relu((x - y, x + y - 1)), Q = h_1 + 10 h_2 + 0.5; at (2, 3): h = (0, 4), Q = 40.5.
        let parameters = vec![1.0, -1.0, 1.0, 1.0, 0.0, -1.0, 1.0, 10.0, 0.5];
        let network =
            QNetwork::from_parameters(shape(&[2], 1, false), parameters).expect("as many as it has");
        let mut out = Vec::new();
        network.q_values(&[2.0, 3.0, 0.0, 0.0], 2, &mut out);
        assert_eq!(out, [40.5, 0.5], "two observations, row by row");
    }

    #[test]
    fn first_weights_are_even_within_one_over_the_root_of_the_inputs() {
        let config = NetworkConfig { hidden: vec![64, 64], dueling: true };
        let shape = config.shape(28, 5).expect("the paper's shape");
        let network = QNetwork::new(shape.clone(), &mut stream(1, "test", 0)).expect("a sound shape");
        for (name, inputs) in [("hidden.0.weight", 28.0_f32), ("hidden.1.weight", 64.0)] {
            let view = shape.parameters().into_iter().find(|view| view.name == name).expect("it has this");
            let (weights, bound) = (&network.parameters()[view.range], 1.0 / inputs.sqrt());
            let largest = weights.iter().fold(0.0_f32, |largest, w| largest.max(w.abs()));
            assert!(largest <= bound && largest > 0.99 * bound, "{name}: {largest}, bound {bound}");
            let variance = weights.iter().map(|w| w * w).sum::<f32>() / weights.len() as f32;
            assert!(
                (variance * 3.0 * inputs - 1.0).abs() < 0.1,
                "{name}: variance of an even draw is bound^2 / 3"
            );
        }
        let other = QNetwork::new(shape, &mut stream(2, "test", 0)).expect("a sound shape");
        assert_ne!(network, other, "another stream, other weights");
    }

    #[test]
    fn a_batch_in_pieces_gives_what_single_rows_give() {
        let network =
            QNetwork::new(shape(&[16, 16], 3, true), &mut stream(1, "test", 0)).expect("a sound shape");
        let mut noise = stream(2, "test", 0);
        let observations: Vec<f32> = (0..2 * 300).map(|_| uniform(&mut noise, -1.0, 1.0)).collect();
        let (mut all, mut one) = (vec![7.0; 5], Vec::new());
        network.q_values(&observations, 300, &mut all);
        assert_eq!(all.len(), 900, "an output vector of another length is resized");
        for (observation, q) in observations.chunks(2).zip(all.chunks(3)) {
            network.q_values(observation, 1, &mut one);
            for (a, b) in q.iter().zip(&one) {
                assert!((a - b).abs() < 1e-5, "{q:?} and {one:?}");
            }
        }
        network.q_values(&[], 0, &mut all);
        assert!(all.is_empty(), "no observations, no values");
    }

    #[test]
    fn absurd_shapes_are_refused() {
        for (hidden, inputs, actions) in
            [(vec![64], 0, 5), (vec![64], 28, 0), (vec![64], 28, 256), (vec![4096; 8], 28, 5)]
        {
            let config = NetworkConfig { hidden, dueling: true };
            assert!(config.shape(inputs, actions).is_err(), "{config:?} {inputs} {actions}");
        }
        assert!(QNetwork::from_parameters(shape(&[3], 2, true), vec![0.0; 3]).is_err(), "too few parameters");
    }
}
