//! Tests of the shipped scenarios: they load, have the paper's values, and survive a round trip through RON.

use std::path::{Path, PathBuf};

use glam::vec2;
use wayfield_scenario::{
    BenchmarkRoute, Enclosure, Obstacle, ObstacleMotion, PlacementRule, Scenario, Shape, parse_ron, pose_at,
    to_ron,
};

fn shipped(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join("scenarios").join(name)
}

fn load(name: &str) -> Scenario {
    Scenario::load(shipped(name)).unwrap_or_else(|error| panic!("{error}"))
}

#[test]
fn every_shipped_scenario_loads() {
    let entries = std::fs::read_dir(shipped("")).expect("the folder exists");
    let paths = entries.map(|entry| entry.expect("an entry").path());
    let files: Vec<_> = paths.filter(|path| path.is_file()).collect();
    assert!(files.len() >= 12);
    for file in files {
        Scenario::load(&file).unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
fn the_defaults_are_the_papers_values() {
    let scenario: Scenario = parse_ron("(name: \"x\")", "x.ron").expect("a name is enough");
    assert_eq!(
        scenario,
        Scenario { name: "x".into(), ..Scenario::default() },
        "files and code share their defaults"
    );
    assert_eq!(scenario.enclosure, Enclosure::Rectangle { width_m: 4.0, height_m: 4.0 });
    let motions: Vec<_> = scenario.robot.motions.iter().map(|m| (m.v_m_s, m.w_rad_s)).collect();
    let (v0, w0) = (0.15, 0.75);
    assert_eq!(motions, [(v0, 2.0 * w0), (v0, w0), (v0, 0.0), (v0, -w0), (v0, -2.0 * w0)], "equation (9)");
    assert_eq!(scenario.robot.actuator_lag_s, 0.0.into(), "the paper's robot has no actuator lag");
    assert_eq!(scenario.lidar.beams, 24, "equation (8)");
    assert_eq!(
        (scenario.lidar.max_range_m, scenario.lidar.noise_std_m, scenario.lidar.dropout),
        (3.5, 0.0.into(), 0.0.into())
    );
    assert_eq!(scenario.task.goal_radius_m, 0.2, "l_a");
    assert_eq!(scenario.task.control_period_s, 0.2);
    assert_eq!(
        (scenario.task.collision_range_m, scenario.task.max_episode_steps),
        (0.13, 500),
        "this project's choice"
    );
    assert_eq!(scenario.starts, PlacementRule::Random { clearance_m: 0.35 });
    assert_eq!(scenario.goals, scenario.starts);
    assert_eq!(scenario.benchmark_route, None, "a scenario has one only if its file names it");
    let BenchmarkRoute { start_m, goal_m, .. } = BenchmarkRoute::default();
    assert_eq!((start_m, goal_m), (vec2(0.0, 0.0), vec2(1.2, 1.2)), "tables 3 to 7");
    for name in ["scenario-1.ron", "scenario-2.ron"] {
        assert_eq!(load(name).benchmark_route, Some(BenchmarkRoute::default()), "{name}");
    }
}

#[test]
fn the_file_with_every_field_contains_the_defaults() {
    let empty = load("empty.ron");
    let benchmark_route = Some(BenchmarkRoute::default());
    assert_eq!(empty, Scenario { about: empty.about.clone(), benchmark_route, ..Scenario::default() });
}

#[test]
fn scenario_2_is_scenario_1_with_orbiting_obstacles() {
    let (one, two) = (load("scenario-1.ron"), load("scenario-2.ron"));
    let without_motion = |o: &Obstacle| Obstacle { motion: ObstacleMotion::Static, ..o.clone() };
    assert_eq!(one.obstacles, two.obstacles.iter().map(without_motion).collect::<Vec<_>>());
    assert!(one.obstacles.iter().all(|o| o.shape == Shape::Circle { radius_m: 0.15 }));
    let corners: Vec<_> = one.obstacles.iter().map(|o| o.position_m).collect();
    assert_eq!(corners, [vec2(0.6, 0.6), vec2(-0.6, 0.6), vec2(-0.6, -0.6), vec2(0.6, -0.6)]);
    // A turn of pi/2 at 0.15 rad/s takes 10.472 s, or 52.36 steps. After 52 steps the first obstacle is just short of the
    // second one's initial position.
    let (x, y, _) = pose_at(&two.obstacles[0], 52, two.task.control_period_s);
    assert!((x + 0.593).abs() < 2e-3 && (y - 0.6065).abs() < 2e-3, "({x}, {y})");
}

#[test]
fn a_written_scenario_is_read_back_unchanged() {
    for name in ["empty.ron", "scenario-1.ron", "scenario-2.ron"] {
        let scenario = load(name);
        let text = to_ron(&scenario).expect("it can be written");
        assert_eq!(Scenario::parse(&text, name).expect("and read"), scenario, "{name}");
    }
}
