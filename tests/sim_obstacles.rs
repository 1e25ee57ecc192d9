//! Obstacles stand where the clock says, whatever drives into them.

mod common;

use common::Lab;
use wayfield::scenario::{Scenario, pose_at};
use wayfield::sim;
use wayfield::task::{Clock, Pose, RewardConfig, Streams, TaskMode};

/// Bodies, and the colliders that LIDAR and contacts use, are where `pose_at` puts them at the arena's clock.
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
                    "{when}, arena {arena}, clock {}: the {what} of obstacle {index} is where pose_at says",
                    clock.0
                );
                let off = (at.rotation.angle() - turn).rem_euclid(std::f32::consts::TAU);
                assert!(
                    off.min(std::f32::consts::TAU - off) < 1e-6,
                    "{when}, arena {arena}: the {what} of obstacle {index} is turned as pose_at says"
                );
            }
        }
    });
}

#[test]
fn moving_obstacles_follow_the_step_count_through_restarts() {
    let scenario = common::moving_obstacles();
    let mut lab = Lab::new(&scenario, 3, 8);
    let mut action_streams = common::action_streams(3);
    let mut restarts = 0;
    for step in 1..=400 {
        let actions = common::random_actions(&mut action_streams);
        lab.step(&actions);
        restarts += lab.take_ended_episodes().len();
        for arena in 0..3 {
            assert_eq!(
                lab.state(arena).clock,
                Clock(step),
                "the clock counts control steps and never restarts"
            );
            assert_in_place(&mut lab, arena, &format!("after step {step}"));
        }
    }
    assert!(restarts > 3, "with restarts on the way");
}

#[test]
fn a_rewound_clock_takes_the_obstacles_along() {
    let mut lab = Lab::new(&common::moving_obstacles(), 3, 8);
    for clock in [0, 1, 777, 1_000_000_007] {
        lab.step(&[2, 2, 2]);
        let fresh = |arena| Some((Streams::new(4, arena as u64), Clock(clock + arena as u64)));
        sim::reset_arenas(lab.simulation.world_mut(), fresh);
        for arena in 0..3 {
            assert_eq!(lab.state(arena).clock, Clock(clock + arena as u64));
            assert_in_place(&mut lab, arena, "rewound");
        }
        lab.step(&[2, 2, 2]);
        (0..3).for_each(|arena| assert_in_place(&mut lab, arena, "one step after"));
    }
}

/// Puts the robot 1 mm off, in contact with, or 5 mm into each obstacle, from all around, and drives on.
fn ram_everything(scenario: &Scenario) {
    let mut lab = Lab::with(scenario, 1, 8, RewardConfig::default(), TaskMode::Continuing);
    let radius = scenario.robot.radius_m;
    let mut touched = 0;
    for index in 0..scenario.obstacles.len() {
        for side in 0..12 {
            let angle_rad = side as f32 * 0.5;
            let clock = lab.state(0).clock.0;
            let (x, y, _) = pose_at(&scenario.obstacles[index], clock, scenario.task.control_period_s);
            let (sin, cos) = angle_rad.sin_cos();
            // From inside outwards, to where the robot's rim is `gap` off.
            let at = |r: f32| (f64::from(x + r * cos), f64::from(y + r * sin));
            let gap = [0.001, 0.0, -0.005][side % 3];
            let mut r = 0.0;
            while common::closed_form::clearance(scenario, clock, at(r)) < f64::from(radius + gap) {
                r += 0.0005;
            }
            let heading_rad = wayfield::task::wrap_angle(angle_rad + std::f32::consts::PI);
            lab.edit(0, |state| state.pose = Pose { x_m: x + r * cos, y_m: y + r * sin, heading_rad });
            lab.step(&[2]);
            touched += usize::from(lab.outcomes()[0].collided);
            assert_in_place(&mut lab, 0, &format!("rammed from {angle_rad} rad"));
        }
    }
    assert_eq!(touched, 12 * scenario.obstacles.len(), "every ramming is a collision");
}

#[test]
fn no_ramming_robot_shifts_an_obstacle() {
    ram_everything(&common::four_cylinders());
    ram_everything(&common::moving_obstacles());
}
