//! An arena's fate depends on the seed, its number and its actions: on nothing else.

mod common;

use bevy::prelude::*;
use common::{Lab, bits};
use wayfield::control_step::{ControlSet, ControlStep};
use wayfield::scenario::{Generator, RandomShape, Scenario};
use wayfield::sim;
use wayfield::simulation::{Extensions, SimulationBuilder};
use wayfield::task::{Clock, EpisodeEnd, Pose, RewardConfig, Streams, TaskMode};

const STEPS: usize = 300;

/// Short episodes, so that 300 steps see time-outs too.
fn restless(mut scenario: Scenario) -> Scenario {
    scenario.task.max_episode_steps = 70;
    scenario
}

/// All that can be seen of each arena, bit by bit: by arena, by step.
fn tracks(lab: &mut Lab, arenas: usize) -> Vec<Vec<Vec<u32>>> {
    let mut action_streams = common::action_streams(arenas);
    let mut tracks = vec![Vec::with_capacity(STEPS + 1); arenas];
    for step in 0..=STEPS {
        if step > 0 {
            let actions = common::steer_to_goal(lab, &mut action_streams);
            lab.step(&actions);
        }
        for (arena, state) in lab.states().into_iter().enumerate() {
            let Pose { x_m, y_m, heading_rad } = state.pose;
            let mut seen = vec![x_m, y_m, heading_rad, state.goal.x_m, state.goal.y_m];
            seen.push(lab.outcomes()[arena].reward.total());
            seen.push(state.scan.nearest_m);
            seen.extend(&state.scan.ranges_m);
            seen.extend(lab.row(arena));
            tracks[arena].push(bits(&seen));
        }
    }
    tracks
}

fn assert_same(what: &str, arena: usize, one: &[Vec<u32>], other: &[Vec<u32>]) {
    assert_eq!(one.len(), other.len());
    if let Some(step) = (0..one.len()).find(|&step| one[step] != other[step]) {
        let first = (0..one[step].len()).find(|&i| one[step][i] != other[step][i]);
        panic!("{what}: arena {arena} departs at step {step}, number {first:?} of x, y, heading, goal, ...");
    }
}

fn arena_k_is_the_same_among_however_many(scenario: &Scenario) {
    let scenario = restless(scenario.clone());
    let mut lab = Lab::new(&scenario, 64, 5);
    let among_64 = tracks(&mut lab, 64);
    let ended = lab.take_ended_episodes();
    for end in [EpisodeEnd::Collided, EpisodeEnd::TimedOut] {
        assert!(ended.iter().any(|episode| episode.end == end), "the 300 steps see {end:?}");
    }
    assert!(ended.iter().any(|episode| episode.goals > 0), "and reached goals");
    for arenas in [1, 2, 7] {
        let among_few = tracks(&mut Lab::new(&scenario, arenas, 5), arenas);
        for (arena, track) in among_few.iter().enumerate() {
            assert_same(&format!("{}, {arenas} arenas or 64", scenario.name), arena, track, &among_64[arena]);
        }
    }
    for a in 0..64 {
        for b in 0..a {
            assert_ne!(among_64[a][0], among_64[b][0], "arenas {a} and {b} have streams of their own");
        }
    }
}

#[test]
fn arena_k_moves_and_senses_the_same_bits_among_1_2_7_or_64_still_obstacles() {
    arena_k_is_the_same_among_however_many(&common::four_cylinders());
}

#[test]
fn arena_k_moves_and_senses_the_same_bits_among_1_2_7_or_64_moving_obstacles() {
    arena_k_is_the_same_among_however_many(&common::moving_obstacles());
}

#[test]
fn arena_k_moves_and_senses_the_same_bits_among_1_2_7_or_64_with_generated_obstacles() {
    let shape = RandomShape::Circle { radius_m: (0.1, 0.2) };
    let generators = vec![Generator { count: 4, shape, gap_m: 0.3, within: None }];
    arena_k_is_the_same_among_however_many(&Scenario { generators, ..common::moving_obstacles() });
}

