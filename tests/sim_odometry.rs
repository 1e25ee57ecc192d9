//! Wheel slip and the drift of odometry: the robot's true pose, and its estimated pose.

mod common;

use common::{Lab, bits};
use wayfield::scenario::{OdometryDrift, Ranged, Scenario, Slip};
use wayfield::sim::{chord_velocity, integrate_heading};
use wayfield::task::{EpisodeEnd, Goal, Pose, RewardConfig, TaskMode};

fn drift(distance_error: f32, rotation_error: f32, heading_drift_rad_m: f32) -> Option<OdometryDrift> {
    Some(OdometryDrift {
        distance_error: distance_error.into(),
        rotation_error: rotation_error.into(),
        heading_drift_rad_m: heading_drift_rad_m.into(),
    })
}

/// An arena with the robot at (0, 0), heading along x, with a correct estimate, and the goal `ahead_m` in front of it.
fn facing(scenario: &Scenario, ahead_m: f32, mode: TaskMode) -> Lab {
    let mut lab = Lab::with(scenario, 1, 4, RewardConfig::default(), mode);
    lab.edit(0, |state| {
        state.pose = Pose::default();
        state.estimated_pose = Pose::default();
        state.goal = Goal { x_m: ahead_m, y_m: 0.0 };
    });
    lab
}

/// Asserts that the observed bearing of the goal is that from the estimated pose. Returns the distance and the bearing of the
/// goal from there, in m and rad.
fn observed_goal(lab: &mut Lab) -> (f32, f32) {
    let state = lab.state(0);
    let expected =
        (state.estimated_pose.distance_m(&state.goal), state.estimated_pose.bearing_rad(&state.goal));
    let row = lab.row(0);
    let beams = state.scan.ranges_m.len();
    assert!((row[beams] - expected.1 / std::f32::consts::PI).abs() < 1e-5, "{} and {expected:?}", row[beams]);
    expected
}

#[test]
fn without_drift_the_robot_knows_its_pose_to_the_bit() {
    let mut scenario = common::moving_obstacles();
    scenario.robot.slip = Some(Slip { forward: 0.2.into(), ..Slip::default() });
    let mut lab = Lab::new(&scenario, 3, 1);
    let mut streams = common::action_streams(3);
    for _ in 0..60 {
        lab.step(&common::random_actions(&mut streams));
        for state in lab.states() {
            assert_eq!(state.estimated_pose, state.pose);
        }
    }
}

#[test]
fn slip_shortens_each_motion_by_the_stated_fraction() {
    let mut scenario = common::wide_open();
    scenario.robot.slip = Some(Slip { forward: 0.1.into(), turning: 0.3.into(), std: 0.0.into() });
    let mut lab = facing(&scenario, 50.0, TaskMode::Continuing);
    lab.step(&[2]);
    assert!((lab.state(0).pose.x_m - 0.9 * 0.03).abs() < 1e-6, "{:?}", lab.state(0).pose);
    assert_eq!(lab.state(0).twist.v_m_s, 0.15, "the wheels have their full speed");
    lab.step(&[0]);
    let turned = lab.state(0).pose.heading_rad;
    assert!((turned - 0.7 * 1.5 * 0.2).abs() < 1e-6, "{turned} rad");
}

#[test]
fn random_slip_varies_from_step_to_step_and_never_makes_a_robot_faster() {
    let mut scenario = common::wide_open();
    scenario.robot.slip = Some(Slip { forward: 0.2.into(), turning: 0.0.into(), std: 0.1.into() });
    let mut lab = Lab::new(&scenario, 2, 4);
    let (mut kept, mut other) = (Vec::new(), Vec::new());
    for _ in 0..200 {
        let before = lab.states();
        lab.step(&[2, 2]);
        let moved: Vec<f32> = before
            .iter()
            .zip(lab.states())
            .map(|(from, to)| (to.pose.x_m - from.pose.x_m).hypot(to.pose.y_m - from.pose.y_m) / 0.03)
            .collect();
        kept.push(moved[0]);
        other.push(moved[1]);
    }
    let mean = kept.iter().sum::<f32>() / 200.0;
    let std = (kept.iter().map(|part| (part - mean).powi(2)).sum::<f32>() / 199.0).sqrt();
    assert!(kept.iter().all(|part| (0.0..=1.0 + 1e-3).contains(part)));
    // Four standard errors of the mean are 0.03, of the standard deviation 0.02. Fractions are at most 1, two
    // standard deviations above the mean.
    assert!((mean - 0.8).abs() < 0.03 && (std - 0.1).abs() < 0.02, "mean {mean}, standard deviation {std}");
    assert_ne!(bits(&kept), bits(&other), "each arena has its own random slip");
}

