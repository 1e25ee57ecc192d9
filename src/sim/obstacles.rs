//! Obstacles: where a moving one is, is a function of the arena's step count alone; generated ones are put up anew when an
//! episode begins.
//!
//! In: the arena's [`Clock`] and its [`ArenaLayout`]. Out: the next position of its kinematic bodies, which neither drift nor get
//! pushed; and generated obstacles in their new shapes and places.

use bevy::prelude::*;
use bevy_rapier2d::prelude::*;
use bevy_rapier2d::rapier::math::{Pose as BodyPose, Rotation, Vector};

use super::physics::{self, Bodies};
use crate::scenario::{Obstacle, ObstacleMotion, Scenario, pose_at};
use crate::task::{ArenaLayout, Clock, CurrentScenario, Episode, PendingReset};

/// `Actuate`: the clock advances, and every moving obstacle is told where it will be after this step.
pub(super) fn advance(
    scenario: Res<CurrentScenario>,
    mut arenas: Query<(&mut Clock, &Bodies, &Episode, &mut RapierRigidBodySet)>,
) {
    for (mut clock, bodies, episode, mut set) in &mut arenas {
        if episode.inactive {
            continue;
        }
        clock.0 += 1;
        for (index, obstacle) in moving(&scenario.0) {
            if let Some(body) = bodies.obstacles[index].and_then(|body| set.bodies.get_mut(body)) {
                body.set_next_kinematic_position(body_pose(&scenario.0, obstacle, *clock));
            }
        }
    }
}

/// `Place`: what was generated for a new episode is put up, and in a fresh or rewound arena the moving obstacles are put
/// where the clock says.
pub(super) fn place(
    scenario: Res<CurrentScenario>,
    mut arenas: Query<(
        &Clock,
        &ArenaLayout,
        &mut Bodies,
        &Episode,
        &mut RapierRigidBodySet,
        &mut RapierContextColliders,
    )>,
) {
    for (clock, room, mut bodies, episode, mut set, mut colliders) in &mut arenas {
        if episode.pending_reset.begins_episode() {
            place_generated_obstacles(&scenario.0, room, &mut bodies, &mut colliders);
        }
        if episode.pending_reset == PendingReset::Full {
            place_bodies(room, *clock, &bodies, &mut set, &mut colliders);
        }
    }
}

/// Gives the colliders for what `scenario` generates the shapes and places that `room` has; the others are taken away.
pub(super) fn place_generated_obstacles(
    scenario: &Scenario,
    room: &ArenaLayout,
    bodies: &mut Bodies,
    colliders: &mut RapierContextColliders,
) {
    if bodies.generated.is_empty() {
        return;
    }
    bodies.solids.retain(|solid| !bodies.generated.contains(solid));
    let generated = room.scenario.obstacles.get(scenario.obstacles.len()..).unwrap_or_default();
    let mut obstacles = generated.iter();
    for &handle in &bodies.generated {
        let Some(collider) = colliders.colliders.get_mut(handle) else { continue };
        let obstacle = obstacles.next();
        collider.set_enabled(obstacle.is_some());
        if let Some(obstacle) = obstacle {
            collider.set_shape(physics::shape(&obstacle.shape));
            collider.set_position(body_pose(&room.scenario, obstacle, Clock(0)));
            bodies.solids.push(handle);
        }
    }
}

/// Puts the moving obstacles, and the colliders that the LIDAR sees, where the clock says.
pub(super) fn place_bodies(
    room: &ArenaLayout,
    clock: Clock,
    bodies: &Bodies,
    set: &mut RapierRigidBodySet,
    colliders: &mut RapierContextColliders,
) {
    let scenario = &*room.scenario;
    for (index, obstacle) in moving(scenario) {
        if let Some(body) =
            bodies.obstacles.get(index).copied().flatten().and_then(|body| set.bodies.get_mut(body))
        {
            let pose = body_pose(scenario, obstacle, clock);
            body.set_position(pose, true);
            body.set_next_kinematic_position(pose);
        }
    }
    set.propagate_modified_body_positions_to_colliders(colliders);
}

fn moving(scenario: &Scenario) -> impl Iterator<Item = (usize, &Obstacle)> {
    scenario.obstacles.iter().enumerate().filter(|(_, obstacle)| obstacle.motion != ObstacleMotion::Static)
}

fn body_pose(scenario: &Scenario, obstacle: &Obstacle, clock: Clock) -> BodyPose {
    let (x, y, rotation) = pose_at(obstacle, clock.0, scenario.task.control_period_s);
    let (sin, cos) = libm::sincosf(rotation);
    BodyPose::from_parts(Vector::new(x, y), Rotation::from_cos_sin_unchecked(cos, sin))
}
