//! Where episodes start and goals lie.
//!
//! In: what each arena is owed ([`PendingReset`]), its own stream `places`, and the scenario's rules. Out: a new
//! [`Pose`] at rest, a new [`Goal`], and an [`Episode`] at zero. Bodies, scans and observations follow in [`Reset`].

use bevy::prelude::*;

use super::{
    Arena, ArenaLayout, Clock, CurrentScenario, Episode, Fault, Goal, PendingReset, Pose, Streams, TaskFault,
    Twist,
};
use crate::control_step::Reset;
use crate::random;
use crate::scenario::{NoFreeSpace, Scenario, draw_goal, draw_start_and_goal};

/// By which rule starts and goals are chosen.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum EpisodeSetup {
    /// At random, by the scenario's rules.
    #[default]
    Random,
    /// The scenario's benchmark route: always the same start, heading and goal.
    BenchmarkRoute,
}

/// `Reset`: begins what is due, if anything is.
pub(super) fn run_reset(world: &mut World, arenas: &mut QueryState<&Episode>) {
    if arenas.iter(world).any(|episode| episode.pending_reset != PendingReset::None) {
        world.run_schedule(Reset);
    }
}

/// So many layouts are tried for one that leaves room for a start and a goal.
const MAX_LAYOUT_ATTEMPTS: u32 = 50;

/// What is read and written of an arena where something begins.
type Begins = (
    &'static Arena,
    &'static Clock,
    &'static mut ArenaLayout,
    &'static mut Pose,
    &'static mut Twist,
    &'static mut Goal,
    &'static mut Episode,
    &'static mut Streams,
);

/// What is drawn for an arena: a start where the robot does not stay where it is, and a goal.
type StartAndGoalDraw = (Option<Pose>, Goal);

/// `Draw`: a new goal, and for a new episode a new layout where there are generators and a new start, at rest.
pub(super) fn draw(
    scenario: Res<CurrentScenario>,
    places: Res<EpisodeSetup>,
    mut fault: ResMut<TaskFault>,
    mut arenas: Query<Begins>,
) {
    for (arena, clock, mut room, mut pose, mut twist, mut goal, mut episode, mut streams) in &mut arenas {
        if matches!(episode.pending_reset, PendingReset::None | PendingReset::Refresh) {
            continue;
        }
        if episode.pending_reset.begins_episode() {
            *episode = Episode { pending_reset: episode.pending_reset, ..Episode::default() };
        }
        let stays = (episode.pending_reset == PendingReset::Goal).then_some(*pose);
        let generates = episode.pending_reset.begins_episode() && !scenario.0.generators.is_empty();
        // A layout may leave no room: then it is another.
        let mut tries = if generates { MAX_LAYOUT_ATTEMPTS } else { 1 };
        let drawn = loop {
            if generates {
                *room = ArenaLayout::new(&scenario.0, random::random_u64(&mut streams.places));
            }
            let drawn = match *places {
                EpisodeSetup::BenchmarkRoute => Ok(course(&room.scenario)),
                EpisodeSetup::Random => draw_for(&room.scenario, clock.0, stays, &mut streams),
            };
            tries -= 1;
            if drawn.is_ok() || tries == 0 {
                break drawn;
            }
        };
        match drawn {
            Ok((start, new_goal)) => {
                *goal = new_goal;
                if let Some(start) = start {
                    (*pose, *twist) = (start, Twist::default());
                    if episode.pending_reset == PendingReset::Goal {
                        episode.pending_reset = PendingReset::StartAndGoal;
                    }
                }
            }
            Err(why) => {
                *twist = Twist::default();
                fault.0.get_or_insert(Fault::NoFreeSpace { arena: arena.0, step: clock.0, why });
            }
        }
    }
}

/// The benchmark route.
fn course(scenario: &Scenario) -> StartAndGoalDraw {
    let course = &scenario.benchmark_route;
    let start = Pose { x_m: course.start_m.x, y_m: course.start_m.y, heading_rad: course.heading_rad };
    (Some(start), Goal { x_m: course.goal_m.x, y_m: course.goal_m.y })
}

/// A goal for a robot that `stays` where it is; if there is none far enough, or it doesn't stay, a start, too.
fn draw_for(
    scenario: &Scenario,
    step: u64,
    stays: Option<Pose>,
    streams: &mut Streams,
) -> Result<StartAndGoalDraw, NoFreeSpace> {
    let stream = &mut streams.places;
    let for_it = stays.map(|pose| draw_goal(scenario, step, vec2(pose.x_m, pose.y_m), stream));
    if let Some(Ok(Vec2 { x: x_m, y: y_m })) = for_it {
        return Ok((None, Goal { x_m, y_m }));
    }
    let ((x_m, y_m, heading_rad), goal) = draw_start_and_goal(scenario, step, stream)?;
    Ok((Some(Pose { x_m, y_m, heading_rad }), Goal { x_m: goal.x, y_m: goal.y }))
}

/// `Observe`, last: nothing is owed any more.
pub(super) fn clear_pending_resets(mut arenas: Query<&mut Episode>) {
    for mut episode in &mut arenas {
        episode.pending_reset = PendingReset::None;
    }
}
