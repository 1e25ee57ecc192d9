//! The trajectory of an arena depends on the seed, the arena's number and its actions alone.

mod common;

use bevy::prelude::*;
use common::{Lab, bits};
use wayfield::control_step::{ControlSet, ControlStep};
use wayfield::scenario::{Generator, RandomShape, Scenario};
use wayfield::sim;
use wayfield::simulation::{Extensions, SimulationBuilder};
use wayfield::task::{Clock, EpisodeEnd, Pose, RewardConfig, Streams, TaskMode};

const STEPS: usize = 300;

/// The scenario with short episodes, so that some reach the time limit within 300 steps.
fn with_short_episodes(mut scenario: Scenario) -> Scenario {
    scenario.task.max_episode_steps = 70;
    scenario
}

/// Everything observable of each arena, as bits, by arena and step.
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
            let mut numbers = vec![x_m, y_m, heading_rad, state.goal.x_m, state.goal.y_m];
            numbers.push(lab.outcomes()[arena].reward.total());
            numbers.push(state.scan.nearest_m);
            numbers.extend(&state.scan.ranges_m);
            numbers.extend(lab.row(arena));
            tracks[arena].push(bits(&numbers));
        }
    }
    tracks
}

fn assert_same(what: &str, arena: usize, one: &[Vec<u32>], other: &[Vec<u32>]) {
    assert_eq!(one.len(), other.len());
    if let Some(step) = (0..one.len()).find(|&step| one[step] != other[step]) {
        let first = (0..one[step].len()).find(|&i| one[step][i] != other[step][i]);
        panic!(
            "{what}: arena {arena} differs at step {step} in number {first:?} of x, y, heading, goal, ..."
        );
    }
}

fn assert_independent_of_number_of_arenas(scenario: &Scenario) {
    let scenario = with_short_episodes(scenario.clone());
    let mut lab = Lab::new(&scenario, 64, 5);
    let among_64 = tracks(&mut lab, 64);
    let ended = lab.take_ended_episodes();
    for end in [EpisodeEnd::Collided, EpisodeEnd::TimedOut] {
        assert!(ended.iter().any(|episode| episode.end == end), "an episode ends with {end:?} in 300 steps");
    }
    assert!(ended.iter().any(|episode| episode.goals > 0), "a goal is reached in 300 steps");
    for arenas in [1, 2, 7] {
        let among_few = tracks(&mut Lab::new(&scenario, arenas, 5), arenas);
        for (arena, track) in among_few.iter().enumerate() {
            let what = format!("{}, {arenas} and 64 arenas", scenario.name);
            assert_same(&what, arena, track, &among_64[arena]);
        }
    }
    for a in 0..64 {
        for b in 0..a {
            assert_ne!(among_64[a][0], among_64[b][0], "arenas {a} and {b} have different streams");
        }
    }
}

#[test]
fn arena_k_has_the_same_bits_among_1_2_7_or_64_with_static_obstacles() {
    assert_independent_of_number_of_arenas(&common::four_cylinders());
}

#[test]
fn arena_k_has_the_same_bits_among_1_2_7_or_64_with_moving_obstacles() {
    assert_independent_of_number_of_arenas(&common::moving_obstacles());
}

#[test]
fn arena_k_has_the_same_bits_among_1_2_7_or_64_with_pedestrians() {
    assert_independent_of_number_of_arenas(&common::pedestrians());
}

#[test]
fn arena_k_has_the_same_bits_among_1_2_7_or_64_with_generated_obstacles() {
    let shape = RandomShape::Circle { radius_m: (0.1, 0.2) };
    let generators = vec![Generator { count: 4, shape, gap_m: 0.3, within: None }];
    assert_independent_of_number_of_arenas(&Scenario { generators, ..common::moving_obstacles() });
}

