//! Actuator lag and limited accelerations: the robot follows the commanded motions with a first-order lag or at a limited rate,
//! and starts at rest.

mod common;

use common::{Lab, bits};
use proptest::prelude::*;
use wayfield::scenario::{Drive, Motion, Robot, Scenario};
use wayfield::sim::{chord_velocity, integrate_heading};
use wayfield::task::{EpisodeEnd, Goal, Pose, RewardConfig, TaskMode, Twist};

/// The paper's robot with a lag of 0.3 s (1.5 control steps), far from everything.
fn lagging() -> Scenario {
    let mut scenario = common::wide_open();
    scenario.robot.actuator_lag_s = 0.3.into();
    scenario
}

/// The drive with a lag of `lag_s`, over steps of `seconds`.
fn lag(lag_s: f32, seconds: f32) -> Drive {
    lagging_by(lag_s).drive(seconds)
}

fn lagging_by(lag_s: f32) -> Robot {
    Robot { actuator_lag_s: lag_s.into(), ..Robot::default() }
}

/// An arena with the robot at rest at (0, 0), heading along x, and the goal `ahead_m` in front of it.
fn facing(scenario: &Scenario, ahead_m: f32, mode: TaskMode) -> Lab {
    let mut lab = Lab::with(scenario, 1, 4, RewardConfig::default(), mode);
    assert_eq!(lab.state(0).twist, Twist::default(), "an episode begins at rest");
    lab.edit(0, |state| {
        state.pose = Pose::default();
        state.goal = Goal { x_m: ahead_m, y_m: 0.0 };
    });
    lab
}

/// Asserts that pose and twist are within 1e-6 of the expected values.
fn assert_near(lab: &mut Lab, (x, y, heading): (f32, f32, f32), (v, w): (f32, f32)) {
    let (pose, twist) = (lab.state(0).pose, lab.state(0).twist);
    let off = [pose.x_m - x, pose.y_m - y, pose.heading_rad - heading, twist.v_m_s - v, twist.w_rad_s - w];
    assert!(off.iter().all(|off| off.abs() < 1e-6), "{pose:?}, {twist:?}, off by {off:?}");
}

#[test]
fn two_steps_match_a_calculation_by_hand() {
    // T = 0.2 s, tau = 0.3 s. Of the difference from the commanded motion, e^(-2/3) = 0.5134171 remains at a step's end, and
    // 1.5 (1 - 0.5134171) = 0.7298743 on average over the step.
    let mut lab = facing(&lagging(), 50.0, TaskMode::Continuing);
    // From rest, commanded (0.15, 1.5). Mean: 0.15 x 0.2701257 = 0.04051885 m/s and 0.4051885 rad/s, so an arc of radius
    // 0.1 m over 0.0810377 rad: x = 0.1 sin, y = 0.1 (1 - cos). At its end: 0.15 x 0.4865829 and 1.5 x 0.4865829.
    lab.step(&[0]);
    assert_near(&mut lab, (0.008_094_903, 0.000_328_176, 0.081_037_7), (0.072_987_43, 0.729_874_3));
    // Then commanded (0.15, -1.5). Mean: 0.15 - 0.07701257 x 0.7298743 = 0.09379050 m/s and
    // -1.5 + 2.2298743 x 0.7298743 = 0.1275280 rad/s, still to the left: an arc of radius 0.7354503 m over 0.0255056 rad.
    // At its end: 0.15 - 0.07701257 x 0.5134171 and -1.5 + 2.2298743 x 0.5134171.
    lab.step(&[4]);
    assert_near(&mut lab, (0.026_770_054, 0.002_084_882, 0.106_543_3), (0.110_460_43, -0.355_144_35));
}

#[test]
fn a_new_goal_keeps_the_robots_speed_and_a_new_episode_resets_it() {
    let mut scenario = lagging();
    scenario.task.max_episode_steps = 3;
    let mut lab = facing(&scenario, 0.205, TaskMode::Continuing);
    lab.step(&[2]);
    assert!(lab.outcomes()[0].reached, "0.205 m minus the 0.0081 m driven is less than the goal radius");
    let remaining = libm::expf(-2.0 / 3.0);
    for step in 1..3 {
        let expected = 0.15 * (1.0 - remaining.powi(step));
        let twist = lab.state(0).twist;
        assert!((twist.v_m_s - expected).abs() < 1e-6, "after step {step}, {expected} m/s: {twist:?}");
        lab.step(&[2]);
    }
    assert_eq!(lab.take_ended_episodes()[0].end, EpisodeEnd::TimedOut);
    assert_eq!(lab.state(0).twist, Twist::default(), "a new episode begins at rest");
}

