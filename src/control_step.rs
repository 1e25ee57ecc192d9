//! The control step: one schedule, [`ControlStep`], which advances simulated time by one control period.
//!
//! Running [`ControlStep`] once advances every arena by one step. Headless, a loop runs it; in the app, the pacer does.
//! Its sets run in the order of [`ControlSet`], and each passes its results to the next. A step never reads the wall
//! clock, the frame time or user input, so the result depends on the seed, not on timing.
//!
//! | set | responsible for | filled by |
//! |---|---|---|
//! | `Decide` | observations -> actions | [`agent`](crate::agent) |
//! | `Actuate` | actions -> velocities of robots and obstacles | [`sim`](crate::sim) |
//! | `Simulate` | one step of rapier | [`sim`](crate::sim) |
//! | `Sense` | poses, LIDAR scans, plugins' sensors -> next observations | [`sim`](crate::sim), plugins, [`task`](crate::task) |
//! | `Reward` | reward, collision, goal, time limit | [`task`](crate::task), plugins |
//! | `Store` | transitions -> replay buffer | [`agent`](crate::agent) |
//! | `Learn` | gradient steps | [`agent`](crate::agent) |
//! | `Reset` | new goals, new episodes, `EpisodeEnded` | [`task`](crate::task) |
//!
//! Plugins add systems to the public sub-sets [`SenseSet`] and [`RewardSet`], usually through
//! [`SimulationAppExt`](crate::task::SimulationAppExt).

use bevy::ecs::schedule::{
    IntoScheduleConfigs, LogLevel, Schedule, ScheduleBuildSettings, ScheduleLabel, SingleThreadedExecutor,
    SystemSet,
};
use bevy::prelude::{App, Plugin};

/// The schedule of one control step.
#[derive(ScheduleLabel, Debug, Clone, PartialEq, Eq, Hash)]
pub struct ControlStep;

/// The sets of [`ControlStep`], in the order in which they run.
#[derive(SystemSet, Debug, Clone, PartialEq, Eq, Hash)]
pub enum ControlSet {
    /// Turns observations into actions.
    Decide,
    /// Turns actions into velocities, and advances the obstacles' clock.
    Actuate,
    /// Takes one step of rapier, the physics engine.
    Simulate,
    /// Casts the LIDAR beams and writes the next observations; see [`SenseSet`].
    Sense,
    /// Computes rewards, terminations and truncations; see [`RewardSet`].
    Reward,
    /// Stores transitions in the replay buffer.
    Store,
    /// Takes the pending gradient steps.
    Learn,
    /// Publishes ended episodes, starts new ones, and replaces reached goals by new ones.
    Reset,
}

/// The sub-sets of [`ControlSet::Sense`], in order.
#[derive(SystemSet, Debug, Clone, PartialEq, Eq, Hash)]
pub enum SenseSet {
    /// Reads poses and writes LIDAR scans.
    Scan,
    /// Sensors of plugins write their [`SensorReadings`](crate::task::SensorReadings).
    Sensors,
    /// Encodes the next observations.
    Observe,
}

/// The sub-sets of [`ControlSet::Reward`], in order.
#[derive(SystemSet, Debug, Clone, PartialEq, Eq, Hash)]
pub enum RewardSet {
    /// Computes the paper's reward, termination and truncation.
    Outcome,
    /// Plugins compute their [`ExtraRewards`](crate::task::ExtraRewards).
    Terms,
    /// Adds the plugins' terms to the outcomes, and checks that all numbers are finite.
    Sum,
}

/// The schedule of pending resets. It draws the new starts and goals that are due, and updates bodies, scans and
/// observations. [`ControlStep`] runs it last, if an arena has a pending reset.
#[derive(ScheduleLabel, Debug, Clone, PartialEq, Eq, Hash)]
pub struct Reset;

/// The sets of [`Reset`], in the order in which they run.
#[derive(SystemSet, Debug, Clone, PartialEq, Eq, Hash)]
pub enum ResetSet {
    /// Draws starts and goals.
    Draw,
    /// Places bodies at their starts.
    Place,
    /// Takes LIDAR scans at the starts.
    Scan,
    /// Sensors of plugins write their first readings.
    Sensors,
    /// Writes the first observations.
    Observe,
}

/// Defines the two schedules and the order of their sets.
///
/// Both run on the single-threaded executor: a step takes microseconds, and threads would cost more than they gain.
/// Two systems that access the same data without a defined order are an error.
pub(crate) struct ControlStepPlugin;

impl Plugin for ControlStepPlugin {
    fn build(&self, app: &mut App) {
        use {ControlSet as C, ResetSet as R};
        let mut step = strict(Schedule::new(ControlStep));
        step.configure_sets(
            (C::Decide, C::Actuate, C::Simulate, C::Sense, C::Reward, C::Store, C::Learn, C::Reset).chain(),
        )
        .configure_sets((SenseSet::Scan, SenseSet::Sensors, SenseSet::Observe).chain().in_set(C::Sense))
        .configure_sets((RewardSet::Outcome, RewardSet::Terms, RewardSet::Sum).chain().in_set(C::Reward));
        let mut reset = strict(Schedule::new(Reset));
        reset.configure_sets((R::Draw, R::Place, R::Scan, R::Sensors, R::Observe).chain());
        app.add_schedule(step).add_schedule(reset);
    }
}

fn strict(mut schedule: Schedule) -> Schedule {
    schedule.set_executor(SingleThreadedExecutor::new()).set_build_settings(ScheduleBuildSettings {
        ambiguity_detection: LogLevel::Error,
        ..Default::default()
    });
    schedule
}
