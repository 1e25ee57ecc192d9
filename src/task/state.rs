//! The state of one arena, as the task sees it: components on the arena's entity.
//!
//! In: `world/` writes [`Pose`], [`Twist`] and [`Scan`], `reset.rs` writes [`Goal`] and [`Episode`]. Out: everything else
//! reads them. Positions are in the arena's own frame, whose origin is the enclosure's centre.

use std::collections::VecDeque;
use std::sync::Arc;

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::ObservationLayout;
use super::reward::{Potential, RewardTerms};
use crate::random::{self, Stream};
use crate::scenario::Scenario;

/// An arena: one robot in one enclosure. The number is its row in every batch.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arena(pub usize);

/// The world as it stands in this arena: the scenario, with the layout of this episode where it has generators.
#[derive(Component, Clone, Debug)]
pub struct ArenaLayout {
    /// The layout's number; 0 where there are no generators.
    pub layout_seed: u64,
    /// The scenario with that layout ([`Scenario::with_generated_obstacles`]).
    pub scenario: Arc<Scenario>,
}

impl ArenaLayout {
    /// The world of `scenario` with layout number `layout_seed`, which only generators ask for.
    #[must_use]
    pub fn new(scenario: &Arc<Scenario>, layout_seed: u64) -> Self {
        if scenario.generators.is_empty() {
            return Self { layout_seed: 0, scenario: scenario.clone() };
        }
        Self { layout_seed, scenario: Arc::new(scenario.with_generated_obstacles(layout_seed)) }
    }
}

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
    /// Distance to a goal's centre, in m: d_g of eq. (8).
    #[must_use]
    pub fn distance_m(&self, goal: &Goal) -> f32 {
        libm::hypotf(goal.x_m - self.x_m, goal.y_m - self.y_m)
    }

    /// Angle from the heading to the line to a goal, in rad, in (-pi, pi], counterclockwise positive: phi_0 of
    /// eq. (8).
    #[must_use]
    pub fn bearing_rad(&self, goal: &Goal) -> f32 {
        wrap_angle(libm::atan2f(goal.y_m - self.y_m, goal.x_m - self.x_m) - self.heading_rad)
    }
}

/// How fast the robot actually goes at this moment: what its drive has made of the motions chosen so far. At rest when
/// an episode begins. Wheels know nothing of contacts: one that stops the body leaves this as it is.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Twist {
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
    /// What the sensor reports, in m, by beam ([`beam_angle_rad`](crate::scenario::Lidar::beam_angle_rad)). Noise,
    /// dropout and latency included.
    pub ranges_m: Vec<f32>,
    /// From where that was seen: the robot's pose, `latency_steps` steps ago.
    pub sensor_pose: Pose,
    /// The smallest range without noise and dropout, in m: d_o, by which collisions and rewards are judged.
    pub nearest_m: f32,
    /// Whether the robot's body touches another.
    pub touching: bool,
    /// Scans that the policy has yet to see, oldest first, where the sensor has a latency: poses and ranges.
    pub delayed: VecDeque<(Pose, Vec<f32>)>,
}

/// The point that the robot is to reach, in m.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Goal {
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
pub enum PendingReset {
    /// Nothing: the episode goes on.
    #[default]
    None,
    /// A new goal; robot and episode go on.
    Goal,
    /// A new start and a new goal; the episode goes on. So it is after a goal where no other is far enough.
    StartAndGoal,
    /// A new episode: robot and goal are placed anew.
    Episode,
    /// As `Episode`, with the obstacles put where the clock says (a fresh arena, or a rewound clock).
    Full,
    /// Nothing is drawn: a hand has moved something, and robot, scan and observation follow. The episode goes on.
    Refresh,
}

impl PendingReset {
    /// Whether the robot is somewhere else afterwards, or may be.
    #[must_use]
    pub fn moves_robot(self) -> bool {
        matches!(self, Self::StartAndGoal | Self::Episode | Self::Full | Self::Refresh)
    }

    /// Whether a new episode begins.
    #[must_use]
    pub fn begins_episode(self) -> bool {
        matches!(self, Self::Episode | Self::Full)
    }
}

