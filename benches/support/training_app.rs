//! A training simulation with the default preset and any number of arenas.

use std::error::Error;
use std::sync::Arc;

use wayfield::learning::Learner;
use wayfield::run::{shipped, training_setup};
use wayfield::scenario::Scenario;
use wayfield::simulation::{Extensions, Simulation};
use wayfield::task::observation;

/// A training simulation before its first step. Without `learning`, it takes no gradient steps.
pub fn training(
    scenario: &Scenario,
    arenas: usize,
    learning: bool,
    extensions: &Extensions,
) -> Result<Simulation, Box<dyn Error>> {
    let scenario = Arc::new(scenario.clone());
    let mut preset = shipped::preset("fast")?;
    preset.arenas = arenas;
    if !learning {
        preset.learning.train_freq = u64::MAX;
    }
    let inputs = observation::width(scenario.lidar.beams);
    let learner = Learner::new(&preset.learning, inputs, scenario.robot.motions.len(), arenas, 1)?;
    Ok(training_setup::training(&scenario, &preset, 1, learner, extensions))
}
