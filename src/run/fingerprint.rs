//! The fingerprint: a few numbers that two builds agree in if they simulate alike to the bit.
//!
//! In: scenario, preset, seed, how many control steps. Out: a checksum of the weights that a training begins with, and
//! one of all that happens to its robots while they act at random. What is learnt is not in it: that also depends on
//! the order in which a product of matrices is summed up (docs/determinism.md).

use std::fmt;
use std::sync::Arc;

use super::folder::RunConfig;
use super::{RunError, training_setup};
use crate::learning::Exploration;
use crate::sim;
use crate::simulation::Extensions;

/// Checksums (CRC-32C) of a training's beginning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fingerprint {
    /// Of the weights that it begins with.
    pub weights: u32,
    /// Of every arena's state after each control step: poses, goals, ranges, rewards, the random streams.
    pub world: u32,
}

impl fmt::Display for Fingerprint {
    /// Weights and world as 16 hexadecimal digits.
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(to, "{:08x}{:08x}", self.weights, self.world)
    }
}

/// The fingerprint of a training's first `control_steps` steps, in which it explores by chance alone and learns nothing.
///
/// # Errors
/// The scenario or the preset cannot be used; a step goes wrong.
pub fn fingerprint(
    scenario: &str,
    preset: &str,
    seed: u64,
    control_steps: u32,
) -> Result<Fingerprint, RunError> {
    let mut config = RunConfig::resolve(scenario, preset, seed)?;
    config.preset.learning.exploration = Exploration::Linear { start: 1.0, end: 1.0, env_steps: 1 };
    config.preset.learning.replay.learning_starts = u64::MAX;
    let learner = training_setup::create_learner(&config, None)?;
    let policy = learner.policy();
    let weights: Vec<u8> = policy.parameters().iter().flat_map(|weight| weight.to_le_bytes()).collect();
    let scenario = Arc::new(config.scenario);
    let mut simulation =
        training_setup::training(&scenario, &config.preset, seed, learner, &Extensions::default());
    let mut checksum = 0;
    for _ in 0..control_steps {
        simulation.step()?;
        let bytes = postcard::to_stdvec(&sim::snapshot(simulation.world_mut()))
            .map_err(|error| RunError::Failed(error.to_string()))?;
        checksum = crc32c::crc32c_append(checksum, &bytes);
    }
    Ok(Fingerprint { weights: crc32c::crc32c(&weights), world: checksum })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What is expected on every machine, and in a browser (`web/tests`), too.
    const EXPECTED: &str = include_str!("../../tests/fixtures/fingerprints.json");

    #[derive(serde::Deserialize)]
    struct Expected {
        scenario: String,
        preset: String,
        seed: u64,
        control_steps: u32,
        fingerprint: String,
    }

    #[test]
    fn the_world_and_the_first_weights_are_the_same_everywhere() {
        let expected: Vec<Expected> = serde_json::from_str(EXPECTED).expect("a list");
        assert!(expected.len() >= 3);
        let (mut said, mut found) = (Vec::new(), Vec::new());
        for Expected { scenario, preset, seed, control_steps, fingerprint: expected } in expected {
            let file = format!("{}/tests/fixtures/{scenario}", env!("CARGO_MANIFEST_DIR"));
            let asked = if scenario.ends_with(".ron") { file } else { scenario.clone() };
            let print = fingerprint(&asked, &preset, seed, control_steps).expect("shipped").to_string();
            said.push(format!("{scenario} {preset} {seed}: {expected}"));
            found.push(format!("{scenario} {preset} {seed}: {print}"));
        }
        assert_eq!(found, said);
    }

    #[test]
    fn a_fingerprint_tells_seeds_and_steps_apart() {
        let of = |seed, steps| fingerprint("scenario-1", "fast", seed, steps).expect("shipped");
        let one = of(1, 20);
        assert_eq!(one, of(1, 20));
        assert_ne!(one.world, of(1, 21).world);
        assert_eq!(one.weights, of(1, 21).weights);
        assert_ne!(one.weights, of(2, 20).weights);
        assert_ne!(one.world, of(2, 20).world);
    }
}
