//! Obstacles: the pose of a moving obstacle is a function of the arena's clock alone. Generated obstacles are replaced when
//! an episode begins.
//!
//! In: the arena's [`Clock`] and [`ArenaLayout`]. Out: the poses of kinematic bodies, which neither drift nor get pushed,
//! and the shapes and poses of generated obstacles.

use bevy::prelude::*;
use bevy_rapier2d::prelude::*;
use bevy_rapier2d::rapier::math::{Pose as BodyPose, Rotation, Vector};
use bevy_rapier2d::rapier::prelude::RigidBodyHandle;

use super::colliders::shared_shape;
use super::physics::Bodies;
use crate::scenario::{Obstacle, Scenario, pose_at};
use crate::task::{ArenaLayout, Clock, Episode, PendingReset};

/// `Actuate`: advances the clock, and sets the pose of every moving obstacle after this step.
pub(super) fn advance(
    mut arenas: Query<(&mut Clock, &ArenaLayout, &Bodies, &Episode, &mut RapierRigidBodySet)>,
) {
    for (mut clock, layout, bodies, episode, mut set) in &mut arenas {
        if episode.inactive {
            continue;
        }
        clock.0 += 1;
        for (body, obstacle) in moving(bodies, &layout.scenario) {
            if let Some(body) = set.bodies.get_mut(body) {
                body.set_next_kinematic_position(body_pose(&layout.scenario, obstacle, *clock));
            }
        }
    }
}

/// `Place`: places the generated obstacles of a new episode. If the clock was set or their speeds may have changed, also places
/// the moving obstacles.
pub(super) fn place(
    mut arenas: Query<(
        &Clock,
        &ArenaLayout,
        &mut Bodies,
        &Episode,
        &mut RapierRigidBodySet,
        &mut RapierContextColliders,
    )>,
) {
    for (clock, layout, mut bodies, episode, mut set, mut colliders) in &mut arenas {
        if episode.pending_reset.begins_episode() {
            place_generated_obstacles(layout, &mut bodies, &mut colliders);
        }
        let has_new_speeds = || episode.pending_reset.begins_episode() && layout.written.has_ranges();
        if episode.pending_reset == PendingReset::Full || has_new_speeds() {
            place_bodies(layout, *clock, &bodies, &mut set, &mut colliders);
        }
    }
}

/// Gives the colliders reserved for generated obstacles the shapes and poses of `layout`, and disables the unused ones.
pub(super) fn place_generated_obstacles(
    layout: &ArenaLayout,
    bodies: &mut Bodies,
    colliders: &mut RapierContextColliders,
) {
    if bodies.generated.is_empty() {
        return;
    }
    bodies.solids.retain(|solid| !bodies.generated.contains(solid));
    let generated = layout.scenario.obstacles.get(bodies.obstacles.len()..).unwrap_or_default();
    let mut obstacles = generated.iter();
    for &handle in &bodies.generated {
        let Some(collider) = colliders.colliders.get_mut(handle) else { continue };
        let obstacle = obstacles.next();
        collider.set_enabled(obstacle.is_some());
        if let Some(obstacle) = obstacle {
            collider.set_shape(shared_shape(&obstacle.shape));
            collider.set_position(body_pose(&layout.scenario, obstacle, Clock(0)));
            bodies.solids.push(handle);
        }
    }
    bodies.index_generated(&colliders.colliders, layout.scenario.lidar.max_range_m);
}

/// Places the moving obstacles, and the colliders that the LIDAR senses, at their poses at `clock`.
pub(super) fn place_bodies(
    layout: &ArenaLayout,
    clock: Clock,
    bodies: &Bodies,
    set: &mut RapierRigidBodySet,
    colliders: &mut RapierContextColliders,
) {
    let scenario = &*layout.scenario;
    for (body, obstacle) in moving(bodies, scenario) {
        if let Some(body) = set.bodies.get_mut(body) {
            let pose = body_pose(scenario, obstacle, clock);
            body.set_position(pose, true);
            body.set_next_kinematic_position(pose);
        }
    }
    set.propagate_modified_body_positions_to_colliders(colliders);
}

/// The moving obstacles and their bodies.
fn moving<'a>(
    bodies: &'a Bodies,
    scenario: &'a Scenario,
) -> impl Iterator<Item = (RigidBodyHandle, &'a Obstacle)> {
    bodies.obstacles.iter().zip(&scenario.obstacles).filter_map(|(body, obstacle)| Some(((*body)?, obstacle)))
}

fn body_pose(scenario: &Scenario, obstacle: &Obstacle, clock: Clock) -> BodyPose {
    let (x, y, rotation) = pose_at(obstacle, clock.0, scenario.task.control_period_s);
    let (sin, cos) = libm::sincosf(rotation);
    BodyPose::from_parts(Vector::new(x, y), Rotation::from_cos_sin_unchecked(cos, sin))
}
