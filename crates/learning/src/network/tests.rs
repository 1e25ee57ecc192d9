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
fn shapes_out_of_range_are_rejected() {
    for (hidden, inputs, actions) in
        [(vec![64], 0, 5), (vec![64], 28, 0), (vec![64], 28, 256), (vec![4096; 8], 28, 5)]
    {
        let config = NetworkConfig { hidden, ..NetworkConfig::default() };
        assert!(config.shape(inputs, actions).is_err(), "{config:?} {inputs} {actions}");
    }
    assert!(QNetwork::from_parameters(shape(&[3], 2, true), vec![0.0; 3]).is_err(), "too few parameters");
}
