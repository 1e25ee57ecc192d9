//! Contact: when in a step the robot first touches something.
//!
//! In: the step that rapier has made, and where the robot was to go in it. Out: the part of the step before the first touch,
//! and whether the body may rest where rapier put it.
//!
//! Rapier alone does not tell. It sees obstacles come from 2 mm away, and looks one second ahead: what drives or turns fast
//! passes over a small robot, and a step of ten seconds slides along a wall and off its end. And it stops a body at
//! the plane before a thing, also where it would pass beside it. So the way is gone through here, with both in motion,
//! from distance to distance: nobody can meet before they have gone what lies between them.

use bevy::prelude::*;
use bevy_rapier2d::rapier::prelude::{Collider, ColliderSet, TypedShape};

use super::lidar::polygon_contains;
use super::physics::Bodies;
use crate::scenario::polygon::{distance_to_segment, sides};
use crate::scenario::{Obstacle, ObstacleMotion, Scenario, pose_at};
use crate::task::Clock;

/// Bodies nearer than this, in m, touch: rapier rests a body a hair off what stops it.
const CONTACT_MARGIN_M: f32 = 0.0005;
/// So deep, in m, rapier may leave a robot in what has stopped it.
const MAX_PENETRATION_M: f32 = 0.001;
/// The least that is gone at once, in m: so much earlier or later is a touch told.
const MIN_ADVANCE_M: f32 = 0.0001;

/// A step of one arena that rapier has just made.
pub(super) struct ContactQuery<'a> {
    pub scenario: &'a Scenario,
    pub colliders: &'a ColliderSet,
    pub bodies: &'a Bodies,
    /// After the step.
    pub clock: Clock,
    /// Where the robot's middle was before it, in m.
    pub from: Vec2,
}

impl ContactQuery<'_> {
    /// The part of the step, 0 to 1, after which the robot first touches something, if it goes straight to `to`.
    pub(super) fn first_contact(&self, to: Vec2) -> Option<f32> {
        self.first_within(to, self.scenario.robot.radius_m + CONTACT_MARGIN_M)
    }

    /// Whether `end`, where rapier has put a robot that was to go to `to`, is where it may rest: at something, in nothing,
    /// past nothing, and no farther away than it was to go.
    pub(super) fn is_resting_contact(&self, end: Vec2, to: Vec2) -> bool {
        let radius_m = self.scenario.robot.radius_m;
        let touches = |solid: &Collider| distance(solid, end) <= radius_m + CONTACT_MARGIN_M;
        let mut solids = self.bodies.solids.iter().filter_map(|&solid| self.colliders.get(solid));
        (end - self.from).length() <= (to - self.from).length() * (1.0 + 1e-6) + 1e-6
            && solids.any(touches)
            && self.first_within(end, radius_m - MAX_PENETRATION_M).is_none()
    }

    /// The part of the step after which something is first within `reach_m` of the robot's middle.
    fn first_within(&self, to: Vec2, reach_m: f32) -> Option<f32> {
        let solids = self.bodies.solids.iter().enumerate();
        let first = solids.filter_map(|(index, &handle)| {
            let solid = self.colliders.get(handle)?;
            // The scenario's obstacles are the first of the solids; what comes after them stands.
            let obstacle = self.scenario.obstacles.get(index);
            let most_m = (to - self.from).length() + obstacle.map_or(0.0, |o| self.most_m(o));
            if distance(solid, to) - reach_m > most_m {
                return None;
            }
            let way = obstacle.map_or(ObstacleTrajectory::None, |obstacle| self.way(obstacle));
            let mut part = 0.0;
            loop {
                let at = way.as_seen(self.from.lerp(to, part), 1.0 - part);
                let gap_m = distance(solid, at) - reach_m;
                if gap_m <= 0.0 {
                    return Some(part);
                }
                if part >= 1.0 {
                    return None;
                }
                part = (part + (gap_m.max(MIN_ADVANCE_M) / most_m).max(f32::EPSILON)).min(1.0);
            }
        });
        first.reduce(f32::min)
    }

    /// The farthest that any point of an obstacle goes in a step, in m.
    fn most_m(&self, obstacle: &Obstacle) -> f32 {
        let speed_m_s = obstacle.max_speed_m_s();
        // (And the rounding of its coordinates.)
        if speed_m_s == 0.0 {
            0.0
        } else {
            speed_m_s.abs() * self.scenario.task.control_period_s + MIN_ADVANCE_M
        }
    }

    fn way(&self, obstacle: &Obstacle) -> ObstacleTrajectory {
        let period_s = self.scenario.task.control_period_s;
        match obstacle.motion {
            ObstacleMotion::Static => ObstacleTrajectory::None,
            ObstacleMotion::Orbit { centre_m, speed_rad_s } => {
                ObstacleTrajectory::Round { centre: centre_m, angle_rad: speed_rad_s * period_s }
            }
            _ => {
                let at = |step| {
                    let (x, y, _) = pose_at(obstacle, step, period_s);
                    Vec2::new(x, y)
                };
                ObstacleTrajectory::Straight(at(self.clock.0) - at(self.clock.0.saturating_sub(1)))
            }
        }
    }
}

/// How an obstacle has come in this step to where it stands now.
enum ObstacleTrajectory {
    None,
    /// Evenly, so far, in m.
    Straight(Vec2),
    /// Evenly round a point, through an angle.
    Round {
        centre: Vec2,
        angle_rad: f32,
    },
}

impl ObstacleTrajectory {
    /// What was at `at` when a part `left` of the step was to come, seen as if the obstacle had been where it is now.
    fn as_seen(&self, at: Vec2, left: f32) -> Vec2 {
        match *self {
            Self::None => at,
            Self::Straight(way) => at + way * left,
            Self::Round { centre, angle_rad } => {
                let (sin, cos) = libm::sincosf(angle_rad * left);
                centre + Vec2::new(cos, sin).rotate(at - centre)
            }
        }
    }
}

/// From a point to a solid, in m; 0 within it.
fn distance(solid: &Collider, at: Vec2) -> f32 {
    let at = solid.position().inverse_transform_point(at);
    match solid.shape().as_typed_shape() {
        // By its sides: parry's own comes nearer step by step, and from afar ends millimetres off.
        TypedShape::ConvexPolygon(polygon) if polygon_contains(polygon, at) => 0.0,
        TypedShape::ConvexPolygon(polygon) => sides(polygon.points())
            .map(|(from, to)| distance_to_segment(from, to, at))
            .fold(f32::INFINITY, f32::min),
        _ => solid.shape().distance_to_local_point(at, true),
    }
}
