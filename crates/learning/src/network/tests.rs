//! Forward pass, initial weights, shapes.

use super::*;
use crate::config::NetworkConfig;
use wayfield_random::stream;

fn shape(hidden: &[usize], actions: usize, dueling: bool) -> NetworkShape {
    let config = NetworkConfig { hidden: hidden.to_vec(), dueling, ..NetworkConfig::default() };
    config.shape(2, actions).expect("a valid shape")
}

#[test]
fn a_dueling_head_is_value_plus_advantage_minus_the_mean_advantage() {
    // No hidden layer. V = x + 2y, A = (x, 2x, 6x) + (0, 0, 3). At (1, 10): V = 21, A = (1, 2, 9) with mean 4.
    let weights = [[1.0, 2.0], [1.0, 0.0], [2.0, 0.0], [6.0, 0.0]].concat();
    let parameters = [weights, vec![0.0, 0.0, 0.0, 3.0]].concat();
    let network =
        QNetwork::from_parameters(shape(&[], 3, true), parameters).expect("the right number of parameters");
    let mut out = Vec::new();
    network.q_values(&[1.0, 10.0], 1, &mut out);
    assert_eq!(out, [18.0, 19.0, 26.0], "Q = 21 + (1, 2, 9) - 4");
    network.value_and_advantage(&[1.0, 10.0], 1, &mut out);
    assert_eq!(out, [21.0, -3.0, -2.0, 5.0], "V, then A minus its mean");
}

#[test]
fn a_hidden_layer_applies_weights_bias_and_relu() {
    // h = relu((x - y, x + y - 1)), Q = h_1 + 10 h_2 + 0.5; at (2, 3): h = (0, 4), Q = 40.5.
    let parameters = vec![1.0, -1.0, 1.0, 1.0, 0.0, -1.0, 1.0, 10.0, 0.5];
    let network =
        QNetwork::from_parameters(shape(&[2], 1, false), parameters).expect("the right number of parameters");
    let mut out = Vec::new();
    network.q_values(&[2.0, 3.0, 0.0, 0.0], 2, &mut out);
    assert_eq!(out, [40.5, 0.5], "two observations, row by row");
}

#[test]
fn initial_weights_are_uniform_within_one_over_the_root_of_the_input_count() {
    let config = NetworkConfig { hidden: vec![64, 64], ..NetworkConfig::default() };
    let shape = config.shape(28, 5).expect("the paper's shape");
    let network = QNetwork::new(shape.clone(), &mut stream(1, "test", 0)).expect("a valid shape");
    for (name, inputs) in [("hidden.0.weight", 28.0_f32), ("hidden.1.weight", 64.0)] {
        let view = shape.parameters().into_iter().find(|view| view.name == name).expect("this parameter");
        let (weights, bound) = (&network.parameters()[view.range], 1.0 / inputs.sqrt());
        let largest = weights.iter().fold(0.0_f32, |largest, w| largest.max(w.abs()));
        assert!(largest <= bound && largest > 0.99 * bound, "{name}: {largest}, bound {bound}");
        let variance = weights.iter().map(|w| w * w).sum::<f32>() / weights.len() as f32;
        assert!(
            (variance * 3.0 * inputs - 1.0).abs() < 0.1,
            "{name}: the variance of a uniform distribution is bound^2 / 3"
        );
    }
    let normalized = NetworkConfig { layer_norm: true, ..config };
    let normalized =
        QNetwork::new(normalized.shape(28, 5).expect("a valid shape"), &mut stream(1, "test", 0))
            .expect("a valid shape");
    for view in normalized.shape().parameters() {
        let found = &normalized.parameters()[view.range];
        let plain = shape.parameters().into_iter().find(|plain| plain.name == view.name);
        match plain {
            Some(plain) => assert_eq!(found, &network.parameters()[plain.range], "the same draws"),
            None if view.name.ends_with("weight") => assert!(found.iter().all(|scale| *scale == 1.0)),
            None => assert!(found.iter().all(|shift| *shift == 0.0), "{}", view.name),
        }
    }
    let other = QNetwork::new(shape, &mut stream(2, "test", 0)).expect("a valid shape");
    assert_ne!(network, other, "another stream gives other weights");
}

