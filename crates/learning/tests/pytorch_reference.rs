//! Comparison of complete gradient steps with PyTorch.
//!
//! `reference/learning_step.py` trains on nine env steps with float64 PyTorch and writes `learning_step.json`. Here the
//! learner gets the same steps, weights and options. All parts are tested together: n-step returns, termination and
//! truncation, reward scale, (double) TD targets, (dueling) network, MSE or Huber loss, RMSProp or Adam, both target updates.
//! `reference/switches.py` does the same for layer normalization, activations, gradient clipping and weight decay, in plain
//! Python that reproduces PyTorch's results.

use serde::Deserialize;
use serde_json::Value;
use wayfield_learning::{
    Activation, Experience, Exploration, Learner, LearningConfig, Loss, NetworkConfig, Optimizer, QNetwork,
    ReplayConfig, Sampling, Schedule, TargetUpdate,
};

const INPUTS: usize = 3;
const ACTIONS: usize = 2;

/// (state, action, reward, next state, terminated, truncated), as in the script.
const STEPS: [(usize, usize, f32, usize, bool, bool); 9] = [
    (0, 0, 1.0, 1, false, false),
    (1, 1, -2.0, 2, false, false),
    (2, 1, 0.5, 3, false, false),
    (3, 0, 3.0, 4, true, false),
    (5, 1, 1.5, 6, false, false),
    (6, 0, -1.0, 7, false, false),
    (7, 1, 2.0, 8, false, true),
    (9, 0, 0.25, 10, false, false),
    (10, 1, -0.75, 11, false, false),
];

fn observation(state: usize) -> [f32; INPUTS] {
    std::array::from_fn(|j| (((state * 7 + j * 5) % 11) as f32 - 5.0) / 5.0)
}

fn config(case: &Value) -> LearningConfig {
    LearningConfig {
        network: NetworkConfig {
            hidden: vec![4, 3],
            dueling: case["dueling"] == true,
            layer_norm: case["layer_norm"] == true,
            activation: case
                .get("activation")
                .map_or(Activation::Relu, |name| Activation::deserialize(name).expect("an activation")),
        },
        double: case["double"] == true,
        gamma: 0.9,
        n_step: 2,
        reward_scale: 0.5,
        loss: if case["loss"] == "mse" { Loss::MeanSquared } else { Loss::Huber { delta: 0.5 } },
        optimizer: if case["optimizer"] == "rmsprop" {
            Optimizer::RmsProp { smoothing: 0.9, epsilon: 1e-7 }
        } else {
            Optimizer::Adam { beta1: 0.9, beta2: 0.999, epsilon: 1e-8 }
        },
        learning_rate: Schedule::Constant(0.01),
        max_gradient_norm: case["max_gradient_norm"].as_f64().map(|norm| norm as f32),
        weight_decay: case["weight_decay"].as_f64().unwrap_or_default() as f32,
        batch_size: 8,
        replay: ReplayConfig {
            capacity: 8,
            learning_starts: 9,
            // With alpha 0 all priorities are 1. A stratified batch of 8 from 8 transitions then contains each once.
            sampling: Sampling::Prioritized {
                alpha: 0.0,
                beta: Schedule::Constant(1.0),
                importance_weights: true,
                epsilon: 0.01,
            },
        },
        train_freq: 1,
        gradient_steps: 3,
        target_update: if case["target_update"] == "hard" {
            TargetUpdate::Hard { every: 2 }
        } else {
            TargetUpdate::Soft { tau: 0.1 }
        },
        exploration: Exploration::PerEpisode { start: 1.0, decay: 0.99, end: 0.05 },
        mirror: false,
        advantage_learning: 0.0,
        quantiles: 1,
    }
}

fn close(found: f32, expected: &Value, what: &str) {
    let expected = expected.as_f64().expect("a number");
    let error = (f64::from(found) - expected).abs();
    assert!(error < 1e-5 * expected.abs().max(1.0), "{what}: {found} instead of PyTorch's {expected}");
}

#[test]
fn three_gradient_steps_match_pytorch() {
    check(include_str!("reference/learning_step.json"));
}

#[test]
fn three_gradient_steps_with_the_options_of_switches_py_match_pytorchs_formulas() {
    check(include_str!("reference/switches.json"));
}

fn check(reference: &str) {
    let reference: Value = serde_json::from_str(reference).expect("JSON");
    let cases = reference["cases"].as_array().expect("a list");
    assert_eq!(cases.len(), 4);
    for (number, case) in cases.iter().enumerate() {
        let mut learner = Learner::new(&config(case), INPUTS, ACTIONS, 1, 0).expect("a valid config");
        let shape = learner.network().shape().clone();
        let parameters = (0..shape.parameter_count()).map(|i| (((i * 37 + 11) % 101) as f32 - 50.0) / 60.0);
        let network =
            QNetwork::from_parameters(shape, parameters.collect()).expect("the right number of parameters");
        learner.load_weights(&network.to_policy(), None).expect("the same shape");

        for (state, action, reward, next, terminated, truncated) in STEPS {
            assert_eq!(learner.pending_updates(), 0, "no updates before the buffer can fill a batch");
            learner.store(&Experience {
                env_index: 0,
                observation: &observation(state),
                action,
                reward,
                next_observation: &observation(next),
                terminated,
                truncated,
            });
        }
        assert_eq!(learner.replay().len(), 8, "the last of nine steps waits for its second reward");
        let stats = learner.train().expect("no divergence").expect("pending updates");
        assert_eq!(stats.gradient_steps, 3);
        close(stats.loss, &case["mean_loss"], &format!("case {number}: loss"));
        close(stats.td_error, &case["mean_td_error"], &format!("case {number}: |TD error|"));
        close(stats.q, &case["mean_q"], &format!("case {number}: Q"));
        for (name, network) in [("online", learner.network()), ("target", learner.target_network())] {
            let expected = case[name].as_array().expect("a list");
            assert_eq!(expected.len(), network.parameters().len());
            for (i, (found, expected)) in network.parameters().iter().zip(expected).enumerate() {
                close(*found, expected, &format!("case {number}: {name} parameter {i}"));
            }
        }
    }
}