/// Arenas that stand still at different times, and go on together: rapier's working memory, which they share, sees them in
/// turn.
#[test]
fn arena_k_is_the_same_among_7_or_64_when_others_are_parked_and_rewound() {
    let scenario = restless(common::moving_obstacles());
    let navigate = |arenas: usize| {
        let mut lab = Lab::with(&scenario, arenas, 5, RewardConfig::default(), TaskMode::SingleGoal);
        let first = tracks(&mut lab, arenas);
        assert!(lab.states().iter().all(|state| state.episode.inactive), "300 steps end them all");
        let fresh = |arena: usize| Some((Streams::new(6, arena as u64), Clock(0)));
        sim::reset_arenas(lab.simulation.world_mut(), fresh);
        let second = tracks(&mut lab, arenas);
        first.into_iter().zip(second).map(|(first, second)| [first, second].concat()).collect::<Vec<_>>()
    };
    let among_64 = navigate(64);
    for (arena, track) in navigate(7).iter().enumerate() {
        assert_same("7 arenas or 64", arena, track, &among_64[arena]);
    }
}

#[test]
fn arena_k_moves_and_senses_the_same_bits_among_1_2_7_or_64_with_a_noisy_lidar() {
    let mut scenario = common::moving_obstacles();
    (scenario.lidar.noise_std_m, scenario.lidar.dropout) = (0.02, 0.05);
    arena_k_is_the_same_among_however_many(&scenario);
}

#[test]
fn arena_k_moves_and_senses_the_same_bits_among_1_2_7_or_64_with_a_drive_that_lags() {
    let mut scenario = common::moving_obstacles();
    scenario.robot.actuator_lag_s = 0.3;
    arena_k_is_the_same_among_however_many(&scenario);
}

#[test]
fn the_same_seed_gives_the_same_bits_and_another_seed_other_starts() {
    let scenario = restless(common::moving_obstacles());
    let run = |seed| tracks(&mut Lab::new(&scenario, 4, seed), 4);
    let (one, two, other) = (run(11), run(11), run(12));
    for arena in 0..4 {
        assert_same("the same seed twice", arena, &one[arena], &two[arena]);
        assert_ne!(one[arena][0], other[arena][0], "another seed starts arena {arena} elsewhere");
    }
}

#[test]
fn an_app_that_is_populated_again_is_as_good_as_a_fresh_one() {
    let scenario = restless(common::moving_obstacles());
    let fresh = tracks(&mut Lab::new(&scenario, 5, 21), 5);
    let mut used = Lab::new(&common::four_cylinders(), 9, 1);
    tracks(&mut used, 9);
    used.spawn_arenas(&scenario, 5, 21);
    let again = tracks(&mut used, 5);
    for arena in 0..5 {
        assert_same("populated again", arena, &again[arena], &fresh[arena]);
    }
}

#[test]
fn all_systems_of_world_and_task_have_an_order() {
    // An ambiguity is an error when a schedule is built, and an error there panics.
    Lab::new(&common::moving_obstacles(), 1, 1).step(&[2]);
}

#[test]
#[should_panic(expected = "ambigu")]
fn a_system_that_leaves_its_order_open_is_refused() {
    fn meddle(mut poses: Query<&mut Pose>) {
        poses.iter_mut().for_each(|mut pose| pose.x_m += 1.0);
    }
    #[derive(Clone)]
    struct Meddler;
    impl Plugin for Meddler {
        fn build(&self, app: &mut App) {
            app.add_systems(ControlStep, meddle.in_set(ControlSet::Sense));
        }
    }
    let scenario = std::sync::Arc::new(common::moving_obstacles());
    let extensions = Extensions::default().plugin(Meddler);
    let _ = SimulationBuilder::new(&scenario).extensions(&extensions).build().step();
}