#[test]
fn a_batch_in_chunks_gives_the_same_values_as_single_rows() {
    let network = QNetwork::new(shape(&[16, 16], 3, true), &mut stream(1, "test", 0)).expect("a valid shape");
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
    assert!(all.is_empty(), "no observations give no values");
}

#[test]
fn the_policy_of_a_network_with_quantiles_has_their_mean_as_q_values() {
    for dueling in [false, true] {
        let mut noise = stream(3, "test", 0);
        let mut network =
            QNetwork::with_quantiles(shape(&[16, 8], 3, dueling), 5, &mut noise).expect("a valid shape");
        let observations: Vec<f32> = (0..2 * 20).map(|_| uniform(&mut noise, -1.0, 1.0)).collect();
        let (mut q, mut quantiles, mut of_policy) = (Vec::new(), Vec::new(), Vec::new());
        network.q_values(&observations, 20, &mut q);
        network.quantile_values(&observations, 20, &mut quantiles);
        let policy = network.to_policy();
        QNetwork::from_policy(&policy).expect("a valid shape").q_values(&observations, 20, &mut of_policy);
        assert_eq!(quantiles.len(), 20 * 5 * 3);
        for (row, quantiles) in quantiles.chunks(5 * 3).enumerate() {
            for action in 0..3 {
                let mean = quantiles[action..].iter().step_by(3).sum::<f32>() / 5.0;
                for found in [q[row * 3 + action], of_policy[row * 3 + action]] {
                    assert!((found - mean).abs() < 1e-5, "{found}, but the mean is {mean}");
                }
            }
        }
        // A policy that is loaded gives every quantile its values.
        let other = QNetwork::new(shape(&[16, 8], 3, dueling), &mut noise).expect("a valid shape").to_policy();
        network.load(&other);
        QNetwork::from_policy(&other).expect("a valid shape").q_values(&observations, 20, &mut of_policy);
        network.quantile_values(&observations, 20, &mut quantiles);
        for (quantiles, q) in quantiles.chunks(5 * 3).zip(of_policy.chunks(3)) {
            assert!(quantiles.iter().zip(q.iter().cycle()).all(|(z, q)| (z - q).abs() < 1e-5));
        }
    }
}

#[test]
fn a_parameter_of_any_quantile_has_the_name_of_its_part_of_the_head() {
    let network = QNetwork::with_quantiles(shape(&[4], 2, true), 3, &mut stream(1, "test", 0));
    let network = network.expect("a valid shape");
    // 2 x 4 + 4 of the hidden layer, then 3 x (1 + 2) x 4 weights, then 3 x (1 + 2) biases.
    let names: Vec<_> = [0, 11, 12, 15, 16, 23, 24, 47, 48, 49, 51, 56].map(|at| network.parameter_name(at)).into();
    let hidden = ["hidden.0.weight", "hidden.0.bias"];
    let (value, advantage) = (["value.weight", "value.bias"], ["advantage.weight", "advantage.bias"]);
    assert_eq!(
        names,
        [
            hidden[0], hidden[1], value[0], value[0], advantage[0], advantage[0], value[0], advantage[0], value[1],
            advantage[1], value[1], advantage[1]
        ]
    );
}

#[test]
fn shapes_out_of_range_are_rejected() {
    for (hidden, inputs, actions) in
        [(vec![64], 0, 5), (vec![64], 28, 0), (vec![64], 28, 256), (vec![4096; 8], 28, 5)]
    {
        let config = NetworkConfig { hidden, ..NetworkConfig::default() };
        assert!(config.shape(inputs, actions).is_err(), "{config:?} {inputs} {actions}");
    }
    assert!(QNetwork::from_parameters(shape(&[3], 2, true), vec![0.0; 3]).is_err(), "too few parameters");
    let wide = shape(&[4096, 2000], 250, true);
    let error = QNetwork::with_quantiles(wide, 100, &mut stream(1, "test", 0)).expect_err("too many parameters");
    assert_eq!(error.field, "quantiles", "{error}");
}
