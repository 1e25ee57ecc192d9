//! RMSProp and Adam over flat slices, with moments that can be seen and saved.
//!
//! In: parameters, their gradient, a learning rate. Out: the parameters, moved; the moments, updated. The formulas
//! are PyTorch's (`torch.optim.RMSprop`, `torch.optim.Adam`, no weight decay).

use serde::{Deserialize, Serialize};

use super::config::Optimizer;

/// Moments below this are set to 0. Gradients of dead ReLUs let moments decay into denormal numbers, which cost a
/// hundred cycles each; 1e-30 is far below what `epsilon` lets the step feel.
const TINY: f32 = 1e-30;

/// The state of an optimizer for a network of so many parameters.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct OptimizerState {
    /// Mean gradient per parameter (Adam), empty for RMSProp.
    pub first: Vec<f32>,
    /// Mean square gradient per parameter.
    pub second: Vec<f32>,
    /// Steps taken.
    pub steps: u64,
}

impl OptimizerState {
    /// Zero moments for `parameters` parameters.
    #[must_use]
    pub fn new(optimizer: &Optimizer, parameters: usize) -> Self {
        let first = match optimizer {
            Optimizer::RmsProp { .. } => 0,
            Optimizer::Adam { .. } => parameters,
        };
        Self { first: vec![0.0; first], second: vec![0.0; parameters], steps: 0 }
    }

    /// One step down `gradient` (as long as `parameters`).
    pub fn step(
        &mut self,
        optimizer: &Optimizer,
        learning_rate: f32,
        parameters: &mut [f32],
        gradient: &[f32],
    ) {
        self.steps += 1;
        match *optimizer {
            Optimizer::RmsProp { smoothing, epsilon } => {
                for ((p, &g), v) in parameters.iter_mut().zip(gradient).zip(&mut self.second) {
                    *v = flushed(smoothing * *v + (1.0 - smoothing) * g * g);
                    *p -= learning_rate * g / (v.sqrt() + epsilon);
                }
            }
            Optimizer::Adam { beta1, beta2, epsilon } => {
                // The moments start at 0; dividing by these undoes that bias. In f64: 0.999^t for t up to 10^7.
                let correction = |beta: f32| 1.0 - libm::pow(f64::from(beta), self.steps as f64);
                let step_size = (f64::from(learning_rate) / correction(beta1)) as f32;
                let root = (1.0 / correction(beta2).sqrt()) as f32;
                let moments = self.first.iter_mut().zip(&mut self.second);
                for ((p, &g), (m, v)) in parameters.iter_mut().zip(gradient).zip(moments) {
                    *m = flushed(beta1 * *m + (1.0 - beta1) * g);
                    *v = flushed(beta2 * *v + (1.0 - beta2) * g * g);
                    *p -= step_size * *m / (v.sqrt() * root + epsilon);
                }
            }
        }
    }
}

fn flushed(moment: f32) -> f32 {
    if moment.abs() < TINY { 0.0 } else { moment }
}