#[test]
fn the_goal_is_observed_from_where_odometry_says_that_the_robot_is() {
    let mut scenario = common::wide_open();
    scenario.robot.odometry_drift = drift(0.1, 0.2, 0.5);
    let mut lab = facing(&scenario, 10.0, TaskMode::Continuing);
    assert_eq!(observed_goal(&mut lab), (10.0, 0.0), "an episode begins with the true pose");
    // Ahead for 0.03 m, which odometry reports as 0.033 m and a turn of 0.015 rad.
    lab.step(&[2]);
    let estimate = lab.state(0).estimated_pose;
    assert!((estimate.heading_rad - 0.015).abs() < 1e-6, "{estimate:?}");
    assert!((estimate.x_m - 0.033 * 0.0075_f32.cos()).abs() < 1e-6, "{estimate:?}");
    assert!((estimate.y_m - 0.033 * 0.0075_f32.sin()).abs() < 1e-6, "{estimate:?}");
    let (_, bearing_rad) = observed_goal(&mut lab);
    assert!(bearing_rad < -0.014, "the goal seems to lie to the right: {bearing_rad} rad");
    assert_eq!(lab.state(0).pose.heading_rad, 0.0, "the robot has not turned");
    // 0.3 rad to the left, which odometry reports as 0.36 rad, and 0.015 rad more for another 0.03 m.
    lab.step(&[0]);
    let turned = lab.state(0).estimated_pose.heading_rad;
    assert!((turned - 0.39).abs() < 1e-5, "{turned} rad");
}

#[test]
fn odometry_does_not_notice_slip() {
    let mut scenario = common::wide_open();
    scenario.robot.slip = Some(Slip { forward: 0.5.into(), ..Slip::default() });
    scenario.robot.odometry_drift = drift(0.0, 0.0, 0.0);
    let mut lab = facing(&scenario, 10.0, TaskMode::Continuing);
    for _ in 0..10 {
        lab.step(&[2]);
    }
    let state = lab.state(0);
    assert!((state.estimated_pose.x_m - 0.3).abs() < 1e-5, "{:?}", state.estimated_pose);
    assert!((state.pose.x_m - 0.15).abs() < 1e-5, "{:?}", state.pose);
}

#[test]
fn goals_are_reached_by_the_true_pose_and_do_not_correct_the_estimate() {
    let mut scenario = common::wide_open();
    scenario.robot.odometry_drift = drift(-0.5, 0.0, 0.0);
    let mut lab = facing(&scenario, 1.0, TaskMode::Continuing);
    let steps = (1..50).find(|_| {
        lab.step(&[2]);
        lab.outcomes()[0].reached
    });
    // The robot has to drive more than 0.8 m, at 0.03 m per step.
    assert_eq!(steps, Some(27));
    let state = lab.state(0);
    assert!((state.estimated_pose.x_m - 0.405).abs() < 1e-4, "{:?}", state.estimated_pose);
    assert_eq!(state.episode.goals, 1);
    assert!(lab.take_ended_episodes().is_empty(), "the episode goes on");
    scenario.task.max_episode_steps = 5;
    let mut lab = facing(&scenario, 10.0, TaskMode::Continuing);
    for _ in 0..5 {
        lab.step(&[2]);
    }
    assert_eq!(lab.take_ended_episodes()[0].end, EpisodeEnd::TimedOut);
    let state = lab.state(0);
    assert_eq!(state.estimated_pose, state.pose, "a new episode begins with the true pose");
}

#[test]
fn a_drifting_estimate_is_restored_to_the_bit() {
    let mut scenario = common::moving_obstacles();
    scenario.robot.slip =
        Some(Slip { forward: Ranged::Range(0.0, 0.2), turning: 0.1.into(), std: 0.05.into() });
    scenario.robot.odometry_drift = Some(OdometryDrift {
        distance_error: Ranged::Range(-0.1, 0.1),
        rotation_error: Ranged::Range(-0.1, 0.1),
        heading_drift_rad_m: Ranged::Range(-0.2, 0.2),
    });
    let (mut one, mut other) = (Lab::new(&scenario, 4, 9), Lab::new(&scenario, 4, 10));
    let mut streams = common::action_streams(4);
    for _ in 0..30 {
        one.step(&common::random_actions(&mut streams));
    }
    assert!(one.states().iter().any(|state| state.estimated_pose != state.pose));
    let states = one.states();
    wayfield::sim::restore(other.simulation.world_mut(), &states);
    for step in 0..200 {
        let actions = common::random_actions(&mut streams);
        one.step(&actions);
        other.step(&actions);
        assert_eq!(one.states(), other.states(), "step {step}");
        for arena in 0..4 {
            assert_eq!(bits(&one.row(arena)), bits(&other.row(arena)), "step {step}, arena {arena}");
        }
    }
}

#[test]
fn the_estimate_adds_up_the_wheels_arcs() {
    let mut scenario = common::wide_open();
    scenario.robot.odometry_drift = drift(0.05, -0.1, 0.0);
    let mut lab = facing(&scenario, 50.0, TaskMode::Continuing);
    let mut expected = Pose::default();
    for action in [0, 1, 2, 3, 4, 2, 0] {
        let motion = scenario.robot.motions[action];
        let reported =
            wayfield::scenario::Motion { v_m_s: motion.v_m_s * 1.05, w_rad_s: motion.w_rad_s * 0.9 };
        let velocity = chord_velocity(expected.heading_rad, &reported, 0.2);
        expected.x_m += velocity.x * 0.2;
        expected.y_m += velocity.y * 0.2;
        expected.heading_rad = integrate_heading(expected.heading_rad, &reported, 0.2);
        lab.step(&[action]);
    }
    let estimate = lab.state(0).estimated_pose;
    let off = [
        estimate.x_m - expected.x_m,
        estimate.y_m - expected.y_m,
        estimate.heading_rad - expected.heading_rad,
    ];
    assert!(off.iter().all(|off| off.abs() < 1e-5), "{estimate:?} and {expected:?}");
}
