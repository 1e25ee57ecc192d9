//! The components of an arena's entity: robot, scan, goal, episode and random streams.
//!
//! In a control step, [`sim`](crate::sim) writes [`Pose`], [`Twist`] and [`Scan`], and `outcome.rs` writes [`Episode`].
//! `reset.rs` draws new goals and starts, and begins new episodes. Positions are in the arena's frame, with the origin at the
//! centre of a rectangular enclosure.

use std::collections::VecDeque;
use std::sync::{Arc, OnceLock};

use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use super::reward::{GoalDistance, Potential, RewardConfig, RewardTerms};
use crate::random::{self, Stream};
use crate::scenario::{Crowd, FreeCells, Geodesic, IndexedScenario, Motion, Scenario, SpatialIndex};

/// The index of an arena: one robot in one enclosure. It is the arena's row in every batch.
#[derive(Component, Clone, Copy, Debug, PartialEq, Eq)]
pub struct Arena(pub usize);

/// The scenario of an arena, and its layout in the current episode. All systems of an arena read the scenario here.
#[derive(Component, Clone, Debug)]
pub struct ArenaLayout {
    /// The scenario as written, with its generators instead of their obstacles.
    pub written: Arc<Scenario>,
    /// The seed of the generated obstacles, of the values drawn from ranges and of random slip; 0 if the scenario has none of
    /// these.
    pub layout_seed: u64,
    /// The scenario with the generated obstacles and the drawn values ([`Scenario::with_generated_obstacles`]).
    pub scenario: Arc<Scenario>,
    /// The spatial index of `scenario`, if it has many static parts.
    pub index: Option<Arc<SpatialIndex>>,
    /// The free cells of `scenario`, once they are needed. Clones share them.
    free_cells: Arc<OnceLock<Arc<FreeCells>>>,
    /// The unit, in m, of lengths relative to the robot ([`Scenario::robot_unit_m`]).
    pub robot_unit_m: f32,
    /// The directions of the LIDAR's beams in the robot's frame: unit vectors, in the sensor's order.
    pub beams: Arc<[Vec2]>,
}

impl ArenaLayout {
    /// The layout of `scenario` without generated obstacles. Cloning it is cheaper than making it.
    #[must_use]
    pub(crate) fn as_written(scenario: &Arc<Scenario>) -> Self {
        let index = SpatialIndex::new(scenario).map(Arc::new);
        let robot_unit_m = scenario.robot_unit_m();
        Self {
            written: scenario.clone(),
            layout_seed: 0,
            scenario: scenario.clone(),
            index,
            free_cells: Arc::default(),
            robot_unit_m,
            beams: scenario.lidar.beam_directions().into(),
        }
    }

    /// Replaces the generated obstacles, the drawn values and the random slip by those of `layout_seed`. Does nothing if the
    /// scenario has none of these.
    pub(crate) fn generate(&mut self, layout_seed: u64) {
        if self.written.varies_by_episode() {
            self.layout_seed = layout_seed;
            self.scenario = Arc::new(self.written.with_generated_obstacles(layout_seed));
        }
        if !self.written.generators.is_empty() {
            self.index = SpatialIndex::new(&self.scenario).map(Arc::new);
            self.free_cells = Arc::default();
        }
    }

    /// The cells of the layout in which the robot has room.
    fn free_cells(&self) -> &Arc<FreeCells> {
        self.free_cells.get_or_init(|| Arc::new(FreeCells::new(&self.scenario)))
    }

    /// The scenario with the generated obstacles and the pedestrians, for questions about poses and clearance.
    #[must_use]
    pub fn indexed<'a>(&'a self, pedestrians: &'a Pedestrians) -> IndexedScenario<'a> {
        IndexedScenario {
            scenario: &self.scenario,
            index: self.index.as_deref(),
            crowd: Some(&pedestrians.0).filter(|crowd| !crowd.is_empty()),
        }
    }
}

/// The position and heading of the robot.
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
    /// The distance to the goal's centre, in m: d_g of eq. (8).
    #[must_use]
    pub fn distance_m(&self, goal: &Goal) -> f32 {
        libm::hypotf(goal.x_m - self.x_m, goal.y_m - self.y_m)
    }

    /// The bearing of the goal: the angle from the heading to the goal, counterclockwise positive, in rad, in (-pi, pi].
    /// phi_0 of eq. (8).
    #[must_use]
    pub fn bearing_rad(&self, goal: &Goal) -> f32 {
        wrap_angle(libm::atan2f(goal.y_m - self.y_m, goal.x_m - self.x_m) - self.heading_rad)
    }
}

/// The lengths of the shortest paths to an arena's goal. They are a function of layout and goal, computed when they are needed.
#[derive(Component, Debug, Default)]
pub struct PathLengths(Geodesic);

impl PathLengths {
    /// The distance from `pose` to the goal, in m, on which the attraction depends.
    pub(crate) fn distance_m(
        &mut self,
        reward: &RewardConfig,
        layout: &ArenaLayout,
        pose: &Pose,
        goal: &Goal,
    ) -> f32 {
        match reward.distance {
            GoalDistance::Straight => pose.distance_m(goal),
            GoalDistance::Geodesic => {
                let (goal_m, from_m) = (vec2(goal.x_m, goal.y_m), vec2(pose.x_m, pose.y_m));
                self.0.distance_m(layout.free_cells(), goal_m, from_m)
            }
        }
    }
}

/// The robot's estimate of its pose, from which it observes the goal: its true [`Pose`] unless its odometry drifts
/// ([`OdometryDrift`](crate::scenario::OdometryDrift)).
#[derive(Component, Clone, Copy, Debug, Default, PartialEq)]
pub struct EstimatedPose(pub Pose);

