//! The robot: a differential drive.
//!
//! In: the chosen motion (v, w) of eq. (9). Out: the body's velocity before the physics step, its pose and [`Twist`]
//! after it.
//!
//! What is driven in a step is the mean of the actual (v, w) over it: the chosen motion itself, or what the scenario's
//! [`ActuatorLag`] makes of it. With a lag that is a simplification, for v and w change within the step and the true path is
//! no arc; its turn and its length (what is reversed taken off) are kept, so the heading after the step is exact.
//!
//! Driving with constant v and w for a time t describes an arc. Its chord has the length v t sinc(w t / 2) and points
//! along the heading half way through, so one physics step with that velocity puts the robot exactly on the arc's
//! end, unless it touches something on the way (`contact.rs`): there it stops. The body is a disc with locked rotation: the
//! wheels turn it, contacts do not. Its heading is kept here, by `libm`, so that the bits are the same on every platform.

use bevy::prelude::*;
use bevy_rapier2d::prelude::*;
use bevy_rapier2d::rapier::math::Pose as BodyPose;

use super::contact::ContactQuery;
use super::physics::Bodies;
use crate::scenario::{Motion, Scenario};
use crate::task::{Actions, Arena, Clock, CurrentScenario, Episode, Pose, Scan, Twist, wrap_angle};

/// What rounding may add to coordinates, and to a metre's way.
const ROUNDING: f32 = 1e-6;

/// The constant velocity, in m/s, that takes the robot in `seconds` to the end of its arc.
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

/// A drive whose actual u = (v, w) follows the chosen one as a first-order lag, over one control step: a share of the
/// difference is left, the rest is made up. Without a lag nothing is left, and the step drives the chosen motion to the
/// bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ActuatorLag {
    /// Share of the difference at the step's start that is left on average over the step, 0 to 1.
    mean: f32,
    /// Share of it that is left at the step's end, 0 to 1.
    end: f32,
}

impl ActuatorLag {
    /// The lag with time constant `lag_s`, 0 s or more, over steps of `seconds`, more than 0.
    ///
    /// From du/dt = (chosen - u) / lag the difference falls as e^(-t / lag); over T seconds its mean is
    /// (lag / T)(1 - e^(-T / lag)).
    #[must_use]
    pub fn new(lag_s: f32, seconds: f32) -> Self {
        if lag_s <= 0.0 {
            return Self { mean: 0.0, end: 0.0 };
        }
        let lags = seconds / lag_s;
        Self { mean: -libm::expm1f(-lags) / lags, end: libm::expf(-lags) }
    }

    /// What is driven on average in a step that begins with `twist` while `chosen` is chosen, and what the drive does
    /// at its end.
    #[must_use]
    pub fn step(&self, twist: &Twist, chosen: &Motion) -> (Motion, Twist) {
        // Whatever the drive did, nothing of it is left: not even the sign of a zero.
        let left = |share: f32, actual: f32, chosen: f32| {
            if share == 0.0 { chosen } else { chosen + (actual - chosen) * share }
        };
        let v = |share| left(share, twist.v_m_s, chosen.v_m_s);
        let w = |share| left(share, twist.w_rad_s, chosen.w_rad_s);
        let mean = Motion { v_m_s: v(self.mean), w_rad_s: w(self.mean) };
        (mean, Twist { v_m_s: v(self.end), w_rad_s: w(self.end) })
    }

    /// That of the robot of `scenario` over its control period.
    fn of(scenario: &Scenario) -> Self {
        Self::new(scenario.robot.actuator_lag_s, scenario.task.control_period_s)
    }
}

/// `Actuate`: what is driven in this step becomes the body's velocity.
pub(super) fn actuate(
    scenario: Res<CurrentScenario>,
    actions: Res<Actions>,
    mut arenas: Query<(
        &Arena,
        &Bodies,
        &Pose,
        &Twist,
        &Episode,
        &mut RapierRigidBodySet,
        &mut RapierConfiguration,
    )>,
) {
    let lag = ActuatorLag::of(&scenario.0);
    for (arena, bodies, pose, twist, episode, mut set, mut configuration) in &mut arenas {
        if configuration.physics_pipeline_active == episode.inactive {
            configuration.physics_pipeline_active = !episode.inactive;
        }
        if episode.inactive {
            continue;
        }
        let (motion, _) = lag.step(twist, &scenario.0.robot.motions[actions.0[arena.0]]);
        let velocity = chord_velocity(pose.heading_rad, &motion, scenario.0.task.control_period_s);
        if let Some(body) = set.bodies.get_mut(bodies.robot) {
            body.set_linvel(velocity, true);
        }
    }
}

