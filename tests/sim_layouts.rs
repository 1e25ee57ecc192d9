//! Layouts: polygonal enclosures and inner walls, generated obstacles, LIDAR latency, fixed starts and goals.

mod common;

use std::sync::Arc;

use bevy::math::vec2;
use common::{Lab, bits, closed_form};
use wayfield::random::{self, uniform, uniform_index};
use wayfield::scenario::{
    Enclosure, Generator, Motion, Obstacle, ObstacleMotion, PlacementRule, RandomShape, Scenario, Shape, Wall,
};
use wayfield::sim;
use wayfield::task::{Clock, EpisodeEnd, Pose};

/// An L-shaped enclosure with an inner wall, a static and a moving capsule, and a static and a moving triangle.
fn irregular_walls() -> Scenario {
    let triangle = Shape::Polygon { corners_m: vec![vec2(-0.2, -0.1), vec2(0.2, -0.1), vec2(0.0, 0.3)] };
    let capsule = Shape::Capsule { length_m: 0.4, radius_m: 0.08 };
    let back_and_forth =
        ObstacleMotion::BackAndForth { waypoints_m: vec![vec2(1.4, -0.4)], speed_m_s: 0.1.into() };
    let random_walk = ObstacleMotion::RandomWalk { radius_m: 0.3, speed_m_s: 0.1.into(), seed: 4 };
    Scenario {
        enclosure: Enclosure::Polygon {
            corners_m: vec![
                vec2(-2.0, -2.0),
                vec2(2.0, -2.0),
                vec2(2.0, 0.0),
                vec2(0.0, 0.0),
                vec2(0.0, 2.0),
                vec2(-2.0, 2.0),
            ],
        },
        walls: vec![Wall {
            corners_m: vec![vec2(-2.0, 0.2), vec2(-1.2, 0.2), vec2(-1.2, 0.9)],
            thickness_m: 0.1,
            ..Wall::default()
        }],
        obstacles: vec![
            common::static_obstacle(capsule.clone(), vec2(-0.6, 0.9), 0.6),
            common::static_obstacle(triangle.clone(), vec2(0.6, -0.7), 0.4),
            Obstacle { motion: back_and_forth, ..common::static_obstacle(capsule, vec2(1.4, -1.6), 1.2) },
            Obstacle { motion: random_walk, ..common::static_obstacle(triangle, vec2(-1.3, -1.3), 0.0) },
        ],
        ..Scenario::default()
    }
}

/// A static cylinder, and six generated obstacles.
fn generated_obstacles() -> Scenario {
    let generator = |count, shape| Generator { count, shape, gap_m: 0.3, within: None };
    Scenario {
        obstacles: vec![common::static_obstacle(Shape::Circle { radius_m: 0.1 }, vec2(-1.0, 0.0), 0.0)],
        generators: vec![
            generator(4, RandomShape::Circle { radius_m: (0.1, 0.2) }),
            generator(2, RandomShape::Rectangle { width_m: (0.3, 0.5), height_m: (0.1, 0.2) }),
        ],
        ..Scenario::default()
    }
}

/// Asserts that the ranges of every arena agree with the geometry of the arena's current layout.
fn assert_scan_matches_layout(lab: &mut Lab, when: &str) {
    for (arena, state) in lab.states().iter().enumerate() {
        let layout = lab.scenario.with_generated_obstacles(state.layout_seed);
        let origin = (f64::from(state.pose.x_m), f64::from(state.pose.y_m));
        for (beam, &range) in state.scan.ranges_m.iter().enumerate() {
            let angle = f64::from(state.pose.heading_rad) + layout.lidar.beam_angle_rad(beam);
            let (low, high) = closed_form::range_bounds(&layout, state.clock.0, origin, angle, 3.5);
            assert!(
                f64::from(range) > low - 2e-5 && f64::from(range) < high + 2e-5,
                "{when}, arena {arena}, beam {beam}: range {range} m, expected {low} to {high} m"
            );
        }
    }
}

