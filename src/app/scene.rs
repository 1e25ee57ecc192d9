//! The scene: all that there is to see, taken from the world once a frame.
//!
//! In: the ECS, read only (`extract.rs`). Out: plain data. Everything that draws takes a [`Scene`] and nothing else of the
//! world, so no view can touch what is learnt.

use std::sync::Arc;

use crate::scenario::Scenario;
use crate::task::{Goal, Pose};

/// How a navigation ended: in a training episode there may be many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum TrailEnd {
    /// The target was reached.
    Reached,
    /// Something was hit.
    Collided,
    /// The time limit came first.
    TimedOut,
}

/// The way driven in one navigation.
#[derive(Clone, Debug, PartialEq)]
pub struct Trail {
    /// Where the robot was after each control step, in m.
    pub points_m: Vec<[f32; 2]>,
    /// How it ended.
    pub end: TrailEnd,
}

/// Who drives an arena.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum DriverLabel {
    /// The network in training, exploring.
    Learner,
    /// A policy, greedily; its name.
    Policy(String),
    /// The user.
    User,
}

/// What is to be seen of one arena.
#[derive(Clone, Debug, PartialEq)]
pub struct ArenaScene {
    /// The world as it stands in this arena: with what generators made of it, where there are some.
    pub scenario: Arc<Scenario>,
    /// The robot, between its last two poses when the pace is slow enough to see it.
    pub pose: Pose,
    /// The present target.
    pub goal: Goal,
    /// Pose (x in m, y in m, rotation in rad) of each obstacle of the room, in its order, in step with `pose`.
    pub obstacles: Vec<(f32, f32, f32)>,
    /// The last scan, in m, as the sensor reports it, by beam.
    pub ranges_m: Vec<f32>,
    /// From where it was taken; the robot may be drawn on its way there.
    pub scan_pose: Pose,
    /// Who drives.
    pub driver: DriverLabel,
    /// The last action, an index into the robot's motions.
    pub action: usize,
    /// Whether it was a random one.
    pub explored: bool,
    /// The network's Q-values at the last decision, one for each motion; empty where no network was asked.
    pub q_values: Vec<f32>,
    /// The way of the running navigation so far, oldest first, in m.
    pub path_m: Vec<[f32; 2]>,
    /// The last navigations, oldest first.
    pub trails: Vec<Trail>,
    /// How many of this arena's episodes have ended in a collision since its driver began.
    pub collisions: u32,
    /// How many goals were reached since its driver began.
    pub goals_reached: u32,
    /// Nothing moves here any more.
    pub inactive: bool,
}

/// A number for each point of a grid over the enclosure's bounding box.
#[derive(Clone, Debug, PartialEq)]
pub struct ScalarField {
    /// Grid points along x and y.
    pub size: [usize; 2],
    /// The box's lower left corner, in m.
    pub min_m: [f32; 2],
    /// The box's upper right corner, in m.
    pub max_m: [f32; 2],
    /// The values, row by row from the bottom, each row from the left, at the middle of each cell. NaN where the robot
    /// cannot be.
    pub values: Vec<f32>,
    /// Changes whenever the values do.
    pub version: u64,
}

/// What there is to see.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The world being driven in.
    pub scenario: Arc<Scenario>,
    /// Its arenas, by number; at least one, and of very many the first hundred.
    pub arenas: Vec<ArenaScene>,
    /// The potential U of eq. (4) for the followed arena's target, if it is asked for.
    pub potential: Option<Arc<ScalarField>>,
    /// The value V(s) that the network gives to the followed arena's robot if it stood there, with its heading and
    /// target, in units of reward as they are learnt; if it is asked for and there is a network.
    pub value: Option<Arc<ScalarField>>,
}