/// What is read and written of an arena after its step.
type Stepped = (
    &'static Arena,
    &'static Bodies,
    &'static Clock,
    &'static Episode,
    &'static RapierContextColliders,
    &'static mut RapierRigidBodySet,
    &'static mut Pose,
    &'static mut Twist,
    &'static mut Scan,
);

/// `Sense`: where the step has left the robot, whether it touched something, and how fast it goes now.
///
/// A free robot is where rapier has brought it. One that touches something rests where rapier has stopped it, if that is a
/// place to rest at, else where it first touched. One that rapier has only turned aside goes where it was told to.
pub(super) fn read_pose(scenario: Res<CurrentScenario>, actions: Res<Actions>, mut arenas: Query<Stepped>) {
    let scenario = &*scenario.0;
    let (lag, period_s) = (ActuatorLag::of(scenario), scenario.task.control_period_s);
    for (arena, bodies, clock, episode, colliders, mut set, mut pose, mut twist, mut scan) in &mut arenas {
        if episode.inactive {
            continue;
        }
        if let Some(body) = set.bodies.get_mut(bodies.robot) {
            let (motion, after) = lag.step(&twist, &scenario.robot.motions[actions.0[arena.0]]);
            *twist = after;
            let from = Vec2::new(pose.x_m, pose.y_m);
            let due = chord_velocity(pose.heading_rad, &motion, period_s);
            let free = from + due * period_s;
            // (Rapier also moves what overlaps, without a velocity.)
            let turned_aside =
                (body.translation() - free).length() > ROUNDING * (1.0 + from.length() + free.length());
            let to = if turned_aside { free } else { body.translation() };
            let step =
                ContactQuery { scenario, colliders: &colliders.colliders, bodies, clock: *clock, from };
            let touch = step.first_contact(to);
            scan.touching = touch.is_some();
            if let Some(part) = touch {
                if !step.is_resting_contact(body.translation(), to) {
                    body.set_translation(from.lerp(to, part), true);
                }
                body.set_linvel(Vec2::ZERO, true);
            } else if turned_aside || body.linvel() != due {
                body.set_translation(to, true);
                body.set_linvel(due, true);
            }
            let position = body.translation();
            *pose = Pose {
                x_m: position.x,
                y_m: position.y,
                heading_rad: integrate_heading(pose.heading_rad, &motion, period_s),
            };
        }
    }
}

/// `Place`: a restarted robot's body is put where its pose says, at rest.
pub(super) fn place(mut arenas: Query<(&Bodies, &Pose, &Episode, &mut RapierRigidBodySet)>) {
    for (bodies, pose, episode, mut set) in &mut arenas {
        if !episode.pending_reset.moves_robot() {
            continue;
        }
        place_body(&mut set, bodies, pose);
    }
}

/// Puts the robot's body where `pose` says, at rest.
pub(super) fn place_body(set: &mut RapierRigidBodySet, bodies: &Bodies, pose: &Pose) {
    if let Some(body) = set.bodies.get_mut(bodies.robot) {
        body.set_position(BodyPose::translation(pose.x_m, pose.y_m), true);
        body.set_linvel(Vec2::ZERO, true);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_chord_ends_where_the_arc_ends() {
        // On a circle of radius v / w = 0.1 m, heading east from its lowest point, for 0.2 s at 1.5 rad/s: 0.3 rad.
        let motion = Motion { v_m_s: 0.15, w_rad_s: 1.5 };
        let end = chord_velocity(0.0, &motion, 0.2) * 0.2;
        assert!((end.x - 0.1 * 0.3_f32.sin()).abs() < 1e-7, "x = r sin(w t), got {}", end.x);
        assert!((end.y - 0.1 * (1.0 - 0.3_f32.cos())).abs() < 1e-7, "y = r (1 - cos(w t)), got {}", end.y);
        assert!((integrate_heading(0.0, &motion, 0.2) - 0.3).abs() < 1e-7);
    }

    #[test]
    fn driving_straight_is_driving_straight() {
        let motion = Motion { v_m_s: 0.15, w_rad_s: 0.0 };
        assert_eq!(chord_velocity(0.0, &motion, 0.2), Vec2::new(0.15, 0.0));
    }
}
