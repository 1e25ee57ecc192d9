//! The config in a checkpoint, as bytes that a reader compares with those of its own config.

use std::io;

use serde::Serialize;
use wayfield_policy::Activation;

use crate::config::{LearningConfig, NetworkConfig};
use crate::framing::encode;

/// The options that version 2 of the file adds. Version 3 adds mirror augmentation, version 4 advantage learning and version 5
/// quantiles. A config is written in the lowest version that has all the options it uses.
#[derive(Serialize, PartialEq)]
struct Switches {
    layer_norm: bool,
    activation: Activation,
    max_gradient_norm: Option<f32>,
    weight_decay: f32,
}

const OFF: Switches =
    Switches { layer_norm: false, activation: Activation::Relu, max_gradient_norm: None, weight_decay: 0.0 };

/// The version of the file of a learner with `config`, and the bytes of the config in it.
///
/// # Errors
/// None: every config can be serialized.
pub(super) fn encoded(config: &LearningConfig) -> io::Result<(u32, Vec<u8>)> {
    // Every field is named, so that a new one is not forgotten.
    let LearningConfig {
        network: NetworkConfig { hidden, dueling, layer_norm, activation },
        double,
        gamma,
        n_step,
        reward_scale,
        loss,
        optimizer,
        learning_rate,
        max_gradient_norm,
        weight_decay,
        batch_size,
        replay,
        train_freq,
        gradient_steps,
        target_update,
        exploration,
        mirror,
        advantage_learning,
        quantiles,
    } = config;
    let update = (double, gamma, n_step, reward_scale, loss, optimizer, learning_rate, batch_size);
    let version_1 = (hidden, dueling, update, replay, train_freq, gradient_steps, target_update, exploration);
    let switches = Switches {
        layer_norm: *layer_norm,
        activation: *activation,
        max_gradient_norm: *max_gradient_norm,
        weight_decay: *weight_decay,
    };
    if *quantiles != 1 {
        Ok((5, encode(&(version_1, switches, mirror, advantage_learning, quantiles))?))
    } else if *advantage_learning != 0.0 {
        Ok((4, encode(&(version_1, switches, mirror, advantage_learning))?))
    } else if *mirror {
        Ok((3, encode(&(version_1, switches, mirror))?))
    } else if switches != OFF {
        Ok((2, encode(&(version_1, switches))?))
    } else {
        Ok((1, encode(&version_1)?))
    }
}
