//! The quantities that the numbers of an observation measure.

use serde::{Deserialize, Serialize};

/// The quantity that an input measures.
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
    /// The index of the first beam with the smallest range.
    NearestBeam,
    /// A reading of a plugin's sensor.
    Sensor,
    /// The nearness of the nearest thing in a sector: 0 (nothing in sight) to 1 (contact).
    Nearness,
    /// The change of a sector's nearness since the earlier scan.
    NearnessChange,
    /// The nearness of a collision in the direction of a sector's centre.
    CollisionNearness,
    /// Like [`CollisionNearness`](Self::CollisionNearness), at the robot's highest speed, if moving objects keep their
    /// speeds and turning rates.
    PredictedNearness,
    /// The cosine of the goal's bearing.
    GoalCosine,
    /// The sine of the goal's bearing.
    GoalSine,
    /// The nearness of the goal's edge.
    GoalNearness,
    /// The logarithm of the distance to the goal's edge: ln(1 + d) / 4 with d in units of the robot.
    GoalLogDistance,
    /// The robot's speed, as a fraction of its highest speed.
    Speed,
    /// The robot's turning rate, as a fraction of its highest turning rate.
    TurningRate,
    /// The longest distance that the robot drives in a control step, in units of the robot.
    StepLength,
    /// The robot's largest turn in a control step.
    StepTurn,
    /// The nearness of a collision if the robot waits.
    WaitingNearness,
}

impl Quantity {
    /// The quantity's unit; empty for a number without a unit.
    #[must_use]
    pub fn unit(self) -> &'static str {
        match self {
            Self::Range | Self::GoalDistance | Self::SmallestRange => "m",
            Self::GoalBearing | Self::StepTurn => "rad",
            _ => "",
        }
    }
}
