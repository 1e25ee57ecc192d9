//! Newly drawn starts and goals keep their clearance from walls and obstacles, and starts are spread over the arena.

mod common;

use bevy::math::{Vec2, vec2};
use common::{Lab, closed_form};
use wayfield::scenario::{BenchmarkRoute, PlacementRule, Scenario, Shape};
use wayfield::sim;
use wayfield::task::{Arena, ArenaState, EpisodeSetup, RewardConfig, TaskFault, TaskMode};

fn assert_clear(scenario: &Scenario, state: &ArenaState, what: &str, at: Vec2, rule: &PlacementRule) {
    let PlacementRule::Random { clearance_m } = *rule else { panic!("a random placement rule") };
    let clear = closed_form::clearance(scenario, state.clock.0, (f64::from(at.x), f64::from(at.y)));
    assert!(
        clear > f64::from(clearance_m) - 1e-6,
        "clock {}: the {what} {at:?} has a clearance of {clear} m, less than {clearance_m} m",
        state.clock.0
    );
}

/// Asserts over 1000 episodes of random driving that every start and goal keeps the clearance of its placement rule.
fn assert_starts_and_goals_are_clear(scenario: &Scenario) {
    let mut scenario = scenario.clone();
    scenario.task.max_episode_steps = 100;
    scenario.goals = PlacementRule::Random { clearance_m: 0.25 };
    let arenas = 64;
    let mut lab = Lab::new(&scenario, arenas, 41);
    let mut action_streams = common::action_streams(arenas);
    let (mut episodes, mut redrawn, mut quarters) = (0, 0, [0_u32; 4]);
    let mut started = vec![true; arenas];
    let mut reached = vec![false; arenas];
    loop {
        for (arena, state) in lab.states().iter().enumerate() {
            let (start, goal) = (vec2(state.pose.x_m, state.pose.y_m), vec2(state.goal.x_m, state.goal.y_m));
            if started[arena] {
                episodes += 1;
                assert_clear(&scenario, state, "start", start, &scenario.starts);
                quarters[usize::from(start.x > 0.0) + 2 * usize::from(start.y > 0.0)] += 1;
            }
            if started[arena] || reached[arena] {
                redrawn += u32::from(!started[arena]);
                assert_clear(&scenario, state, "goal", goal, &scenario.goals);
                let distance = (goal.x - start.x).hypot(goal.y - start.y);
                assert!(distance > 0.5 - 1e-6, "a new goal is {distance} m away, less than 0.5 m");
            }
        }
        if episodes >= 1000 {
            break;
        }
        let actions = common::random_actions(&mut action_streams);
        lab.step(&actions);
        started.fill(false);
        lab.take_ended_episodes().iter().for_each(|episode| started[episode.arena] = true);
        for (arena, outcome) in lab.outcomes().iter().enumerate() {
            reached[arena] = outcome.reached;
        }
    }
    assert!(redrawn > 5, "only {redrawn} goals were redrawn within an episode");
    assert!(quarters.iter().all(|&n| n > 150), "starts per quarter of the arena: {quarters:?}");
    assert_eq!(lab.simulation.world().resource::<TaskFault>().0, None);
}

#[test]
fn a_thousand_starts_and_goals_are_clear_of_static_obstacles() {
    assert_starts_and_goals_are_clear(&common::four_cylinders());
}

#[test]
fn a_thousand_starts_and_goals_are_clear_of_moving_obstacles() {
    assert_starts_and_goals_are_clear(&common::moving_obstacles());
}

#[test]
fn every_arena_begins_on_the_benchmark_route() {
    let scenario = common::four_cylinders();
    let route = BenchmarkRoute::default();
    let mut lab = Lab::with(&scenario, 2, 1, RewardConfig::default(), TaskMode::SingleGoal);
    lab.simulation.world_mut().insert_resource(EpisodeSetup::Route(route));
    lab.spawn_arenas(&scenario, 2, 1);
    for state in lab.states() {
        assert_eq!((state.pose.x_m, state.pose.y_m, state.pose.heading_rad), (0.0, 0.0, 0.0), "the start");
        assert_eq!((state.goal.x_m, state.goal.y_m), (1.2, 1.2), "the goal");
        let cylinder_m = 0.6 * 2.0_f32.sqrt() - 0.15;
        assert!((state.scan.ranges_m[3] - cylinder_m).abs() < 1e-5, "a cylinder is between start and goal");
    }
}

#[test]
fn missing_free_space_for_a_start_is_reported_with_the_arena() {
    let block =
        common::static_obstacle(Shape::Rectangle { width_m: 3.9, height_m: 3.9 }, vec2(0.0, 0.0), 0.0);
    let scenario = Scenario { obstacles: vec![block], ..Scenario::default() };
    let lab = Lab::new(&scenario, 1, 1);
    let fault = lab.simulation.world().resource::<TaskFault>().0.clone().expect("a fault");
    assert!(fault.to_string().starts_with("arena 0, step 0: no free space for a start"), "{fault}");
}

#[test]
fn arenas_are_numbered_from_0() {
    let mut lab = Lab::new(&common::four_cylinders(), 7, 1);
    let world = lab.simulation.world_mut();
    let mut numbers: Vec<usize> = world.query::<&Arena>().iter(world).map(|arena| arena.0).collect();
    numbers.sort_unstable();
    assert_eq!(numbers, (0..7).collect::<Vec<_>>());
    assert_eq!(sim::snapshot(world).len(), 7);
}
