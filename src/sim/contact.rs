//! Contact: the moment in a step at which the robot first touches something.
//!
//! In: the step that rapier has just made, and where the robot was to go in it. Out: the fraction of the step before the
//! first contact, and whether the robot may rest where rapier stopped it.
//!
//! Rapier alone does not detect every contact. It takes an obstacle's motion into account only near the robot (its prediction
//! distance is 20 mm), and looks ahead only one second. An obstacle that moves or turns fast can pass over a small robot, and in
//! a step of ten seconds a robot slides along a wall and off its end. Rapier also stops a body at the plane in front of an
//! obstacle, even if the body would pass beside the obstacle. So this file checks the motion of robot and obstacles through the
//! step by conservative advancement: two bodies cannot touch before they have covered the distance between them.

use bevy::prelude::*;
use bevy_rapier2d::rapier::math::Pose as BodyPose;
use bevy_rapier2d::rapier::prelude::{Collider, ColliderSet, Shape, TypedShape};

use super::footprint::Sweep;
use super::physics::Bodies;
use super::ray_cast::polygon_contains;
use crate::scenario::polygon::{distance_to_segment, sides};
use crate::scenario::{IndexedScenario, MotionSpeed};
use crate::task::Clock;

/// The gap in m below which bodies count as touching. Rapier leaves a small gap when it stops a body.
const CONTACT_MARGIN_M: f32 = 0.0005;
/// The penetration in m that is tolerated where rapier stops a robot.
const MAX_PENETRATION_M: f32 = 0.001;
/// The smallest advance in m: the resolution of the moment of contact.
pub(super) const MIN_ADVANCE_M: f32 = 0.0001;

/// A step of one arena that rapier has just made.
pub(super) struct ContactQuery<'a> {
    /// The scenario with generated obstacles and pedestrians.
    pub layout: IndexedScenario<'a>,
    pub colliders: &'a ColliderSet,
    pub bodies: &'a Bodies,
    /// The arena's clock after the step.
    pub clock: Clock,
    /// The robot's centre before the step, in m.
    pub from: Vec2,
    /// The robot's heading before the step, and its change in the step, in rad.
    pub heading_rad: f32,
    pub turn_rad: f32,
}

