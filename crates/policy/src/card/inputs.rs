//! The network's inputs on a policy's card, the description in its file: quantity, unit, divisor and angle of each.

use serde::{Deserialize, Serialize};

pub use crate::observation::Quantity;
use crate::observation::{Column, Encoding};

/// One input of the network: the quantity in its unit, divided by the divisor.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Input {
    /// The quantity.
    pub quantity: Quantity,
    /// The quantity's unit before the division; empty if it has none.
    pub unit: String,
    /// The divisor.
    pub divisor: f32,
    /// The direction of the LIDAR beam or sector relative to the heading, counterclockwise positive, in rad.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub angle_rad: Option<f32>,
    /// The name of the plugin sensor that this input is a reading of.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sensor: Option<String>,
}

/// The inputs for a LIDAR with beams at `angles_rad` (ignored for an observation by sectors), followed by those of plugin
/// sensors with these names and widths.
#[must_use]
pub fn inputs(encoding: Encoding, angles_rad: &[f32], sensors: &[(&str, usize)]) -> Vec<Input> {
    let input = |quantity: Quantity, divisor| Input {
        quantity,
        unit: quantity.unit().into(),
        divisor,
        angle_rad: None,
        sensor: None,
    };
    let mut inputs: Vec<Input> = match encoding.sectors() {
        Some(sectors) => sectors
            .columns()
            .map(|Column { quantity, sector }| Input {
                angle_rad: sector.map(|sector| sectors.angle_rad(sector)),
                ..input(quantity, 1.0)
            })
            .collect(),
        None => {
            let [range, bearing, distance, index] = encoding.divisors(angles_rad.len());
            let beam = |&angle: &f32| Input { angle_rad: Some(angle), ..input(Quantity::Range, range) };
            let goal = [
                input(Quantity::GoalBearing, bearing),
                input(Quantity::GoalDistance, distance),
                input(Quantity::SmallestRange, range),
                input(Quantity::NearestBeam, index),
            ];
            angles_rad.iter().map(beam).chain(goal).collect()
        }
    };
    for (name, width) in sensors {
        let reading = Input { sensor: Some((*name).into()), ..input(Quantity::Sensor, 1.0) };
        inputs.extend(std::iter::repeat_n(reading, *width));
    }
    inputs
}
