//! The paper's observation, eq. (8).
//!
//! In: a scan, and the goal's bearing and distance. Out: a row in the paper's order `d_1 ... d_B, phi_0, d_g, d_o, n`, which
//! is B + 4 numbers for B beams (28 for 24). [`Encoding::Raw`] keeps the units; [`Encoding::Scaled`] divides each number
//! by a constant, so that all are of the order of one:
//!
//! | index | meaning | divided by |
//! |---|---|---|
//! | 0 .. B-1 | LIDAR ranges d_1 ... d_B, in m | [`RANGE_SCALE_M`] (3.5 m) |
//! | B | phi_0, angle from the heading to the goal, in rad, left positive | pi |
//! | B+1 | d_g, distance to the goal, in m | [`DISTANCE_SCALE_M`] (4 m) |
//! | B+2 | d_o, the smallest range, in m | [`RANGE_SCALE_M`] |
//! | B+3 | n, the index of the beam with that range, 0 .. B-1 | B |
//!
//! The paper does not say whether it scales its inputs; see `docs/algorithm.md`.

use super::Encoding;

/// The divisor of LIDAR ranges in [`Encoding::Scaled`], in m.
pub const RANGE_SCALE_M: f32 = 3.5;
/// The divisor of the goal's distance in [`Encoding::Scaled`], in m.
pub const DISTANCE_SCALE_M: f32 = 4.0;

impl Encoding {
    /// The divisors of the ranges, the bearing, the goal's distance and the beam index in the paper's observation, with `beams`
    /// beams.
    pub(crate) fn divisors(self, beams: usize) -> [f32; 4] {
        match self {
            Self::Scaled => [RANGE_SCALE_M, core::f32::consts::PI, DISTANCE_SCALE_M, beams as f32],
            Self::Raw | Self::Sectors { .. } => [1.0; 4],
        }
    }
}

/// The length of an observation from a LIDAR with `beams` beams.
#[must_use]
pub const fn width(beams: usize) -> usize {
    beams + 4
}

/// Writes the paper's observation, [`Encoding::Scaled`] or [`Encoding::Raw`], into `row`, which must have
/// [`width`]`(ranges_m.len())` elements.
///
/// `ranges_m` has one range per beam, in m, counterclockwise from the LIDAR's first beam (which points straight ahead if
/// the field of view is a full turn). `bearing_rad` is the angle from the heading to the goal in (-pi, pi], left positive;
/// `distance_m` is the distance to the goal. Observations by [`Encoding::Sectors`] come from a
/// [`SectorObserver`](super::SectorObserver).
///
/// # Panics
/// `row` is too short.
pub fn encode(encoding: Encoding, ranges_m: &[f32], bearing_rad: f32, distance_m: f32, row: &mut [f32]) {
    let beams = ranges_m.len();
    let [range_scale, bearing_scale, distance_scale, index_scale] = encoding.divisors(beams);
    let (mut nearest, mut index) = (f32::INFINITY, 0);
    for (i, &range) in ranges_m.iter().enumerate() {
        row[i] = range / range_scale;
        if range < nearest {
            (nearest, index) = (range, i);
        }
    }
    row[beams] = bearing_rad / bearing_scale;
    row[beams + 1] = distance_m / distance_scale;
    row[beams + 2] = nearest / range_scale;
    row[beams + 3] = index as f32 / index_scale;
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The observation when beam 6 of 24 measures 0.7 m and the goal is 2 m away, 90 degrees to the right.
    fn row(encoding: Encoding) -> Vec<f32> {
        let mut ranges_m = vec![3.5; 24];
        ranges_m[6] = 0.7;
        let mut row = vec![f32::NAN; width(24)];
        encode(encoding, &ranges_m, -core::f32::consts::FRAC_PI_2, 2.0, &mut row);
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
        assert_eq!(row[27], 0.25, "and the index of its beam: 6 / 24");
    }

    #[test]
    fn a_raw_observation_is_eq_8_in_metres_and_radians() {
        let mut expected = [3.5; 28];
        expected[6] = 0.7;
        expected[24..].copy_from_slice(&[-core::f32::consts::FRAC_PI_2, 2.0, 0.7, 6.0]);
        assert_eq!(row(Encoding::Raw), expected, "24 ranges, -90 degrees, 2 m, 0.7 m, beam 6");
    }
}
