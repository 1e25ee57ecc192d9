//! Arenas never see each other: whatever is done in the neighbours, by robots or by hand, each goes on to the bit as when
//! it is alone.

use bevy::math::vec2;
use wayfield::random::{Stream, stream, uniform, uniform_01, uniform_index};
use wayfield::scenario::Scenario;
use wayfield::sim;
use wayfield::task::{ArenaState, Clock, Observations, Streams};

use crate::common::{Lab, bits};
use crate::random_scenarios::{at_max_speed, free_pose, worlds};

const ARENAS: usize = 5;

/// All that there is of an arena after a step, as bytes: state, outcome, observation.
fn all_of(lab: &mut Lab, arena: usize, state: &ArenaState) -> Vec<u8> {
    let outcome = lab.outcomes()[arena];
    let rewards = bits(&[outcome.reward.total()]);
    let ends = (outcome.reached, outcome.collided, outcome.timed_out, outcome.inactive);
    let rows = lab.simulation.world().resource::<Observations>();
    let row = bits(rows.row(arena));
    postcard::to_stdvec(&(state, rewards, ends, row)).expect("bytes")
}

/// Arenas in one world, and each of them in a world of its own.
struct Pair {
    together: Lab,
    alone: Vec<Lab>,
}

impl Pair {
    fn new(scenario: &Scenario, seed: u64) -> Self {
        let mut together = Lab::new(scenario, ARENAS, seed);
        let states = together.states();
        let alone = states.iter().map(|state| {
            let mut lab = Lab::new(scenario, 1, seed + 1);
            sim::restore(lab.simulation.world_mut(), std::slice::from_ref(state));
            lab
        });
        Self { alone: alone.collect(), together }
    }

    /// The same hand in one arena, here and there.
    fn by_hand(&mut self, arena: usize, hand: impl Fn(&mut Lab, usize)) {
        hand(&mut self.together, arena);
        hand(&mut self.alone[arena], 0);
    }

    fn assert_alike(&mut self, what: &str) {
        let states = self.together.states();
        for (arena, state) in states.iter().enumerate() {
            let here = all_of(&mut self.together, arena, state);
            let own = self.alone[arena].state(0);
            let there = all_of(&mut self.alone[arena], 0, &own);
            assert_eq!(state, &own, "{what}: arena {arena}");
            assert!(here == there, "{what}: arena {arena} differs in a bit, or in what came of the step");
        }
    }
}

/// What a hand may do to an arena; where it leads to another robot, to the very place where that one stands.
fn meddle(pair: &mut Pair, arena: usize, stream: &mut Stream) {
    let states = pair.together.states();
    let neighbour = &states[uniform_index(stream, ARENAS)];
    let there = vec2(neighbour.pose.x_m, neighbour.pose.y_m);
    let room = pair.together.scenario.with_generated_obstacles(states[arena].layout_seed);
    let anywhere = free_pose(&room, 0, -0.2, stream).map_or(there, |pose| vec2(pose.x_m, pose.y_m));
    match uniform_index(stream, 6) {
        0 | 1 => pair.by_hand(arena, |lab, k| sim::move_robot(lab.simulation.world_mut(), k, there)),
        // Into a wall or an obstacle, perhaps.
        2 => pair.by_hand(arena, |lab, k| sim::move_robot(lab.simulation.world_mut(), k, anywhere)),
        3 => pair.by_hand(arena, |lab, k| sim::move_goal(lab.simulation.world_mut(), k, there)),
        4 => {
            // The obstacles jump to another moment, and the robot turns about.
            let later = uniform_index(stream, 5_000) as u64;
            pair.by_hand(arena, |lab, k| {
                lab.edit(k, |state| {
                    state.clock = Clock(later);
                    state.pose.heading_rad = 1.0;
                });
            });
        }
        _ => {
            // Everybody begins anew, this one with another stream.
            let seed = uniform_index(stream, 1_000) as u64;
            let fresh = |of: usize, state: &ArenaState| match of {
                of if of == arena => (Streams::new(seed, 77), Clock(seed)),
                _ => (state.streams.clone(), state.clock),
            };
            sim::reset_arenas(pair.together.simulation.world_mut(), |k| Some(fresh(k, &states[k])));
            for (k, lab) in pair.alone.iter_mut().enumerate() {
                sim::reset_arenas(lab.simulation.world_mut(), |_| Some(fresh(k, &states[k])));
            }
        }
    }
}

fn never_see_each_other(what: &str, scenario: &Scenario, number: u64) {
    let mut scenario = scenario.clone();
    scenario.task.max_episode_steps = scenario.task.max_episode_steps.min(25);
    let mut stream = stream(31, what, number);
    let mut pair = Pair::new(&scenario, number);
    // All at one place, where that is free in the first one's room.
    let first = pair.together.state(0);
    let together = vec2(first.pose.x_m, first.pose.y_m);
    for arena in 0..ARENAS {
        pair.by_hand(arena, |lab, k| sim::move_robot(lab.simulation.world_mut(), k, together));
    }
    pair.assert_alike(&format!("{what} {number}, all at {together:?}"));
    for step in 0..60 {
        let actions: Vec<usize> =
            (0..ARENAS).map(|_| uniform_index(&mut stream, scenario.robot.motions.len())).collect();
        pair.together.step(&actions);
        for (lab, action) in pair.alone.iter_mut().zip(&actions) {
            lab.step(&[*action]);
        }
        pair.assert_alike(&format!("{what} {number}, step {step}"));
        if uniform_01(&mut stream) < 0.3 {
            let arena = uniform_index(&mut stream, ARENAS);
            meddle(&mut pair, arena, &mut stream);
            pair.assert_alike(&format!("{what} {number}, a hand in arena {arena} after step {step}"));
        }
    }
}

#[test]
fn in_random_worlds_each_arena_is_as_if_alone() {
    for (number, scenario) in worlds(4, 40).enumerate() {
        never_see_each_other("world", &scenario, number as u64);
    }
}

#[test]
fn at_full_speed_each_arena_is_as_if_alone() {
    for (number, mut scenario) in worlds(5, 40).filter_map(at_max_speed).enumerate() {
        let mut stream = stream(32, "sensor", number as u64);
        scenario.lidar.noise_std_m = uniform(&mut stream, 0.001, 0.05);
        never_see_each_other("fast world", &scenario, number as u64);
    }
}
