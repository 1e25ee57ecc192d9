//! Classical drivers, policies as drivers (with or without a map) and manual control, as action sources (`Decide`).
//!
//! In: the components of an arena. Out: its action. A driver of [class](DriverClass) A or B gets what a policy's observation is
//! made of, and odometry; one of class C also gets the true scenario and pose.

use bevy::ecs::system::SystemParam;
use bevy::prelude::*;

use super::{ActionSource, ActionSources};
use crate::drivers::{
    Driver, DriverClass, DriverConfig, DriverPlan, DrivingPolicy, Odometry, Percept, Robot, Truth,
};
use crate::policy::ActionSet;
use crate::scenario::{self, Motion, Scenario};
use crate::task::{
    Actions, ActiveActionSet, Arena, ArenaLayout, Clock, CommandedMotions, Episode, EstimatedPose, Goal,
    Pedestrians, Pose, Scan, Twist,
};

/// The kind of driver of a [`DriverSource`]. A driver chooses actions from [`Percept`]s.
#[derive(Clone, Debug)]
pub enum DriverKind {
    /// A classical driver with its parameters.
    Classical(DriverConfig),
    /// A policy, without or with a map that it builds as it drives.
    Policy(DrivingPolicy),
}

impl DriverKind {
    /// Returns the class: what the driver may perceive.
    #[must_use]
    pub fn class(&self) -> DriverClass {
        match self {
            Self::Classical(config) => config.class(),
            Self::Policy(policy) => policy.class(),
        }
    }

    /// Makes a driver for one episode, for the robot of `scenario`.
    fn driver(&self, scenario: &Scenario) -> Box<dyn Driver> {
        match self {
            Self::Classical(config) => config.driver(&Robot::of(scenario)),
            Self::Policy(policy) => policy.driver(scenario),
        }
    }
}

/// The driver of one arena. Each episode gets a new one.
pub struct DriverSource {
    kind: DriverKind,
    /// The driver of the current episode; `None` before the first step.
    driver: Option<Box<dyn Driver>>,
    /// The estimated pose at the last decision.
    last_pose: Pose,
}

impl DriverSource {
    /// Makes a source whose drivers are of the kind `kind`.
    #[must_use]
    pub fn new(kind: DriverKind) -> Self {
        Self { kind, driver: None, last_pose: Pose::default() }
    }

    /// Returns the driver's path and map, in the arena's frame; `None` before the first step, or if it plans no path.
    #[must_use]
    pub fn plan(&self) -> Option<DriverPlan> {
        self.driver.as_ref()?.plan(tuple(&self.last_pose))
    }

    /// Returns the Q-values of the last decision, one per action; `None` before the first step, or if the driver has no network.
    #[must_use]
    pub fn q_values(&self) -> Option<&[f32]> {
        self.driver.as_ref()?.q_values()
    }

    /// Returns the driver's own motions, which its actions index; `None` before the first step, or if its actions index the
    /// robot's motions.
    #[must_use]
    pub fn motions(&self) -> Option<&[Motion]> {
        self.driver.as_ref()?.motions()
    }
}

fn tuple(pose: &Pose) -> (f32, f32, f32) {
    (pose.x_m, pose.y_m, pose.heading_rad)
}

/// The components of an arena from which [`drive`] makes a [`Percept`].
type Perceived = (
    &'static Arena,
    &'static ArenaLayout,
    (&'static Pose, &'static EstimatedPose),
    &'static Twist,
    &'static Scan,
    &'static Goal,
    (&'static Clock, &'static Pedestrians),
    &'static Episode,
);

/// The commands that [`drive`] writes.
#[derive(SystemParam)]
pub(super) struct Commanded<'w> {
    actions: ResMut<'w, Actions>,
    motions: ResMut<'w, CommandedMotions>,
    /// The action set of the networks.
    action_set: Res<'w, ActiveActionSet>,
}

impl Commanded<'_> {
    /// Commands `action` in `arena`: an index into `motions`, or without them into the motions of `robot`.
    fn set(&mut self, arena: usize, action: usize, motions: Option<&[Motion]>, robot: &scenario::Robot) {
        let all = motions.unwrap_or(&robot.motions);
        let action = action.min(all.len().saturating_sub(1));
        let is_network_action = motions.is_none() && self.action_set.0 == ActionSet::Robot;
        let motion = if is_network_action { None } else { all.get(action).copied() };
        if let Some(slot) = self.actions.0.get_mut(arena) {
            *slot = action;
        }
        let commanded = &mut self.motions.0;
        commanded.resize(commanded.len().max(arena + 1), None);
        commanded[arena] = motion;
    }
}

/// `Decide`: sets the actions of the arenas that a driver or the user controls.
pub(super) fn drive(
    sources: Option<ResMut<ActionSources>>,
    arenas: Query<Perceived>,
    mut commanded: Commanded,
) {
    let Some(mut sources) = sources else { return };
    // Drivers update their memory in every step; that does not count as a change of the sources.
    let sources = sources.bypass_change_detection();
    for (arena, layout, (pose, estimate), twist, scan, goal, (clock, pedestrians), episode) in &arenas {
        let estimate = &estimate.0;
        let source = match sources.arenas.get_mut(arena.0) {
            Some(ActionSource::Driver(source)) => source,
            Some(ActionSource::Manual(action)) => {
                commanded.set(arena.0, *action, None, &layout.scenario.robot);
                continue;
            }
            _ => continue,
        };
        if episode.inactive {
            continue;
        }
        if episode.steps == 0 || source.driver.is_none() {
            // Like a policy, a driver does not know the values drawn for its robot and LIDAR.
            source.driver = Some(source.kind.driver(&layout.written));
            source.last_pose = *estimate;
        }
        let truth = Truth {
            layout: layout.indexed(pedestrians),
            clock: clock.0,
            pose: tuple(pose),
            goal_m: Vec2::new(goal.x_m, goal.y_m),
        };
        let percept = Percept {
            ranges_m: &scan.ranges_m,
            goal_distance_m: estimate.distance_m(goal),
            goal_bearing_rad: estimate.bearing_rad(goal),
            twist: Motion { v_m_s: twist.v_m_s, w_rad_s: twist.w_rad_s },
            odometry: Odometry::between(tuple(&source.last_pose), tuple(estimate)),
            truth: (source.kind.class() == DriverClass::C).then_some(truth),
        };
        source.last_pose = *estimate;
        if let Some(driver) = &mut source.driver {
            let action = driver.act(&percept);
            commanded.set(arena.0, action, driver.motions(), &layout.scenario.robot);
        }
    }
}
