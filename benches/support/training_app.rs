//! Scenario I with the default preset, in any number of arenas, as training has it.

use std::error::Error;
use std::sync::Arc;

use bevy::prelude::App;
use wayfield::learning::Learner;
use wayfield::run::{shipped, simulation};
use wayfield::task::observation;

/// An app at its first observations. Without `learning` no gradient step is ever due.
pub fn training(arenas: usize, learning: bool) -> Result<App, Box<dyn Error>> {
    let scenario = Arc::new(shipped::scenario("scenario-1")?);
    let mut preset = shipped::preset("fast")?;
    preset.arenas = arenas;
    if !learning {
        preset.learning.train_freq = u64::MAX;
    }
    let inputs = observation::width(scenario.lidar.beams);
    let learner = Learner::new(&preset.learning, inputs, scenario.robot.motions.len(), arenas, 1)?;
    Ok(simulation::training_app(&scenario, &preset, 1, learner))
}
