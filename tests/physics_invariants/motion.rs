//! The robot has the speed and the energy of the commanded motion.
//!
//! Without contact, a step takes the robot along the chord of the arc of v and w (with a lag, of their means over the step)
//! and turns it by w T. Rapier's body has the chord's velocity v_c, so its kinetic energy is m v_c^2 / 2 with the mass m of a
//! disc of 1 kg/m^2. The tolerances cover the rounding of f32: up to 3e-6 of distances, speeds, rotations and energies,
//! and half a unit in the last place of the coordinates.

use std::f64::consts::{PI, TAU};

use bevy::math::{Vec2, vec2};
use wayfield::random::{Stream, stream, uniform, uniform_01};
use wayfield::scenario::{Enclosure, Motion, Scenario, diagnostics};
use wayfield::task::{Pose, RewardConfig, TaskMode, Twist};

use crate::common::Lab;
use crate::random_scenarios::{Point, arc, centre, distance};

/// A scenario without obstacles, and a robot with 64 motions: speeds up to `max_m_s` and all allowed turning rates, the extremes
/// included.
fn empty(period_s: f32, lag_s: f32, max_m_s: f32, stream: &mut Stream) -> Scenario {
    let mut scenario = Scenario {
        enclosure: Enclosure::Rectangle { width_m: 1000.0, height_m: 1000.0 },
        ..Scenario::default()
    };
    let max_rad_s = (PI as f32 / period_s).min(20.0);
    let levels = [-1.0, 0.0, 1.0];
    let extremes = levels.into_iter().flat_map(|v| levels.map(|w| (v, w)));
    let random: Vec<_> =
        (0..55).map(|_| (2.0 * uniform_01(stream) - 1.0, 2.0 * uniform_01(stream) - 1.0)).collect();
    scenario.robot.motions =
        extremes.chain(random).map(|(v, w)| Motion { v_m_s: v * max_m_s, w_rad_s: w * max_rad_s }).collect();
    scenario.robot.radius_m = uniform(stream, 0.01, 0.12);
    scenario.robot.actuator_lag_s = lag_s.into();
    scenario.task.control_period_s = period_s;
    scenario.task.goal_radius_m = 25.0;
    scenario.task.min_goal_distance_m = 26.0;
    let route = scenario.benchmark_route.get_or_insert_default();
    (route.start_m, route.goal_m) = (Vec2::ZERO, vec2(60.0, 0.0));
    scenario.task.max_episode_steps = 1_000_000;
    assert!(diagnostics(&scenario).is_empty(), "{:?}", diagnostics(&scenario));
    scenario
}

/// The mean (v, w) over a step and (v, w) at its end, in f64, from du/dt = (commanded - u) / lag.
fn mean_and_end((v, w): (f64, f64), motion: &Motion, lag: f64, period: f64) -> [(f64, f64); 2] {
    let commanded = (f64::from(motion.v_m_s), f64::from(motion.w_rad_s));
    let lags = period / lag;
    let (mean, end) = if lag > 0.0 { (-(-lags).exp_m1() / lags, (-lags).exp()) } else { (0.0, 0.0) };
    [mean, end].map(|rest| (commanded.0 + (v - commanded.0) * rest, commanded.1 + (w - commanded.1) * rest))
}

/// The absolute difference of two headings, modulo full turns.
fn angle_between(a: f64, b: f64) -> f64 {
    let turn = (a - b).rem_euclid(TAU);
    turn.min(TAU - turn)
}

/// A control period from 0.001 s to 10 s, and a lag: none, up to two periods, or up to 10 s. Both in s.
fn period_and_lag(number: u64, stream: &mut Stream) -> (f32, f32) {
    let period = [0.001, 10.0, 0.2].get(number as usize).copied();
    let period = period.unwrap_or_else(|| 10.0_f32.powf(uniform(stream, -3.0, 1.0)).clamp(0.001, 10.0));
    let lag = [0.0, 0.0, uniform(stream, 0.0, 10.0), period * uniform(stream, 0.0, 2.0)][number as usize % 4];
    (period, lag.min(10.0))
}