#[test]
fn every_episode_has_a_new_layout_that_the_lidar_measures() {
    let mut scenario = generated_obstacles();
    scenario.task.max_episode_steps = 25;
    let mut lab = Lab::new(&scenario, 6, 11);
    let mut layouts = std::collections::BTreeSet::new();
    let mut before = lab.states();
    assert_scan_matches_layout(&mut lab, "before the first step");
    for step in 1..=120 {
        lab.step(&[2; 6]);
        assert_scan_matches_layout(&mut lab, &format!("after step {step}"));
        let states = lab.states();
        let ended: Vec<usize> = lab.take_ended_episodes().iter().map(|episode| episode.arena).collect();
        for (arena, (old, new)) in before.iter().zip(&states).enumerate() {
            assert_eq!(
                old.layout_seed != new.layout_seed,
                ended.contains(&arena),
                "a layout changes exactly when an episode ends"
            );
            layouts.insert(new.layout_seed);
        }
        before = states;
    }
    assert!(layouts.len() > 20, "only {} different layouts", layouts.len());
    assert_eq!(
        Lab::new(&scenario, 2, 11).states()[1].layout_seed,
        Lab::new(&scenario, 6, 11).states()[1].layout_seed,
        "the layout depends on seed and arena alone"
    );
}

#[test]
fn a_restored_layout_continues_bit_for_bit() {
    let scenario = generated_obstacles();
    let mut lab = Lab::new(&scenario, 3, 5);
    for _ in 0..40 {
        lab.step(&[1; 3]);
    }
    let saved = lab.states();
    let mut other = Lab::new(&scenario, 3, 99);
    sim::restore(other.simulation.world_mut(), &saved);
    assert_eq!(other.states(), saved);
    for step in 0..200 {
        let action = [step / 7 % 5; 3];
        lab.step(&action);
        other.step(&action);
        assert_eq!(lab.states(), other.states(), "step {step}");
    }
}

#[test]
fn no_robot_passes_through_a_wall_at_any_speed() {
    for (scenario, name) in [(irregular_walls(), "irregular"), (generated_obstacles(), "generated")] {
        for v_m_s in [0.15, 1.0, 5.0] {
            let mut scenario = scenario.clone();
            scenario.robot.motions = [-3.0, 0.0, 3.0].map(|w_rad_s| Motion { v_m_s, w_rad_s }).into();
            let mut lab = Lab::new(&scenario, 8, 3);
            let mut stream = random::stream(9, "actions", 0);
            let mut collisions = 0;
            for step in 0..300 {
                let actions: Vec<usize> = (0..8).map(|_| uniform_index(&mut stream, 3)).collect();
                let before = lab.states();
                lab.step(&actions);
                let ended = lab.take_ended_episodes();
                for (arena, (old, new)) in before.iter().zip(lab.states()).enumerate() {
                    let layout = lab.scenario.with_generated_obstacles(new.layout_seed);
                    let walls = Scenario { obstacles: Vec::new(), ..layout };
                    // The clearance at a fraction of the straight line from the old position to the new one.
                    let clearance_m = |fraction: f64| {
                        let at = |from: f32, to: f32| {
                            f64::from(from) * (1.0 - fraction) + f64::from(to) * fraction
                        };
                        let (x, y) = (at(old.pose.x_m, new.pose.x_m), at(old.pose.y_m, new.pose.y_m));
                        closed_form::clearance(&walls, 0, (x, y))
                    };
                    let clear_m = clearance_m(1.0);
                    assert!(clear_m > 0.0999 - 0.001, "{name} at {v_m_s} m/s, step {step}: {clear_m} m");
                    // A new episode, or a reached goal, may move the robot elsewhere.
                    let may_jump = old.episode.goals != new.episode.goals
                        || ended.iter().any(|episode| episode.arena == arena);
                    let crosses = || (1..20_u32).any(|k| clearance_m(f64::from(k) / 20.0) < 0.0);
                    assert!(
                        may_jump || !crosses(),
                        "{name} at {v_m_s} m/s, step {step}: arena {arena}'s robot has crossed a wall"
                    );
                }
                collisions += ended.iter().filter(|episode| episode.end == EpisodeEnd::Collided).count();
            }
            assert!(collisions > 10, "{name} at {v_m_s} m/s: only {collisions} collisions");
        }
    }
}

