//! The network's operations with their backward passes: dense layer, layer normalization, activation functions, dueling
//! combination, quantiles, TD loss.
//!
//! In: tensors of batch x units, with or without a gradient tape. Out: tensors; on a tape, each operation records its
//! backward pass.
//!
//! dfdx's own bias broadcast, ReLU and row selection iterate over general strides and cost more than the matrix products.
//! Here dfdx only holds the tape and, except on wasm, computes the matrix products; plain loops do the rest.

mod activation;
mod layer_norm;
mod quantiles;

use dfdx::prelude::*;

use super::config::Loss;
#[cfg(target_arch = "wasm32")]
use super::matmul::{LeftMatrix, multiply, transposed};
pub(crate) use activation::activate;
pub(crate) use layer_norm::{LayerNorm, Units};
pub(crate) use quantiles::{mean_of_quantiles, quantile_loss};

/// A batch of rows, with or without a tape.
pub(crate) type Rows<T = NoneTape> = Tensor<(usize, usize), f32, Cpu, T>;

/// A tensor of shape n x width with the row-major `values`.
pub(crate) fn rows(device: &Cpu, values: Vec<f32>, n: usize, width: usize) -> Rows {
    device.tensor_from_vec(values, (n, width))
}

/// The values of `tensor`, row-major.
pub(crate) fn values<S: Shape, T>(tensor: &Tensor<S, f32, Cpu, T>) -> Vec<f32> {
    let mut values = vec![0.0; tensor.shape().num_elements()];
    tensor.copy_into(&mut values);
    values
}

/// The product a b^T.
#[cfg(not(target_arch = "wasm32"))]
fn times_transposed(a: &Rows, b: &Rows) -> Rows {
    product(a.clone(), b.clone().permute::<_, Axes2<1, 0>>())
}

/// The product a^T b, written to `out`.
#[cfg(not(target_arch = "wasm32"))]
fn transposed_times(a: &Rows, b: &Rows, out: &mut [f32]) {
    product(a.clone().permute::<_, Axes2<1, 0>>(), b.clone()).copy_into(out);
}

/// The product a b, written to `out`.
#[cfg(not(target_arch = "wasm32"))]
fn times(a: &Rows, b: &Rows, out: &mut [f32]) {
    product(a.clone(), b.clone()).copy_into(out);
}

#[cfg(not(target_arch = "wasm32"))]
fn product(a: Rows, b: Rows) -> Rows {
    super::thread_pool::ensure();
    a.matmul(b)
}

#[cfg(target_arch = "wasm32")]
fn times_transposed(a: &Rows, b: &Rows) -> Rows {
    let ((m, k), (n, _)) = (*a.shape(), *b.shape());
    let mut out = vec![0.0; m * n];
    let left = LeftMatrix { values: &values(a), strides: (k, 1) };
    multiply(left, &transposed(&values(b), n, k), (m, k, n), &mut out);
    rows(a.device(), out, m, n)
}

#[cfg(target_arch = "wasm32")]
fn transposed_times(a: &Rows, b: &Rows, out: &mut [f32]) {
    let ((k, m), (_, n)) = (*a.shape(), *b.shape());
    multiply(LeftMatrix { values: &values(a), strides: (1, m) }, &values(b), (m, k, n), out);
}

#[cfg(target_arch = "wasm32")]
fn times(a: &Rows, b: &Rows, out: &mut [f32]) {
    let ((m, k), (_, n)) = (*a.shape(), *b.shape());
    multiply(LeftMatrix { values: &values(a), strides: (k, 1) }, &values(b), (m, k, n), out);
}

/// A fully connected layer. `weight` is outputs x inputs, as in PyTorch; `bias` has one value per output.
#[derive(Debug, Clone)]
pub(crate) struct Dense {
    pub(crate) weight: Rows,
    pub(crate) bias: Units,
}

impl Dense {
    /// The layer's output x W^T + b, followed by a ReLU if `relu` is set. `input_gradient`: whether the backward pass
    /// computes the gradient of x; observations need none. Neither x nor the layer may be used elsewhere on the tape: the
    /// gradients of x and of the weights are assigned, not accumulated.
    pub(crate) fn forward<T: Tape<f32, Cpu>>(&self, x: Rows<T>, relu: bool, input_gradient: bool) -> Rows<T> {
        let (x, mut tape) = x.split_tape();
        let (n, outputs) = (x.shape().0, self.weight.shape().0);

        let mut y = times_transposed(&x, &self.weight);
        let mut activations = values(&y);
        let bias = values(&self.bias);
        for row in activations.chunks_exact_mut(outputs) {
            for (z, b) in row.iter_mut().zip(&bias) {
                *z += b;
                if relu {
                    *z = z.max(0.0);
                }
            }
        }
        y.copy_from(&activations);
        let (Self { weight, bias }, output) = (self.clone(), y.clone());
        tape.add_backward_op(move |grads| {
            let mut gradient = std::mem::take(&mut **grads.get_or_alloc_mut(&output)?);
            if relu {
                for (g, &a) in gradient.iter_mut().zip(&activations) {
                    *g = if a > 0.0 { *g } else { 0.0 };
                }
            }
            let bias_gradient = grads.get_or_alloc_mut(&bias)?;
            for row in gradient.chunks_exact(outputs) {
                add(bias_gradient, row);
            }
            let gradient = x.device().try_tensor_from_vec(gradient, (n, outputs))?;
            transposed_times(&gradient, &x, grads.get_or_alloc_mut(&weight)?);
            if input_gradient {
                times(&gradient, &weight, grads.get_or_alloc_mut(&x)?);
            }
            Ok(())
        });
        y.put_tape(tape)
    }
}

