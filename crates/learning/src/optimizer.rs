//! RMSProp and Adam over flat slices, with decoupled weight decay, and gradient clipping.
//!
//! In: parameters, their gradient, a learning rate. Out: updated parameters and moments. The formulas are those of PyTorch
//! (`torch.optim.RMSprop`, `torch.optim.AdamW`, `torch.nn.utils.clip_grad_norm_`); RMSProp's weight decay is AdamW's.

use serde::{Deserialize, Serialize};

use super::config::Optimizer;

/// The smallest moment that is not set to 0. The moments of dead ReLUs would otherwise decay into denormal numbers, which
/// cost a hundred cycles each. 1e-30 is too small to affect the step, because of `epsilon`.
const MIN_MOMENT: f32 = 1e-30;

/// The state of an optimizer.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub(crate) struct OptimizerState {
    /// The mean gradient per parameter for Adam; empty for RMSProp.
    pub first: Vec<f32>,
    /// The mean square gradient per parameter.
    pub second: Vec<f32>,
    /// The number of steps taken.
    pub steps: u64,
}

impl OptimizerState {
    /// Zero moments for `parameters` parameters.
    pub fn new(optimizer: &Optimizer, parameters: usize) -> Self {
        let first = match optimizer {
            Optimizer::RmsProp { .. } => 0,
            Optimizer::Adam { .. } => parameters,
        };
        Self { first: vec![0.0; first], second: vec![0.0; parameters], steps: 0 }
    }

    /// Shrinks `parameters` by the weight decay, then moves them by one step against `gradient`, which has the same length.
    pub fn step(
        &mut self,
        optimizer: &Optimizer,
        (learning_rate, weight_decay): (f32, f32),
        parameters: &mut [f32],
        gradient: &[f32],
    ) {
        self.steps += 1;
        if weight_decay > 0.0 {
            let factor = 1.0 - learning_rate * weight_decay;
            parameters.iter_mut().for_each(|p| *p *= factor);
        }
        match *optimizer {
            Optimizer::RmsProp { smoothing, epsilon } => {
                for ((p, &g), v) in parameters.iter_mut().zip(gradient).zip(&mut self.second) {
                    *v = flush(smoothing * *v + (1.0 - smoothing) * g * g);
                    *p -= learning_rate * g / (v.sqrt() + epsilon);
                }
            }
            Optimizer::Adam { beta1, beta2, epsilon } => {
                // Corrects the bias of moments that start at 0. In f64, because of 0.999^t with t up to 10^7.
                let correction = |beta: f32| 1.0 - libm::pow(f64::from(beta), self.steps as f64);
                let step_size = (f64::from(learning_rate) / correction(beta1)) as f32;
                let root = (1.0 / correction(beta2).sqrt()) as f32;
                let moments = self.first.iter_mut().zip(&mut self.second);
                for ((p, &g), (m, v)) in parameters.iter_mut().zip(gradient).zip(moments) {
                    *m = flush(beta1 * *m + (1.0 - beta1) * g);
                    *v = flush(beta2 * *v + (1.0 - beta2) * g * g);
                    *p -= step_size * *m / (v.sqrt() * root + epsilon);
                }
            }
        }
    }
}

/// Scales `gradient` down to the norm `max_norm` if its own is larger. A gradient that is not finite stays as it is.
pub(crate) fn clip(gradient: &mut [f32], max_norm: f32) {
    let norm = gradient.iter().map(|&g| f64::from(g) * f64::from(g)).sum::<f64>().sqrt();
    let factor = (f64::from(max_norm) / (norm + 1e-6)) as f32;
    if norm.is_finite() && factor < 1.0 {
        gradient.iter_mut().for_each(|g| *g *= factor);
    }
}

