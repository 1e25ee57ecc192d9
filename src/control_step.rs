//! The clockwork: one schedule, [`ControlStep`], worth one control period of simulated time.
//!
//! In: whoever calls `world.run_schedule(ControlStep)`; headless that is a loop, in a window a pacer. Out: every
//! arena has moved on by one step. The sets run in the order of [`ControlSet`], and each hands its product to the
//! next. Nothing in a step asks for wall-clock time, frame time or input, so a seed means one result everywhere.
//!
//! | set | responsible for | filled by |
//! |---|---|---|
//! | `Decide` | observations -> actions | [`AgentPlugin`](crate::agent::AgentPlugin) |
//! | `Actuate` | actions -> velocities of robots and obstacles | [`SimPlugin`](crate::sim::WorldPlugin) |
//! | `Simulate` | one step of rapier | [`SimPlugin`](crate::sim::WorldPlugin) |
//! | `Sense` | poses, LIDAR scans -> next observations | `SimPlugin`, [`TaskPlugin`](crate::task::TaskPlugin) |
//! | `Reward` | reward, collision, target, time limit | [`TaskPlugin`](crate::task::TaskPlugin) |
//! | `Store` | transitions -> replay buffer | [`TrainingPlugin`](crate::agent::TrainingPlugin) |
//! | `Learn` | gradient steps | [`TrainingPlugin`](crate::agent::TrainingPlugin) |
//! | `Reset` | new goals, new episodes, `EpisodeEnded` | [`TaskPlugin`](crate::task::TaskPlugin) |

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
    /// Observations become actions.
    Decide,
    /// Actions become velocities; obstacles learn where they go next.
    Actuate,
    /// Rapier steps the bodies.
    Simulate,
    /// The LIDAR is cast and the next observations are written.
    Sense,
    /// Reward, terminated, truncated.
    Reward,
    /// Transitions are stored.
    Store,
    /// Gradient steps.
    Learn,
    /// Ended episodes are published and begun anew, reached goals are redrawn.
    Reset,
}

/// Within [`ControlSet::Sense`]: the systems that write poses and scans. Observations are written after them.
#[derive(SystemSet, Debug, Clone, PartialEq, Eq, Hash)]
pub struct ScanWritten;

/// The schedule that gives every arena marked for it a new start or target, and a fresh observation.
/// [`ControlStep`] runs it last, when there is such an arena.
#[derive(ScheduleLabel, Debug, Clone, PartialEq, Eq, Hash)]
pub struct Reset;

/// The sets of [`Reset`], in the order in which they run.
#[derive(SystemSet, Debug, Clone, PartialEq, Eq, Hash)]
pub enum ResetSet {
    /// Starts and goals are drawn.
    Draw,
    /// Bodies are put where they belong.
    Place,
    /// The LIDAR is cast from there.
    Sense,
    /// The first observation is written.
    Observe,
}

/// Responsible for the two schedules and the order of their sets.
///
/// Both run on the single-threaded executor (a step of microseconds pays more for threads than it gets), and two
/// systems whose order is left open although they touch the same data are an error.
pub struct ControlStepPlugin;

impl Plugin for ControlStepPlugin {
    fn build(&self, app: &mut App) {
        use {ControlSet as C, ResetSet as B};
        let mut step = strict(Schedule::new(ControlStep));
        step.configure_sets(
            (C::Decide, C::Actuate, C::Simulate, C::Sense, C::Reward, C::Store, C::Learn, C::Reset).chain(),
        );
        let mut begin = strict(Schedule::new(Reset));
        begin.configure_sets((B::Draw, B::Place, B::Sense, B::Observe).chain());
        app.add_schedule(step).add_schedule(begin);
    }
}

fn strict(mut schedule: Schedule) -> Schedule {
    schedule.set_executor(SingleThreadedExecutor::new()).set_build_settings(ScheduleBuildSettings {
        ambiguity_detection: LogLevel::Error,
        ..Default::default()
    });
    schedule
}
