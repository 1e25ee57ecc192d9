//! The robot: a differential drive.
//!
//! In: the commanded motion (v, w) of eq. (9). Out: the body's velocity before the physics step; its pose and [`Twist`]
//! after the step.
//!
//! A robot that drives with constant v and w for a time t follows an arc. The arc's chord has the length v t sinc(w t / 2)
//! and the direction of the heading at t / 2. So one physics step with the chord's velocity takes the robot exactly to the
//! end of the arc, unless it touches something first (`contact.rs`) and stops there.
//!
//! Usually, (v, w) is the commanded motion. With an actuator lag or limited accelerations
//! ([`Drive`](crate::scenario::Drive)), it is the mean of the actual motion over the step, and slip reduces it. That is a
//! simplification: the true path is not an arc. Its rotation and its signed length are kept, so the heading
//! after the step is exact.
//!
//! The body is a disc with locked rotation: only the wheels turn it, never a contact. The heading is integrated here,
//! with `libm`, so that its bits are the same on every platform. A body of another shape (`footprint.rs`) stops both
//! moving and turning where it first touches something.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;
use bevy_rapier2d::prelude::*;
use bevy_rapier2d::rapier::math::{Pose as BodyPose, Rotation};

use super::contact::ContactQuery;
use super::physics::Bodies;
use crate::scenario::{Motion, Scenario, Slip};
use crate::task::{
    Actions, ActiveActionSet, Arena, ArenaLayout, Clock, CommandedMotions, Episode, EstimatedPose,
    Pedestrians, Pose, Scan, Twist, wrap_angle,
};

/// The tolerance for rounding of positions: in m, and also relative to their distances from the origin.
const ROUNDING: f32 = 1e-6;

/// The constant velocity, in m/s, that takes the robot to the end of its arc in `seconds`.
#[must_use]
pub fn chord_velocity(heading_rad: f32, motion: &Motion, seconds: f32) -> Vec2 {
    let half_turn = 0.5 * motion.w_rad_s * seconds;
    let sinc = if half_turn.abs() < 1e-4 { 1.0 } else { libm::sinf(half_turn) / half_turn };
    let (sin, cos) = libm::sincosf(heading_rad + half_turn);
    Vec2::new(cos, sin) * (motion.v_m_s * sinc)
}

/// The heading after `seconds` of `motion`, in rad, in (-pi, pi].
#[must_use]
pub fn integrate_heading(heading_rad: f32, motion: &Motion, seconds: f32) -> f32 {
    wrap_angle(heading_rad + motion.w_rad_s * seconds)
}

/// What commands the robots: the action set's motions by index, or motions that the caller sets.
#[derive(SystemParam)]
pub(super) struct MotionCommands<'w> {
    actions: Res<'w, Actions>,
    action_set: Res<'w, ActiveActionSet>,
    motions: Res<'w, CommandedMotions>,
}

impl MotionCommands<'_> {
    /// The motion that is commanded in `arena`, whose scenario is `scenario`. A motion that the caller sets is limited to what
    /// the robot's minimum turning radius allows.
    fn motion(&self, arena: &Arena, scenario: &Scenario) -> Motion {
        match self.motions.0.get(arena.0).copied().flatten() {
            Some(motion) => scenario.robot.steerable(motion),
            None => self.action_set.motion(self.actions.0[arena.0], &scenario.robot),
        }
    }
}

/// The motion of a robot in a control step.
struct DrivenStep {
    /// The mean motion of the robot.
    robot: Motion,
    /// The mean motion of its wheels, which differs if they slip.
    wheels: Motion,
    /// The twist of the wheels at the step's end.
    end: Twist,
}

/// The step that ends at `clock`, of a robot that begins it with `twist` and gets the command `commanded`.
fn driven(layout: &ArenaLayout, clock: Clock, twist: &Twist, commanded: &Motion) -> DrivenStep {
    let Scenario { robot, task, .. } = &*layout.scenario;
    let (wheels, end) = robot.drive(task.control_period_s).step(&(*twist).into(), commanded);
    let slipping = |slip: Slip| slip.robot_motion(&wheels, layout.layout_seed, clock.0);
    let robot = robot.slip.map_or(wheels, slipping);
    DrivenStep { robot, wheels, end: end.into() }
}

/// The pose at the end of an arc.
fn pose_after(from: &Pose, motion: &Motion, seconds: f32) -> Pose {
    let step = chord_velocity(from.heading_rad, motion, seconds) * seconds;
    let heading_rad = integrate_heading(from.heading_rad, motion, seconds);
    Pose { x_m: from.x_m + step.x, y_m: from.y_m + step.y, heading_rad }
}

/// The components of an arena that [`actuate`] reads and writes.
type Actuated = (
    &'static Arena,
    &'static ArenaLayout,
    &'static Bodies,
    &'static Clock,
    &'static Pose,
    &'static Twist,
    &'static Episode,
    &'static mut RapierRigidBodySet,
    &'static mut RapierConfiguration,
);

/// `Actuate`: sets the velocity of every robot's body for this step.
pub(super) fn actuate(commands: MotionCommands, mut arenas: Query<Actuated>) {
    for (arena, layout, bodies, clock, pose, twist, episode, mut set, mut configuration) in &mut arenas {
        if configuration.physics_pipeline_active == episode.inactive {
            configuration.physics_pipeline_active = !episode.inactive;
        }
        if episode.inactive {
            continue;
        }
        let scenario = &*layout.scenario;
        let motion = driven(layout, *clock, twist, &commands.motion(arena, scenario)).robot;
        let velocity = chord_velocity(pose.heading_rad, &motion, scenario.task.control_period_s);
        if let Some(body) = set.bodies.get_mut(bodies.robot) {
            body.set_linvel(velocity, true);
        }
    }
}

