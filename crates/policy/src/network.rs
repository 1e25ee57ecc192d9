//! The shape of a Q-network (fig. 5 of the paper), and its forward pass in plain loops.
//!
//! Fully connected layers, each with an optional layer normalization and an activation function, then Q-values, plain or
//! dueling. The learner computes the same function with dfdx; `crates/learning/tests/policy.rs` compares the two.

use std::fmt;
use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::activation::{self, Activation};
use crate::limits::{MAX_ACTIONS, MAX_LAYERS, MAX_PARAMETERS, MAX_UNITS};
use crate::range::{ConfigError, within};

/// The layers of a Q-network.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct NetworkShape {
    /// Length of an observation, 1 to 4096.
    pub inputs: usize,
    /// Widths of the hidden layers: at most 8, each 1 to 4096.
    pub hidden: Vec<usize>,
    /// Number of discrete actions, 1 to 255.
    pub actions: usize,
    /// Whether the head is dueling (state value and advantages) or plain Q-values.
    pub dueling: bool,
    /// Whether each hidden layer is normalized before its activation (Ba et al. 2016): y = (x - mean) / sqrt(variance +
    /// [`LAYER_NORM_EPSILON`]) * scale + shift, with the mean and the biased variance over the units of the layer.
    #[serde(default, skip_serializing_if = "is_default")]
    pub layer_norm: bool,
    /// The activation function of the hidden layers.
    #[serde(default, skip_serializing_if = "is_default", with = "activation::by_name")]
    pub activation: Activation,
}

/// The constant that a layer normalization adds to the variance, as in PyTorch's `LayerNorm`.
pub const LAYER_NORM_EPSILON: f32 = 1e-5;

/// Whether `value` is the default, which a header leaves out.
fn is_default<T: Default + PartialEq>(value: &T) -> bool {
    *value == T::default()
}

/// The name and shape of one parameter tensor, and its range in the flat parameter vector.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ParameterView {
    /// The tensor's name, such as "hidden.0.weight", "hidden.0.norm.weight", "value.bias" or "output.weight".
    pub name: String,
    /// `[outputs, inputs]` for a weight (row-major, as in PyTorch); `[outputs]` for a bias, and for the scale
    /// (`norm.weight`) and the shift (`norm.bias`) of a layer normalization.
    pub shape: Vec<usize>,
    /// The tensor's range in the flat parameter vector.
    pub range: Range<usize>,
}

impl NetworkShape {
    /// Checks every size against its range.
    ///
    /// # Errors
    /// The first size that is out of its range.
    pub fn check(&self) -> Result<(), ConfigError> {
        within("network.inputs", self.inputs, 1..=MAX_UNITS)?;
        within("network.actions", self.actions, 1..=MAX_ACTIONS)?;
        Self::check_hidden(&self.hidden)?;
        within("network.parameters", self.parameter_count(), 1..=MAX_PARAMETERS)
    }

    /// Checks the widths of hidden layers only: at most 8 layers, each of 1 to 4096 units.
    ///
    /// # Errors
    /// There are too many layers, or a width is out of its range.
    pub fn check_hidden(hidden: &[usize]) -> Result<(), ConfigError> {
        Self::hidden_problems(hidden).into_iter().next().map_or(Ok(()), Err)
    }

    /// All problems that [`check_hidden`](Self::check_hidden) looks for. If there are too many layers, widths are not checked.
    #[must_use]
    pub fn hidden_problems(hidden: &[usize]) -> Vec<ConfigError> {
        if hidden.len() > MAX_LAYERS {
            let problem = format!("has {} layers; help: give at most {MAX_LAYERS}", hidden.len());
            return vec![ConfigError { field: "network.hidden".into(), problem }];
        }
        let widths = hidden.iter().enumerate();
        widths
            .filter_map(|(i, &width)| within(&format!("network.hidden[{i}]"), width, 1..=MAX_UNITS).err())
            .collect()
    }

