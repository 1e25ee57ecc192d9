//! Layer normalization (Ba et al. 2016) with its backward pass.

use dfdx::prelude::*;
use wayfield_policy::network::LAYER_NORM_EPSILON;

use super::{Rows, add, mean, rows, values};

/// One value per unit of a layer.
pub(crate) type Units = Tensor<(usize,), f32, Cpu>;

/// The normalization of each row, y = (x - mean) / sqrt(variance + epsilon) * scale + shift, as in PyTorch's `LayerNorm`.
#[derive(Debug, Clone)]
pub(crate) struct LayerNorm {
    pub(crate) scale: Units,
    pub(crate) shift: Units,
}

impl LayerNorm {
    /// The normalized rows of `x`.
    pub(crate) fn forward<T: Tape<f32, Cpu>>(&self, x: Rows<T>) -> Rows<T> {
        let (x, mut tape) = x.split_tape();
        let (n, width) = *x.shape();
        let (scale, shift) = (values(&self.scale), values(&self.shift));
        let mut standardized = values(&x);
        let factors: Vec<f32> = standardized.chunks_exact_mut(width).map(standardize).collect();
        let mut y = standardized.clone();
        for row in y.chunks_exact_mut(width) {
            for ((y, scale), shift) in row.iter_mut().zip(&scale).zip(&shift) {
                *y = *y * scale + shift;
            }
        }
        let out = rows(x.device(), y, n, width);

        let (Self { scale: scale_tensor, shift: shift_tensor }, y) = (self.clone(), out.clone());
        tape.add_backward_op(move |grads| {
            let mut gradient = std::mem::take(&mut **grads.get_or_alloc_mut(&y)?);
            let shift_gradient = grads.get_or_alloc_mut(&shift_tensor)?;
            gradient.chunks_exact(width).for_each(|row| add(shift_gradient, row));
            let scale_gradient = grads.get_or_alloc_mut(&scale_tensor)?;
            let per_row = gradient.chunks_exact_mut(width).zip(standardized.chunks_exact(width));
            for ((g, x), factor) in per_row.zip(&factors) {
                for ((sum, g), x) in scale_gradient.iter_mut().zip(&*g).zip(x) {
                    *sum += g * x;
                }
                input_gradient(g, x, &scale, *factor);
            }
            add(grads.get_or_alloc_mut(&x)?, &gradient);
            Ok(())
        });
        out.put_tape(tape)
    }
}

/// Shifts and scales `row` to mean 0 and variance 1, up to epsilon. Returns the factor 1 / sqrt(variance + epsilon).
fn standardize(row: &mut [f32]) -> f32 {
    let center = mean(row);
    row.iter_mut().for_each(|x| *x -= center);
    let variance = row.iter().map(|x| x * x).sum::<f32>() / row.len() as f32;
    let factor = 1.0 / (variance + LAYER_NORM_EPSILON).sqrt();
    row.iter_mut().for_each(|x| *x *= factor);
    factor
}

/// Replaces `g`, the gradient with respect to a row of outputs, by the gradient with respect to the inputs:
/// factor * (h - mean(h) - x * mean(h x)), with h = g * scale and the standardized inputs x.
fn input_gradient(g: &mut [f32], x: &[f32], scale: &[f32], factor: f32) {
    g.iter_mut().zip(scale).for_each(|(g, scale)| *g *= scale);
    let center = mean(g);
    let slope = g.iter().zip(x).map(|(h, x)| h * x).sum::<f32>() / g.len() as f32;
    g.iter_mut().zip(x).for_each(|(h, x)| *h = factor * (*h - center - x * slope));
}