#[test]
fn a_reset_arena_starts_at_rest() {
    let mut lab = Lab::with(&lagging(), 1, 4, RewardConfig::default(), TaskMode::SingleGoal);
    lab.step(&[0]);
    let state = lab.state(0);
    assert!(state.twist.v_m_s > 0.07 && state.twist.w_rad_s > 0.7);
    wayfield::sim::reset_arenas(lab.simulation.world_mut(), |_| Some((state.streams.clone(), state.clock)));
    assert_eq!(lab.state(0).twist, Twist::default());
}

#[test]
fn without_a_lag_every_step_has_the_commanded_motion_to_the_bit() {
    let scenario = common::wide_open();
    assert_eq!(scenario.robot.actuator_lag_s, 0.0.into());
    let arenas = 4;
    let mut lab = Lab::new(&scenario, arenas, 3);
    let mut action_streams = common::action_streams(arenas);
    for step in 1..=200 {
        let before = lab.states();
        let actions = common::random_actions(&mut action_streams);
        lab.step(&actions);
        for (arena, after) in lab.states().iter().enumerate() {
            let (from, motion) = (&before[arena].pose, &scenario.robot.motions[actions[arena]]);
            let velocity = lab.with_physics(arena, |bodies, set, _| set.bodies[bodies.robot].linvel());
            let expected = chord_velocity(from.heading_rad, motion, 0.2);
            assert_eq!(
                bits(&[velocity.x, velocity.y]),
                bits(&[expected.x, expected.y]),
                "step {step}, arena {arena}"
            );
            let heading_rad = integrate_heading(from.heading_rad, motion, 0.2);
            assert_eq!(after.pose.heading_rad.to_bits(), heading_rad.to_bits(), "step {step}, arena {arena}");
            assert_eq!(after.twist, Twist { v_m_s: motion.v_m_s, w_rad_s: motion.w_rad_s });
        }
    }
    assert!(lab.take_ended_episodes().is_empty(), "no robot collided and no episode ended");
}

#[test]
fn each_arena_has_its_own_actuator_state() {
    // Two arenas that differ in the robot's initial speed only.
    let mut lab = Lab::new(&lagging(), 2, 3);
    let state = lab.state(0);
    lab.edit(1, |other| *other = state.clone());
    lab.edit(1, |other| other.twist = Twist { v_m_s: 0.15, w_rad_s: 0.0 });
    let alone = {
        let mut lab = Lab::new(&lagging(), 1, 3);
        lab.step(&[2]);
        lab.state(0)
    };
    lab.step(&[2, 2]);
    let (slow, fast) = (lab.state(0), lab.state(1));
    assert_eq!(slow, alone, "arena 0 does not depend on arena 1");
    let distance = |pose: &Pose| (pose.x_m - state.pose.x_m).hypot(pose.y_m - state.pose.y_m);
    assert!((distance(&slow.pose) - 0.008_103_77).abs() < 2e-5, "{} m from rest", distance(&slow.pose));
    assert!((distance(&fast.pose) - 0.03).abs() < 2e-5, "{} m at full speed", distance(&fast.pose));
}

#[test]
fn a_robot_with_limited_accelerations_speeds_up_and_brakes_along_a_ramp() {
    let mut scenario = common::wide_open();
    scenario.robot.max_acceleration_m_s2 = Some(0.5);
    scenario.robot.max_angular_acceleration_rad_s2 = Some(5.0);
    let mut lab = facing(&scenario, 50.0, TaskMode::Continuing);
    // 0.5 m/s^2 reach 0.1 m/s after the first step of 0.2 s, with a mean of 0.05 m/s, and 0.15 m/s in the middle of the second.
    // 5 rad/s^2 reach 1 rad/s and then 1.5 rad/s in the middle of the second step.
    lab.step(&[0]);
    let twist = lab.state(0).twist;
    assert!((twist.v_m_s - 0.1).abs() < 1e-6 && (twist.w_rad_s - 1.0).abs() < 1e-6, "{twist:?}");
    assert!((lab.state(0).pose.heading_rad - 0.1).abs() < 1e-6, "a mean of 0.5 rad/s");
    lab.step(&[0]);
    assert_eq!(lab.state(0).twist, Twist { v_m_s: 0.15, w_rad_s: 1.5 });
    let heading_rad = 0.1 + 0.125 + 0.15;
    assert!((lab.state(0).pose.heading_rad - heading_rad).abs() < 1e-6, "1.25 rad/s on average, then 1.5");
    lab.step(&[4]);
    assert!((lab.state(0).twist.w_rad_s - 0.5).abs() < 1e-6, "1 rad/s less");
}

