//! Obstacles. A moving obstacle's pose is a function of the arena's clock alone; a pedestrian's depends on the previous step.
//! Generated obstacles are replaced when an episode begins.
//!
//! In: the arena's [`Clock`], [`ArenaLayout`] and [`Pedestrians`]. Out: the poses of kinematic bodies, which neither drift nor
//! get pushed, and the shapes and poses of generated obstacles.

use bevy::prelude::*;
use bevy_rapier2d::prelude::*;
use bevy_rapier2d::rapier::math::{Pose as BodyPose, Rotation, Vector};

use super::colliders::shared_shape;
use super::physics::Bodies;
use crate::scenario::{IndexedScenario, pose_at};
use crate::task::{ArenaLayout, Clock, Episode, Pedestrians, PendingReset, Pose, Twist};

/// The components of an arena that [`advance`] reads and writes.
type Advanced = (
    &'static mut Clock,
    &'static mut Pedestrians,
    &'static ArenaLayout,
    &'static Bodies,
    &'static Pose,
    &'static Twist,
    &'static Episode,
    &'static mut RapierRigidBodySet,
);

/// Set `Actuate` of a control step: advances the clock and the pedestrians, and sets the pose of every moving obstacle after this step.
pub(super) fn advance(mut arenas: Query<Advanced>) {
    for (mut clock, mut pedestrians, layout, bodies, pose, twist, episode, mut set) in &mut arenas {
        if episode.inactive {
            continue;
        }
        clock.0 += 1;
        if !pedestrians.0.is_empty() {
            let (sin, cos) = libm::sincosf(pose.heading_rad);
            let velocity_m_s = Vec2::new(cos, sin) * twist.v_m_s;
            pedestrians.0.advance(&layout.scenario, (Vec2::new(pose.x_m, pose.y_m), velocity_m_s));
        }
        let layout = layout.indexed(&pedestrians);
        for &(body, obstacle) in &bodies.moving {
            if let Some(body) = set.bodies.get_mut(body) {
                body.set_next_kinematic_position(body_pose(layout, obstacle, *clock));
            }
        }
    }
}

/// Set `Place` of a reset: places the generated obstacles of a new episode. Places the moving obstacles, too, if the reset has set
/// the clock, or if a new episode begins and there are pedestrians, or obstacles whose speeds may have changed.
pub(super) fn place(
    mut arenas: Query<(
        &Clock,
        &Pedestrians,
        &ArenaLayout,
        &mut Bodies,
        &Episode,
        &mut RapierRigidBodySet,
        &mut RapierContextColliders,
    )>,
) {
    for (clock, pedestrians, layout, mut bodies, episode, mut set, mut colliders) in &mut arenas {
        let begins = episode.pending_reset.begins_episode();
        if begins {
            place_generated_obstacles(layout, &mut bodies, &mut colliders);
        }
        let may_jump = || !pedestrians.0.is_empty() || layout.written.has_ranges();
        if episode.pending_reset == PendingReset::Full || begins && may_jump() {
            place_bodies(layout.indexed(pedestrians), *clock, &bodies, &mut set, &mut colliders);
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
            collider.set_position(as_body_pose(pose_at(obstacle, 0, layout.scenario.task.control_period_s)));
            bodies.solids.push(handle);
        }
    }
    bodies.index_generated(&colliders.colliders, layout.scenario.lidar.max_range_m);
}

/// Moves the moving obstacles' bodies, and with them the colliders that the LIDAR senses, to their poses at `clock`.
pub(super) fn place_bodies(
    layout: IndexedScenario,
    clock: Clock,
    bodies: &Bodies,
    set: &mut RapierRigidBodySet,
    colliders: &mut RapierContextColliders,
) {
    for &(body, obstacle) in &bodies.moving {
        if let Some(body) = set.bodies.get_mut(body) {
            let pose = body_pose(layout, obstacle, clock);
            body.set_position(pose, true);
            body.set_next_kinematic_position(pose);
        }
    }
    set.propagate_modified_body_positions_to_colliders(colliders);
}

/// The pose of the obstacle with index `obstacle`.
fn body_pose(layout: IndexedScenario, obstacle: usize, clock: Clock) -> BodyPose {
    as_body_pose(layout.pose_at(obstacle, clock.0))
}

/// Converts a pose in m and rad to rapier's.
fn as_body_pose((x, y, rotation): (f32, f32, f32)) -> BodyPose {
    let (sin, cos) = libm::sincosf(rotation);
    BodyPose::from_parts(Vector::new(x, y), Rotation::from_cos_sin_unchecked(cos, sin))
}