/// The running episode of an arena.
#[derive(Component, Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Episode {
    /// Control steps taken in it.
    pub steps: u32,
    /// Targets reached in it.
    pub goals: u32,
    /// The rewards so far, term by term.
    pub rewards: RewardTerms,
    /// The sums of the plugins' reward terms; empty if there are none. (Checkpoints keep them apart.)
    #[serde(skip)]
    pub extra_rewards: Vec<f32>,
    /// The potential of eq. (4) after the last step, for the present goal.
    pub potential: Potential,
    /// What is due before the next step.
    pub pending_reset: PendingReset,
    /// The arena stands still: its single navigation has ended.
    pub inactive: bool,
}

/// The random streams of an arena: they depend on the seed and the arena's number alone.
#[derive(Component, Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Streams {
    /// Starts and goals.
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
    pub twist: Twist,
    /// The last scan.
    pub scan: Scan,
    /// The last readings of plugins' sensors; empty if there are none. (Checkpoints keep them apart.)
    #[serde(skip)]
    pub readings: Vec<f32>,
    /// The present goal.
    pub goal: Goal,
    /// The obstacles' clock.
    pub clock: Clock,
    /// The layout's number ([`ArenaLayout`]).
    pub layout_seed: u64,
    /// The running episode.
    pub episode: Episode,
    /// The streams where they stand.
    pub streams: Streams,
}

/// The farthest from an arena's origin that anything in it may be, in m: twice as far as any wall.
const MAX_COORDINATE_M: f32 = 1_000.0;
/// The most that a heading is off the x axis, in rad: that of a benchmark route may be a full turn.
const MAX_HEADING_RAD: f32 = 7.0;
/// The fastest that a drive goes, in m/s and rad/s: what a scenario allows, with a little room for rounding.
const MAX_TWIST: (f32, f32) = (5.01, 20.01);
/// The longest that an episode may last, in control steps, and the farthest that a beam reaches, in m: what a scenario
/// allows at most. (Who has a training in a window may have changed its own limits since.)
const MAX_EPISODE_STEPS: u32 = 1_000_000;
const MAX_RANGE_M: f32 = 1_000.0;