/// Arenas become inactive at different times and are reset together. They share rapier's working memory.
#[test]
fn arena_k_has_the_same_bits_among_7_or_64_when_others_become_inactive_and_are_reset() {
    let scenario = with_short_episodes(common::moving_obstacles());
    let two_episodes = |arenas: usize| {
        let mut lab = Lab::with(&scenario, arenas, 5, RewardConfig::default(), TaskMode::SingleGoal);
        let first = tracks(&mut lab, arenas);
        assert!(lab.states().iter().all(|state| state.episode.inactive), "all episodes end within 300 steps");
        let start = |arena: usize| Some((Streams::new(6, arena as u64), Clock(0)));
        sim::reset_arenas(lab.simulation.world_mut(), start);
        let second = tracks(&mut lab, arenas);
        first.into_iter().zip(second).map(|(first, second)| [first, second].concat()).collect::<Vec<_>>()
    };
    let among_64 = two_episodes(64);
    for (arena, track) in two_episodes(7).iter().enumerate() {
        assert_same("7 and 64 arenas", arena, track, &among_64[arena]);
    }
}

#[test]
fn arena_k_has_the_same_bits_among_1_2_7_or_64_with_a_noisy_lidar() {
    let mut scenario = common::moving_obstacles();
    (scenario.lidar.noise_std_m, scenario.lidar.dropout) = (0.02.into(), 0.05.into());
    assert_independent_of_number_of_arenas(&scenario);
}

#[test]
fn arena_k_has_the_same_bits_among_1_2_7_or_64_with_an_actuator_lag() {
    let mut scenario = common::moving_obstacles();
    scenario.robot.actuator_lag_s = 0.3.into();
    assert_independent_of_number_of_arenas(&scenario);
}

#[test]
fn the_same_seed_gives_the_same_bits_and_a_different_seed_gives_different_starts() {
    let scenario = with_short_episodes(common::moving_obstacles());
    let run = |seed| tracks(&mut Lab::new(&scenario, 4, seed), 4);
    let (one, two, other) = (run(11), run(11), run(12));
    for arena in 0..4 {
        assert_same("the same seed twice", arena, &one[arena], &two[arena]);
        assert_ne!(one[arena][0], other[arena][0], "a different seed gives arena {arena} a different start");
    }
}

#[test]
fn a_simulation_with_replaced_arenas_has_the_same_bits_as_a_new_one() {
    let scenario = with_short_episodes(common::moving_obstacles());
    let fresh = tracks(&mut Lab::new(&scenario, 5, 21), 5);
    let mut used = Lab::new(&common::four_cylinders(), 9, 1);
    tracks(&mut used, 9);
    used.spawn_arenas(&scenario, 5, 21);
    let again = tracks(&mut used, 5);
    for arena in 0..5 {
        assert_same("replaced arenas", arena, &again[arena], &fresh[arena]);
    }
}

#[test]
fn all_systems_of_the_simulation_have_a_defined_order() {
    // An ambiguous order is an error when the schedule is built, and that error panics.
    Lab::new(&common::moving_obstacles(), 1, 1).step(&[2]);
}

#[test]
#[should_panic(expected = "ambigu")]
fn a_system_with_an_ambiguous_order_is_rejected() {
    fn move_robots(mut poses: Query<&mut Pose>) {
        poses.iter_mut().for_each(|mut pose| pose.x_m += 1.0);
    }
    #[derive(Clone)]
    struct AmbiguousPlugin;
    impl Plugin for AmbiguousPlugin {
        fn build(&self, app: &mut App) {
            app.add_systems(ControlStep, move_robots.in_set(ControlSet::Sense));
        }
    }
    let scenario = std::sync::Arc::new(common::moving_obstacles());
    let extensions = Extensions::default().plugin(AmbiguousPlugin);
    let _ = SimulationBuilder::new(&scenario).extensions(&extensions).build().step();
}