    /// The sizes `(inputs, outputs)` of each layer; the head comes last. A dueling head has one output for the state
    /// value V, then one per action for the advantages A.
    pub fn layers(&self) -> impl Iterator<Item = (usize, usize)> + '_ {
        let head = self.actions + usize::from(self.dueling);
        let inputs = std::iter::once(self.inputs).chain(self.hidden.iter().copied());
        inputs.zip(self.hidden.iter().copied().chain(std::iter::once(head)))
    }

    /// The number of parameters in all layers.
    #[must_use]
    pub fn parameter_count(&self) -> usize {
        let normalized = if self.layer_norm { &self.hidden[..] } else { &[] };
        let norms = normalized.iter().fold(0_usize, |sum, width| sum.saturating_add(width.saturating_mul(2)));
        self.layers().fold(norms, |sum, (inputs, outputs)| {
            sum.saturating_add(inputs.saturating_add(1).saturating_mul(outputs))
        })
    }

    /// All parameter tensors, in the order of the flat parameter vector. A dueling head is one matrix there; its first
    /// row is the state value's.
    #[must_use]
    pub fn parameters(&self) -> Vec<ParameterView> {
        let mut views = Vec::new();
        let mut start = 0;
        let mut push = |name: String, shape: Vec<usize>| {
            let range = start..start + shape.iter().product::<usize>();
            start = range.end;
            views.push(ParameterView { name, shape, range });
        };
        for (i, (inputs, outputs)) in self.layers().enumerate() {
            let parts = if i < self.hidden.len() {
                vec![(format!("hidden.{i}"), outputs)]
            } else if self.dueling {
                vec![("value".to_string(), 1), ("advantage".to_string(), self.actions)]
            } else {
                vec![("output".to_string(), outputs)]
            };
            for (part, outputs) in &parts {
                push(format!("{part}.weight"), vec![*outputs, inputs]);
            }
            for (part, outputs) in &parts {
                push(format!("{part}.bias"), vec![*outputs]);
            }
            if self.layer_norm && i < self.hidden.len() {
                for tensor in ["weight", "bias"] {
                    push(format!("hidden.{i}.norm.{tensor}"), vec![outputs]);
                }
            }
        }
        views
    }
}

impl fmt::Display for NetworkShape {
    /// The sizes from inputs to actions, such as "28-64-64-dueling 5", then what differs from a network with ReLU and
    /// without layer normalization, such as " with layer norm and tanh".
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}-", self.inputs)?;
        self.hidden.iter().try_for_each(|width| write!(f, "{width}-"))?;
        write!(f, "{}{}", if self.dueling { "dueling " } else { "" }, self.actions)?;
        match (self.layer_norm, self.activation.name()) {
            (false, "relu") => Ok(()),
            (false, name) => write!(f, " with {name}"),
            (true, name) => write!(f, " with layer norm and {name}"),
        }
    }
}

/// The parameters of a network as a forward pass reads them: each weight matrix is transposed, so that the weights of one
/// input are contiguous.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Weights(Vec<f32>);

impl Weights {
    /// Transposes the matrices of flat `parameters`, [`NetworkShape::parameter_count`] of them.
    pub(crate) fn new(shape: &NetworkShape, parameters: &[f32]) -> Self {
        let mut transposed = Vec::with_capacity(parameters.len());
        let mut rest = parameters;
        for (i, (inputs, outputs)) in shape.layers().enumerate() {
            let (weight, tail) = rest.split_at(inputs * outputs);
            for input in 0..inputs {
                transposed.extend((0..outputs).map(|output| weight[output * inputs + input]));
            }
            let norm = if shape.layer_norm && i < shape.hidden.len() { 2 * outputs } else { 0 };
            let (others, tail) = tail.split_at(outputs + norm);
            transposed.extend_from_slice(others);
            rest = tail;
        }
        Self(transposed)
    }
}

/// The working memory of a forward pass. Reusing it avoids allocations.
#[derive(Debug, Clone, Default)]
pub struct Scratch {
    units: Vec<f32>,
    next: Vec<f32>,
    /// The indices of a layer's nonzero inputs, followed by unused elements.
    active: Vec<u32>,
}

/// Computes the Q-values of one `observation` in `scratch`, for a network of this `shape` with these `weights`.
///
/// `observation` has `shape.inputs` elements.
pub(crate) fn forward<'a>(
    shape: &NetworkShape,
    weights: &Weights,
    observation: &[f32],
    scratch: &'a mut Scratch,
) -> &'a [f32] {
    let Scratch { units, next, active } = scratch;
    units.clear();
    units.extend_from_slice(observation);
    let mut rest = &weights.0[..];
    let mut take = |length| {
        let (tensor, tail) = rest.split_at(length);
        rest = tail;
        tensor
    };
    for (i, (inputs, outputs)) in shape.layers().enumerate() {
        let (weight, bias) = (take(inputs * outputs), take(outputs));
        fully_connected(weight, bias, units, list_active(units, active), next);
        if i < shape.hidden.len() {
            if shape.layer_norm {
                normalize(next, take(outputs), take(outputs));
            }
            shape.activation.apply(next);
        }
        std::mem::swap(units, next);
    }
    if !shape.dueling {
        return units;
    }
    // Q = V + A - mean(A): the dueling head of Wang et al. 2016.
    let (value, advantages) = (units[0], &mut units[1..]);
    let mean = advantages.iter().sum::<f32>() / shape.actions as f32;
    advantages.iter_mut().for_each(|advantage| *advantage += value - mean);
    &units[1..]
}

