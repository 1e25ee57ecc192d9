//! The state of one arena, as the task sees it: components on the arena's entity.
//!
//! In: `world/` writes [`Pose`], [`Drive`] and [`Scan`], `begin.rs` writes [`Target`] and [`Episode`]. Out: everything else
//! reads them. Positions are in the arena's own frame, whose origin is the enclosure's centre.

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::reward::{Potential, RewardTerms};
use crate::random::{self, Stream};

/// An arena: one robot in one enclosure. The number is its row in every batch.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arena(pub usize);

/// Where the robot is and where it looks.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pose {
    /// Position of the robot's centre along x, in m.
    pub x_m: f32,
    /// Position of the robot's centre along y, in m.
    pub y_m: f32,
    /// Heading in rad, counterclockwise from the x axis, in (-pi, pi].
    pub heading_rad: f32,
}

impl Pose {
    /// Distance to a target's centre, in m: d_g of eq. (8).
    #[must_use]
    pub fn distance_m(&self, target: &Target) -> f32 {
        libm::hypotf(target.x_m - self.x_m, target.y_m - self.y_m)
    }

    /// Angle from the heading to the line to a target, in rad, in (-pi, pi], counterclockwise positive: phi_0 of
    /// eq. (8).
    #[must_use]
    pub fn bearing_rad(&self, target: &Target) -> f32 {
        wrap_angle(libm::atan2f(target.y_m - self.y_m, target.x_m - self.x_m) - self.heading_rad)
    }
}

/// How fast the robot actually goes at this moment: what its drive has made of the motions chosen so far. At rest when
/// an episode begins. Wheels know nothing of contacts: one that stops the body leaves this as it is.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Drive {
    /// Speed along the heading, in m/s.
    pub v_m_s: f32,
    /// Turning speed, left positive, in rad/s.
    pub w_rad_s: f32,
}

/// The same angle in (-pi, pi], in rad.
#[must_use]
pub fn wrap_angle(angle_rad: f32) -> f32 {
    use core::f32::consts::{PI, TAU};
    if angle_rad > -PI && angle_rad <= PI {
        return angle_rad;
    }
    let wrapped = libm::fmodf(angle_rad, TAU);
    if wrapped > PI {
        wrapped - TAU
    } else if wrapped <= -PI {
        wrapped + TAU
    } else {
        wrapped
    }
}

/// One LIDAR scan.
#[derive(Component, Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Scan {
    /// What the sensor reports, in m: beam i looks along heading + i * 2 pi / beams. Noise and dropout included.
    pub ranges_m: Vec<f32>,
    /// The smallest range without noise and dropout, in m: d_o, by which collisions and rewards are judged.
    pub nearest_m: f32,
    /// Whether the robot's body touches another.
    pub touching: bool,
}

/// The point that the robot is to reach, in m.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Target {
    /// Along x, in m.
    pub x_m: f32,
    /// Along y, in m.
    pub y_m: f32,
}

/// Control steps since the arena came to be: moving obstacles are a function of it.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Clock(pub u64);

/// What an arena is owed before the next step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Restart {
    /// Nothing: the episode goes on.
    #[default]
    No,
    /// A new target; robot and episode go on.
    Target,
    /// A new episode: robot and target are placed anew.
    Episode,
    /// As `Episode`, with the obstacles put where the clock says (a fresh arena, or a rewound clock).
    Everything,
    /// Nothing is drawn: a hand has moved something, and robot, scan and observation follow. The episode goes on.
    Moved,
}

/// The running episode of an arena.
#[derive(Component, Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Episode {
    /// Control steps taken in it.
    pub steps: u32,
    /// Targets reached in it.
    pub targets: u32,
    /// The rewards so far, term by term.
    pub rewards: RewardTerms,
    /// The potential of eq. (4) after the last step, for the present target.
    pub potential: Potential,
    /// What is due before the next step.
    pub restart: Restart,
    /// The arena stands still: its single navigation has ended.
    pub parked: bool,
}

/// The random streams of an arena: they depend on the seed and the arena's number alone.
#[derive(Component, Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Streams {
    /// Starts and targets.
    pub places: Stream,
    /// LIDAR noise and dropout.
    pub sensor: Stream,
}

impl Streams {
    /// The streams of arena `index` in the run with `seed`.
    #[must_use]
    pub fn new(seed: u64, index: u64) -> Self {
        Self { places: random::stream(seed, "places", index), sensor: random::stream(seed, "sensor", index) }
    }
}

/// All of an arena that a checkpoint must hold, so that a run goes on to the bit.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ArenaState {
    /// The robot's pose.
    pub pose: Pose,
    /// How fast it goes.
    pub drive: Drive,
    /// The last scan.
    pub scan: Scan,
    /// The present target.
    pub target: Target,
    /// The obstacles' clock.
    pub clock: Clock,
    /// The running episode.
    pub episode: Episode,
    /// The streams where they stand.
    pub streams: Streams,
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::PI;

    #[test]
    fn bearing_is_the_angle_from_the_heading_to_the_target() {
        let target = Target { x_m: 0.0, y_m: 2.0 };
        let east = Pose { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 };
        assert_eq!(east.distance_m(&target), 2.0);
        assert!((east.bearing_rad(&target) - PI / 2.0).abs() < 1e-6, "the target lies to the left");
        let south_west = Pose { heading_rad: -3.0 * PI / 4.0, ..east };
        // From -135 degrees to 90 degrees the short way is clockwise: -135 degrees.
        assert!((south_west.bearing_rad(&target) + 3.0 * PI / 4.0).abs() < 1e-5);
    }

    #[test]
    fn wrapped_angles_stay_in_range() {
        for k in -50..50 {
            for offset in [-3.1_f32, -1.0, 0.0, 0.5, 3.1] {
                let wrapped = wrap_angle(offset + k as f32 * 2.0 * PI);
                assert!(wrapped > -PI && wrapped <= PI, "{wrapped}");
                assert!((wrapped - offset).abs() < 1e-3, "{offset} plus {k} turns became {wrapped}");
            }
        }
    }
}
