//! No scan or observation is stale, and a restored simulation continues bit for bit.

mod common;

use common::{Lab, bits, closed_form};
use wayfield::scenario::{Ranged, Scenario, with_setting};
use wayfield::sim;
use wayfield::task::{
    ArenaState, Clock, Encoding, EpisodeEnd, ObservationLayout, RewardConfig, StepOutcome, Streams, TaskMode,
    observation::RANGE_SCALE_M,
};

/// Asserts that the scan and observation of every arena are current. The scan equals a new cast bit for bit, and the closed
/// form at the arena's clock to 1e-5 m.
fn assert_current(lab: &mut Lab, when: &str) {
    lab.assert_observations_current(when);
    let scenario = lab.scenario.clone();
    for (arena, state) in lab.states().iter().enumerate() {
        let cast = lab.cast(arena, &state.pose);
        assert_eq!(
            bits(&state.scan.ranges_m),
            bits(&cast),
            "{when}, arena {arena}: the scan equals a new cast"
        );
        assert_eq!(
            state.scan.nearest_m,
            cast.iter().copied().fold(3.5, f32::min),
            "{when}: `nearest_m` is the smallest range of the scan"
        );
        let origin = (f64::from(state.pose.x_m), f64::from(state.pose.y_m));
        for (i, &range) in cast.iter().enumerate() {
            let turn = i as f64 * std::f64::consts::TAU / cast.len() as f64;
            let angle = f64::from(state.pose.heading_rad) + turn;
            let (low, high) = closed_form::range_bounds(&scenario, state.clock.0, origin, angle, 3.5);
            assert!(
                f64::from(range) > low - 1e-5 && f64::from(range) < high + 1e-5,
                "{when}, arena {arena}, clock {}, beam {i}: range {range} m, expected {low} to {high} m",
                state.clock.0
            );
        }
    }
}

fn assert_no_stale_scan(mut scenario: Scenario) {
    scenario.task.max_episode_steps = 80;
    let arenas = 16;
    let mut lab = Lab::new(&scenario, arenas, 6);
    assert_current(&mut lab, "after spawning");
    let mut action_streams = common::action_streams(arenas);
    let (mut collisions, mut time_outs, mut redrawn) = (0, 0, 0);
    for step in 1..=300 {
        let before = lab.states();
        let actions = common::steer_to_goal(&lab, &mut action_streams);
        lab.step(&actions);
        assert_current(&mut lab, &format!("after step {step}"));
        for episode in lab.take_ended_episodes() {
            collisions += usize::from(episode.end == EpisodeEnd::Collided);
            time_outs += usize::from(episode.end == EpisodeEnd::TimedOut);
        }
        let outcomes: Vec<StepOutcome> = lab.outcomes().to_vec();
        for (arena, after) in lab.states().iter().enumerate() {
            if outcomes[arena].reached {
                redrawn += 1;
                assert_ne!(after.goal, before[arena].goal, "a reached goal is redrawn");
                let row = lab.row(arena);
                let (dx, dy) = (after.goal.x_m - after.pose.x_m, after.goal.y_m - after.pose.y_m);
                assert!(
                    (row[25] * 4.0 - dx.hypot(dy)).abs() < 1e-5,
                    "the distance of the new goal is observed"
                );
                let off = (dy.atan2(dx) - after.pose.heading_rad) - row[24] * std::f32::consts::PI;
                let off = off.rem_euclid(std::f32::consts::TAU);
                assert!(
                    off.min(std::f32::consts::TAU - off) < 1e-5,
                    "the bearing of the new goal is observed"
                );
            }
        }
    }
    assert!(
        collisions > 3 && time_outs > 3 && redrawn > 20,
        "{collisions} collisions, {time_outs} time-outs, {redrawn} redrawn goals"
    );
    let start = |arena| Some((Streams::new(77, arena as u64), Clock(1000 * arena as u64)));
    sim::reset_arenas(lab.simulation.world_mut(), start);
    assert_current(&mut lab, "after a reset");
}

