//! The network's inputs on a card: quantity, unit, divisor and angle of each.

use serde::{Deserialize, Serialize};

use crate::observation::{Column, Encoding, SectorLayout};

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
    /// The nearness of the nearest thing in a sector: see `docs/policy-file.md`.
    Nearness,
    /// The change of a sector's nearness since the earlier scan.
    NearnessChange,
    /// The nearness of a collision in the direction of a sector's centre.
    CollisionNearness,
    /// The cosine of the goal's bearing.
    GoalCosine,
    /// The sine of the goal's bearing.
    GoalSine,
    /// The nearness of the goal's edge.
    GoalNearness,
    /// The logarithm of the distance to the goal's edge.
    GoalLogDistance,
    /// The robot's speed, in units of its highest.
    Speed,
    /// The robot's turning rate, in units of its highest.
    TurningRate,
    /// The robot's longest way in a control step, in units of the robot.
    StepLength,
    /// The robot's largest turn in a control step.
    StepTurn,
}

/// The input of a column of an observation by sectors.
fn of_column(column: Column, sectors: SectorLayout) -> Input {
    let input = |quantity, unit: &str, sector: Option<usize>| Input {
        quantity,
        unit: unit.into(),
        divisor: 1.0,
        angle_rad: sector.map(|sector| sectors.angle_rad(sector)),
        sensor: None,
    };
    match column {
        Column::Nearness(sector) => input(Quantity::Nearness, "", Some(sector)),
        Column::Change(sector) => input(Quantity::NearnessChange, "", Some(sector)),
        Column::FreePath(sector) => input(Quantity::CollisionNearness, "", Some(sector)),
        Column::GoalCosine => input(Quantity::GoalCosine, "", None),
        Column::GoalSine => input(Quantity::GoalSine, "", None),
        Column::GoalNearness => input(Quantity::GoalNearness, "", None),
        Column::GoalLogDistance => input(Quantity::GoalLogDistance, "", None),
        Column::Speed => input(Quantity::Speed, "", None),
        Column::TurningRate => input(Quantity::TurningRate, "", None),
        Column::StepLength => input(Quantity::StepLength, "", None),
        Column::StepTurn => input(Quantity::StepTurn, "rad", None),
    }
}

/// The inputs for a LIDAR with beams at `angles_rad`, of which sectors make no difference, followed by plugin sensors with these names and widths.
#[must_use]
pub fn inputs(encoding: Encoding, angles_rad: &[f32], sensors: &[(&str, usize)]) -> Vec<Input> {
    let input = |quantity, unit: &str, divisor| Input {
        quantity,
        unit: unit.into(),
        divisor,
        angle_rad: None,
        sensor: None,
    };
    let mut inputs: Vec<Input> = match encoding.sectors() {
        Some(sectors) => sectors.columns().map(|column| of_column(column, sectors)).collect(),
        None => {
            let [range, bearing, distance, index] = encoding.divisors(angles_rad.len());
            let beam = |&angle: &f32| Input { angle_rad: Some(angle), ..input(Quantity::Range, "m", range) };
            let goal = [
                input(Quantity::GoalBearing, "rad", bearing),
                input(Quantity::GoalDistance, "m", distance),
                input(Quantity::SmallestRange, "m", range),
                input(Quantity::NearestBeam, "", index),
            ];
            angles_rad.iter().map(beam).chain(goal).collect()
        }
    };
    for (name, width) in sensors {
        let reading = Input { sensor: Some((*name).into()), ..input(Quantity::Sensor, "", 1.0) };
        inputs.extend(std::iter::repeat_n(reading, *width));
    }
    inputs
}