/// The robot's speed and turning rate according to its wheels: after the actuator lag, before slip. Zero at the start of an
/// episode. A contact that stops the body does not change it.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Twist {
    /// Speed along the heading, in m/s.
    pub v_m_s: f32,
    /// Turning rate, counterclockwise positive, in rad/s.
    pub w_rad_s: f32,
}

impl From<Twist> for Motion {
    fn from(Twist { v_m_s, w_rad_s }: Twist) -> Self {
        Self { v_m_s, w_rad_s }
    }
}

impl From<Motion> for Twist {
    fn from(Motion { v_m_s, w_rad_s }: Motion) -> Self {
        Self { v_m_s, w_rad_s }
    }
}

/// The equivalent angle in (-pi, pi], in rad.
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
    /// The reported ranges, in m, one per beam ([`beam_angle_rad`](crate::scenario::Lidar::beam_angle_rad)), with noise,
    /// dropout and latency.
    pub ranges_m: Vec<f32>,
    /// The robot's pose when the reported ranges were measured, at most `latency_steps` steps ago.
    pub sensor_pose: Pose,
    /// The smallest current range without noise and dropout, in m: d_o, which decides collisions and rewards.
    pub nearest_m: f32,
    /// Whether the robot touches something.
    pub touching: bool,
    /// The poses and ranges of the last scans, at most `latency_steps` + 1, oldest first: the first is the reported one. Empty
    /// without latency.
    pub delayed: VecDeque<(Pose, Vec<f32>)>,
}

/// The position that the robot has to reach.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Goal {
    /// Position along x, in m.
    pub x_m: f32,
    /// Position along y, in m.
    pub y_m: f32,
}

/// The pedestrians. An episode starts with them at their start positions.
#[derive(Component, Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Pedestrians(pub Crowd);

/// The number of control steps for which the arena has been simulated; a reset may set it. The poses of all moving obstacles but
/// pedestrians are a function of it.
#[derive(Component, Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Clock(pub u64);

/// The reset that an arena needs before the next step.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum PendingReset {
    /// No reset.
    #[default]
    None,
    /// A new goal. The robot stays where it is, and the episode continues.
    Goal,
    /// A new start and a new goal, drawn if no new goal is far enough from the robot. The episode continues.
    StartAndGoal,
    /// A new episode with a new start and goal.
    Episode,
    /// A new episode after the clock was set, with the moving obstacles at their poses at that time.
    Full,
    /// An update of bodies, scan and observation after an edit. Nothing is drawn, and the episode continues.
    Refresh,
}

impl PendingReset {
    /// Whether the reset may move the robot.
    #[must_use]
    pub(crate) fn moves_robot(self) -> bool {
        matches!(self, Self::StartAndGoal | Self::Episode | Self::Full | Self::Refresh)
    }

    /// Whether the reset starts a new episode.
    #[must_use]
    pub(crate) fn begins_episode(self) -> bool {
        matches!(self, Self::Episode | Self::Full)
    }
}

/// The current episode of an arena.
#[derive(Component, Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Episode {
    /// The number of control steps.
    pub steps: u32,
    /// The number of goals reached.
    pub goals: u32,
    /// The undiscounted sum of the rewards, term by term.
    pub rewards: RewardTerms,
    /// The sums of the plugins' reward terms; empty without such plugins. Checkpoints store them separately.
    #[serde(skip)]
    pub extra_rewards: Vec<f32>,
    /// The potential of eq. (4) after the last step, for the current goal.
    pub potential: Potential,
    /// The reset that is needed before the next step.
    pub pending_reset: PendingReset,
    /// Whether the arena is inactive: it is not simulated until it is reset.
    pub inactive: bool,
}

/// The random streams of an arena. They depend on the seed and the arena's index alone.
#[derive(Component, Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Streams {
    /// Layout seeds, starts and goals.
    pub placement: Stream,
    /// LIDAR noise and dropout. The choice of the predictions to drop also depends on its state, but draws nothing from it.
    pub sensor: Stream,
}

impl Streams {
    /// The streams of arena `index` in the run with `seed`.
    #[must_use]
    pub fn new(seed: u64, index: u64) -> Self {
        Self {
            placement: random::stream(seed, "places", index),
            sensor: random::stream(seed, "sensor", index),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use core::f32::consts::PI;

    #[test]
    fn the_bearing_is_the_angle_from_the_heading_to_the_goal() {
        let goal = Goal { x_m: 0.0, y_m: 2.0 };
        let east = Pose { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 };
        assert_eq!(east.distance_m(&goal), 2.0);
        assert!((east.bearing_rad(&goal) - PI / 2.0).abs() < 1e-6, "the goal lies to the left");
        let south_west = Pose { heading_rad: -3.0 * PI / 4.0, ..east };
        // The shortest rotation from -135 degrees to 90 degrees is -135 degrees.
        assert!((south_west.bearing_rad(&goal) + 3.0 * PI / 4.0).abs() < 1e-5);
    }

    #[test]
    fn wrapped_angles_are_in_range_and_equivalent() {
        for k in -50..50 {
            for offset in [-3.1_f32, -1.0, 0.0, 0.5, 3.1] {
                let wrapped = wrap_angle(offset + k as f32 * 2.0 * PI);
                assert!(wrapped > -PI && wrapped <= PI, "{wrapped}");
                assert!((wrapped - offset).abs() < 1e-3, "{offset} rad plus {k} turns became {wrapped} rad");
            }
        }
    }
}
