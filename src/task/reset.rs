//! New episodes: their layouts, starts and goals.
//!
//! In: each arena's [`PendingReset`], its stream for placement, and the scenario's placement rules. Out: a new [`Pose`] at
//! rest, a new [`Goal`], an empty [`Episode`], and the pedestrians at their start positions. Bodies, scans and observations
//! follow in the schedule [`Reset`].

use bevy::prelude::*;

use super::{
    Arena, ArenaLayout, Clock, Episode, Fault, Goal, Pedestrians, PendingReset, Pose, Streams, TaskFault,
    Twist,
};
use crate::control_step::Reset;
use crate::random::{self, Stream};
use crate::scenario::{
    BenchmarkRoute, Crowd, IndexedScenario, NoFreeSpace, Scenario, draw_goal, draw_start_and_goal,
};

/// The choice of starts and goals.
#[derive(Resource, Clone, Copy, Debug, Default, PartialEq)]
pub enum EpisodeSetup {
    /// Random draws by the scenario's placement rules.
    #[default]
    Random,
    /// Always the same start, heading and goal.
    Route(BenchmarkRoute),
}

/// Set `Reset`: runs the schedule [`Reset`] if an arena has a pending reset.
pub(super) fn run_reset(world: &mut World, arenas: &mut QueryState<&Episode>) {
    if arenas.iter(world).any(|episode| episode.pending_reset != PendingReset::None) {
        world.run_schedule(Reset);
    }
}

/// The maximum number of layouts that are tried to find one with free space for a start and a goal.
const MAX_LAYOUT_ATTEMPTS: u32 = 50;

/// The components of an arena that a reset reads and writes.
type ResetData = (
    &'static Arena,
    &'static Clock,
    &'static mut ArenaLayout,
    &'static mut Pedestrians,
    &'static mut Pose,
    &'static mut Twist,
    &'static mut Goal,
    &'static mut Episode,
    &'static mut Streams,
);

/// The draw for an arena: a start, unless the robot stays where it is, and a goal.
type StartAndGoalDraw = (Option<Pose>, Goal);

/// `Draw`: draws a new goal; for a new episode also a new start, and a new layout if layouts vary by episode.
pub(super) fn draw(setup: Res<EpisodeSetup>, mut fault: ResMut<TaskFault>, mut arenas: Query<ResetData>) {
    for (arena, clock, mut layout, mut crowd, mut pose, mut twist, mut goal, mut episode, mut streams) in
        &mut arenas
    {
        if matches!(episode.pending_reset, PendingReset::None | PendingReset::Refresh) {
            continue;
        }
        if episode.pending_reset.begins_episode() {
            *episode = Episode { pending_reset: episode.pending_reset, ..Episode::default() };
            crowd.0 = Crowd::at_start(&layout.written);
        }
        let kept_pose = (episode.pending_reset == PendingReset::Goal).then_some(*pose);
        let varies = episode.pending_reset.begins_episode() && layout.written.varies_by_episode();
        // A layout without free space is replaced by another.
        let generates = varies && !layout.written.generators.is_empty();
        let mut attempts = if generates { MAX_LAYOUT_ATTEMPTS } else { 1 };
        let drawn = loop {
            if varies {
                let layout_seed = layout_seed(&layout.written, *clock, &mut streams.placement);
                layout.generate(layout_seed);
            }
            let drawn = match *setup {
                EpisodeSetup::Route(route) => Ok(start_and_goal(route)),
                EpisodeSetup::Random => draw_random(layout.indexed(&crowd), clock.0, kept_pose, &mut streams),
            };
            attempts -= 1;
            if drawn.is_ok() || attempts == 0 {
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

/// The layout seed of a new episode. With generators, it is drawn from `placement`. With only ranges or random slip, nothing
/// is drawn, so that starts and goals are the same as without them: the seed is then a function of the stream's state and of the
/// clock. The clock makes it change even if start and goal are fixed and the stream is never used.
fn layout_seed(written: &Scenario, clock: Clock, placement: &mut Stream) -> u64 {
    if !written.generators.is_empty() {
        return random::random_u64(placement);
    }
    random::derived_seed(placement, "ranges", clock.0)
}

/// The start and goal of a route.
fn start_and_goal(route: BenchmarkRoute) -> StartAndGoalDraw {
    let start = Pose { x_m: route.start_m.x, y_m: route.start_m.y, heading_rad: route.heading_rad };
    (Some(start), Goal { x_m: route.goal_m.x, y_m: route.goal_m.y })
}

/// Draws a goal for a robot that stays at `kept_pose`; also a start if `kept_pose` is `None` or no goal is far enough from it.
fn draw_random(
    scenario: IndexedScenario,
    step: u64,
    kept_pose: Option<Pose>,
    streams: &mut Streams,
) -> Result<StartAndGoalDraw, NoFreeSpace> {
    let stream = &mut streams.placement;
    let goal = kept_pose.map(|pose| draw_goal(scenario, step, vec2(pose.x_m, pose.y_m), stream));
    if let Some(Ok(Vec2 { x: x_m, y: y_m })) = goal {
        return Ok((None, Goal { x_m, y_m }));
    }
    let ((x_m, y_m, heading_rad), goal) = draw_start_and_goal(scenario, step, stream)?;
    Ok((Some(Pose { x_m, y_m, heading_rad }), Goal { x_m: goal.x, y_m: goal.y }))
}

/// Schedule `Reset`, last: clears the pending resets.
pub(super) fn clear_pending_resets(mut arenas: Query<&mut Episode>) {
    for mut episode in &mut arenas {
        episode.pending_reset = PendingReset::None;
    }
}
