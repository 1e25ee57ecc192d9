//! Where episodes start and targets lie.
//!
//! In: what each arena is owed ([`Restart`]), its own stream `places`, and the scenario's rules. Out: a new
//! [`Pose`] at rest, a new [`Target`], and an [`Episode`] at zero. Bodies, scans and observations follow in [`Begin`].

use bevy::prelude::*;

use super::{
    Arena, Clock, CurrentScenario, Drive, Episode, Fault, Pose, Restart, Room, Streams, Target, TaskFault,
};
use crate::control_step::Begin;
use crate::random;
use crate::scenario::{NoFreePlace, Scenario, draw_navigation, draw_target};

/// By which rule starts and targets are chosen.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Places {
    /// At random, by the scenario's rules.
    #[default]
    Drawn,
    /// The scenario's timed course: always the same start, heading and target.
    Course,
}

/// `Restart`: begins what is due, if anything is.
pub(super) fn run_begin(world: &mut World, arenas: &mut QueryState<&Episode>) {
    if arenas.iter(world).any(|episode| episode.restart != Restart::No) {
        world.run_schedule(Begin);
    }
}

/// So many layouts are tried for one that leaves room for a start and a target.
const LAYOUTS: u32 = 50;

/// What is read and written of an arena where something begins.
type Begins = (
    &'static Arena,
    &'static Clock,
    &'static mut Room,
    &'static mut Pose,
    &'static mut Drive,
    &'static mut Target,
    &'static mut Episode,
    &'static mut Streams,
);

/// What is drawn for an arena: a start where the robot does not stay where it is, and a target.
type Drawn = (Option<Pose>, Target);

/// `Draw`: a new target, and for a new episode a new layout where there are generators and a new start, at rest.
pub(super) fn draw(
    scenario: Res<CurrentScenario>,
    places: Res<Places>,
    mut fault: ResMut<TaskFault>,
    mut arenas: Query<Begins>,
) {
    for (arena, clock, mut room, mut pose, mut drive, mut target, mut episode, mut streams) in &mut arenas {
        if matches!(episode.restart, Restart::No | Restart::Moved) {
            continue;
        }
        if episode.restart.begins_episode() {
            *episode = Episode { restart: episode.restart, ..Episode::default() };
        }
        let stays = (episode.restart == Restart::Target).then_some(*pose);
        let generates = episode.restart.begins_episode() && !scenario.0.generators.is_empty();
        // A layout may leave no room: then it is another.
        let mut tries = if generates { LAYOUTS } else { 1 };
        let drawn = loop {
            if generates {
                *room = Room::new(&scenario.0, random::word(&mut streams.places));
            }
            let drawn = match *places {
                Places::Course => Ok(course(&room.scenario)),
                Places::Drawn => draw_for(&room.scenario, clock.0, stays, &mut streams),
            };
            tries -= 1;
            if drawn.is_ok() || tries == 0 {
                break drawn;
            }
        };
        match drawn {
            Ok((start, new_target)) => {
                *target = new_target;
                if let Some(start) = start {
                    (*pose, *drive) = (start, Drive::default());
                    if episode.restart == Restart::Target {
                        episode.restart = Restart::Place;
                    }
                }
            }
            Err(why) => {
                *drive = Drive::default();
                fault.0.get_or_insert(Fault::NoRoom { arena: arena.0, step: clock.0, why });
            }
        }
    }
}

/// The timed course.
fn course(scenario: &Scenario) -> Drawn {
    let course = &scenario.course;
    let start = Pose { x_m: course.start_m.0, y_m: course.start_m.1, heading_rad: course.heading_rad };
    (Some(start), Target { x_m: course.target_m.0, y_m: course.target_m.1 })
}

/// A target for a robot that `stays` where it is; if there is none far enough, or it doesn't stay, a start, too.
fn draw_for(
    scenario: &Scenario,
    step: u64,
    stays: Option<Pose>,
    streams: &mut Streams,
) -> Result<Drawn, NoFreePlace> {
    let stream = &mut streams.places;
    let for_it = stays.map(|pose| draw_target(scenario, step, (pose.x_m, pose.y_m), stream));
    if let Some(Ok((x_m, y_m))) = for_it {
        return Ok((None, Target { x_m, y_m }));
    }
    let ((x_m, y_m, heading_rad), target) = draw_navigation(scenario, step, stream)?;
    Ok((Some(Pose { x_m, y_m, heading_rad }), Target { x_m: target.0, y_m: target.1 }))
}

/// `Observe`, last: nothing is owed any more.
pub(super) fn settle(mut arenas: Query<&mut Episode>) {
    for mut episode in &mut arenas {
        episode.restart = Restart::No;
    }
}