/// Writes the indices of the nonzero units into `active`, and returns them. Typically half of an observation by sectors, and at
/// least half of the units after a ReLU, are 0 and add nothing to the next layer.
fn list_active<'a>(units: &[f32], active: &'a mut Vec<u32>) -> &'a [u32] {
    if active.len() < units.len() {
        active.resize(units.len(), 0);
    }
    let mut count = 0;
    for (index, unit) in units.iter().enumerate() {
        // Writing first and counting afterwards avoids an unpredictable branch. The shift drops the sign bit, so that -0
        // counts as 0.
        active[count] = index as u32;
        count += usize::from(unit.to_bits() << 1 != 0);
    }
    &active[..count]
}

/// Writes the outputs of a fully connected layer into `outputs`: each is its bias plus the products of its weights and the
/// `active` ones of `units`, added in the order of the units. `weight` is [transposed](Weights).
fn fully_connected(weight: &[f32], bias: &[f32], units: &[f32], active: &[u32], outputs: &mut Vec<f32>) {
    outputs.clear();
    outputs.extend_from_slice(bias);
    let unit = |index: u32| units[index as usize];
    let weights = |index: u32| &weight[index as usize * bias.len()..][..bias.len()];
    pulp::Arch::new().dispatch(
        #[inline(always)]
        || {
            // Four units at a time, so that the sums are loaded and stored less often.
            let (fours, rest) = active.as_chunks::<4>();
            for four in fours {
                let [a, b, c, d] = four.map(unit);
                let [i, j, k, l] = four.map(weights);
                for ((((sum, i), j), k), l) in outputs.iter_mut().zip(i).zip(j).zip(k).zip(l) {
                    *sum = *sum + i * a + j * b + k * c + l * d;
                }
            }
            for &index in rest {
                outputs.iter_mut().zip(weights(index)).for_each(|(sum, weight)| *sum += weight * unit(index));
            }
        },
    );
}

/// Normalizes the units of a layer: see [`NetworkShape::layer_norm`].
fn normalize(units: &mut [f32], scale: &[f32], shift: &[f32]) {
    let n = units.len() as f32;
    let mean = units.iter().sum::<f32>() / n;
    let variance = units.iter().map(|x| (x - mean) * (x - mean)).sum::<f32>() / n;
    let factor = 1.0 / (variance + LAYER_NORM_EPSILON).sqrt();
    for ((x, scale), shift) in units.iter_mut().zip(scale).zip(shift) {
        *x = (*x - mean) * factor * scale + shift;
    }
}

