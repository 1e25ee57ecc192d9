//! Where episodes start and targets lie.
//!
//! In: what each arena is owed ([`Restart`]), its own stream `places`, and the scenario's rules. Out: a new
//! [`Pose`] at rest, a new [`Target`], and an [`Episode`] at zero. Bodies, scans and observations follow in [`Begin`].

use bevy::prelude::*;

use super::{Arena, Clock, CurrentScenario, Drive, Episode, Pose, Restart, Streams, Target};
use crate::control_step::Begin;
use crate::scenario::{draw_start, draw_target};

/// By which rule starts and targets are chosen.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Places {
    /// At random, by the scenario's rules.
    #[default]
    Drawn,
    /// The scenario's timed course: always the same start, heading and target.
    Course,
}

/// Set where no start or target could be found: the caller of the step must look, and stop.
#[derive(Resource, Clone, Debug, Default)]
pub struct TaskFault(pub Option<String>);

/// `Restart`: begins what is due, if anything is.
pub(super) fn run_begin(world: &mut World, arenas: &mut QueryState<&Episode>) {
    if arenas.iter(world).any(|episode| episode.restart != Restart::No) {
        world.run_schedule(Begin);
    }
}

/// `Draw`: a new target, and for a new episode a new start, at rest.
pub(super) fn draw(
    scenario: Res<CurrentScenario>,
    places: Res<Places>,
    mut fault: ResMut<TaskFault>,
    mut arenas: Query<(&Arena, &Clock, &mut Pose, &mut Drive, &mut Target, &mut Episode, &mut Streams)>,
) {
    let scenario = &*scenario.0;
    for (arena, clock, mut pose, mut drive, mut target, mut episode, mut streams) in &mut arenas {
        if matches!(episode.restart, Restart::No | Restart::Moved) {
            continue;
        }
        if episode.restart != Restart::Target {
            *episode = Episode { restart: episode.restart, ..Episode::default() };
            *drive = Drive::default();
        }
        let drawn = match *places {
            Places::Course => {
                let course = &scenario.course;
                *pose =
                    Pose { x_m: course.start_m.0, y_m: course.start_m.1, heading_rad: course.heading_rad };
                *target = Target { x_m: course.target_m.0, y_m: course.target_m.1 };
                Ok(())
            }
            Places::Drawn => (|| {
                if episode.restart != Restart::Target {
                    let (x_m, y_m, heading_rad) = draw_start(scenario, clock.0, &mut streams.places)?;
                    *pose = Pose { x_m, y_m, heading_rad };
                }
                let (x_m, y_m) = draw_target(scenario, clock.0, (pose.x_m, pose.y_m), &mut streams.places)?;
                *target = Target { x_m, y_m };
                Ok::<(), crate::scenario::NoFreePlace>(())
            })(),
        };
        if let Err(problem) = drawn {
            fault.0 = Some(format!("arena {}, step {}: {problem}", arena.0, clock.0));
        }
    }
}

/// `Observe`, last: nothing is owed any more.
pub(super) fn settle(mut arenas: Query<&mut Episode>) {
    for mut episode in &mut arenas {
        episode.restart = Restart::No;
    }
}
