//! The pose of an obstacle, unless it is a pedestrian, depends on the clock alone, even when robots drive into it.

mod common;

use common::Lab;
use wayfield::scenario::{Scenario, pose_at};
use wayfield::sim;
use wayfield::task::{Clock, Pose, RewardConfig, Streams, TaskMode};

/// Asserts that bodies, and the colliders that LIDAR and contacts use, have the poses of `pose_at` at the arena's clock.
fn assert_in_place(lab: &mut Lab, arena: usize, when: &str) {
    let clock = lab.state(arena).clock;
    let scenario = lab.scenario.clone();
    lab.with_physics(arena, |bodies, set, colliders| {
        for (index, obstacle) in scenario.obstacles.iter().enumerate() {
            let (x, y, turn) = pose_at(obstacle, clock.0, scenario.task.control_period_s);
            let collider = &colliders.colliders[bodies.solids[index]];
            assert_eq!(collider.parent(), bodies.obstacles[index], "solids are in the scenario's order");
            let body = bodies.obstacles[index].map(|body| ("body", set.bodies[body].position()));
            for (what, at) in body.into_iter().chain([("collider", collider.position())]) {
                assert_eq!(
                    (at.translation.x, at.translation.y),
                    (x, y),
                    "{when}, arena {arena}, clock {}: position of the {what} of obstacle {index}",
                    clock.0
                );
                let off = (at.rotation.angle() - turn).rem_euclid(std::f32::consts::TAU);
                assert!(
                    off.min(std::f32::consts::TAU - off) < 1e-6,
                    "{when}, arena {arena}: rotation of the {what} of obstacle {index}"
                );
            }
        }
    });
}

#[test]
fn moving_obstacles_follow_the_clock_across_episodes() {
    let scenario = common::moving_obstacles();
    let mut lab = Lab::new(&scenario, 3, 8);
    let mut action_streams = common::action_streams(3);
    let mut episodes = 0;
    for step in 1..=400 {
        let actions = common::random_actions(&mut action_streams);
        lab.step(&actions);
        episodes += lab.take_ended_episodes().len();
        for arena in 0..3 {
            assert_eq!(lab.state(arena).clock, Clock(step), "the clock counts control steps across episodes");
            assert_in_place(&mut lab, arena, &format!("after step {step}"));
        }
    }
    assert!(episodes > 3, "only {episodes} episodes ended");
}

#[test]
fn obstacles_move_to_their_poses_when_the_clock_is_set() {
    let mut lab = Lab::new(&common::moving_obstacles(), 3, 8);
    for clock in [0, 1, 777, 1_000_000_007] {
        lab.step(&[2, 2, 2]);
        let start = |arena| Some((Streams::new(4, arena as u64), Clock(clock + arena as u64)));
        sim::reset_arenas(lab.simulation.world_mut(), start);
        for arena in 0..3 {
            assert_eq!(lab.state(arena).clock, Clock(clock + arena as u64));
            assert_in_place(&mut lab, arena, "after the reset");
        }
        lab.step(&[2, 2, 2]);
        (0..3).for_each(|arena| assert_in_place(&mut lab, arena, "one step later"));
    }
}

/// Puts the robot 1 mm away from, in contact with, or 5 mm inside each obstacle, from all sides, and drives into it.
fn drive_into_every_obstacle(scenario: &Scenario) {
    let mut lab = Lab::with(scenario, 1, 8, RewardConfig::default(), TaskMode::Continuing);
    let radius = scenario.robot.radius_m;
    let mut collisions = 0;
    for index in 0..scenario.obstacles.len() {
        for side in 0..12 {
            let angle_rad = side as f32 * 0.5;
            let clock = lab.state(0).clock.0;
            let (x, y, _) = pose_at(&scenario.obstacles[index], clock, scenario.task.control_period_s);
            let (sin, cos) = angle_rad.sin_cos();
            // Moves outwards from the obstacle's centre until the gap to the robot is `gap`.
            let at = |r: f32| (f64::from(x + r * cos), f64::from(y + r * sin));
            let gap = [0.001, 0.0, -0.005][side % 3];
            let mut r = 0.0;
            while common::closed_form::clearance(scenario, clock, at(r)) < f64::from(radius + gap) {
                r += 0.0005;
            }
            let heading_rad = wayfield::task::wrap_angle(angle_rad + std::f32::consts::PI);
            lab.edit(0, |state| state.pose = Pose { x_m: x + r * cos, y_m: y + r * sin, heading_rad });
            lab.step(&[2]);
            collisions += usize::from(lab.outcomes()[0].collided);
            assert_in_place(&mut lab, 0, &format!("after a collision from {angle_rad} rad"));
        }
    }
    assert_eq!(collisions, 12 * scenario.obstacles.len(), "every attempt is a collision");
}

#[test]
fn a_robot_cannot_push_an_obstacle() {
    drive_into_every_obstacle(&common::four_cylinders());
    drive_into_every_obstacle(&common::moving_obstacles());
}