#[test]
fn collisions_agree_with_the_clearance() {
    let scenario = irregular_walls();
    let mut lab = Lab::new(&scenario, 1, 3);
    let mut stream = random::stream(2, "places", 0);
    let (mut hits, mut free) = (0, 0);
    while hits < 150 || free < 150 {
        let at = (uniform(&mut stream, -1.99, 1.99), uniform(&mut stream, -1.99, 1.99));
        let clear_m = closed_form::clearance(&scenario, 0, (f64::from(at.0), f64::from(at.1)));
        // Skips positions inside obstacles, and those so close to contact that one step decides.
        if clear_m < 0.02 || (clear_m - 0.1).abs() < 0.035 {
            continue;
        }
        lab.edit(0, |state| {
            state.pose = Pose { x_m: at.0, y_m: at.1, heading_rad: 0.0 };
            state.clock = Clock(0);
        });
        lab.step(&[2]);
        // Contact is always a collision. An obstacle that is merely within the collision range may lie between two beams.
        let touches = clear_m < 0.1;
        if touches {
            assert!(lab.outcomes()[0].collided, "{at:?}, clearance {clear_m} m");
            hits += 1;
        } else if clear_m > 0.13 + 0.035 {
            assert!(!lab.outcomes()[0].collided, "{at:?}, clearance {clear_m} m");
            free += 1;
        }
        lab.take_ended_episodes();
    }
}

#[test]
fn a_lidar_with_latency_reports_the_scan_of_earlier_steps() {
    let mut scenario = irregular_walls();
    scenario.lidar.latency_steps = 3.into();
    scenario.task.max_episode_steps = 40;
    let mut lab = Lab::new(&scenario, 1, 8);
    let pose = lab.state(0).pose;
    let mut scans = vec![lab.cast(0, &pose)];
    let mut resets = 0;
    for step in 0..200_usize {
        lab.step(&[step / 5 % 5]);
        let state = lab.state(0);
        let now = lab.cast(0, &state.pose);
        if lab.take_ended_episodes().is_empty() {
            assert_eq!(
                state.scan.nearest_m,
                now.iter().copied().fold(3.5, f32::min),
                "collisions use the current ranges"
            );
            scans.push(now);
        } else {
            resets += 1;
            scans = vec![now];
        }
        let expected = &scans[scans.len().saturating_sub(4)];
        assert_eq!(bits(&state.scan.ranges_m), bits(expected), "step {step}");
        lab.assert_observations_current("with latency");
    }
    assert!(resets > 2);
}

#[test]
fn after_reaching_a_fixed_goal_the_robot_returns_to_its_start_and_the_episode_continues() {
    let scenario = Scenario {
        starts: PlacementRule::Fixed { position_m: vec2(0.0, 0.0), heading_rad: Some(0.0) },
        goals: PlacementRule::Fixed { position_m: vec2(0.6, 0.0), heading_rad: None },
        ..Scenario::default()
    };
    let mut lab = Lab::new(&scenario, 1, 1);
    let start = Pose { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 };
    assert_eq!(lab.state(0).pose, start);
    // 0.6 m to the goal at 0.03 m per step: nearer than the goal radius of 0.2 m after 14 steps.
    for round in 1..=3 {
        for _ in 0..14 {
            lab.step(&[2]);
        }
        let state = lab.state(0);
        assert!(lab.outcomes()[0].reached && lab.take_ended_episodes().is_empty());
        assert_eq!((state.pose, state.episode.goals), (start, round));
        assert_eq!(state.twist.v_m_s, 0.0, "at rest");
        lab.assert_observations_current("after the return to the start");
    }
    assert_eq!(lab.state(0).episode.steps, 42);
}

#[test]
fn a_reset_with_another_scenario_keeps_streams_and_clocks() {
    let mut lab = Lab::new(&common::moving_obstacles(), 4, 7);
    for _ in 0..30 {
        lab.step(&[2; 4]);
    }
    let before = lab.states();
    let other = Arc::new(irregular_walls());
    lab.scenario = other.clone();
    sim::reset_with_scenario(lab.simulation.world_mut(), &other);
    let after = lab.states();
    for (old, new) in before.iter().zip(&after) {
        assert_eq!(old.clock, new.clock);
        assert_eq!(old.streams.sensor, new.streams.sensor, "nothing is noisy, so nothing was drawn from it");
        assert_eq!(new.episode.steps, 0, "a new episode");
        assert_ne!(
            old.streams.placement, new.streams.placement,
            "the start was drawn from the arena's stream"
        );
    }
    assert_scan_matches_layout(&mut lab, "after the reset");
    lab.step(&[2; 4]);
    assert_scan_matches_layout(&mut lab, "one step later");
    let mut again = Lab::new(&common::moving_obstacles(), 4, 7);
    for _ in 0..30 {
        again.step(&[2; 4]);
    }
    sim::reset_with_scenario(again.simulation.world_mut(), &other);
    assert_eq!(again.states(), after, "the reset is repeatable");
}
