//! Gradient check: every derivative is compared with a central finite difference of the loss.

use super::{Gradient, QNetwork, Regression};
use crate::config::{Loss, NetworkConfig};
use wayfield_policy::Activation;
use wayfield_random::{normal, stream};

const BATCH: usize = 12;

#[test]
fn the_gradient_is_the_derivative_of_the_weighted_loss() {
    for dueling in [false, true] {
        // The TD errors are of order 1, so that delta 0.8 tests both branches of the Huber loss.
        for loss in [Loss::MeanSquared, Loss::Huber { delta: 0.8 }] {
            check(&config(dueling, false, Activation::Relu), loss);
        }
    }
}

#[test]
fn the_gradient_is_right_with_every_activation_and_with_layer_normalization() {
    for activation in Activation::ALL {
        for layer_norm in [false, true] {
            check(&config(layer_norm, layer_norm, activation), Loss::MeanSquared);
        }
    }
}

#[test]
fn the_gradient_of_quantiles_is_the_derivative_of_their_loss() {
    const QUANTILES: usize = 4;
    for dueling in [false, true] {
        let mut noise = stream(12, "test", u64::from(dueling));
        let shape = config(dueling, false, Activation::Tanh).shape(5, 3).expect("a valid shape");
        let mut network = QNetwork::with_quantiles(shape, QUANTILES, &mut noise).expect("a valid shape");
        let observations: Vec<f32> = (0..BATCH * 5).map(|_| normal(&mut noise)).collect();
        let targets: Vec<f32> = (0..BATCH * QUANTILES).map(|_| normal(&mut noise)).collect();
        let weights: Vec<f32> = (0..BATCH).map(|i| 0.1 + 0.07 * i as f32).collect();
        let actions: Vec<u8> = (0..BATCH).map(|i| (i % 3) as u8).collect();
        let loss = Loss::Huber { delta: 0.8 };
        let regression = Regression { actions: &actions, targets: &targets, weights: &weights, loss };
        let (mut gradient, mut other) = (Gradient::default(), Gradient::default());
        network.gradient(&observations, regression, &mut gradient);
        let (mut q, mut nonzero) = (Vec::new(), 0);
        network.q_values(&observations, BATCH, &mut q);
        for (i, found) in gradient.q.iter().enumerate() {
            assert!((found - q[i * 3 + i % 3]).abs() < 1e-5, "the Q-value is the mean of the quantiles");
        }
        let mut moved = |network: &mut QNetwork, i: usize, by: f32| {
            network.update(|parameters| parameters[i] += by);
            network.gradient(&observations, regression, &mut other);
            other.loss
        };
        for (i, found) in gradient.values.iter().enumerate() {
            let (above, below) = (moved(&mut network, i, 2e-3), moved(&mut network, i, -4e-3));
            network.update(|parameters| parameters[i] += 2e-3);
            let slope = (above - below) / 4e-3;
            nonzero += usize::from(found.abs() > 1e-3);
            assert!((slope - found).abs() < 2e-3 + 0.01 * slope.abs(), "parameter {i}: {found}, not {slope}");
        }
        assert!(nonzero > gradient.values.len() / 2, "most derivatives are not 0: {nonzero}");
    }
}

fn config(dueling: bool, layer_norm: bool, activation: Activation) -> NetworkConfig {
    NetworkConfig { hidden: vec![7, 6], dueling, layer_norm, activation }
}

fn check(config: &NetworkConfig, loss: Loss) {
    let dueling = config.dueling;
    let mut noise = stream(11, "test", u64::from(dueling));
    let shape = config.shape(5, 3).expect("a valid shape");
    let mut network = QNetwork::new(shape.clone(), &mut noise).expect("a valid shape");
    let observations: Vec<f32> = (0..BATCH * 5).map(|_| normal(&mut noise)).collect();
    let targets: Vec<f32> = (0..BATCH).map(|_| normal(&mut noise)).collect();
    let weights: Vec<f32> = (0..BATCH).map(|i| 0.1 + 0.07 * i as f32).collect();
    let actions: Vec<u8> = (0..BATCH).map(|i| (i % 3) as u8).collect();
    let regression = Regression { actions: &actions, targets: &targets, weights: &weights, loss };

    let mut gradient = Gradient::default();
    network.gradient(&observations, regression, &mut gradient);
    assert_eq!(gradient.values.len(), shape.parameter_count());

    // Compare the loss and the TD errors with their definitions.
    let mut q = Vec::new();
    network.q_values(&observations, BATCH, &mut q);
    let mut expected = 0.0;
    let (mut small, mut large) = (0, 0);
    for i in 0..BATCH {
        let chosen = q[i * 3 + i % 3];
        let d = chosen - targets[i];
        assert!((gradient.td_errors[i] - d).abs() < 1e-5, "TD error {i} is Q(s, a) - y");
        assert!((gradient.q[i] - chosen).abs() < 1e-5, "Q(s, a) of transition {i}");
        expected += weights[i]
            * match loss {
                Loss::MeanSquared => d * d,
                Loss::Huber { delta } if d.abs() <= delta => d * d / 2.0,
                Loss::Huber { delta } => delta * (d.abs() - delta / 2.0),
            };
        *if d.abs() <= 0.8 { &mut small } else { &mut large } += 1;
    }
    assert!(small > 1 && large > 1, "both branches of the Huber loss are tested: {small}, {large}");
    assert!((gradient.loss - expected / BATCH as f32).abs() < 1e-5, "the loss is the weighted mean");

    // Central differences. The step is small compared with the weights (about 0.4), and large compared with f32 rounding.
    // Layer normalization amplifies the step; 2e-3 would push a ReLU over its kink.
    let step = if config.layer_norm { 5e-4 } else { 2e-3 };
    let mut other = Gradient::default();
    let mut moved = |network: &mut QNetwork, i: usize, by: f32| {
        network.update(|parameters| parameters[i] += by);
        network.gradient(&observations, regression, &mut other);
        other.loss
    };
    let mut nonzero = 0;
    for (view, i) in shape.parameters().iter().flat_map(|view| view.range.clone().map(move |i| (view, i))) {
        let above = moved(&mut network, i, step);
        let below = moved(&mut network, i, -2.0 * step);
        network.update(|parameters| parameters[i] += step);
        let (slope, found) = ((above - below) / (2.0 * step), gradient.values[i]);
        nonzero += usize::from(found.abs() > 1e-3);
        assert!(
            (slope - found).abs() < 1e-3 + 0.01 * slope.abs(),
            "{} ({i}), {config:?}, {loss:?}: gradient {found} instead of {slope}",
            view.name
        );
    }
    assert!(nonzero > shape.parameter_count() / 2, "most derivatives are not 0: {nonzero}");
}