impl ArenaState {
    /// Whether an arena of `scenario`, in training, can be so: what is read from a file can be anything.
    ///
    /// # Errors
    /// What cannot be.
    pub fn check(&self, scenario: &Scenario, layout: &ObservationLayout) -> Result<(), &'static str> {
        let Self { pose, twist, scan, readings, goal, clock, layout_seed: _, episode, streams } = self;
        let beams = scenario.lidar.beams;
        let within = |value: f32, most: f32| value.abs() <= most;
        let is_pose = |pose: &Pose| {
            within(pose.x_m, MAX_COORDINATE_M)
                && within(pose.y_m, MAX_COORDINATE_M)
                && within(pose.heading_rad, MAX_HEADING_RAD)
        };
        let is_range = |range: &f32| (0.0..=MAX_RANGE_M).contains(range);
        let are_ranges = |ranges: &[f32]| ranges.len() == beams && ranges.iter().all(is_range);
        let Episode { steps, goals, rewards, extra_rewards, potential, pending_reset, inactive } = episode;
        let are_finite = |values: &[f32]| values.iter().all(|value| value.is_finite());
        for (what, sane) in [
            ("the robot's pose", is_pose(pose)),
            (
                "how fast the robot goes",
                within(twist.v_m_s, MAX_TWIST.0) && within(twist.w_rad_s, MAX_TWIST.1),
            ),
            ("a scan", are_ranges(&scan.ranges_m) && is_range(&scan.nearest_m) && is_pose(&scan.sensor_pose)),
            ("the number of late scans", scan.delayed.len() <= scenario.lidar.latency_steps as usize + 1),
            ("a late scan", scan.delayed.iter().all(|(from, ranges)| is_pose(from) && are_ranges(ranges))),
            ("a sensor's readings", readings.len() == layout.extra_width() && are_finite(readings)),
            ("the goal's place", within(goal.x_m, MAX_COORDINATE_M) && within(goal.y_m, MAX_COORDINATE_M)),
            ("the clock", clock.0 < 1 << 62),
            ("the episode's length", *steps <= MAX_EPISODE_STEPS && goals <= steps),
            ("the episode's rewards", rewards.total().is_finite() && are_finite(extra_rewards)),
            ("the potential", potential.total().is_finite()),
            ("what is due", *pending_reset == PendingReset::None && !inactive),
            ("a stream", random::is_valid(&streams.places) && random::is_valid(&streams.sensor)),
        ] {
            if !sane {
                return Err(what);
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::PI;

    /// What is changed in a sound state, and what must be blamed for it.
    type Breakage = (&'static str, fn(&mut ArenaState));

    #[test]
    fn a_state_that_cannot_be_is_refused_and_what_is_wrong_is_named() {
        let mut scenario = Scenario::default();
        scenario.lidar.latency_steps = 1;
        let ranges = vec![1.0; scenario.lidar.beams];
        let sound = ArenaState {
            pose: Pose { x_m: 1.0, y_m: -1.0, heading_rad: 3.0 },
            twist: Twist { v_m_s: 0.15, w_rad_s: -1.5 },
            scan: Scan {
                ranges_m: ranges.clone(),
                sensor_pose: Pose::default(),
                nearest_m: 0.5,
                touching: false,
                delayed: VecDeque::from([(Pose::default(), ranges.clone()), (Pose::default(), ranges)]),
            },
            readings: Vec::new(),
            goal: Goal { x_m: 0.5, y_m: 0.5 },
            clock: Clock(1_000),
            layout_seed: u64::MAX,
            episode: Episode { steps: 7, goals: 1, ..Episode::default() },
            streams: Streams::new(1, 0),
        };
        assert_eq!(sound.check(&scenario, &ObservationLayout::default()), Ok(()));
        let breakages: &[Breakage] = &[
            ("the robot's pose", |s| s.pose.x_m = f32::NAN),
            ("the robot's pose", |s| s.pose.y_m = 1e9),
            ("the robot's pose", |s| s.pose.heading_rad = f32::INFINITY),
            ("how fast the robot goes", |s| s.twist.v_m_s = f32::NAN),
            ("a scan", |s| s.scan.ranges_m.truncate(3)),
            ("a scan", |s| s.scan.ranges_m[2] = -1.0),
            ("a scan", |s| s.scan.nearest_m = f32::NAN),
            ("the number of late scans", |s| s.scan.delayed.push_back((Pose::default(), vec![1.0; 24]))),
            ("a late scan", |s| s.scan.delayed[1].1.push(1.0)),
            ("a sensor's readings", |s| s.readings.push(0.0)),
            ("the goal's place", |s| s.goal.y_m = f32::NEG_INFINITY),
            ("the clock", |s| s.clock = Clock(u64::MAX)),
            ("the episode's length", |s| s.episode.steps = u32::MAX),
            ("the episode's length", |s| s.episode.goals = 8),
            ("the episode's rewards", |s| s.episode.rewards.attraction = f32::NAN),
            ("the potential", |s| s.episode.potential.repulsion = f32::INFINITY),
            ("what is due", |s| s.episode.pending_reset = PendingReset::Full),
            ("what is due", |s| s.episode.inactive = true),
        ];
        for (what, breakage) in breakages {
            let mut state = sound.clone();
            breakage(&mut state);
            assert_eq!(state.check(&scenario, &ObservationLayout::default()), Err(*what));
        }
    }

    #[test]
    fn bearing_is_the_angle_from_the_heading_to_the_target() {
        let goal = Goal { x_m: 0.0, y_m: 2.0 };
        let east = Pose { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 };
        assert_eq!(east.distance_m(&goal), 2.0);
        assert!((east.bearing_rad(&goal) - PI / 2.0).abs() < 1e-6, "the goal lies to the left");
        let south_west = Pose { heading_rad: -3.0 * PI / 4.0, ..east };
        // From -135 degrees to 90 degrees the short way is clockwise: -135 degrees.
        assert!((south_west.bearing_rad(&goal) + 3.0 * PI / 4.0).abs() < 1e-5);
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