#[test]
fn no_scan_is_stale_with_static_obstacles() {
    assert_no_stale_scan(common::four_cylinders());
}

#[test]
fn no_scan_is_stale_with_moving_obstacles() {
    assert_no_stale_scan(common::moving_obstacles());
}

#[test]
fn an_arena_without_a_start_in_a_reset_becomes_inactive() {
    let mut lab = Lab::with(&common::moving_obstacles(), 3, 6, RewardConfig::default(), TaskMode::SingleGoal);
    sim::reset_arenas(lab.simulation.world_mut(), |arena| {
        (arena != 1).then(|| (Streams::new(1, arena as u64), Clock(5)))
    });
    let (before, row) = (lab.states(), lab.row(1));
    for _ in 0..5 {
        lab.step(&[2, 2, 2]);
        assert!(lab.outcomes()[1].inactive && !lab.outcomes()[0].inactive);
        let (after, row_after) = (lab.state(1), lab.row(1));
        assert_eq!(after, before[1], "the state of an inactive arena does not change");
        assert_eq!(bits(&row), bits(&row_after), "the observation of an inactive arena does not change");
    }
    assert_ne!(lab.state(2), before[2], "the other arenas continue");
}

/// The states and observations after each of the next 300 steps.
fn rollout(
    lab: &mut Lab,
    mut action_streams: Vec<wayfield::random::Stream>,
) -> Vec<(Vec<ArenaState>, Vec<u32>)> {
    (0..300)
        .map(|_| {
            let actions = common::steer_to_goal(lab, &mut action_streams);
            lab.step(&actions);
            let rows = (0..action_streams.len()).flat_map(|arena| bits(&lab.row(arena))).collect();
            (lab.states(), rows)
        })
        .collect()
}

fn assert_restored_continues_bit_for_bit(mut scenario: Scenario) {
    scenario.task.max_episode_steps = 90;
    let arenas = 8;
    let mut lab = Lab::new(&scenario, arenas, 31);
    let mut action_streams = common::action_streams(arenas);
    for _ in 0..100 {
        let actions = common::steer_to_goal(&lab, &mut action_streams);
        lab.step(&actions);
    }
    let saved = postcard::to_allocvec(&lab.states()).expect("a snapshot serializes");
    let rows: Vec<_> = (0..arenas).map(|arena| bits(&lab.row(arena))).collect();

    // A different seed, so that any state of the new simulation that survives the restore shows.
    let mut other = Lab::new(&scenario, arenas, 32);
    let mut states: Vec<ArenaState> = postcard::from_bytes(&saved).expect("a snapshot deserializes");
    // Checkpoints store these apart from the states.
    for (state, saved) in states.iter_mut().zip(lab.states()) {
        (state.estimated_pose, state.pedestrians) = (saved.estimated_pose, saved.pedestrians);
    }
    sim::restore(other.simulation.world_mut(), &states);
    assert_eq!(other.states(), lab.states(), "{}: the restored states are the saved ones", scenario.name);
    for (arena, row) in rows.iter().enumerate() {
        assert_eq!(bits(&other.row(arena)), *row, "{}: observation of arena {arena}", scenario.name);
    }

    lab.take_ended_episodes();
    let one = rollout(&mut lab, action_streams.clone());
    let two = rollout(&mut other, action_streams);
    for (step, (one, two)) in one.iter().zip(&two).enumerate() {
        assert!(one == two, "{}: the two differ {} steps after the snapshot", scenario.name, step + 1);
    }
    let (ended, other_ended) = (lab.take_ended_episodes(), other.take_ended_episodes());
    assert!(ended.len() > 2 * arenas, "only {} episodes ended", ended.len());
    assert_eq!(ended, other_ended, "both publish the same episodes");
}

#[test]
fn a_restored_simulation_continues_bit_for_bit_with_static_obstacles() {
    assert_restored_continues_bit_for_bit(common::four_cylinders());
}

