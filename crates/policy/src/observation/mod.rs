//! Observations: the inputs of a policy's network.
//!
//! | encoding | what it is |
//! |---|---|
//! | [`Encoding::Scaled`], [`Encoding::Raw`] | eq. (8) of the paper: a range per beam, the goal, and the nearest beam ([`encode`]) |
//! | [`Encoding::Sectors`] | sectors around the robot, with lengths in units of the robot and motion since an earlier scan ([`SectorObserver`]): for any LIDAR and any robot |

mod moving;
mod observer;
mod paper;
mod quantity;
mod sectors;
mod tracker;

use serde::{Deserialize, Serialize};

pub use observer::{FORESIGHT_STEPS, FollowUp, ObserverMemory, SectorObserver, Sensed};
pub use paper::{DISTANCE_SCALE_M, RANGE_SCALE_M, encode, width};
pub use quantity::Quantity;
pub use sectors::{BodyScale, Column, LidarBeams, SectorLayout};

/// The encoding of an observation. A policy needs the encoding that it was trained with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum Encoding {
    /// Eq. (8) of the paper, each number divided by a constant, so that it is of the order of one.
    #[default]
    Scaled,
    /// Eq. (8) of the paper without scaling: lengths are in m, the bearing in rad, and n is the index of the nearest beam.
    Raw,
    /// Sectors around the robot, with lengths in units of the distance at which it collides, and with motion since an earlier
    /// scan: for any LIDAR and any robot.
    Sectors {
        /// Number of sectors of a full turn, 4 to 360.
        #[serde(default = "default_count")]
        count: u16,
        /// Number of control steps to the earlier scan that the current one is compared with, 1 to 20; 0 for none.
        #[serde(default = "default_earlier_steps")]
        earlier_steps: u8,
        /// Whether the observation also shows, for each sector, how far the robot can drive in that direction before it
        /// collides: which gaps are wide enough.
        #[serde(default = "default_free_paths")]
        free_paths: bool,
        /// Whether the observation also shows, for each sector, how far the robot can drive in that direction if all moving
        /// things keep their speeds and turning rates, and when one of them would hit the robot if it waited. Needs
        /// `earlier_steps`.
        #[serde(default)]
        predicted_paths: bool,
    },
}

fn default_count() -> u16 {
    36
}

fn default_earlier_steps() -> u8 {
    3
}

fn default_free_paths() -> bool {
    true
}

impl Encoding {
    /// The length of an observation from a LIDAR with `beams` beams.
    #[must_use]
    pub const fn width(self, beams: usize) -> usize {
        match self.sectors() {
            Some(layout) => layout.width(),
            None => width(beams),
        }
    }

    /// The layout of the sectors; `None` for the paper's observation.
    #[must_use]
    pub const fn sectors(self) -> Option<SectorLayout> {
        match self {
            Self::Scaled | Self::Raw => None,
            Self::Sectors { count, earlier_steps, free_paths, predicted_paths } => {
                Some(SectorLayout { count, earlier_steps, free_paths, predicted_paths })
            }
        }
    }

    /// Whether the observation `row` [shows something that moves](SectorLayout::shows_motion); true if its encoding cannot show
    /// motion.
    ///
    /// # Panics
    /// `row` is shorter than an observation with this encoding.
    #[must_use]
    pub fn shows_motion(self, row: &[f32]) -> bool {
        self.sectors().is_none_or(|layout| layout.shows_motion(row))
    }

    /// Checks the parameters of the encoding.
    ///
    /// # Errors
    /// The problem and its fix.
    pub fn check(self) -> Result<(), String> {
        self.sectors().map_or(Ok(()), SectorLayout::check)
    }
}