/// `moment`, or 0 if it is smaller than [`MIN_MOMENT`].
fn flush(moment: f32) -> f32 {
    if moment.abs() < MIN_MOMENT { 0.0 } else { moment }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn close(found: f32, expected: f32, what: &str) {
        assert!(
            (found - expected).abs() < 1e-6 * expected.abs().max(1.0),
            "{what}: {found} instead of {expected}"
        );
    }

    #[test]
    fn two_steps_of_rmsprop_match_a_calculation_by_hand() {
        // smoothing 0.9, epsilon 0.1, rate 0.5, gradient 2 then -1, from p = 1.
        // v1 = 0.1 x 4 = 0.4               p1 = 1 - 0.5 x 2 / (sqrt 0.4 + 0.1) = 1 - 1 / 0.7324555 = -0.3652706
        // v2 = 0.9 x 0.4 + 0.1 x 1 = 0.46  p2 = p1 + 0.5 / (sqrt 0.46 + 0.1) = p1 + 0.5 / 0.7782330 = 0.2772105
        let rmsprop = Optimizer::RmsProp { smoothing: 0.9, epsilon: 0.1 };
        let (mut state, mut p) = (OptimizerState::new(&rmsprop, 1), [1.0]);
        state.step(&rmsprop, (0.5, 0.0), &mut p, &[2.0]);
        close(p[0], -0.365_270_6, "after one step");
        state.step(&rmsprop, (0.5, 0.0), &mut p, &[-1.0]);
        close(state.second[0], 0.46, "the mean square");
        close(p[0], 0.277_210_5, "after two steps");
    }

    #[test]
    fn two_steps_of_adam_match_a_calculation_by_hand() {
        // beta 0.9 and 0.99, epsilon 0.1, rate 0.5, gradient 2 then -1, from p = 1. m^ and v^ are bias-corrected.
        // m1 = 0.2,              m^ = 0.2 / 0.1 = 2
        // v1 = 0.04,             v^ = 0.04 / 0.01 = 4, root 2
        //                        p1 = 1 - 0.5 x 2 / 2.1 = 0.5238095
        // m2 = 0.18 - 0.1,       m^ = 0.08 / 0.19 = 0.4210526
        // v2 = 0.0396 + 0.01,    v^ = 0.0496 / 0.0199 = 2.4924623, root 1.5787534
        //                        p2 = p1 - 0.5 x 0.4210526 / 1.6787534 = 0.3984032
        let adam = Optimizer::Adam { beta1: 0.9, beta2: 0.99, epsilon: 0.1 };
        let (mut state, mut p) = (OptimizerState::new(&adam, 1), [1.0]);
        state.step(&adam, (0.5, 0.0), &mut p, &[2.0]);
        close(p[0], 0.523_809_5, "after one step");
        state.step(&adam, (0.5, 0.0), &mut p, &[-1.0]);
        close(state.first[0], 0.08, "the mean");
        close(state.second[0], 0.0496, "the mean square");
        close(p[0], 0.398_403_2, "after two steps");
    }

    #[test]
    fn weight_decay_shrinks_the_weights_before_the_step_whatever_the_gradient() {
        // The steps of the two tests above, from p = 1, with decay 0.1: each step first multiplies p by 1 - 0.5 x 0.1.
        // RMSProp: 0.95 - 1.3652706 = -0.4152706, then 0.95 x -0.4152706 + 0.6424811 = 0.2479740.
        // Adam:    0.95 - 0.4761905 = 0.4738095, then 0.95 x 0.4738095 - 0.1254063 = 0.3247127.
        let rmsprop = Optimizer::RmsProp { smoothing: 0.9, epsilon: 0.1 };
        let adam = Optimizer::Adam { beta1: 0.9, beta2: 0.99, epsilon: 0.1 };
        for (optimizer, expected) in [(rmsprop, 0.247_974), (adam, 0.324_712_7)] {
            let (mut state, mut p) = (OptimizerState::new(&optimizer, 1), [1.0]);
            state.step(&optimizer, (0.5, 0.1), &mut p, &[2.0]);
            state.step(&optimizer, (0.5, 0.1), &mut p, &[-1.0]);
            close(p[0], expected, "after two steps");
            let (mut state, mut p) = (OptimizerState::new(&optimizer, 1), [1.0]);
            state.step(&optimizer, (0.5, 0.1), &mut p, &[0.0]);
            close(p[0], 0.95, "a weight without gradient decays as well");
        }
    }

    #[test]
    fn a_gradient_is_scaled_down_to_the_maximum_norm_and_a_shorter_one_stays() {
        let mut gradient = [3.0, 0.0, -4.0];
        clip(&mut gradient, 5.1);
        assert_eq!(gradient, [3.0, 0.0, -4.0], "its norm is 5");
        clip(&mut gradient, 1.0);
        close(gradient[0], 0.6, "a fifth");
        close(gradient[2], -0.8, "a fifth");
        let mut large = [3e30, -4e30];
        clip(&mut large, 1.0);
        close(large[1], -0.8, "squares that f32 cannot hold");
        let mut infinite = [f32::INFINITY, 1.0];
        clip(&mut infinite, 1.0);
        assert_eq!(infinite, [f32::INFINITY, 1.0], "a divergence is reported as it happened");
    }

    #[test]
    fn moments_of_a_dead_unit_become_zero_instead_of_denormal() {
        for optimizer in [
            Optimizer::RmsProp { smoothing: 0.5, epsilon: 1e-8 },
            Optimizer::Adam { beta1: 0.5, beta2: 0.5, epsilon: 1e-8 },
        ] {
            let (mut state, mut p) = (OptimizerState::new(&optimizer, 1), [1.0]);
            state.step(&optimizer, (0.1, 0.0), &mut p, &[1.0]);
            for _ in 0..200 {
                state.step(&optimizer, (0.1, 0.0), &mut p, &[0.0]);
                let moments = state.first.iter().chain(&state.second);
                assert!(moments.into_iter().all(|m| *m == 0.0 || m.is_normal()), "{state:?}");
            }
            assert_eq!(state.second[0], 0.0);
        }
    }
}
