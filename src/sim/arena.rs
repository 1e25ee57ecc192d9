//! Arenas: spawned from a scenario, reset, saved, restored and edited.
//!
//! In: a scenario, a number of arenas, a seed. Out: one entity per arena, with the task's components and its first
//! observation. Call these functions between control steps only.

use std::sync::Arc;

use bevy::prelude::*;
use bevy_rapier2d::prelude::{RapierContextColliders, RapierContextSimulation, RapierRigidBodySet};

use super::physics::{self, ArenaBodies, Bodies, KeptBodies};
use super::{obstacles, robot};
use crate::control_step::Reset;
use crate::scenario::Scenario;
use crate::task::{
    Actions, Arena, ArenaLayout, ArenaScenario, ArenaState, Clock, CurrentScenario, Episode, EstimatedPose,
    ExtraRewards, Goal, ObservationLayout, Observations, PathLengths, Pedestrians, PendingReset, Pose, Scan,
    ScanMemory, ScenarioChoice, ScenarioPool, SensorReadings, StepOutcome, StepOutcomes, Streams, TaskFault,
    Twist, observation,
};

/// Replaces all arenas with `arenas` new arenas of `scenario` with the random streams of `seed`, and starts an episode in
/// each.
pub fn spawn_arenas(world: &mut World, scenario: &Arc<Scenario>, arenas: usize, seed: u64) {
    let mut old = world.query_filtered::<Entity, With<RapierContextSimulation>>();
    for arena in old.iter(world).collect::<Vec<_>>() {
        world.despawn(arena);
    }
    world.insert_resource(CurrentScenario(scenario.clone()));
    let layout = world.resource::<ObservationLayout>();
    let (width, extra) = (layout.width(scenario.lidar.beams), layout.extra_width());
    world.resource_mut::<Observations>().resize(arenas, width);
    world.resource_mut::<ExtraRewards>().resize(arenas);
    world.resource_mut::<Actions>().0 = vec![0; arenas];
    world.resource_mut::<StepOutcomes>().0 = vec![StepOutcome::default(); arenas];
    let has_pool = world.contains_resource::<ScenarioPool>();
    let (layout, bodies) = (ArenaLayout::as_written(scenario), ArenaBodies::new(scenario));
    for index in 0..arenas {
        let mut arena = world.spawn((
            Arena(index),
            layout.clone(),
            (Pose::default(), EstimatedPose::default()),
            Twist::default(),
            (Scan::default(), SensorReadings::zeros(extra), ScanMemory::default()),
            (Goal::default(), PathLengths::default()),
            (Clock::default(), Pedestrians::default()),
            Episode { pending_reset: PendingReset::Full, ..Episode::default() },
            Streams::new(seed, index as u64),
            physics::context(bodies.clone()),
        ));
        if has_pool {
            arena.insert(ArenaScenario::new(seed, index as u64));
        }
    }
    world.run_schedule(Reset);
}

/// Starts a new episode in every arena, with the streams and clock that `start` returns for the arena's index. An arena
/// for which it returns `None` becomes inactive.
pub fn reset_arenas(world: &mut World, mut start: impl FnMut(usize) -> Option<(Streams, Clock)>) {
    let mut arenas = world.query::<(&Arena, &mut Streams, &mut Clock, &mut Episode)>();
    for (arena, mut streams, mut clock, mut episode) in arenas.iter_mut(world) {
        *episode = match start(arena.0) {
            Some(streams_and_clock) => {
                (*streams, *clock) = streams_and_clock;
                Episode { pending_reset: PendingReset::Full, ..Episode::default() }
            }
            None => Episode { inactive: true, ..Episode::default() },
        };
    }
    world.run_schedule(Reset);
}

/// Sets the scenario of each arena's next episodes, one of the [`ScenarioPool`]. The arenas no longer draw scenarios. Does
/// nothing without a pool.
pub fn assign_scenarios(world: &mut World, choice: impl Fn(usize) -> ScenarioChoice) {
    let mut arenas = world.query::<(&Arena, &mut ArenaScenario)>();
    for (arena, mut scenario) in arenas.iter_mut(world) {
        *scenario = ArenaScenario { choice: choice(arena.0), stream: None };
    }
}

