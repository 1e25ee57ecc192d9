//! Pedestrians in the simulation: bodies, sensing, collisions, episodes.

mod common;

use common::Lab;
use wayfield::random::Stream;
use wayfield::scenario::{Crowd, Obstacle, ObstacleMotion, Scenario, Shape, Vec2, vec2};
use wayfield::sim;
use wayfield::task::{Clock, Pose, RewardConfig, Streams, TaskMode};

/// Asserts that the colliders, which LIDAR and contacts use, are where the pedestrians are.
fn assert_in_place(lab: &mut Lab, arena: usize, when: &str) {
    let (crowd, scenario) = (lab.state(arena).pedestrians.0, lab.scenario.clone());
    lab.with_physics(arena, |bodies, _, colliders| {
        for index in 0..scenario.obstacles.len() {
            let Some(pedestrian) = crowd.pedestrian(index) else { continue };
            let at = colliders.colliders[bodies.solids[index]].position().translation;
            assert_eq!(vec2(at.x, at.y), pedestrian.position_m, "{when}, arena {arena}, obstacle {index}");
        }
    });
}

#[test]
fn colliders_follow_the_pedestrians_and_every_episode_begins_with_the_crowd_at_its_start() {
    let scenario = common::pedestrians();
    let mut lab = Lab::new(&scenario, 3, 8);
    let mut streams: Vec<Stream> = common::action_streams(3);
    let (start, mut begun, mut moved) = (Crowd::at_start(&scenario), 0, 0);
    for step in 1..=400 {
        let actions = common::random_actions(&mut streams);
        lab.step(&actions);
        let ended: Vec<usize> = lab.take_ended_episodes().iter().map(|episode| episode.arena).collect();
        for arena in 0..3 {
            assert_in_place(&mut lab, arena, &format!("after step {step}"));
            let state = lab.state(arena);
            assert_eq!(state.pedestrians.0 == start, ended.contains(&arena), "step {step}, arena {arena}");
            moved += usize::from(state.pedestrians.0 != start);
        }
        begun += ended.len();
    }
    assert!(begun > 3 && moved > 900, "{begun} episodes, {moved} arena steps");
    sim::reset_arenas(lab.simulation.world_mut(), |arena| Some((Streams::new(4, arena as u64), Clock(777))));
    for arena in 0..3 {
        assert_in_place(&mut lab, arena, "after a reset");
        assert_eq!(lab.state(arena).pedestrians.0, start, "the clock of the other obstacles does not matter");
    }
}

/// Lets a pedestrian walk along the x axis towards the robot, which stands still at the origin. Returns whether they collide,
/// and the pedestrian's last position.
fn walk_into_the_robot(sees_robot: bool) -> (bool, Vec2) {
    let motion = ObstacleMotion::Pedestrian {
        goals_m: vec![vec2(1.5, 0.0)],
        speed_m_s: 0.5.into(),
        loops: false,
        sees_robot,
    };
    let shape = Shape::Circle { radius_m: 0.2 };
    let obstacles = vec![Obstacle { shape, position_m: vec2(-1.5, 0.02), rotation_rad: 0.0, motion }];
    let mut scenario = Scenario { obstacles, ..Scenario::default() };
    scenario.robot.motions.iter_mut().for_each(|motion| motion.v_m_s *= 0.0001);
    let mut lab = Lab::with(&scenario, 1, 3, RewardConfig::default(), TaskMode::SingleGoal);
    lab.edit(0, |state| state.pose = Pose { x_m: 0.0, y_m: 0.0, heading_rad: 0.0 });
    let mut nearest_m = f32::INFINITY;
    for _ in 0..60 {
        lab.step(&[2]);
        nearest_m = nearest_m.min(lab.state(0).scan.nearest_m);
        if lab.outcomes()[0].collided {
            return (true, lab.state(0).pedestrians.0.pedestrian(0).expect("a pedestrian").position_m);
        }
    }
    assert!(nearest_m < 0.4, "the LIDAR has seen the pedestrian: {nearest_m} m");
    (false, lab.state(0).pedestrians.0.pedestrian(0).expect("a pedestrian").position_m)
}

#[test]
fn a_pedestrian_runs_into_a_robot_that_it_does_not_see_and_walks_around_one_that_it_sees() {
    let (collided, at_m) = walk_into_the_robot(false);
    assert!(collided && at_m.x < 0.0, "on the way to the robot, at {at_m}");
    let (collided, at_m) = walk_into_the_robot(true);
    assert!(!collided && at_m.x > 1.2, "past the robot, at {at_m}");
}
