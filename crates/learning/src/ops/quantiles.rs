//! Quantiles of returns: their loss and their mean (QR-DQN, Dabney et al. 2018).

use dfdx::prelude::*;

use super::{Regression, Rows, loss_and_slope, rows, scalar, values};

/// The quantile regression loss (Dabney et al. 2018, equations 9 and 10, times 2 so that a single quantile has the loss of
/// [`td_loss`](super::td_loss)): the mean over the batch of weight x sum over i of mean over j of
/// 2 |tau_i - (u < 0)| Huber(u), where u = y_j - Z_i and tau_i = (i + 1/2) / N. `quantiles` has the N quantiles Z_i of each
/// of the n transitions as rows (n N x actions), and the regression has N targets y_j per transition. For each transition,
/// writes mean(Z) - mean(y) into `errors` and mean(Z) into `chosen`.
pub(crate) fn quantile_loss<T: Tape<f32, Cpu>>(
    quantiles: Rows<T>,
    count: usize,
    regression: Regression<'_>,
    errors: &mut Vec<f32>,
    chosen: &mut Vec<f32>,
) -> Tensor<Rank0, f32, Cpu, T> {
    let (quantiles, tape) = quantiles.split_tape();
    let (rows, actions) = *quantiles.shape();
    let (n, fraction) = (rows / count, 1.0 / count as f32);
    let all = values(&quantiles);
    errors.clear();
    chosen.clear();
    let mut gradient = vec![0.0; rows * actions];
    let mut total = 0.0;
    for (transition, targets) in regression.targets.chunks_exact(count).enumerate() {
        let weight = regression.weights[transition];
        let mut sum = 0.0;
        for i in 0..count {
            let at = (transition * count + i) * actions + usize::from(regression.actions[transition]);
            let (quantile, tau) = (all[at], (i as f32 + 0.5) * fraction);
            sum += quantile;
            let (mut total_loss, mut total_slope) = (0.0, 0.0);
            for y in targets {
                let u = y - quantile;
                let side = if u < 0.0 { 1.0 - tau } else { tau };
                let (loss, slope) = loss_and_slope(regression.loss, u);
                total_loss += side * loss;
                total_slope -= side * slope;
            }
            total += weight * total_loss * fraction * 2.0;
            gradient[at] = weight * total_slope * fraction * 2.0 / n as f32;
        }
        let mean_target = targets.iter().sum::<f32>() * fraction;
        chosen.push(sum * fraction);
        errors.push(sum * fraction - mean_target);
    }
    scalar(total / n as f32, quantiles, gradient, tape)
}

/// The mean over the `count` quantiles. A row of `heads` has the outputs of quantile 1, then those of quantile 2, and so on.
pub(crate) fn mean_of_quantiles(heads: Rows, count: usize) -> Rows {
    if count == 1 {
        return heads;
    }
    let (n, width) = *heads.shape();
    let outputs = width / count;
    let mut out = Vec::with_capacity(n * outputs);
    for row in values(&heads).chunks_exact(width) {
        let mean = |output: usize| row[output..].iter().step_by(outputs).sum::<f32>() / count as f32;
        out.extend((0..outputs).map(mean));
    }
    rows(heads.device(), out, n, outputs)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::config::Loss;

    /// Loss, gradient and error of two quantiles of the return of one action, for one transition.
    fn loss(quantiles: [f32; 2], targets: [f32; 2], weight: f32) -> (f32, Vec<f32>, f32) {
        let device = Cpu::default();
        let z = rows(&device, quantiles.to_vec(), 2, 1);
        let regression = Regression {
            actions: &[0],
            targets: &targets,
            weights: &[weight],
            loss: Loss::Huber { delta: 1.0 },
        };
        let (mut errors, mut chosen) = (Vec::new(), Vec::new());
        let loss = quantile_loss(z.clone().leaky_traced(), 2, regression, &mut errors, &mut chosen);
        assert_eq!(chosen, [(quantiles[0] + quantiles[1]) / 2.0]);
        let value = values(&loss)[0];
        let gradient = loss.backward().get(&z);
        (value, values(&gradient), errors[0])
    }

    #[test]
    fn the_quantile_loss_is_that_of_the_formula() {
        // tau = 1/4 and 3/4. Z_1 = 0: u = 0.5 and 3, Huber 0.125 and 2.5, both times 1/4. Z_2 = 1: u = -0.5 and 2, Huber 0.125 times
        // 1/4 (below the quantile) and 1.5 times 3/4. The sum of the means over j, times 2.
        let expected = 2.0 * ((0.25 * 0.125 + 0.25 * 2.5) / 2.0 + (0.25 * 0.125 + 0.75 * 1.5) / 2.0);
        let (found, gradient, error) = loss([0.0, 1.0], [0.5, 3.0], 1.0);
        assert!((found - expected).abs() < 1e-6, "{found} instead of {expected}");
        // The slope of Huber(u) is u, clipped to -1..1: -(0.25 x 0.5 + 0.25 x 1) and 0.25 x 0.5 - 0.75 x 1.
        for (found, expected) in gradient.iter().zip([-0.375, -0.625]) {
            assert!((found - expected).abs() < 1e-6, "{found} instead of {expected}");
        }
        assert_eq!(error, 0.5 - 1.75, "the difference of the means");
        let (half, _, _) = loss([0.0, 1.0], [0.5, 3.0], 0.5);
        assert!((half - expected / 2.0).abs() < 1e-6, "times the importance weight");
    }

    #[test]
    fn the_mean_of_quantiles_is_taken_output_by_output() {
        let device = Cpu::default();
        // Two rows of three quantiles of two outputs.
        let heads = rows(&device, vec![1.0, 10.0, 2.0, 20.0, 6.0, 60.0, 0.0, 1.0, 0.0, 1.0, 3.0, 1.0], 2, 6);
        assert_eq!(values(&mean_of_quantiles(heads, 3)), [3.0, 30.0, 1.0, 1.0]);
    }
}