impl ContactQuery<'_> {
    /// The fraction of the step, 0 to 1, after which the robot first touches something on the straight line to `to`.
    pub(super) fn first_contact(&self, to: Vec2) -> Option<f32> {
        let Some(footprint) = &self.bodies.footprint else {
            return self.first_within(to, self.layout.scenario.robot.radius_m + CONTACT_MARGIN_M);
        };
        let Self { from, heading_rad, turn_rad, .. } = *self;
        let sweep = Sweep { from, to, heading_rad, turn_rad };
        self.first(to, footprint.reach_m + CONTACT_MARGIN_M, |shape, obstacle, max_travel_m| {
            footprint.approach(sweep, shape, &self.trajectory_of(obstacle), CONTACT_MARGIN_M, max_travel_m)
        })
    }

    /// Whether a disc that was to go to `to` may rest at `end`, where rapier stopped it: it touches something, penetrates
    /// nothing, has passed through nothing, and has gone no farther than it was to go.
    pub(super) fn is_resting_contact(&self, end: Vec2, to: Vec2) -> bool {
        let radius_m = self.layout.scenario.robot.radius_m;
        let reach_m = radius_m + CONTACT_MARGIN_M;
        let touches = |(position, shape): PlacedShape| distance_m(position, shape, end) <= reach_m;
        let others = self.bodies.not_in_grid().filter_map(|(_, solid)| self.colliders.get(solid));
        (end - self.from).length() <= (to - self.from).length() * (1.0 + 1e-6) + 1e-6
            && (self.static_near(end, reach_m).any(touches) || others.map(placed).any(touches))
            && self.first_within(end, radius_m - MAX_PENETRATION_M).is_none()
    }

    /// The fraction of the step after which something first comes within `reach_m` of the robot's centre.
    fn first_within(&self, to: Vec2, reach_m: f32) -> Option<f32> {
        self.first(to, reach_m, |shape, obstacle, max_travel_m| {
            self.approach(shape, obstacle, to, reach_m, max_travel_m)
        })
    }

    /// The smallest fraction of the step that `approach` returns for any shape that may come within `reach_m` of the robot's
    /// centre. `approach` gets a shape, its obstacle's index if it may move, and the largest distance that it and the robot's
    /// centre together cover.
    #[inline]
    fn first(
        &self,
        to: Vec2,
        reach_m: f32,
        approach: impl Fn(PlacedShape, Option<usize>, f32) -> Option<f32>,
    ) -> Option<f32> {
        let step_m = (to - self.from).length();
        let approach = |shape: PlacedShape, obstacle: Option<usize>, max_travel_m: f32| {
            let is_near = distance_m(shape.0, shape.1, to) - reach_m <= max_travel_m;
            if is_near { approach(shape, obstacle, max_travel_m) } else { None }
        };
        let in_grid = self.static_near(to, reach_m + step_m);
        let in_grid = in_grid.filter_map(|shape| approach(shape, None, step_m));
        let others = self.bodies.not_in_grid().filter_map(|(index, handle)| {
            let shape = placed(self.colliders.get(handle)?);
            // The scenario's own obstacles come first among the solids; all others are static.
            let is_own = index < self.bodies.obstacles.len();
            let obstacle = Some(index).filter(|_| is_own);
            let max_travel_m = step_m + obstacle.map_or(0.0, |o| self.max_travel_m(o));
            approach(shape, obstacle, max_travel_m)
        });
        others.chain(in_grid).reduce(f32::min)
    }

    /// The fraction of the step after which the shape of an obstacle or a wall first comes within `reach_m` of the robot's
    /// centre. Robot and obstacle together cover at most `max_travel_m`.
    #[inline]
    fn approach(
        &self,
        (position, shape): PlacedShape,
        obstacle: Option<usize>,
        to: Vec2,
        reach_m: f32,
        max_travel_m: f32,
    ) -> Option<f32> {
        let trajectory = self.trajectory_of(obstacle);
        let mut fraction = 0.0;
        loop {
            let at = trajectory.in_obstacle_frame(self.from.lerp(to, fraction), 1.0 - fraction);
            let gap_m = distance_m(position, shape, at) - reach_m;
            if gap_m <= 0.0 {
                return Some(fraction);
            }
            if fraction >= 1.0 {
                return None;
            }
            fraction = (fraction + (gap_m.max(MIN_ADVANCE_M) / max_travel_m).max(f32::EPSILON)).min(1.0);
        }
    }

    /// The shapes in the grid at most `radius_m` from `at`, and possibly others.
    fn static_near(&self, at: Vec2, radius_m: f32) -> impl Iterator<Item = PlacedShape<'_>> {
        let near = self.bodies.static_shapes.iter().flat_map(move |shapes| shapes.near(at, radius_m));
        near.map(|shape| (&shape.position, &*shape.shape))
    }

    /// The longest distance that any point of an obstacle travels in a step, in m.
    fn max_travel_m(&self, obstacle: usize) -> f32 {
        let description = &self.layout.scenario.obstacles[obstacle];
        if description.motion.speed() == MotionSpeed::Variable {
            // The length of its trajectory in this step: the highest speed of many key frames would take long to find.
            return self.translation_m(obstacle).length() + MIN_ADVANCE_M;
        }
        let speed_m_s = description.max_speed_m_s();
        // MIN_ADVANCE_M covers the rounding of the obstacle's coordinates.
        if speed_m_s == 0.0 {
            0.0
        } else {
            speed_m_s.abs() * self.layout.scenario.task.control_period_s + MIN_ADVANCE_M
        }
    }

    #[inline]
    fn trajectory_of(&self, obstacle: Option<usize>) -> ObstacleTrajectory {
        obstacle.map_or(ObstacleTrajectory::Static, |obstacle| self.trajectory(obstacle))
    }

    fn trajectory(&self, obstacle: usize) -> ObstacleTrajectory {
        let period_s = self.layout.scenario.task.control_period_s;
        match self.layout.scenario.obstacles[obstacle].motion.speed() {
            MotionSpeed::AtRest => ObstacleTrajectory::Static,
            MotionSpeed::Revolution { centre_m, speed_rad_s } => {
                ObstacleTrajectory::Arc { centre: centre_m, angle_rad: speed_rad_s * period_s }
            }
            MotionSpeed::Translation(_) | MotionSpeed::Variable => {
                ObstacleTrajectory::Straight(self.translation_m(obstacle))
            }
        }
    }

    /// The displacement of an obstacle's origin in this step, in m.
    fn translation_m(&self, obstacle: usize) -> Vec2 {
        if let Some(pedestrian) = self.layout.pedestrian(obstacle) {
            return pedestrian.velocity_m_s * self.layout.scenario.task.control_period_s;
        }
        let at = |step| {
            let (x, y, _) = self.layout.pose_at(obstacle, step);
            Vec2::new(x, y)
        };
        at(self.clock.0) - at(self.clock.0.saturating_sub(1))
    }
}

/// The motion of an obstacle in this step, at constant speed.
pub(super) enum ObstacleTrajectory {
    Static,
    /// A translation by this vector, in m.
    Straight(Vec2),
    /// A rotation about `centre`.
    Arc {
        centre: Vec2,
        angle_rad: f32,
    },
}

impl ObstacleTrajectory {
    /// Takes a point that is at `at` when the fraction `left` of the step remains. Returns the point that has the same position
    /// relative to the obstacle at the end of the step.
    pub(super) fn in_obstacle_frame(&self, at: Vec2, left: f32) -> Vec2 {
        match *self {
            Self::Static => at,
            Self::Straight(translation) => at + translation * left,
            Self::Arc { centre, angle_rad } => {
                let (sin, cos) = libm::sincosf(angle_rad * left);
                centre + Vec2::new(cos, sin).rotate(at - centre)
            }
        }
    }
}

/// A shape and its position.
pub(super) type PlacedShape<'a> = (&'a BodyPose, &'a dyn Shape);

fn placed(solid: &Collider) -> PlacedShape<'_> {
    (solid.position(), solid.shape())
}

/// The distance from a point to a shape, in m; 0 inside the shape.
#[inline]
pub(super) fn distance_m(position: &BodyPose, shape: &dyn Shape, at: Vec2) -> f32 {
    let at = position.inverse_transform_point(at);
    match shape.as_typed_shape() {
        // Computed from the sides: parry's iterative distance is millimetres off for distant points.
        TypedShape::ConvexPolygon(polygon) if polygon_contains(polygon, at) => 0.0,
        TypedShape::ConvexPolygon(polygon) => sides(polygon.points())
            .map(|(from, to)| distance_to_segment(from, to, at))
            .fold(f32::INFINITY, f32::min),
        _ => shape.distance_to_local_point(at, true),
    }
}