#[test]
fn a_restored_simulation_continues_bit_for_bit_with_moving_obstacles() {
    assert_restored_continues_bit_for_bit(common::moving_obstacles());
}

#[test]
fn a_restored_simulation_continues_bit_for_bit_with_pedestrians() {
    assert_restored_continues_bit_for_bit(common::pedestrians());
}

#[test]
fn a_restored_simulation_continues_bit_for_bit_with_a_noisy_lidar() {
    let mut scenario = common::moving_obstacles();
    (scenario.lidar.noise_std_m, scenario.lidar.dropout) = (0.05.into(), 0.05.into());
    assert_restored_continues_bit_for_bit(scenario);
}

#[test]
fn a_restored_simulation_continues_bit_for_bit_with_an_actuator_lag() {
    let mut scenario = common::moving_obstacles();
    scenario.robot.actuator_lag_s = 0.5.into();
    assert_restored_continues_bit_for_bit(scenario);
}

#[test]
fn a_restored_simulation_continues_bit_for_bit_with_numbers_drawn_from_ranges() {
    let mut scenario = common::moving_obstacles();
    let speeds = with_setting(&scenario, "obstacles[*].motion.speed_rad_s", "(-0.2, 0.2)");
    scenario = speeds.expect("a range");
    scenario.robot.actuator_lag_s = Ranged::Range(0.0, 0.5);
    (scenario.lidar.noise_std_m, scenario.lidar.dropout) = (Ranged::Range(0.0, 0.1), Ranged::Range(0.0, 0.1));
    scenario.lidar.latency_steps = Ranged::Range(0, 4);
    assert_restored_continues_bit_for_bit(scenario);
}

#[test]
fn a_restored_simulation_continues_bit_for_bit_when_episodes_end_in_contact() {
    // The collision range hardly exceeds the radius, so robots collide by contact rather than by a short range.
    let mut scenario = common::moving_obstacles();
    (scenario.task.collision_range_m, scenario.robot.radius_m) = (0.1005, 0.1);
    assert_restored_continues_bit_for_bit(scenario);
}

#[test]
fn raw_observations_are_raw_after_restores_steps_and_resets() {
    let mut scenario = common::moving_obstacles();
    scenario.task.max_episode_steps = 30;
    let mut lab = Lab::new(&scenario, 4, 3);
    lab.simulation.world_mut().resource_mut::<ObservationLayout>().encoding = Encoding::Raw;
    lab.edit(0, |_| ());
    let mut action_streams = common::action_streams(4);
    for step in 0..100 {
        // In m and rad after a restore, after a step, and at the start of an episode.
        for (arena, state) in lab.states().iter().enumerate() {
            let row = lab.row(arena);
            assert_eq!(bits(&row[..24]), bits(&state.scan.ranges_m), "step {step}, arena {arena}");
            let goal = [state.pose.bearing_rad(&state.goal), state.pose.distance_m(&state.goal)];
            assert_eq!(bits(&row[24..26]), bits(&goal), "step {step}, arena {arena}");
            assert_eq!(row[26], state.scan.nearest_m, "step {step}, arena {arena}");
            assert_eq!(state.scan.ranges_m[row[27] as usize], row[26], "step {step}, arena {arena}");
        }
        lab.step(&common::random_actions(&mut action_streams));
    }
    assert!(lab.take_ended_episodes().len() > 8, "some episodes ended");
}

#[test]
fn a_restore_draws_no_new_noise() {
    let mut scenario = common::four_cylinders();
    scenario.lidar.noise_std_m = 0.1.into();
    let mut lab = Lab::new(&scenario, 1, 3);
    lab.step(&[1]);
    let (state, row) = (lab.state(0), lab.row(0));
    lab.edit(0, |_| ());
    assert_eq!(bits(&lab.row(0)), bits(&row), "the restored observation is the saved one");
    assert_eq!(row[0], state.scan.ranges_m[0] / RANGE_SCALE_M);
}
