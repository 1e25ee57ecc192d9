//! Eq. (8): what the policy sees.
//!
//! In: a scan, a pose and a goal. Out: one row of [`Observations`] per arena, in the paper's order
//! `d_1 ... d_B, phi_0, d_g, d_o, n` (B beams; 28 numbers for 24): as they are ([`Encoding::Raw`]), or each scaled so
//! that it is of the order of one ([`Encoding::Scaled`]):
//!
//! | columns | meaning | scaled by |
//! |---|---|---|
//! | 0 .. B-1 | LIDAR ranges d_1 ... d_B, in m | / [`RANGE_SCALE_M`] (3.5 m) |
//! | B | phi_0, angle from the heading to the goal, in rad | / pi |
//! | B+1 | d_g, distance to the goal, in m | / [`DISTANCE_SCALE_M`] (4 m) |
//! | B+2 | d_o, the smallest reported range, in m | / [`RANGE_SCALE_M`] |
//! | B+3 | n, the index of that beam, 0 .. B-1 | / B |
//!
//! The paper does not say whether it scales its inputs; see `docs/algorithm.md`.

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::{Arena, CurrentScenario, Episode, Goal, PendingReset, Pose, Scan};

/// LIDAR ranges are divided by this, in m.
pub const RANGE_SCALE_M: f32 = 3.5;
/// The goal's distance is divided by this, in m.
pub const DISTANCE_SCALE_M: f32 = 4.0;

/// In which units the numbers of eq. (8) enter the network. A policy drives only by the encoding it was trained with.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Encoding {
    /// Each divided by a constant, so that it is of the order of one.
    #[default]
    Scaled,
    /// As they are: metres, radians, metres, metres, and the beam's index.
    Raw,
}

impl Encoding {
    /// What ranges, the bearing, the goal's distance and the index of a beam among `beams` are divided by.
    fn divisors(self, beams: usize) -> [f32; 4] {
        match self {
            Self::Scaled => [RANGE_SCALE_M, core::f32::consts::PI, DISTANCE_SCALE_M, beams as f32],
            Self::Raw => [1.0; 4],
        }
    }
}

/// How many numbers an observation has with `beams` beams.
#[must_use]
pub const fn width(beams: usize) -> usize {
    beams + 4
}

/// Writes eq. (8) in `encoding` into `row`, which must be [`width`]`(scan.ranges_m.len())` long.
pub fn encode(encoding: Encoding, scan: &Scan, pose: &Pose, goal: &Goal, row: &mut [f32]) {
    let beams = scan.ranges_m.len();
    let [of_range, of_bearing, of_distance, of_index] = encoding.divisors(beams);
    let (mut nearest, mut index) = (f32::INFINITY, 0);
    for (i, &range) in scan.ranges_m.iter().enumerate() {
        row[i] = range / of_range;
        if range < nearest {
            (nearest, index) = (range, i);
        }
    }
    row[beams] = pose.bearing_rad(goal) / of_bearing;
    row[beams + 1] = pose.distance_m(goal) / of_distance;
    row[beams + 2] = nearest / of_range;
    row[beams + 3] = index as f32 / of_index;
}

/// The observations of all arenas, row by row.
#[derive(Resource, Clone, Debug, Default)]
pub struct Observations {
    /// Numbers in a row.
    pub width: usize,
    /// What each arena's policy sees now: arenas x width.
    pub current: Vec<f32>,
    /// What each arena's step led to, before anything was drawn anew: arenas x width.
    pub next: Vec<f32>,
}

impl Observations {
    /// Makes room for `arenas` rows of `width`.
    pub fn resize(&mut self, arenas: usize, width: usize) {
        self.width = width;
        self.current = vec![0.0; arenas * width];
        self.next = vec![0.0; arenas * width];
    }

    /// The row of `arena` in `current`.
    #[must_use]
    pub fn row(&self, arena: usize) -> &[f32] {
        &self.current[arena * self.width..(arena + 1) * self.width]
    }

    /// The row of `arena` in `next`.
    #[must_use]
    pub fn next_row(&self, arena: usize) -> &[f32] {
        &self.next[arena * self.width..(arena + 1) * self.width]
    }
}

/// `Sense`: what the step has led to.
pub(super) fn observe_next(
    encoding: Res<Encoding>,
    mut observations: ResMut<Observations>,
    arenas: Query<(&Arena, &Scan, &Pose, &Goal)>,
) {
    let width = observations.width;
    // Parked arenas too: `current` and `next` change places after every step.
    for (arena, scan, pose, goal) in &arenas {
        encode(*encoding, scan, pose, goal, &mut observations.next[arena.0 * width..][..width]);
    }
}

/// `Reset`: what the step led to is what the next one starts from.
pub(super) fn advance(mut observations: ResMut<Observations>) {
    let observations = &mut *observations;
    std::mem::swap(&mut observations.current, &mut observations.next);
}

/// `Reset`: the first observation after a new goal or start; the potential is that of the new goal.
pub(super) fn observe_first(
    encoding: Res<Encoding>,
    mut observations: ResMut<Observations>,
    reward: Res<super::RewardConfig>,
    scenario: Res<CurrentScenario>,
    mut arenas: Query<(&Arena, &Scan, &Pose, &Goal, &mut Episode)>,
) {
    let width = observations.width;
    debug_assert_eq!(width, self::width(scenario.0.lidar.beams));
    for (arena, scan, pose, goal, mut episode) in &mut arenas {
        if episode.pending_reset != PendingReset::None {
            encode(*encoding, scan, pose, goal, &mut observations.current[arena.0 * width..][..width]);
            episode.potential = reward.potential(pose.distance_m(goal), scan.nearest_m);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Beam 6 of 24 meets something 0.7 m away; the goal is 2 m away, 90 degrees to the right.
    fn row(encoding: Encoding) -> Vec<f32> {
        let mut ranges_m = vec![3.5; 24];
        ranges_m[6] = 0.7;
        let scan = Scan { ranges_m, nearest_m: 0.7, ..Scan::default() };
        let pose = Pose { x_m: 1.0, y_m: 0.0, heading_rad: 0.0 };
        let goal = Goal { x_m: 1.0, y_m: -2.0 };
        let mut row = vec![f32::NAN; width(24)];
        encode(encoding, &scan, &pose, &goal, &mut row);
        row
    }

    #[test]
    fn an_observation_is_eq_8_in_the_papers_order() {
        let row = row(Encoding::Scaled);
        assert_eq!(row.len(), 28, "28 numbers with 24 beams");
        assert_eq!(row[0], 1.0, "a free beam is 3.5 m / 3.5 m");
        assert!((row[6] - 0.2).abs() < 1e-7, "beam 6 is 0.7 m / 3.5 m");
        assert!((row[24] + 0.5).abs() < 1e-6, "the goal lies 90 degrees to the right: -1/2 of pi");
        assert_eq!(row[25], 0.5, "2 m / 4 m");
        assert!((row[26] - 0.2).abs() < 1e-7, "the smallest range again");
        assert_eq!(row[27], 0.25, "and its beam's number: 6 / 24");
    }

    #[test]
    fn a_raw_observation_is_eq_8_in_metres_and_radians() {
        let mut expected = [3.5; 28];
        expected[6] = 0.7;
        expected[24..].copy_from_slice(&[-core::f32::consts::FRAC_PI_2, 2.0, 0.7, 6.0]);
        assert_eq!(row(Encoding::Raw), expected, "24 ranges, -90 degrees, 2 m, 0.7 m, beam 6");
    }
}
