//! The speed and the track of a moving obstacle.
//!
//! In: an [`Obstacle`]. Out: its kind of speed and the places where it may be, without regard to the time.

use super::geometry::length;
use super::key_frames::{self, Leg};
use super::schema::{KeyFrameEnd, Obstacle, ObstacleMotion};
use glam::Vec2;

/// The velocity of an obstacle, apart from its direction.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MotionSpeed {
    /// No motion at all.
    AtRest,
    /// A translation without rotation, at up to this speed in m/s.
    Translation(f32),
    /// A translation without rotation, at a speed that changes: [`Obstacle::origin_speed_m_s`] is the highest.
    Variable,
    /// A revolution about a point, in which the obstacle rotates as if fixed to a turntable.
    Revolution {
        /// The point, in m.
        centre_m: Vec2,
        /// Angular speed, counterclockwise positive.
        speed_rad_s: f32,
    },
}

/// The positions of an obstacle's origin over all times. A pedestrian leaves its track to avoid others.
#[derive(Clone, Debug, PartialEq)]
pub enum Track {
    /// Its position only.
    Point,
    /// The circle through its position about a point.
    Circle {
        /// The point, in m.
        centre_m: Vec2,
    },
    /// Straight lines from corner to corner.
    Lines {
        /// The corners, in m, starting with its position.
        corners_m: Vec<Vec2>,
        /// Whether the last corner is connected to the first; else the obstacle goes back along the same lines, or stops.
        closed: bool,
    },
    /// Any place within a distance of its position.
    Disc {
        /// The distance, in m.
        radius_m: f32,
    },
}

impl ObstacleMotion {
    /// The speed; of a range of speeds, the middle.
    #[inline]
    #[must_use]
    pub fn speed(&self) -> MotionSpeed {
        match *self {
            Self::Static => MotionSpeed::AtRest,
            Self::Orbit { centre_m, speed_rad_s } => {
                MotionSpeed::Revolution { centre_m, speed_rad_s: speed_rad_s.value() }
            }
            Self::Patrol { speed_m_s, .. }
            | Self::BackAndForth { speed_m_s, .. }
            | Self::RandomWalk { speed_m_s, .. }
            | Self::Pedestrian { speed_m_s, .. } => MotionSpeed::Translation(speed_m_s.value()),
            Self::KeyFrames { .. } => MotionSpeed::Variable,
        }
    }

    /// The speed; of a range of speeds, the end with the larger absolute value.
    pub(super) fn fastest_speed(&self) -> MotionSpeed {
        let mut motion = self.clone();
        if let Some(speed) = motion.given_speed_mut() {
            let [low, high] = speed.ends();
            *speed = if low.abs() > high.abs() { low } else { high }.into();
        }
        motion.speed()
    }

    /// Whether an obstacle with this motion ever moves. Key frames count as motion even if all are in one place.
    #[must_use]
    pub fn is_moving(&self) -> bool {
        match self.given_speed() {
            Some(speed) => speed.ends() != [0.0; 2],
            None => *self != Self::Static,
        }
    }
}

impl Obstacle {
    /// The track.
    #[must_use]
    pub fn track(&self) -> Track {
        let lines = |waypoints_m: &[Vec2], closed| Track::Lines {
            corners_m: std::iter::once(self.position_m).chain(waypoints_m.iter().copied()).collect(),
            closed,
        };
        match &self.motion {
            ObstacleMotion::Static => Track::Point,
            ObstacleMotion::Orbit { centre_m, .. } => Track::Circle { centre_m: *centre_m },
            ObstacleMotion::Patrol { waypoints_m, .. } => lines(waypoints_m, true),
            ObstacleMotion::BackAndForth { waypoints_m, .. } => lines(waypoints_m, false),
            ObstacleMotion::Pedestrian { goals_m, loops, .. } => lines(goals_m, *loops),
            ObstacleMotion::RandomWalk { radius_m, .. } => Track::Disc { radius_m: *radius_m },
            ObstacleMotion::KeyFrames { frames, end } => {
                let positions_m: Vec<Vec2> = frames.iter().map(|frame| frame.position_m).collect();
                lines(&positions_m, *end != KeyFrameEnd::Stop)
            }
        }
    }

    /// The places where it really goes: its track, or a point if its speed is 0.
    pub(super) fn actual_track(&self) -> Track {
        if self.motion.is_moving() { self.track() } else { Track::Point }
    }

    /// The corners of its path, in m, starting with its position, and whether the path is closed. `None` for motions without
    /// a path.
    #[must_use]
    pub fn path_m(&self) -> Option<(Vec<Vec2>, bool)> {
        match self.track() {
            Track::Lines { corners_m, closed } => Some((corners_m, closed)),
            _ => None,
        }
    }

    /// Speed of the obstacle's origin, in m/s; of random walks, pedestrians and key frames, the highest. Of a range of speeds,
    /// the middle counts.
    #[must_use]
    pub fn origin_speed_m_s(&self) -> f32 {
        self.origin_speed_at(self.motion.speed())
    }

    /// The speed of the obstacle's origin, in m/s, if the motion has this speed.
    pub(super) fn origin_speed_at(&self, speed: MotionSpeed) -> f32 {
        match speed {
            MotionSpeed::AtRest => 0.0,
            MotionSpeed::Translation(speed_m_s) => speed_m_s.abs(),
            MotionSpeed::Variable => self.legs().filter_map(Leg::speed_m_s).fold(0.0, f64::max) as f32,
            MotionSpeed::Revolution { centre_m, speed_rad_s } => {
                (speed_rad_s * self.distance_to(centre_m)).abs()
            }
        }
    }

    /// Upper bound on the speed of any point of the obstacle, in m/s. It is negative if the motion's speed is. Of a range of
    /// speeds, the middle counts, so the bound holds only for a scenario without ranges, such as that of an episode.
    #[must_use]
    pub fn max_speed_m_s(&self) -> f32 {
        self.max_speed_at(self.motion.speed())
    }

    /// The bound of [`Obstacle::max_speed_m_s`], if the motion has this speed.
    pub(super) fn max_speed_at(&self, speed: MotionSpeed) -> f32 {
        match speed {
            MotionSpeed::AtRest => 0.0,
            MotionSpeed::Translation(speed_m_s) => speed_m_s,
            MotionSpeed::Variable => self.origin_speed_m_s(),
            MotionSpeed::Revolution { centre_m, speed_rad_s } => {
                // A circle that rotates about its own centre approaches nothing.
                let turning_m =
                    if self.shape.has_orientation() { self.shape.bounding_radius_m() } else { 0.0 };
                speed_rad_s * (self.distance_to(centre_m) + turning_m)
            }
        }
    }

    /// The legs between key frames; none for other motions.
    pub(super) fn legs(&self) -> impl Iterator<Item = Leg> {
        let (frames, end) = match &self.motion {
            ObstacleMotion::KeyFrames { frames, end } => (frames.as_slice(), *end),
            _ => (&[][..], KeyFrameEnd::Stop),
        };
        key_frames::legs(self.position_m, frames, end)
    }

    /// Distance of the obstacle's origin at step 0 from `centre_m`, in m.
    pub(super) fn distance_to(&self, centre_m: Vec2) -> f32 {
        length(self.position_m.x - centre_m.x, self.position_m.y - centre_m.y)
    }
}