#[test]
fn a_step_without_contact_has_the_arc_and_the_energy_of_the_commanded_motion() {
    const ARENAS: usize = 16;
    let mut stream = stream(21, "free steps", 0);
    let (mut worst_distance, mut worst_speed, mut worst_turn) = (0.0_f64, 0.0_f64, 0.0_f64);
    for number in 0..120 {
        let (period_s, lag_s) = period_and_lag(number, &mut stream);
        let scenario = empty(period_s, lag_s, 5.0, &mut stream);
        let period = f64::from(period_s);
        let mut lab = Lab::with(&scenario, ARENAS, number, RewardConfig::default(), TaskMode::SingleGoal);
        let fresh = lab.states();
        for round in 0..20_usize {
            let mut states = fresh.clone();
            for state in &mut states {
                let mut coordinate = || uniform(&mut stream, -200.0, 200.0);
                (state.pose.x_m, state.pose.y_m) = (coordinate(), coordinate());
                state.pose.heading_rad = uniform(&mut stream, -3.1, 3.1);
                // Any initial twist that a motion can cause.
                state.twist = Twist {
                    v_m_s: uniform(&mut stream, -5.0, 5.0),
                    w_rad_s: uniform(&mut stream, -1.0, 1.0) * (PI as f32 / period_s).min(20.0),
                };
            }
            wayfield::sim::restore(lab.simulation.world_mut(), &states);
            let actions: Vec<usize> = (0..ARENAS).map(|k| (round * ARENAS + k) % 64).collect();
            lab.step(&actions);
            for (arena, (before, after)) in states.iter().zip(lab.states()).enumerate() {
                let motion = &scenario.robot.motions[actions[arena]];
                let context =
                    || format!("{motion:?} for {period_s} s, lag {lag_s} s, from {:?}", before.pose);
                let twist = (f64::from(before.twist.v_m_s), f64::from(before.twist.w_rad_s));
                let [mean, end] = mean_and_end(twist, motion, f64::from(lag_s), period);
                let (from, heading) = (centre(&before.pose), f64::from(before.pose.heading_rad));
                let (expected, expected_heading) = arc((from, heading), mean, period);
                let collided = after.scan.touching || lab.outcomes()[arena].collided;
                assert!(!collided, "{}: a collision without obstacles", context());

                // Each coordinate is rounded by up to half a unit in the last place.
                let rounding =
                    2.0_f64.powi(-24) * (expected.0.abs() + expected.1.abs() + from.0.abs() + from.1.abs());
                let off_m = (distance(centre(&after.pose), expected) - rounding).max(0.0);
                let off = off_m / (mean.0.abs() * period).max(1e-3);
                let off_rad = angle_between(f64::from(after.pose.heading_rad), expected_heading);
                assert!(off < 2e-6, "{}: position off by {off} of the distance", context());
                assert!(off_rad < 2e-6, "{}: heading off by {off_rad} rad", context());
                let off_v = (f64::from(after.twist.v_m_s) - end.0).abs() / 5.0;
                let off_w = (f64::from(after.twist.w_rad_s) - end.1).abs() / 20.0;
                assert!(off_v.max(off_w) < 1e-6, "{}: {:?}, expected {end:?}", context(), after.twist);

                let chord_m_s = distance(from, expected) / period;
                let (velocity, mass, energy) = lab.with_physics(arena, |bodies, set, _| {
                    let body = &set.bodies[bodies.robot];
                    (body.linvel(), f64::from(body.mass()), f64::from(body.kinetic_energy()))
                });
                let chord = ((expected.0 - from.0) / period, (expected.1 - from.1) / period);
                let off_velocity = distance((f64::from(velocity.x), f64::from(velocity.y)), chord) / 5.0;
                assert!(off_velocity < 1e-6, "{}: velocity {velocity} m/s, expected {chord:?}", context());
                let disc = PI * f64::from(scenario.robot.radius_m).powi(2);
                assert!((mass / disc - 1.0).abs() < 1e-6, "mass {mass} kg, expected {disc} kg");
                let expected_energy = 0.5 * disc * chord_m_s * chord_m_s;
                let max_energy = 0.5 * disc * 25.0;
                assert!(
                    (energy - expected_energy).abs() <= 3e-6 * max_energy,
                    "{}: energy {energy} J, expected {expected_energy} J",
                    context()
                );
                worst_distance = worst_distance.max(off);
                worst_speed = worst_speed.max(off_velocity);
                worst_turn = worst_turn.max(off_rad);
            }
        }
    }
    println!("largest errors: {worst_distance} of the distance, {worst_speed} of 5 m/s, {worst_turn} rad");
}

#[test]
fn hundreds_of_steps_with_any_lag_do_not_drift() {
    const ARENAS: usize = 8;
    const STEPS: usize = 500;
    let mut stream = stream(22, "drift", 0);
    let (mut worst_m, mut worst_rad) = (0.0_f64, 0.0_f64);
    for number in 0..24 {
        let period_s = uniform(&mut stream, 0.02, 0.5);
        let lag_s = [0.0, 0.1, 2.0][number % 3] * uniform_01(&mut stream);
        let scenario = empty(period_s, lag_s, 1.0, &mut stream);
        let mut lab = Lab::with(&scenario, ARENAS, 3, RewardConfig::default(), TaskMode::SingleGoal);
        let mut states = lab.states();
        for state in &mut states {
            state.pose = Pose::default();
            (state.goal.x_m, state.goal.y_m) = (490.0, 490.0);
        }
        wayfield::sim::restore(lab.simulation.world_mut(), &states);
        let mut tracks: Vec<((Point, f64), (f64, f64))> = vec![(((0.0, 0.0), 0.0), (0.0, 0.0)); ARENAS];
        for step in 0..STEPS {
            // Keeps each motion for 20 steps, so that robots cover some distance.
            let actions: Vec<usize> = (0..ARENAS).map(|k| (step / 20 * 7 + 11 * k) % 64).collect();
            lab.step(&actions);
            for ((track, twist), action) in tracks.iter_mut().zip(&actions) {
                let motion = &scenario.robot.motions[*action];
                let [mean, end] = mean_and_end(*twist, motion, f64::from(lag_s), f64::from(period_s));
                *track = arc(*track, mean, f64::from(period_s));
                *twist = end;
            }
        }
        for (state, ((expected, heading), _)) in lab.states().iter().zip(&tracks) {
            let off_m = distance(centre(&state.pose), *expected);
            let off_rad = angle_between(f64::from(state.pose.heading_rad), *heading);
            assert!(
                off_m < 1e-3 && off_rad < 2e-4,
                "{STEPS} steps of {period_s} s: {off_m} m, {off_rad} rad off"
            );
            (worst_m, worst_rad) = (worst_m.max(off_m), worst_rad.max(off_rad));
        }
    }
    println!("largest errors after {STEPS} steps: {worst_m} m, {worst_rad} rad");
}
