//! Arenas: spawned from a scenario, rewound, saved and restored.
//!
//! In: a scenario, how many arenas, a seed. Out: one entity an arena, with the task's components, and its first
//! observation taken. Arenas are changed between control steps only.

use std::sync::Arc;

use bevy::prelude::*;
use bevy_rapier2d::prelude::*;

use super::lidar::BeamDirections;
use super::physics::{self, Bodies};
use super::{obstacles, robot};
use crate::control_step::Reset;
use crate::scenario::Scenario;
use crate::task::{
    Actions, Arena, ArenaLayout, ArenaState, Clock, CurrentScenario, Episode, ExtraRewards, Goal,
    ObservationLayout, Observations, PendingReset, Pose, Scan, SensorReadings, StepOutcome, StepOutcomes,
    Streams, TaskFault, Twist, observation,
};

/// Replaces whatever arenas there are by `arenas` new ones of `scenario`, with the streams of `seed`, and begins an
/// episode in each.
pub fn spawn_arenas(world: &mut World, scenario: &Arc<Scenario>, arenas: usize, seed: u64) {
    physics::despawn_all(world);
    world.insert_resource(CurrentScenario(scenario.clone()));
    world.insert_resource(BeamDirections::from_lidar(&scenario.lidar));
    let layout = world.resource::<ObservationLayout>();
    let (width, extra) = (layout.width(scenario.lidar.beams), layout.extra_width());
    world.resource_mut::<Observations>().resize(arenas, width);
    world.resource_mut::<ExtraRewards>().resize(arenas);
    world.resource_mut::<Actions>().0 = vec![0; arenas];
    world.resource_mut::<StepOutcomes>().0 = vec![StepOutcome::default(); arenas];
    for index in 0..arenas {
        let arena = world
            .spawn((
                Arena(index),
                ArenaLayout { layout_seed: 0, scenario: scenario.clone() },
                Pose::default(),
                Twist::default(),
                (Scan::default(), SensorReadings::zeros(extra)),
                Goal::default(),
                Clock::default(),
                Episode { pending_reset: PendingReset::Full, ..Episode::default() },
                Streams::new(seed, index as u64),
                physics::context(scenario.task.control_period_s),
            ))
            .id();
        physics::spawn_bodies(world, scenario, arena);
    }
    physics::make_bodies(world);
    world.run_schedule(Reset);
}

/// Begins anew in every arena, with the streams and the clock that `fresh` gives for its number; where it gives none,
/// the arena is parked.
pub fn reset_arenas(world: &mut World, mut fresh: impl FnMut(usize) -> Option<(Streams, Clock)>) {
    let mut arenas = world.query::<(&Arena, &mut Streams, &mut Clock, &mut Episode)>();
    for (arena, mut streams, mut clock, mut episode) in arenas.iter_mut(world) {
        *episode = match fresh(arena.0) {
            Some(begin) => {
                (*streams, *clock) = begin;
                Episode { pending_reset: PendingReset::Full, ..Episode::default() }
            }
            None => Episode { inactive: true, ..Episode::default() },
        };
    }
    world.run_schedule(Reset);
}

/// The state of every arena, by number.
pub fn snapshot(world: &mut World) -> Vec<ArenaState> {
    let mut arenas = world.query::<(
        &Arena,
        &ArenaLayout,
        &Pose,
        &Twist,
        (&Scan, &SensorReadings),
        &Goal,
        &Clock,
        &Episode,
        &Streams,
    )>();
    let mut states: Vec<(usize, ArenaState)> = arenas
        .iter(world)
        .map(|(arena, layout, pose, twist, (scan, readings), goal, clock, episode, streams)| {
            let state = ArenaState {
                pose: *pose,
                twist: *twist,
                scan: scan.clone(),
                readings: readings.as_slice().to_vec(),
                goal: *goal,
                clock: *clock,
                layout_seed: layout.layout_seed,
                episode: episode.clone(),
                streams: streams.clone(),
            };
            (arena.0, state)
        })
        .collect();
    states.sort_by_key(|(index, _)| *index);
    states.into_iter().map(|(_, state)| state).collect()
}

