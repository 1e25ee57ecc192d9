//! Arenas do not influence each other: an arena among others has the same bits as an arena alone, whatever robots and users
//! do in the others.

use bevy::math::vec2;
use wayfield::random::{Stream, stream, uniform, uniform_01, uniform_index};
use wayfield::scenario::Scenario;
use wayfield::sim;
use wayfield::task::{ArenaState, Clock, Observations, Streams};

use crate::common::{Lab, bits};
use crate::random_scenarios::{at_max_speed, free_pose, scenarios};

const ARENAS: usize = 5;

/// An arena after a step, as bytes: the state (without the parts that serde skips), the outcome and the observation.
fn arena_bytes(lab: &mut Lab, arena: usize, state: &ArenaState) -> Vec<u8> {
    let outcome = lab.outcomes()[arena];
    let rewards = bits(&[outcome.reward.total()]);
    let ends = (outcome.reached, outcome.collided, outcome.timed_out, outcome.inactive);
    let rows = lab.simulation.world().resource::<Observations>();
    let row = bits(rows.row(arena));
    postcard::to_stdvec(&(state, rewards, ends, row)).expect("bytes")
}

/// Arenas in one simulation, and the same arenas in separate simulations.
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

    /// Applies the same edit to `arena` in both simulations.
    fn edit(&mut self, arena: usize, edit: impl Fn(&mut Lab, usize)) {
        edit(&mut self.together, arena);
        edit(&mut self.alone[arena], 0);
    }

    fn assert_equal(&mut self, what: &str) {
        let states = self.together.states();
        for (arena, state) in states.iter().enumerate() {
            let together = arena_bytes(&mut self.together, arena, state);
            let alone_state = self.alone[arena].state(0);
            let alone = arena_bytes(&mut self.alone[arena], 0, &alone_state);
            assert_eq!(state, &alone_state, "{what}: arena {arena}");
            assert!(together == alone, "{what}: state, outcome or observation of arena {arena} differs");
        }
    }
}

/// Applies a random edit to an arena. Some move its robot or goal to the position of a robot in another arena.
fn random_edit(pair: &mut Pair, arena: usize, stream: &mut Stream) {
    let states = pair.together.states();
    let neighbour = &states[uniform_index(stream, ARENAS)];
    let at_neighbour = vec2(neighbour.pose.x_m, neighbour.pose.y_m);
    let layout = pair.together.scenario.with_generated_obstacles(states[arena].layout_seed);
    let anywhere = free_pose(&layout, 0, -0.2, stream).map_or(at_neighbour, |pose| vec2(pose.x_m, pose.y_m));
    match uniform_index(stream, 6) {
        0 | 1 => pair.edit(arena, |lab, k| sim::move_robot(lab.simulation.world_mut(), k, at_neighbour)),
        // Possibly into a wall or an obstacle.
        2 => pair.edit(arena, |lab, k| sim::move_robot(lab.simulation.world_mut(), k, anywhere)),
        3 => pair.edit(arena, |lab, k| sim::move_goal(lab.simulation.world_mut(), k, at_neighbour)),
        4 => {
            // Another clock for the obstacles, and another heading for the robot.
            let later = uniform_index(stream, 5_000) as u64;
            pair.edit(arena, |lab, k| {
                lab.edit(k, |state| {
                    state.clock = Clock(later);
                    state.pose.heading_rad = 1.0;
                });
            });
        }
        _ => {
            // A reset of all arenas, with new streams for this one.
            let seed = uniform_index(stream, 1_000) as u64;
            let start = |of: usize, state: &ArenaState| match of {
                of if of == arena => (Streams::new(seed, 77), Clock(seed)),
                _ => (state.streams.clone(), state.clock),
            };
            sim::reset_arenas(pair.together.simulation.world_mut(), |k| Some(start(k, &states[k])));
            for (k, lab) in pair.alone.iter_mut().enumerate() {
                sim::reset_arenas(lab.simulation.world_mut(), |_| Some(start(k, &states[k])));
            }
        }
    }
}

/// Asserts over 60 steps with random edits that every arena has the same bits together with others as alone.
fn assert_independent(what: &str, scenario: &Scenario, number: u64) {
    let mut scenario = scenario.clone();
    scenario.task.max_episode_steps = scenario.task.max_episode_steps.min(25);
    let mut stream = stream(31, what, number);
    let mut pair = Pair::new(&scenario, number);
    // Moves all robots to the position of the robot in arena 0.
    let first = pair.together.state(0);
    let position = vec2(first.pose.x_m, first.pose.y_m);
    for arena in 0..ARENAS {
        pair.edit(arena, |lab, k| sim::move_robot(lab.simulation.world_mut(), k, position));
    }
    pair.assert_equal(&format!("{what} {number}, all robots at {position:?}"));
    for step in 0..60 {
        let actions: Vec<usize> =
            (0..ARENAS).map(|_| uniform_index(&mut stream, scenario.robot.motions.len())).collect();
        pair.together.step(&actions);
        for (lab, action) in pair.alone.iter_mut().zip(&actions) {
            lab.step(&[*action]);
        }
        pair.assert_equal(&format!("{what} {number}, step {step}"));
        if uniform_01(&mut stream) < 0.3 {
            let arena = uniform_index(&mut stream, ARENAS);
            random_edit(&mut pair, arena, &mut stream);
            pair.assert_equal(&format!("{what} {number}, edit of arena {arena} after step {step}"));
        }
    }
}

#[test]
fn in_random_scenarios_each_arena_has_the_same_bits_as_alone() {
    for (number, scenario) in scenarios(4, 40).enumerate() {
        assert_independent("world", &scenario, number as u64);
    }
}

#[test]
fn at_full_speed_each_arena_has_the_same_bits_as_alone() {
    for (number, mut scenario) in scenarios(5, 40).filter_map(at_max_speed).enumerate() {
        let mut stream = stream(32, "sensor", number as u64);
        scenario.lidar.noise_std_m = uniform(&mut stream, 0.001, 0.05).into();
        assert_independent("fast world", &scenario, number as u64);
    }
}
