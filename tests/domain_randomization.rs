//! Domain randomization: numbers that each episode draws from ranges, in the simulation.

mod common;

use std::collections::BTreeSet;

use bevy::math::vec2;
use common::{Lab, bits};
use wayfield::scenario::{Obstacle, ObstacleMotion, Ranged, Scenario, Shape, with_setting};
use wayfield::task::{Arena, ArenaLayout, ArenaState};

/// Moving obstacles whose speeds each episode draws, and a robot and a LIDAR that differ from episode to episode.
fn randomized() -> Scenario {
    let mut scenario = common::moving_obstacles();
    scenario.task.max_episode_steps = 20;
    scenario = with_setting(&scenario, "obstacles[*].motion.speed_rad_s", "(-0.2, 0.2)").expect("a range");
    scenario.robot.actuator_lag_s = Ranged::Range(0.0, 0.5);
    scenario.lidar.noise_std_m = Ranged::Range(0.01, 0.05);
    scenario.lidar.latency_steps = Ranged::Range(0, 3);
    scenario
}

/// The scenario of the current episode of each arena.
fn layouts(lab: &mut Lab) -> Vec<Scenario> {
    let world = lab.simulation.world_mut();
    let mut arenas = world.query::<(&Arena, &ArenaLayout)>();
    let mut found: Vec<_> =
        arenas.iter(world).map(|(arena, layout)| (arena.0, Scenario::clone(&layout.scenario))).collect();
    found.sort_by_key(|(arena, _)| *arena);
    found.into_iter().map(|(_, layout)| layout).collect()
}

#[test]
fn every_episode_draws_its_numbers_and_keeps_them_until_its_end() {
    let mut lab = Lab::new(&randomized(), 4, 3);
    let mut streams = common::action_streams(4);
    let (mut before, mut lags) = (layouts(&mut lab), BTreeSet::new());
    for step in 0..100 {
        lab.step(&common::random_actions(&mut streams));
        let after = layouts(&mut lab);
        let ended: Vec<usize> = lab.take_ended_episodes().iter().map(|episode| episode.arena).collect();
        for (arena, (old, new)) in before.iter().zip(&after).enumerate() {
            assert!(!new.has_ranges());
            assert_eq!(old != new, ended.contains(&arena), "step {step}, arena {arena}");
            lags.insert(new.robot.actuator_lag_s.value().to_bits());
        }
        lab.assert_observations_current(&format!("after step {step}"));
        before = after;
    }
    assert!(lags.len() >= 20, "{} different lags", lags.len());
}

#[test]
fn the_drawn_numbers_are_those_of_the_simulation() {
    let mut lab = Lab::new(&randomized(), 6, 5);
    lab.step(&[0; 6]);
    for (state, layout) in lab.states().iter().zip(layouts(&mut lab)) {
        let lag_s = layout.robot.actuator_lag_s.value();
        let motion = layout.robot.motions[0];
        let reached = 1.0 - libm::expf(-layout.task.control_period_s / lag_s);
        assert!(
            (state.twist.v_m_s - motion.v_m_s * reached).abs() < 1e-6,
            "lag {lag_s} s: {:?}",
            state.twist
        );
        // With a latency, the scans at the start and after the step are remembered.
        let latency_steps = layout.lidar.latency_steps.value();
        let remembered = if latency_steps == 0 { 0 } else { 2 };
        assert_eq!(state.scan.delayed.len(), remembered, "latency of {latency_steps} steps");
    }
}

#[test]
fn ranges_do_not_change_starts_and_goals() {
    let poses = |scenario: &Scenario| {
        let states = Lab::new(scenario, 5, 8).states();
        let of = |state: &ArenaState| [state.pose.x_m, state.pose.y_m, state.goal.x_m, state.goal.y_m];
        states.iter().flat_map(of).collect::<Vec<f32>>()
    };
    let mut with_ranges = common::four_cylinders();
    with_ranges.lidar.noise_std_m = Ranged::Range(0.0, 0.1);
    assert_eq!(bits(&poses(&with_ranges)), bits(&poses(&common::four_cylinders())));
}

#[test]
fn episodes_between_fixed_positions_draw_new_numbers_too() {
    let mut scenario = Scenario::parse(
        "(name: \"Fixed\", starts: Fixed(position_m: (-1.0, 0.0), heading_rad: 0.0), goals: Fixed(position_m: (1.0, 0.0)), \
         lidar: (noise_std_m: (0.0, 0.1)))",
        "fixed.ron",
    )
    .expect("valid");
    scenario.task.max_episode_steps = 50;
    let mut lab = Lab::new(&scenario, 2, 1);
    let mut noises = BTreeSet::new();
    for _ in 0..300 {
        lab.step(&[2; 2]);
        noises.extend(layouts(&mut lab).iter().map(|layout| layout.lidar.noise_std_m.value().to_bits()));
    }
    assert!(noises.len() >= 10, "{} different noises", noises.len());
}

#[test]
fn a_pedestrian_walks_at_the_speed_that_its_episode_draws() {
    let motion = ObstacleMotion::Pedestrian {
        goals_m: vec![vec2(1.5, 1.5)],
        speed_m_s: Ranged::Range(0.2, 0.6),
        loops: true,
        sees_robot: false,
    };
    let circle = common::static_obstacle(Shape::Circle { radius_m: 0.1 }, vec2(-1.5, 1.5), 0.0);
    let mut scenario = Scenario { obstacles: vec![Obstacle { motion, ..circle }], ..Scenario::default() };
    scenario.task.max_episode_steps = 4;
    let mut lab = Lab::new(&scenario, 4, 3);
    let mut speeds = BTreeSet::new();
    for _ in 0..40 {
        lab.step(&[0; 4]);
        for (state, layout) in lab.states().iter().zip(layouts(&mut lab)) {
            let drawn = layout.obstacles[0].motion.given_speed().expect("a speed").value();
            let walked = state.pedestrians.0.pedestrian(0).expect("a pedestrian").velocity_m_s.length();
            // It stands when an episode begins.
            assert!((0.2..=0.6).contains(&drawn) && (walked == 0.0 || (walked - drawn).abs() < 1e-5));
            speeds.extend((walked > 0.0).then_some(drawn.to_bits()));
        }
    }
    assert!(speeds.len() >= 20, "{} different speeds", speeds.len());
}