/// The greedy action: the index of the largest Q-value in `q_row`, the lowest index among equals. An empty row gives 0.
#[must_use]
pub fn greedy(q_row: &[f32]) -> usize {
    let mut best = 0;
    for (action, &q) in q_row.iter().enumerate() {
        if q > q_row[best] {
            best = action;
        }
    }
    best
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shape(hidden: &[usize], dueling: bool) -> NetworkShape {
        NetworkShape {
            inputs: 2,
            hidden: hidden.to_vec(),
            actions: 2,
            dueling,
            layer_norm: false,
            activation: Activation::Relu,
        }
    }

    #[test]
    fn parameters_have_stable_names_and_fill_the_flat_vector() {
        let shape = NetworkShape { layer_norm: true, ..shape(&[3], true) };
        let views = shape.parameters();
        let names: Vec<&str> = views.iter().map(|view| view.name.as_str()).collect();
        let expected = [
            "hidden.0.weight",
            "hidden.0.bias",
            "hidden.0.norm.weight",
            "hidden.0.norm.bias",
            "value.weight",
            "advantage.weight",
            "value.bias",
            "advantage.bias",
        ];
        assert_eq!(names, expected);
        let mut end = 0;
        for view in &views {
            assert_eq!(view.range.start, end, "{} directly follows the previous tensor", view.name);
            end = view.range.end;
        }
        assert_eq!(end, shape.parameter_count());
    }

    #[test]
    fn a_plain_network_matches_a_calculation_by_hand() {
        // One hidden unit: relu(1*3 - 2*1 + 0.5) = 1.5. Outputs: 2*1.5 + 1 = 4 and -1*1.5 + 0 = -1.5.
        let parameters = [1.0, -2.0, 0.5, 2.0, -1.0, 1.0, 0.0];
        let (shape, mut scratch) = (shape(&[1], false), Scratch::default());
        let weights = Weights::new(&shape, &parameters);
        assert_eq!(forward(&shape, &weights, &[3.0, 1.0], &mut scratch), [4.0, -1.5]);
        // relu(1*0 - 2*1 + 0.5) = 0: the outputs are their biases.
        assert_eq!(forward(&shape, &weights, &[0.0, 1.0], &mut scratch), [1.0, 0.0]);
    }

    #[test]
    fn transposed_weights_give_the_same_bits_as_sums_one_by_one() {
        let shape = NetworkShape { inputs: 7, actions: 21, ..shape(&[37, 16], false) };
        let mut parameters = Vec::new();
        parameters.extend((0..shape.parameter_count()).map(|k| (k as f32 * 0.37).sin()));
        let observation: Vec<f32> = (0..7).map(|k| (k as f32).cos()).collect();
        let mut scratch = Scratch::default();
        let found = forward(&shape, &Weights::new(&shape, &parameters), &observation, &mut scratch);
        let (mut units, mut rest) = (observation.clone(), &parameters[..]);
        for (i, (inputs, outputs)) in shape.layers().enumerate() {
            let (weight, tail) = rest.split_at(inputs * outputs);
            let (bias, tail) = tail.split_at(outputs);
            rest = tail;
            let sum =
                |(row, bias): (&[f32], &f32)| row.iter().zip(&units).fold(*bias, |sum, (w, u)| sum + w * u);
            let sums = weight.chunks_exact(inputs).zip(bias).map(sum);
            units = if i < 2 { sums.map(|sum| sum.max(0.0)).collect() } else { sums.collect() };
        }
        assert_eq!(found, units);
    }

    #[test]
    fn a_normalized_layer_matches_a_calculation_by_hand() {
        // x = (3, 1) + (1, 1) = (4, 2): mean 3, variance 1, so (1, -1) up to epsilon. Scale (2, 1), shift (0, 4): (2, 3).
        // Q_0 = ELU(2) + ELU(3) = 5. Q_1 = -1.
        let hidden = [1.0, 0.0, 0.0, 1.0, 1.0, 1.0, 2.0, 1.0, 0.0, 4.0];
        let parameters = [&hidden[..], &[1.0, 1.0, 0.0, 0.0, 0.0, -1.0]].concat();
        let shape = NetworkShape { layer_norm: true, activation: Activation::Elu, ..shape(&[2], false) };
        assert_eq!(shape.parameter_count(), parameters.len());
        let mut scratch = Scratch::default();
        let q = forward(&shape, &Weights::new(&shape, &parameters), &[3.0, 1.0], &mut scratch);
        assert!((q[0] - 5.0).abs() < 1e-4 && q[1] == -1.0, "{q:?}");
        assert_eq!(shape.to_string(), "2-2-2 with layer norm and elu");
    }

    #[test]
    fn a_dueling_head_is_value_plus_advantage_minus_mean_advantage() {
        // No hidden layer: V = x0 = 10, A = (x1, 3 x1) = (2, 6), mean 4: Q = (8, 12).
        let parameters = [1.0, 0.0, 0.0, 1.0, 0.0, 3.0, 0.0, 0.0, 0.0];
        let shape = shape(&[], true);
        let weights = Weights::new(&shape, &parameters);
        let q = forward(&shape, &weights, &[10.0, 2.0], &mut Scratch::default()).to_vec();
        assert_eq!(q, [8.0, 12.0]);
        assert_eq!(greedy(&q), 1);
    }

    #[test]
    fn the_greedy_action_is_the_first_with_the_largest_value() {
        assert_eq!(greedy(&[0.0, 2.0, 1.0]), 1);
        assert_eq!(greedy(&[-1.0, 3.0, 3.0, 3.0]), 1);
        assert_eq!(greedy(&[f32::NEG_INFINITY, -5.0]), 1);
    }

    #[test]
    fn a_size_out_of_range_is_named_and_does_not_overflow() {
        let error = shape(&[5000], true).check().expect_err("a layer of 5000 units");
        assert_eq!(error.field, "network.hidden[0]");
        assert!(shape(&[1; 9], true).check().is_err(), "nine layers");
        assert!(shape(&[usize::MAX], true).check().is_err());
        assert!(shape(&[4096; 3], true).check().is_err(), "more parameters than allowed");
        assert_eq!(shape(&[64, 64], true).check(), Ok(()));
    }
}
