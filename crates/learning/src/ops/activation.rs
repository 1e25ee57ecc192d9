//! The activation function of a hidden layer as a separate operation. (A ReLU without layer normalization is part of
//! [`Dense`](super::Dense).)

use dfdx::prelude::*;
use wayfield_policy::activation::{Activation, sigmoid};

use super::{Rows, add, rows, values};

/// Applies the activation function to each element of `x`.
pub(crate) fn activate<T: Tape<f32, Cpu>>(activation: Activation, x: Rows<T>) -> Rows<T> {
    let (x, mut tape) = x.split_tape();
    let (n, width) = *x.shape();
    let before = values(&x);
    let mut after = before.clone();
    activation.apply(&mut after);
    let out = rows(x.device(), after.clone(), n, width);

    let y = out.clone();
    tape.add_backward_op(move |grads| {
        let mut gradient = std::mem::take(&mut **grads.get_or_alloc_mut(&y)?);
        let (g, x_y) = (&mut gradient, before.iter().zip(&after));
        match activation {
            Activation::Relu => scale(g, x_y, |x, _| if x > 0.0 { 1.0 } else { 0.0 }),
            Activation::Elu => scale(g, x_y, |x, y| if x > 0.0 { 1.0 } else { y + 1.0 }),
            // With s = 1 / (1 + exp(-x)) and y = x s: y' = s + x s (1 - s).
            Activation::Silu => scale(g, x_y, |x, y| {
                let s = sigmoid(x);
                s + y * (1.0 - s)
            }),
            Activation::Tanh => scale(g, x_y, |_, y| 1.0 - y * y),
        }
        add(grads.get_or_alloc_mut(&x)?, &gradient);
        Ok(())
    });
    out.put_tape(tape)
}

/// Multiplies `gradient` by the derivatives, which `slope` computes from the values before and after the activation.
fn scale<'a>(
    gradient: &mut [f32],
    x_y: impl Iterator<Item = (&'a f32, &'a f32)>,
    slope: impl Fn(f32, f32) -> f32,
) {
    for (g, (&x, &y)) in gradient.iter_mut().zip(x_y) {
        *g *= slope(x, y);
    }
}