/// Lets the selected arenas draw the scenarios of their next episodes with the random streams of `seed`. Does nothing without a
/// [`ScenarioPool`].
pub(crate) fn seed_scenarios(world: &mut World, seed: u64, is_selected: impl Fn(usize) -> bool) {
    let mut arenas = world.query::<(&Arena, &mut ArenaScenario)>();
    for (arena, mut scenario) in arenas.iter_mut(world).filter(|(arena, _)| is_selected(arena.0)) {
        *scenario = ArenaScenario::new(seed, arena.0 as u64);
    }
}

/// Restarts each arena for whose index `reset` returns a pending reset. If it also returns streams, the arena gets them, and
/// its clock starts at 0. The other arenas stay as they are.
pub fn restart_arenas(
    world: &mut World,
    mut reset: impl FnMut(usize) -> Option<(PendingReset, Option<Streams>)>,
) {
    let mut arenas = world.query::<(&Arena, &mut Streams, &mut Clock, &mut Episode)>();
    for (arena, mut streams, mut clock, mut episode) in arenas.iter_mut(world) {
        let Some((pending_reset, new_streams)) = reset(arena.0) else { continue };
        if let Some(new_streams) = new_streams {
            (*streams, *clock) = (new_streams, Clock::default());
        }
        (episode.pending_reset, episode.inactive) = (pending_reset, false);
    }
    world.run_schedule(Reset);
}

/// The states of all arenas, in the order of their indices.
pub fn snapshot(world: &mut World) -> Vec<ArenaState> {
    let mut arenas = world.query::<(
        &Arena,
        (&ArenaLayout, Option<&ArenaScenario>),
        (&Pose, &EstimatedPose),
        &Twist,
        (&Scan, &SensorReadings, &ScanMemory),
        &Goal,
        (&Clock, &Pedestrians),
        &Episode,
        &Streams,
    )>();
    let mut states: Vec<(usize, ArenaState)> = arenas
        .iter(world)
        .map(
            |(
                arena,
                (layout, scenario),
                (pose, estimate),
                twist,
                (scan, readings, memory),
                goal,
                (clock, pedestrians),
                episode,
                streams,
            )| {
                let state = ArenaState {
                    pose: *pose,
                    estimated_pose: estimate.0,
                    twist: *twist,
                    scan: scan.clone(),
                    readings: readings.as_slice().to_vec(),
                    observer_memory: memory.observer_memory(),
                    goal: *goal,
                    clock: *clock,
                    pedestrians: pedestrians.clone(),
                    layout_seed: layout.layout_seed,
                    scenario: scenario.cloned(),
                    episode: episode.clone(),
                    streams: streams.clone(),
                };
                (arena.0, state)
            },
        )
        .collect();
    states.sort_by_key(|(index, _)| *index);
    states.into_iter().map(|(_, state)| state).collect()
}

/// Restores every arena to a state from [`snapshot`], and encodes the current observations from the saved scans.
/// `states` must have one entry per arena.
pub fn restore(world: &mut World, states: &[ArenaState]) {
    let mut observations = world.remove_resource::<Observations>().unwrap_or_default();
    let width = observations.width;
    let encoding = world.resource::<ObservationLayout>().encoding;
    let mut arenas = world.query::<(
        &Arena,
        (&mut Bodies, &mut RapierContextSimulation, &mut RapierRigidBodySet, &mut RapierContextColliders),
        (
            (&mut ArenaLayout, Option<&mut ArenaScenario>),
            (&mut Pose, &mut EstimatedPose),
            &mut Twist,
            (&mut Scan, &mut SensorReadings, &mut ScanMemory),
            &mut Goal,
            (&mut Clock, &mut Pedestrians),
            &mut Episode,
            &mut Streams,
        ),
    )>();
    let pool = world.get_resource::<ScenarioPool>().cloned();
    let mut kept = KeptBodies::default();
    for (arena, physics, components) in arenas.iter_mut(world) {
        let (mut bodies, mut context, mut set, mut colliders) = physics;
        let Some(state) = states.get(arena.0) else { continue };
        let (
            (mut layout, member),
            (mut pose, mut estimate),
            mut twist,
            (mut scan, mut readings, mut memory),
            mut goal,
            (mut clock, mut pedestrians),
            mut episode,
            mut streams,
        ) = components;
        if let (Some(mut member), Some(saved)) = (member, &state.scenario) {
            *member = saved.clone();
        }
        let saved = pool.as_ref().zip(state.scenario.as_ref());
        if let Some(saved) = saved.and_then(|(pool, saved)| pool.layout(saved.choice).ok().flatten()) {
            *layout = saved;
        }
        layout.generate(state.layout_seed);
        kept.replace(&layout, &mut bodies, &mut context, &mut set, &mut colliders);
        *pose = state.pose;
        let drifts = layout.scenario.robot.odometry_drift.is_some();
        estimate.0 = if drifts { state.estimated_pose } else { state.pose };
        *twist = state.twist;
        *scan = state.scan.clone();
        *readings = SensorReadings::from_saved(&state.readings);
        memory.restore(encoding, &layout.written, &state.observer_memory, &state.twist);
        *goal = state.goal;
        *clock = state.clock;
        pedestrians.clone_from(&state.pedestrians);
        *episode = state.episode.clone();
        *streams = state.streams.clone();
        robot::place_body(&mut set, &bodies, &pose);
        obstacles::place_generated_obstacles(&layout, &mut bodies, &mut colliders);
        obstacles::place_bodies(layout.indexed(&pedestrians), *clock, &bodies, &mut set, &mut colliders);
        let row = &mut observations.current[arena.0 * width..][..width];
        observation::encode(encoding, &memory, &scan, (&estimate.0, &goal), &readings, row);
    }
    world.insert_resource(observations);
}