#[test]
fn a_high_limit_changes_nothing_and_a_lag_within_the_limit_stays_a_lag() {
    let motion = Motion { v_m_s: 0.15, w_rad_s: -1.5 };
    let rest = Motion { v_m_s: 0.0, w_rad_s: 0.0 };
    for lag_s in [0.0, 0.3] {
        let free = lagging_by(lag_s);
        let limited = Robot {
            max_acceleration_m_s2: Some(1000.0),
            max_angular_acceleration_rad_s2: Some(10_000.0),
            ..free.clone()
        };
        let [free, limited] = [free, limited].map(|robot| robot.drive(0.2).step(&rest, &motion));
        for (free, limited) in [(free.0, limited.0), (free.1, limited.1)] {
            let off = [free.v_m_s - limited.v_m_s, free.w_rad_s - limited.w_rad_s];
            assert!(off.iter().all(|off| off.abs() < 1e-3), "lag {lag_s} s: {free:?} and {limited:?}");
        }
    }
}

proptest! {
    #[test]
    fn the_twist_stays_between_the_initial_and_the_commanded_motion(
        lag_s in 0.0_f32..=10.0, seconds in 0.001_f32..10.0, initial in -5.0_f32..5.0, commanded in -5.0_f32..5.0,
    ) {
        let lag = lag(lag_s, seconds);
        let motion = Motion { v_m_s: commanded, w_rad_s: -4.0 * commanded };
        let mut twist = Motion { v_m_s: initial, w_rad_s: -4.0 * initial };
        let max = initial.abs().max(commanded.abs()) * (1.0 + 1e-6);
        let slack = 1e-6 * max;
        let between = initial.min(commanded) - slack..=initial.max(commanded) + slack;
        let steps = (20.0 * lag_s / seconds).ceil().min(1e6) as u32 + 1;
        for _ in 0..steps {
            let (mean, after) = lag.step(&twist, &motion);
            for (v, w) in [(mean.v_m_s, mean.w_rad_s), (after.v_m_s, after.w_rad_s)] {
                prop_assert!(between.contains(&v) && between.contains(&(w / -4.0)), "{v}, {w}");
            }
            let off = |v: f32| (v - commanded).abs();
            prop_assert!(off(after.v_m_s) <= off(mean.v_m_s) + slack && off(mean.v_m_s) <= off(twist.v_m_s) + slack);
            twist = after;
        }
        // The twist stops changing when the change per step is below the rounding error.
        let rounding = 2e-7 * max * (1.0 + lag_s / seconds);
        prop_assert!((twist.v_m_s - commanded).abs() <= rounding, "after 20 lags: {twist:?}, commanded {commanded}");
    }

    #[test]
    fn zero_lag_gives_the_commanded_motion_to_the_bit(
        v in -5.0_f32..5.0, w in -20.0_f32..20.0, v_m_s in -5.0_f32..5.0, w_rad_s in -20.0_f32..20.0, index in 0..3,
    ) {
        // Includes the smallest positive number, a lag too short to have an effect.
        let lag = lag([0.0, -0.0, f32::from_bits(1)][index as usize], 0.2);
        let (mean, after) = lag.step(&Motion { v_m_s: v, w_rad_s: w }, &Motion { v_m_s, w_rad_s });
        let expected = bits(&[v_m_s, w_rad_s]);
        prop_assert_eq!(bits(&[mean.v_m_s, mean.w_rad_s]), expected.clone());
        prop_assert_eq!(bits(&[after.v_m_s, after.w_rad_s]), expected);
    }

    #[test]
    fn one_step_equals_a_hundred_steps_of_a_hundredth(
        lag_s in prop_oneof![Just(0.0), 0.01_f32..10.0], seconds in 0.01_f32..10.0, initial in -5.0_f32..5.0,
        commanded in -5.0_f32..5.0, limit in proptest::option::of(0.01_f32..20.0),
    ) {
        let motion = Motion { v_m_s: commanded, w_rad_s: 0.0 };
        let start = Motion { v_m_s: initial, w_rad_s: 0.0 };
        let drive = Robot { max_acceleration_m_s2: limit, ..lagging_by(lag_s) }.drive(seconds);
        let (mean, end) = drive.step(&start, &motion);
        let small = drive.over(seconds / 100.0);
        let (mut twist, mut sum) = (start, 0.0_f64);
        for _ in 0..100 {
            let (mean, after) = small.step(&twist, &motion);
            sum += f64::from(mean.v_m_s) / 100.0;
            twist = after;
        }
        // The tolerance covers the rounding of speeds that differ by up to 10 m/s in each of the hundred steps.
        prop_assert!((sum - f64::from(mean.v_m_s)).abs() < 2e-4, "mean: {sum} and {}", mean.v_m_s);
        prop_assert!((twist.v_m_s - end.v_m_s).abs() < 2e-4, "end: {twist:?} and {end:?}");
    }
}