/// Q = V + A - mean A for rows of (V, A_1, ..., A_k): equation (9) of Wang et al. 2016.
pub(crate) fn dueling<T: Tape<f32, Cpu>>(head: Rows<T>) -> Rows<T> {
    let (head, mut tape) = head.split_tape();
    let (n, width) = *head.shape();
    let actions = width - 1;

    let mut q = vec![0.0; n * actions];
    for (q, head) in q.chunks_exact_mut(actions).zip(values(&head).chunks_exact(width)) {
        let base = head[0] - mean(&head[1..]);
        for (q, advantage) in q.iter_mut().zip(&head[1..]) {
            *q = base + advantage;
        }
    }
    let out = rows(head.device(), q, n, actions);

    let y = out.clone();
    tape.add_backward_op(move |grads| {
        let q_gradient = std::mem::take(&mut **grads.get_or_alloc_mut(&y)?);
        let head_gradient = grads.get_or_alloc_mut(&head)?;
        for (q_gradient, head_gradient) in
            q_gradient.chunks_exact(actions).zip(head_gradient.chunks_exact_mut(width))
        {
            let mean = mean(q_gradient);
            head_gradient[0] += mean * actions as f32;
            for (advantage_gradient, q) in head_gradient[1..].iter_mut().zip(q_gradient) {
                *advantage_gradient += q - mean;
            }
        }
        Ok(())
    });
    out.put_tape(tape)
}

/// The regression of Q(s, a) on TD targets for a batch of n transitions.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Regression<'a> {
    /// The n indices of the actions taken.
    pub actions: &'a [u8],
    /// The n TD targets y; with N quantiles, N for each transition.
    pub targets: &'a [f32],
    /// The n importance weights.
    pub weights: &'a [f32],
    /// The loss as a function of the TD error.
    pub loss: Loss,
}

/// The mean of weight x loss(Q(s, a) - y) over the batch. `q` is n x actions. Writes the n TD errors Q(s, a) - y into
/// `errors` and the n values Q(s, a) into `chosen`.
pub(crate) fn td_loss<T: Tape<f32, Cpu>>(
    q: Rows<T>,
    regression: Regression<'_>,
    errors: &mut Vec<f32>,
    chosen: &mut Vec<f32>,
) -> Tensor<Rank0, f32, Cpu, T> {
    let (q, tape) = q.split_tape();
    let (n, actions) = *q.shape();
    let all = values(&q);
    errors.clear();
    chosen.clear();
    let mut q_gradient = vec![0.0; n * actions];
    let mut total = 0.0;
    for i in 0..n {
        let at = i * actions + usize::from(regression.actions[i]);
        let error = all[at] - regression.targets[i];
        let (loss, slope) = loss_and_slope(regression.loss, error);
        total += regression.weights[i] * loss;
        q_gradient[at] = regression.weights[i] * slope / n as f32;
        errors.push(error);
        chosen.push(all[at]);
    }
    scalar(total / n as f32, q, q_gradient, tape)
}

/// The loss of a TD error, and its derivative.
fn loss_and_slope(loss: Loss, error: f32) -> (f32, f32) {
    match loss {
        Loss::MeanSquared => (error * error, 2.0 * error),
        Loss::Huber { delta } if error.abs() > delta => {
            (delta * (error.abs() - 0.5 * delta), delta.copysign(error))
        }
        Loss::Huber { .. } => (0.5 * error * error, error),
    }
}

/// The scalar `value`, a function of `x` with this `gradient`, on the tape of `x`.
fn scalar<T: Tape<f32, Cpu>>(
    value: f32,
    x: Rows,
    gradient: Vec<f32>,
    mut tape: T,
) -> Tensor<Rank0, f32, Cpu, T> {
    let scalar = x.device().tensor(value);
    tape.add_backward_op(move |grads| {
        add(grads.get_or_alloc_mut(&x)?, &gradient);
        Ok(())
    });
    scalar.put_tape(tape)
}

fn add(to: &mut [f32], from: &[f32]) {
    for (to, from) in to.iter_mut().zip(from) {
        *to += from;
    }
}

fn mean(values: &[f32]) -> f32 {
    values.iter().sum::<f32>() / values.len() as f32
}
