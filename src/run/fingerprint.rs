//! Fingerprints: checksums that show whether two builds simulate bit-identically.
//!
//! In: scenario, preset, seed, number of control steps. Out: a checksum of the initial weights, and one of
//! the arenas' states while the robots act at random. Learning is not included, because it also depends on
//! the order in which matrix products are summed (docs/determinism.md).

use std::fmt;
use std::sync::Arc;

use super::folder::RunConfig;
use super::{RunError, training_setup};
use crate::learning::Exploration;
use crate::sim;
use crate::simulation::Extensions;

/// CRC-32C checksums of the start of a training run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fingerprint {
    /// Checksum of the initial weights.
    pub weights: u32,
    /// Checksum of every arena's state after each control step: poses, goals, ranges, rewards, random
    /// streams. The parts that checkpoints store separately, such as estimated poses, are not included.
    pub arena_states: u32,
}

impl fmt::Display for Fingerprint {
    /// The checksums of the weights and of the arenas' states, as 16 hexadecimal digits.
    fn fmt(&self, to: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(to, "{:08x}{:08x}", self.weights, self.arena_states)
    }
}

/// The fingerprint of the first `control_steps` steps of a training run that only explores and never learns.
///
/// # Errors
/// The scenario or the preset is invalid, or a step fails.
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
    Ok(Fingerprint { weights: crc32c::crc32c(&weights), arena_states: checksum })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The expected fingerprints, on every machine and in the browser (`web/tests`).
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
    fn simulation_and_initial_weights_match_the_recorded_fingerprints() {
        let expected: Vec<Expected> = serde_json::from_str(EXPECTED).expect("a list");
        assert!(expected.len() >= 3);
        let (mut recorded, mut found) = (Vec::new(), Vec::new());
        for Expected { scenario, preset, seed, control_steps, fingerprint: expected } in expected {
            let file = format!("{}/tests/fixtures/{scenario}", env!("CARGO_MANIFEST_DIR"));
            let path_or_name = if scenario.ends_with(".ron") { file } else { scenario.clone() };
            let actual =
                fingerprint(&path_or_name, &preset, seed, control_steps).expect("shipped").to_string();
            recorded.push(format!("{scenario} {preset} {seed}: {expected}"));
            found.push(format!("{scenario} {preset} {seed}: {actual}"));
        }
        assert_eq!(found, recorded);
    }

    #[test]
    fn fingerprints_of_different_seeds_or_steps_differ() {
        let of = |seed, steps| fingerprint("scenario-1", "fast", seed, steps).expect("shipped");
        let one = of(1, 20);
        assert_eq!(one, of(1, 20));
        assert_ne!(one.arena_states, of(1, 21).arena_states);
        assert_eq!(one.weights, of(1, 21).weights);
        assert_ne!(one.weights, of(2, 20).weights);
        assert_ne!(one.arena_states, of(2, 20).arena_states);
    }
}
