//! The reward's attraction to the goal, measured along the shortest path: it changes nothing but the reward, and a restored
//! simulation continues it bit for bit.

mod common;

use std::sync::Arc;

use bevy::math::vec2;
use common::{Lab, bits};
use wayfield::run::shipped;
use wayfield::scenario::{FreeCells, Generator, Geodesic, RandomShape, Scenario};
use wayfield::sim;
use wayfield::task::{ArenaState, Attraction, GoalDistance, Pose, RewardConfig, TaskMode};

fn geodesic() -> RewardConfig {
    RewardConfig { distance: GoalDistance::Geodesic, ..RewardConfig::default() }
}

/// The length of the shortest path to the goal, in m.
fn length_m(scenario: &Scenario, state: &ArenaState) -> f32 {
    let free = Arc::new(FreeCells::new(scenario));
    let goal_m = vec2(state.goal.x_m, state.goal.y_m);
    Geodesic::default().distance_m(&free, goal_m, vec2(state.pose.x_m, state.pose.y_m))
}

/// An arena with new random obstacles in every episode. Episodes are short.
fn random_obstacles() -> Scenario {
    let shape = RandomShape::Rectangle { width_m: (0.2, 1.0), height_m: (0.1, 0.5) };
    let generators = vec![Generator { count: 10, shape, gap_m: 0.3, within: None }];
    let mut scenario = Scenario { generators, ..Scenario::default() };
    scenario.task.max_episode_steps = 60;
    scenario
}

#[test]
fn only_the_geodesic_distance_rewards_driving_out_of_the_u() {
    let trap = shipped::scenario("u-trap").expect("shipped");
    for (reward, heading_rad, is_rewarded) in [
        (geodesic(), std::f32::consts::PI, true),
        (geodesic(), 0.0, false),
        (RewardConfig::default(), std::f32::consts::PI, false),
        (RewardConfig::default(), 0.0, true),
    ] {
        let mut lab = Lab::with(&trap, 1, 3, reward.clone(), TaskMode::Continuing);
        lab.edit(0, |state| (state.goal.x_m, state.goal.y_m) = (0.8, 0.0));
        lab.edit(0, |state| state.pose = Pose { x_m: -0.3, y_m: 0.1, heading_rad });
        sim::move_goal(lab.simulation.world_mut(), 0, vec2(0.8, 0.0));
        let before = lab.state(0);
        lab.step(&[2]);
        let (after, terms) = (lab.state(0), lab.outcomes()[0].reward);
        assert_eq!(terms.attraction > 0.0, is_rewarded, "{reward:?}, heading {heading_rad}: {terms:?}");
        let (from_m, to_m) = match reward.distance {
            GoalDistance::Geodesic => (length_m(&trap, &before), length_m(&trap, &after)),
            GoalDistance::Straight => {
                (before.pose.distance_m(&before.goal), after.pose.distance_m(&after.goal))
            }
        };
        let expected = 50.0 * (from_m * from_m - to_m * to_m);
        assert!((terms.attraction - expected).abs() < 1e-3, "{terms:?}, expected {expected}");
    }
}

#[test]
fn only_the_attraction_differs() {
    let scenario = random_obstacles();
    let linear = RewardConfig { attraction: Attraction::Linear, ..geodesic() };
    let mut labs = [RewardConfig::default(), geodesic(), linear]
        .map(|reward| Lab::with(&scenario, 8, 5, reward, TaskMode::Continuing));
    let mut actions = common::action_streams(8);
    let mut differences = 0;
    for step in 0..200 {
        let actions = common::steer_to_goal(&labs[0], &mut actions);
        labs.iter_mut().for_each(|lab| lab.step(&actions));
        let [straight, others @ ..] = &mut labs;
        for other in others {
            for arena in 0..8 {
                assert_eq!(bits(&straight.row(arena)), bits(&other.row(arena)), "step {step}");
                let (mut by_path, by_line) = (other.outcomes()[arena], straight.outcomes()[arena]);
                differences += u32::from(by_path.reward.attraction != by_line.reward.attraction);
                by_path.reward.attraction = by_line.reward.attraction;
                assert_eq!(by_path, by_line, "step {step}");
            }
        }
    }
    assert!(
        differences > 1_600,
        "the linear attraction always differs, the other one behind obstacles: {differences}"
    );
}

#[test]
fn a_restored_simulation_continues_bit_for_bit() {
    let scenario = random_obstacles();
    let mut lab = Lab::with(&scenario, 8, 6, geodesic(), TaskMode::Continuing);
    let mut actions = common::action_streams(8);
    for _ in 0..90 {
        let actions = common::steer_to_goal(&lab, &mut actions);
        lab.step(&actions);
    }
    let mut resumed = Lab::with(&scenario, 8, 99, geodesic(), TaskMode::Continuing);
    let states = lab.states();
    sim::restore(resumed.simulation.world_mut(), &states);
    for step in 0..150 {
        let actions = common::steer_to_goal(&lab, &mut actions);
        lab.step(&actions);
        resumed.step(&actions);
        assert_eq!(lab.outcomes(), resumed.outcomes(), "step {step}");
    }
    assert_eq!(lab.states(), resumed.states());
}

#[test]
fn a_goal_that_is_moved_has_its_own_paths() {
    let doorway = shipped::scenario("doorway").expect("shipped");
    let mut lab = Lab::with(&doorway, 1, 3, geodesic(), TaskMode::Continuing);
    for goal_m in [vec2(1.2, 1.2), vec2(-1.2, 1.2), vec2(1.2, -1.2)] {
        sim::move_robot(lab.simulation.world_mut(), 0, vec2(-0.6, 1.0));
        sim::move_goal(lab.simulation.world_mut(), 0, goal_m);
        let state = lab.state(0);
        let length_m = length_m(&doorway, &state);
        assert_eq!(state.episode.potential.attraction, 50.0 * length_m * length_m);
        assert_eq!(
            length_m > 1.01 * state.pose.distance_m(&state.goal),
            goal_m.x > 0.0,
            "{goal_m}: {length_m} m"
        );
    }
}
