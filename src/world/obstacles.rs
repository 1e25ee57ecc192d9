//! Moving obstacles: where each is, is a function of the arena's step count alone.
//!
//! In: the arena's [`Clock`]. Out: the next position of its kinematic bodies; they neither drift nor get pushed.

use bevy::prelude::*;
use bevy_rapier2d::prelude::*;
use bevy_rapier2d::rapier::math::{Pose as BodyPose, Rotation, Vector};

use super::physics::Bodies;
use crate::scenario::{Obstacle, ObstacleMotion, Scenario, pose_at};
use crate::task::{Clock, CurrentScenario, Episode, Restart};

/// `Actuate`: the clock advances, and every moving obstacle is told where it will be after this step.
pub(super) fn advance(
    scenario: Res<CurrentScenario>,
    mut arenas: Query<(&mut Clock, &Bodies, &Episode, &mut RapierRigidBodySet)>,
) {
    for (mut clock, bodies, episode, mut set) in &mut arenas {
        if episode.parked {
            continue;
        }
        clock.0 += 1;
        for (index, obstacle) in moving(&scenario.0) {
            if let Some(body) = set.bodies.get_mut(bodies.obstacles[index]) {
                body.set_next_kinematic_position(body_pose(&scenario.0, obstacle, *clock));
            }
        }
    }
}

/// `Place`: in a fresh or rewound arena the moving obstacles are put where the clock says.
pub(super) fn place(
    scenario: Res<CurrentScenario>,
    mut arenas: Query<(&Clock, &Bodies, &Episode, &mut RapierRigidBodySet, &mut RapierContextColliders)>,
) {
    for (clock, bodies, episode, mut set, mut colliders) in &mut arenas {
        if episode.restart == Restart::Everything {
            place_bodies(&scenario.0, *clock, bodies, &mut set, &mut colliders);
        }
    }
}

/// Puts the moving obstacles, and the colliders that the LIDAR sees, where the clock says.
pub(super) fn place_bodies(
    scenario: &Scenario,
    clock: Clock,
    bodies: &Bodies,
    set: &mut RapierRigidBodySet,
    colliders: &mut RapierContextColliders,
) {
    for (index, obstacle) in moving(scenario) {
        if let Some(body) = set.bodies.get_mut(bodies.obstacles[index]) {
            let pose = body_pose(scenario, obstacle, clock);
            body.set_position(pose, true);
            body.set_next_kinematic_position(pose);
        }
    }
    set.propagate_modified_body_positions_to_colliders(colliders);
}

fn moving(scenario: &Scenario) -> impl Iterator<Item = (usize, &Obstacle)> {
    scenario.obstacles.iter().enumerate().filter(|(_, obstacle)| obstacle.motion != ObstacleMotion::Still)
}

fn body_pose(scenario: &Scenario, obstacle: &Obstacle, clock: Clock) -> BodyPose {
    let (x, y, rotation) = pose_at(obstacle, clock.0, scenario.task.control_period_s);
    let (sin, cos) = libm::sincosf(rotation);
    BodyPose::from_parts(Vector::new(x, y), Rotation::from_cos_sin_unchecked(cos, sin))
}