#[test]
fn an_arena_whose_scenario_has_changed_computes_the_same_bits_as_a_new_one() {
    use wayfield::scenario::{ScenarioSet, SetMember, SetSource};
    use wayfield::task::{ScenarioChoice, ScenarioPool, StepOutcome, StepOutcomes};

    let scenarios = [common::four_cylinders(), common::moving_obstacles()];
    let member = |scenario: &Scenario| SetMember {
        name: scenario.name.clone(),
        share: 1.0,
        source: SetSource::Scenario(Box::new(scenario.clone())),
    };
    let members = scenarios.iter().map(member).collect();
    let pool = ScenarioPool::new(&ScenarioSet { name: "both".into(), members });
    let extensions = Extensions::default().plugin(pool);
    let first = std::sync::Arc::new(scenarios[0].clone());
    let simulation = SimulationBuilder::new(&first).arenas(3).seed(5).extensions(&extensions).build();
    let mut changed = Lab { simulation, scenario: first };
    let restart = |lab: &mut Lab| {
        let streams = |arena| Some((Streams::new(9, arena as u64), Clock(17)));
        sim::reset_arenas(lab.simulation.world_mut(), streams);
        lab.simulation.world_mut().resource_mut::<StepOutcomes>().0.fill(StepOutcome::default());
    };
    for member in [1, 0, 1] {
        let choice = ScenarioChoice { member, level: 0 };
        sim::assign_scenarios(changed.simulation.world_mut(), |_| choice);
        restart(&mut changed);
        let mut new = Lab::new(&scenarios[member as usize], 3, 5);
        restart(&mut new);
        let (one, other) = (tracks(&mut changed, 3), tracks(&mut new, 3));
        for arena in 0..3 {
            assert_same(&format!("scenario {member}"), arena, &one[arena], &other[arena]);
        }
    }
}

#[test]
fn a_scenario_that_replaces_a_set_stays_for_all_later_episodes() {
    use std::sync::Arc;
    use wayfield::scenario::{ScenarioSet, SetMember, SetSource};
    use wayfield::task::{ArenaLayout, ScenarioPool};

    let member = SetMember {
        name: "cylinders".into(),
        share: 1.0,
        source: SetSource::Scenario(Box::new(common::four_cylinders())),
    };
    let pool = ScenarioPool::new(&ScenarioSet { name: "one".into(), members: vec![member] });
    let extensions = Extensions::default().plugin(pool);
    let first = Arc::new(common::four_cylinders());
    let mut simulation = SimulationBuilder::new(&first).arenas(3).seed(5).extensions(&extensions).build();
    let other = Arc::new(common::moving_obstacles());
    let world = simulation.world_mut();
    sim::reset_with_scenario(world, &other);
    for seed in [9, 10] {
        let mut layouts = world.query::<&ArenaLayout>();
        assert!(layouts.iter(world).all(|layout| Arc::ptr_eq(&layout.written, &other)), "before seed {seed}");
        sim::reset_arenas(world, |arena| Some((Streams::new(seed, arena as u64), Clock(0))));
    }
}

#[test]
fn obstacles_keep_moving_when_the_next_episode_begins_in_another_scenario() {
    use std::sync::Arc;
    use wayfield::scenario::{ScenarioSet, SetMember, SetSource, pose_at};
    use wayfield::task::{ArenaLayout, ScenarioPool};

    let mut scenario = common::moving_obstacles();
    scenario.task.max_episode_steps = 7;
    let member = |name: &str| SetMember {
        name: name.into(),
        share: 1.0,
        source: SetSource::Scenario(Box::new(scenario.clone())),
    };
    let set = ScenarioSet { name: "both".into(), members: vec![member("one"), member("other")] };
    let extensions = Extensions::default().plugin(ScenarioPool::new(&set));
    let scenario = Arc::new(scenario);
    let simulation = SimulationBuilder::new(&scenario).seed(5).extensions(&extensions).build();
    let mut lab = Lab { simulation, scenario };
    let mut streams = common::action_streams(1);
    let (mut changes, mut checked, mut before) = (0, 0, None);
    for step in 0..200 {
        lab.step(&common::random_actions(&mut streams));
        let world = lab.simulation.world_mut();
        let written = world.query::<&ArenaLayout>().single(world).expect("one arena").written.clone();
        changes += usize::from(before.is_some_and(|before| !Arc::ptr_eq(&before, &written)));
        let clock = lab.state(0).clock.0;
        lab.with_physics(0, |bodies, set, _| {
            for (obstacle, body) in written.obstacles.iter().zip(&bodies.obstacles) {
                let Some(body) = body.and_then(|body| set.bodies.get(body)) else { continue };
                let (x, y, _) = pose_at(obstacle, clock, written.task.control_period_s);
                let at = body.translation();
                assert!((at.x - x).hypot(at.y - y) < 1e-5, "step {step}: {at:?}, not ({x}, {y})");
                checked += 1;
            }
        });
        before = Some(written);
    }
    assert!(changes > 10, "{changes}");
    assert_eq!(checked, 200 * 4, "four obstacles move");
}
