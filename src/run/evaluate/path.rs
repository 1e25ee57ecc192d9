//! The measures of the paths that robots take in evaluation episodes.

use bevy::math::vec2;
use bevy::prelude::*;
use serde::{Deserialize, Serialize};

use crate::scenario::{IndexedScenario, Solid};
use crate::task::{Arena, ArenaLayout, Clock, EpisodeEnd, Pedestrians, Pose, Scan};

/// The measures of the path that the robot took in an episode.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct PathMeasures {
    /// Length of the path in m: the sum of the straight-line distances between the robot's positions after consecutive control
    /// steps.
    pub length_m: f64,
    /// Smallest distance in m between the robot's body and the surface of a wall or an obstacle, at the start and after each
    /// control step; 0 if they touched.
    pub min_clearance_m: f32,
    /// What the robot collided with: the wall or obstacle that was nearest when the episode ended. `None` without a collision.
    pub hit: Option<Solid>,
}

/// The components of an arena that are measured.
type Measured = (
    &'static Arena,
    (&'static ArenaLayout, &'static Pedestrians),
    &'static Pose,
    &'static Clock,
    &'static Scan,
);

/// Reads the robots' poses and clearances from the world.
pub(super) struct PathQuery(QueryState<Measured>);

impl PathQuery {
    pub(super) fn new(world: &mut World) -> Self {
        Self(world.query())
    }

    /// Calls `each` with the index of every arena, the robot's pose, and a function that measures the robot's clearance, which
    /// takes time in large scenarios.
    pub(super) fn read(&mut self, world: &World, mut each: impl FnMut(usize, &Pose, &dyn Fn() -> Clearance)) {
        for (arena, (layout, pedestrians), pose, clock, scan) in self.0.iter(world) {
            each(arena.0, pose, &|| Clearance::new(layout.indexed(pedestrians), pose, *clock, scan));
        }
    }
}

/// The distance between a robot's body and the nearest wall or obstacle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Clearance {
    pub(super) distance_m: f32,
    nearest: Solid,
}

impl Clearance {
    pub(super) fn new(layout: IndexedScenario, pose: &Pose, clock: Clock, scan: &Scan) -> Self {
        let robot = &layout.scenario.robot;
        let (nearest, gap_m) = if robot.shape.is_some() {
            layout.nearest_to_body((pose.x_m, pose.y_m, pose.heading_rad), clock.0)
        } else {
            let (nearest, distance_m) = layout.nearest(vec2(pose.x_m, pose.y_m), clock.0);
            (nearest, (distance_m - robot.radius_m).max(0.0))
        };
        Self { distance_m: if scan.touching { 0.0 } else { gap_m }, nearest }
    }
}

/// The path of a robot in an episode that has not ended.
#[derive(Clone, Copy, Debug)]
pub(super) struct PathTracker {
    measures: PathMeasures,
    pose: Pose,
    nearest: Solid,
}

impl PathTracker {
    pub(super) fn new(start: &Pose, clearance: Clearance) -> Self {
        let measures = PathMeasures { length_m: 0.0, min_clearance_m: clearance.distance_m, hit: None };
        Self { measures, pose: *start, nearest: clearance.nearest }
    }

    /// Adds a control step.
    pub(super) fn add(&mut self, pose: &Pose, clearance: Clearance) {
        let (dx, dy) =
            (f64::from(pose.x_m) - f64::from(self.pose.x_m), f64::from(pose.y_m) - f64::from(self.pose.y_m));
        self.measures.length_m += libm::hypot(dx, dy);
        self.measures.min_clearance_m = self.measures.min_clearance_m.min(clearance.distance_m);
        (self.pose, self.nearest) = (*pose, clearance.nearest);
    }

    /// The measures of the whole path, after an episode that ended for the reason `end`.
    pub(super) fn finish(&self, end: EpisodeEnd) -> PathMeasures {
        PathMeasures { hit: (end == EpisodeEnd::Collided).then_some(self.nearest), ..self.measures }
    }
}