/// Puts every arena back as [`snapshot`] found it, and rewrites the current observations from the saved scans.
/// `states` must have one entry for each arena.
pub fn restore(world: &mut World, states: &[ArenaState]) {
    let scenario = world.resource::<CurrentScenario>().0.clone();
    let mut rows = world.remove_resource::<Observations>().unwrap_or_default();
    let width = rows.width;
    let encoding = world.resource::<ObservationLayout>().encoding;
    let mut arenas = world.query::<(
        &Arena,
        &mut Bodies,
        &mut RapierRigidBodySet,
        &mut RapierContextColliders,
        (
            &mut ArenaLayout,
            &mut Pose,
            &mut Twist,
            (&mut Scan, &mut SensorReadings),
            &mut Goal,
            &mut Clock,
            &mut Episode,
            &mut Streams,
        ),
    )>();
    for (arena, mut bodies, mut set, mut colliders, components) in arenas.iter_mut(world) {
        let Some(state) = states.get(arena.0) else { continue };
        let (
            mut layout,
            mut pose,
            mut twist,
            (mut scan, mut readings),
            mut goal,
            mut clock,
            mut episode,
            mut streams,
        ) = components;
        *layout = ArenaLayout::new(&scenario, state.layout_seed);
        *pose = state.pose;
        *twist = state.twist;
        *scan = state.scan.clone();
        *readings = SensorReadings::from_saved(&state.readings);
        *goal = state.goal;
        *clock = state.clock;
        *episode = state.episode.clone();
        *streams = state.streams.clone();
        robot::place_body(&mut set, &bodies, &pose);
        obstacles::place_generated_obstacles(&scenario, &layout, &mut bodies, &mut colliders);
        obstacles::place_bodies(&layout, *clock, &bodies, &mut set, &mut colliders);
        let row = &mut rows.current[arena.0 * width..][..width];
        observation::encode(encoding, &scan, &pose, &goal, &readings, row);
    }
    world.insert_resource(rows);
}

/// Puts `scenario` under the arenas as they stand: the same episodes go on in the changed world, which their robots
/// sense at once. The number of beams must be the same.
pub fn change_scenario(world: &mut World, scenario: &Arc<Scenario>) {
    let states = snapshot(world);
    let (fault, actions) = (world.resource::<TaskFault>().clone(), world.resource::<Actions>().clone());
    spawn_arenas(world, scenario, states.len(), 0);
    world.insert_resource(fault);
    world.insert_resource(actions);
    restore(world, &states);
    sense_anew(world, |_| true);
}

/// Begins anew in every arena, in another world: streams and clocks go on, layouts, starts and goals are drawn there.
/// The number of beams and that of the robot's motions must be the same.
pub fn reset_with_scenario(world: &mut World, scenario: &Arc<Scenario>) {
    let (states, fault) = (snapshot(world), world.resource::<TaskFault>().clone());
    spawn_arenas(world, scenario, states.len(), 0);
    // What was drawn for a moment is gone.
    world.insert_resource(fault);
    reset_arenas(world, |arena| states.get(arena).map(|state| (state.streams.clone(), state.clock)));
}

/// Puts the robot of `arena` at `to_m`, its heading as it is; the episode goes on from there.
pub fn move_robot(world: &mut World, arena: usize, to_m: Vec2) {
    let mut arenas = world.query::<(&Arena, &mut Pose)>();
    for (_, mut pose) in arenas.iter_mut(world).filter(|(other, _)| other.0 == arena) {
        (pose.x_m, pose.y_m) = to_m.into();
    }
    sense_anew(world, |other| other == arena);
}

/// Puts the target of `arena` at `to_m`; the episode goes on.
pub fn move_goal(world: &mut World, arena: usize, to_m: Vec2) {
    let mut arenas = world.query::<(&Arena, &mut Goal)>();
    for (_, mut goal) in arenas.iter_mut(world).filter(|(other, _)| other.0 == arena) {
        (goal.x_m, goal.y_m) = to_m.into();
    }
    sense_anew(world, |other| other == arena);
}

/// Bodies, scans, observations and potentials of the arenas that are `meant` follow what was moved in them.
fn sense_anew(world: &mut World, meant: impl Fn(usize) -> bool) {
    let mut arenas = world.query::<(&Arena, &mut Episode)>();
    for (_, mut episode) in arenas.iter_mut(world).filter(|(arena, _)| meant(arena.0)) {
        episode.pending_reset = PendingReset::Refresh;
    }
    world.run_schedule(Reset);
}
