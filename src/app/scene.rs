//! The scene: everything visible in the arenas, extracted from the world once per frame.
//!
//! In: the ECS, read-only (`extract.rs`). Out: plain data. The screen draws from a [`Scene`] and has no access to the world, so
//! no view can affect the training.

use std::sync::Arc;

use crate::drivers::DriverPlan;
use crate::scenario::{Motion, Scenario};
use crate::task::{Goal, Pose};

/// How a path ended. A training episode may have many paths, one per goal.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrailEnd {
    /// The goal was reached.
    Reached,
    /// The robot collided.
    Collided,
    /// The time limit was reached.
    TimedOut,
}

/// The path driven towards one goal.
#[derive(Clone, Debug, PartialEq)]
pub struct Trail {
    /// Positions at the start and after each control step, in m.
    pub points_m: Vec<[f32; 2]>,
    /// How it ended.
    pub end: TrailEnd,
}

/// The outcomes of the goals that a driver attempted.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Score {
    /// Goals reached.
    pub reached: u32,
    /// Goals missed by a collision.
    pub collided: u32,
    /// Goals missed at the time limit.
    pub timed_out: u32,
    /// Total simulated time to the goals reached, in s.
    pub reached_time_s: f64,
}

impl Score {
    /// Goals attempted.
    #[must_use]
    pub fn attempts(&self) -> u32 {
        self.reached + self.collided + self.timed_out
    }

    /// Fraction of attempted goals that were reached, 0 to 1; `None` before the first outcome.
    #[must_use]
    pub fn success_rate(&self) -> Option<f64> {
        (self.attempts() > 0).then(|| f64::from(self.reached) / f64::from(self.attempts()))
    }

    /// Mean simulated time to a goal that was reached, in s; `None` before the first.
    #[must_use]
    pub fn mean_time_s(&self) -> Option<f64> {
        (self.reached > 0).then(|| self.reached_time_s / f64::from(self.reached))
    }
}

/// The driver of an arena.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DriverLabel {
    /// The network in training, exploring.
    Learner,
    /// A greedy policy, or a classical driver.
    Policy {
        /// Its name.
        name: String,
        /// Where it comes from, in a few words; may be empty.
        origin: String,
    },
    /// The user.
    User,
}

/// The visible state of one arena.
#[derive(Clone, Debug, PartialEq)]
pub struct ArenaScene {
    /// The scenario as it is laid out in this arena, with generated obstacles.
    pub scenario: Arc<Scenario>,
    /// The same without generated obstacles.
    pub written: Arc<Scenario>,
    /// The scenario of the set that the episode is in, by name, with the level's seed if it is generated; `None` without a set.
    pub set_member: Option<String>,
    /// Pose of the robot, interpolated between the last two control steps.
    pub pose: Pose,
    /// The current goal.
    pub goal: Goal,
    /// Pose (x in m, y in m, rotation in rad) of each obstacle of `scenario`, interpolated like `pose`.
    pub obstacles: Vec<(f32, f32, f32)>,
    /// Ranges of the last scan in m, as measured, by beam.
    pub ranges_m: Vec<f32>,
    /// Pose of the robot at the scan. It is not interpolated.
    pub scan_pose: Pose,
    /// The driver.
    pub driver: DriverLabel,
    /// The motions of the driver's actions.
    pub motions: Vec<Motion>,
    /// The last action: an index into `motions`.
    pub action: usize,
    /// Whether the last action was random.
    pub explored: bool,
    /// Q-values of the last decision, one per element of `motions`; empty if no network decided.
    pub q_values: Vec<f32>,
    /// The driver's map and its planned path, if it plans one.
    pub plan: Option<DriverPlan>,
    /// Path towards the current goal, oldest point first, in m.
    pub path_m: Vec<[f32; 2]>,
    /// Earlier paths, oldest first.
    pub trails: Vec<Trail>,
    /// Outcomes since the driver took over.
    pub score: Score,
    /// Whether the arena is inactive: its episode has ended, and nothing in it moves.
    pub inactive: bool,
}

/// A scalar for each cell of a grid over the bounding box of the enclosure.
#[derive(Clone, Debug, PartialEq)]
pub struct ScalarField {
    /// Number of cells along x and y.
    pub size: [usize; 2],
    /// Lower left corner of the box, in m.
    pub min_m: [f32; 2],
    /// Upper right corner of the box, in m.
    pub max_m: [f32; 2],
    /// Values at the cell centres, row by row from the bottom, each row from the left. NaN where the robot cannot be.
    pub values: Vec<f32>,
    /// Changes whenever the values change.
    pub version: u64,
}

/// Everything visible in the arenas.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The scenario of the training run, or the first of its set, without generated obstacles.
    pub scenario: Arc<Scenario>,
    /// The arenas by index: at least one, at most the first 100.
    pub arenas: Vec<ArenaScene>,
    /// Potential U of eq. (4) for the goal of the followed arena, if its overlay is shown.
    pub potential: Option<Arc<ScalarField>>,
    /// Value V(s) for the robot of the followed arena at each position, with its current heading and goal, in units of the
    /// scaled reward. Present if its overlay is shown and a network drives in some arena.
    pub value: Option<Arc<ScalarField>>,
}
