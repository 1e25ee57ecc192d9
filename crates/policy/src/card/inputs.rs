//! The network's inputs on a card: quantity, unit, divisor and angle of each.

use serde::{Deserialize, Serialize};

use crate::observation::Encoding;

/// One input of the network: the quantity in its unit, divided by the divisor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// The quantity.
    pub quantity: Quantity,
    /// The quantity's unit before the division; empty for a number without a unit.
    pub unit: String,
    /// The divisor.
    pub divisor: f32,
    /// The direction of a LIDAR beam relative to the heading, counterclockwise positive, in rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angle_rad: Option<f32>,
    /// The name of the plugin sensor that this input is a reading of.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensor: Option<String>,
}

/// What an input measures.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Quantity {
    /// The range of a LIDAR beam.
    Range,
    /// The angle from the heading to the goal, left positive, in (-pi, pi].
    GoalBearing,
    /// The distance from the robot's centre to the goal.
    GoalDistance,
    /// The smallest of the ranges.
    SmallestRange,
    /// The number of the first beam with the smallest range, from 0.
    NearestBeam,
    /// A reading of a plugin's sensor.
    Sensor,
}

/// The inputs for a LIDAR with beams at `angles_rad`, followed by plugin sensors with these names and widths.
#[must_use]
pub fn inputs(encoding: Encoding, angles_rad: &[f32], sensors: &[(&str, usize)]) -> Vec<Input> {
    let [range, bearing, distance, index] = encoding.divisors(angles_rad.len());
    let input = |quantity, unit: &str, divisor| Input {
        quantity,
        unit: unit.into(),
        divisor,
        angle_rad: None,
        sensor: None,
    };
    let beam = |&angle: &f32| Input { angle_rad: Some(angle), ..input(Quantity::Range, "m", range) };
    let mut inputs: Vec<Input> = angles_rad.iter().map(beam).collect();
    inputs.extend([
        input(Quantity::GoalBearing, "rad", bearing),
        input(Quantity::GoalDistance, "m", distance),
        input(Quantity::SmallestRange, "m", range),
        input(Quantity::NearestBeam, "", index),
    ]);
    for (name, width) in sensors {
        let reading = Input { sensor: Some((*name).into()), ..input(Quantity::Sensor, "", 1.0) };
        inputs.extend(std::iter::repeat_n(reading, *width));
    }
    inputs
}