/// Replaces the scenario and continues the current episodes in it, with new scans and observations. The number of LIDAR
/// beams must be the same.
pub fn change_scenario(world: &mut World, scenario: &Arc<Scenario>) {
    let mut states = snapshot(world);
    let old = world.resource::<CurrentScenario>().0.clone();
    for state in &mut states {
        state.pedestrians.0.follow_change(&old, scenario);
    }
    let (fault, actions) = (world.resource::<TaskFault>().clone(), world.resource::<Actions>().clone());
    spawn_arenas(world, scenario, states.len(), 0);
    world.insert_resource(fault);
    world.insert_resource(actions);
    restore(world, &states);
    refresh(world, |_| true);
}

/// Replaces the scenario and starts a new episode in every arena. Random streams and clocks continue; layouts, starts and
/// goals are drawn in the new scenario. The numbers of LIDAR beams and of the robot's motions must be the same.
///
/// All later episodes have this scenario, too: a [`ScenarioPool`] is removed.
pub fn reset_with_scenario(world: &mut World, scenario: &Arc<Scenario>) {
    let (states, fault) = (snapshot(world), world.resource::<TaskFault>().clone());
    world.remove_resource::<ScenarioPool>();
    spawn_arenas(world, scenario, states.len(), 0);
    // Discards any fault of the temporary episodes above.
    world.insert_resource(fault);
    reset_arenas(world, |arena| states.get(arena).map(|state| (state.streams.clone(), state.clock)));
}

/// Moves the robot of `arena` to `to_m`, in m, with the same heading. The episode continues.
pub fn move_robot(world: &mut World, arena: usize, to_m: Vec2) {
    let mut arenas = world.query::<(&Arena, &mut Pose)>();
    for (_, mut pose) in arenas.iter_mut(world).filter(|(other, _)| other.0 == arena) {
        (pose.x_m, pose.y_m) = to_m.into();
    }
    refresh(world, |other| other == arena);
}

/// Moves the goal of `arena` to `to_m`, in m. The episode continues.
pub fn move_goal(world: &mut World, arena: usize, to_m: Vec2) {
    let mut arenas = world.query::<(&Arena, &mut Goal)>();
    for (_, mut goal) in arenas.iter_mut(world).filter(|(other, _)| other.0 == arena) {
        (goal.x_m, goal.y_m) = to_m.into();
    }
    refresh(world, |other| other == arena);
}

/// Updates bodies, scans, observations and potentials of the selected arenas after an edit.
fn refresh(world: &mut World, is_selected: impl Fn(usize) -> bool) {
    let mut arenas = world.query::<(&Arena, &mut Episode)>();
    for (_, mut episode) in arenas.iter_mut(world).filter(|(arena, _)| is_selected(arena.0)) {
        episode.pending_reset = PendingReset::Refresh;
    }
    world.run_schedule(Reset);
}