/// The components of an arena that [`read_pose`] reads and writes.
type Stepped = (
    &'static Arena,
    &'static ArenaLayout,
    &'static Bodies,
    (&'static Clock, &'static Pedestrians),
    &'static Episode,
    &'static RapierContextColliders,
    &'static mut RapierRigidBodySet,
    (&'static mut Pose, &'static mut EstimatedPose),
    &'static mut Twist,
    &'static mut Scan,
);

/// `Sense`: reads the robot's pose, contact and twist after the step.
///
/// - A robot that touches nothing is where rapier has moved it.
/// - A robot that touches something rests where rapier has stopped it if that is a valid resting place, and otherwise where
///   it first touched.
/// - A robot that rapier has deflected although it touches nothing is put at the end of its chord.
pub(super) fn read_pose(commands: MotionCommands, mut arenas: Query<Stepped>) {
    for (arena, layout, bodies, clock, episode, colliders, mut set, poses, mut twist, mut scan) in &mut arenas
    {
        let (mut pose, mut estimate) = poses;
        let (clock, pedestrians) = clock;
        if episode.inactive {
            continue;
        }
        if let Some(body) = set.bodies.get_mut(bodies.robot) {
            let scenario = &*layout.scenario;
            let period_s = scenario.task.control_period_s;
            let driven = driven(layout, *clock, &twist, &commands.motion(arena, scenario));
            let motion = driven.robot;
            *twist = driven.end;
            let from = Vec2::new(pose.x_m, pose.y_m);
            let velocity = chord_velocity(pose.heading_rad, &motion, period_s);
            let free = from + velocity * period_s;
            // Rapier also separates overlapping bodies, which moves them without a velocity.
            let deflected =
                (body.translation() - free).length() > ROUNDING * (1.0 + from.length() + free.length());
            let to = if deflected { free } else { body.translation() };
            let (layout, colliders) = (layout.indexed(pedestrians), &colliders.colliders);
            let step = ContactQuery {
                layout,
                colliders,
                bodies,
                clock: *clock,
                from,
                heading_rad: pose.heading_rad,
                turn_rad: motion.w_rad_s * period_s,
            };
            let contact = step.first_contact(to);
            scan.touching = contact.is_some();
            let is_disc = bodies.footprint.is_none();
            if let Some(fraction) = contact {
                if !is_disc || !step.is_resting_contact(body.translation(), to) {
                    body.set_translation(from.lerp(to, fraction), true);
                }
                body.set_linvel(Vec2::ZERO, true);
            } else if deflected || body.linvel() != velocity {
                body.set_translation(to, true);
                body.set_linvel(velocity, true);
            }
            let position = body.translation();
            let turning_s = if is_disc { period_s } else { period_s * contact.unwrap_or(1.0) };
            *pose = Pose {
                x_m: position.x,
                y_m: position.y,
                heading_rad: integrate_heading(pose.heading_rad, &motion, turning_s),
            };
            estimate.0 = match &scenario.robot.odometry_drift {
                Some(drift) => pose_after(&estimate.0, &drift.reported_motion(&driven.wheels), period_s),
                None => *pose,
            };
            if !is_disc {
                body.set_rotation(Rotation::from_angle(pose.heading_rad), true);
            }
        }
    }
}

/// `Place`: moves the body of every reset robot to its pose, at rest. The robot's estimated pose is then exact.
pub(super) fn place(
    mut arenas: Query<(&Bodies, &Pose, &mut EstimatedPose, &Episode, &mut RapierRigidBodySet)>,
) {
    for (bodies, pose, mut estimate, episode, mut set) in &mut arenas {
        if !episode.pending_reset.moves_robot() {
            continue;
        }
        estimate.0 = *pose;
        place_body(&mut set, bodies, pose);
    }
}

/// Moves the robot's body to `pose`, at rest.
pub(super) fn place_body(set: &mut RapierRigidBodySet, bodies: &Bodies, pose: &Pose) {
    if let Some(body) = set.bodies.get_mut(bodies.robot) {
        let mut position = BodyPose::translation(pose.x_m, pose.y_m);
        if bodies.footprint.is_some() {
            position.rotation = Rotation::from_angle(pose.heading_rad);
        }
        body.set_position(position, true);
        body.set_linvel(Vec2::ZERO, true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chord_ends_where_the_arc_ends() {
        // A circle of radius v / w = 0.1 m, driven east from its lowest point for 0.2 s at 1.5 rad/s: 0.3 rad.
        let motion = Motion { v_m_s: 0.15, w_rad_s: 1.5 };
        let end = chord_velocity(0.0, &motion, 0.2) * 0.2;
        assert!((end.x - 0.1 * 0.3_f32.sin()).abs() < 1e-7, "x = r sin(w t), got {}", end.x);
        assert!((end.y - 0.1 * (1.0 - 0.3_f32.cos())).abs() < 1e-7, "y = r (1 - cos(w t)), got {}", end.y);
        assert!((integrate_heading(0.0, &motion, 0.2) - 0.3).abs() < 1e-7);
    }

    #[test]
    fn without_rotation_the_chord_velocity_is_v_along_the_heading() {
        let motion = Motion { v_m_s: 0.15, w_rad_s: 0.0 };
        assert_eq!(chord_velocity(0.0, &motion, 0.2), Vec2::new(0.15, 0.0));
    }
}
