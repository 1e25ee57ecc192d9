//! The range of the numbers of an observation, for Gymnasium's spaces.

use std::f32::consts::PI;

use wayfield::policy::{Encoding, observation};
use wayfield::scenario::{Lidar, Robot, Scenario, ScenarioSet, SetSource};

/// The smallest and the largest value of every number of an observation.
pub struct ObservationBounds {
    pub low: Vec<f32>,
    pub high: Vec<f32>,
}

impl ObservationBounds {
    /// The bounds in `scenario` or, if given, in all scenarios of `set`. Infinite for observations by sectors, and for the
    /// distance to the goal if the robot's odometry drifts.
    pub fn of(encoding: Encoding, scenario: &Scenario, set: Option<&ScenarioSet>) -> Self {
        if encoding.sectors().is_some() {
            let width = encoding.width(scenario.lidar.beams);
            return Self { low: vec![f32::NEG_INFINITY; width], high: vec![f32::INFINITY; width] };
        }
        let sources = set.into_iter().flat_map(|set| &set.members).map(|member| &member.source);
        let all = sources.map(|source| {
            let (robot, lidar, _) = source.task();
            Self::of_scans(encoding, lidar, farthest_m(robot, diagonal_of_source_m(source)))
        });
        all.reduce(Self::union).unwrap_or_else(|| {
            Self::of_scans(encoding, &scenario.lidar, farthest_m(&scenario.robot, diagonal_m(scenario)))
        })
    }

    /// The bounds of an observation by scans whose goal is at most `farthest_m` away.
    fn of_scans(encoding: Encoding, lidar: &Lidar, farthest_m: f32) -> Self {
        // The tolerance is for rounding.
        let farthest_m = 1.001 * farthest_m;
        let encode = |ranges_m: &[f32], bearing_rad, distance_m| {
            let mut row = vec![0.0; encoding.width(lidar.beams)];
            observation::encode(encoding, ranges_m, bearing_rad, distance_m, &mut row);
            row
        };
        let mut ranges_m = vec![lidar.max_range_m; lidar.beams];
        let mut high = encode(&ranges_m, PI, farthest_m);
        // The index of the nearest beam is largest if the nearest beam is the last one.
        if let (Some(range), Some(index)) = (ranges_m.last_mut(), high.last_mut()) {
            *range = 0.0;
            *index = encode(&ranges_m, PI, farthest_m).pop().unwrap_or_default();
        }
        Self { low: encode(&vec![0.0; lidar.beams], -PI, 0.0), high }
    }

    /// The smallest bounds that contain both these and `other`.
    fn union(mut self, other: Self) -> Self {
        for (low, other) in self.low.iter_mut().zip(other.low) {
            *low = low.min(other);
        }
        for (high, other) in self.high.iter_mut().zip(other.high) {
            *high = high.max(other);
        }
        self
    }
}

/// The largest distance at which `robot` may observe its goal in an enclosure with this diagonal, in m. If its odometry drifts,
/// it observes the goal from an estimated position, which may be anywhere.
fn farthest_m(robot: &Robot, diagonal_m: f32) -> f32 {
    if robot.odometry_drift.is_some() { f32::INFINITY } else { diagonal_m }
}

/// The largest distance in the enclosure of a scenario of `source`, in m.
fn diagonal_of_source_m(source: &SetSource) -> f32 {
    match source {
        SetSource::Scenario(scenario) => diagonal_m(scenario),
        SetSource::Levels { generator, .. } => generator.width_m.1.hypot(generator.height_m.1),
    }
}

/// The largest distance in the enclosure of `scenario`, in m.
fn diagonal_m(scenario: &Scenario) -> f32 {
    let corners = scenario.enclosure.corners_m();
    let distances = corners.iter().flat_map(|a| corners.iter().map(|b| a.distance(*b)));
    distances.fold(0.0, f32::max)
}
