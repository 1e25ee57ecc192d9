//! In scenarios with many static shapes, the spatial index and the grid over them change no bit of ranges, contacts, starts or
//! goals.

mod common;

use std::f32::consts::PI;

use bevy::math::{Vec2, vec2};
use common::{Lab, bits, large_worlds, static_obstacle};
use proptest::prelude::*;
use wayfield::scenario::{
    Enclosure, Generator, Obstacle, ObstacleMotion, PlacementRule, RandomShape, Scenario, Shape, Wall,
    WallCells,
};
use wayfield::sim::{Bodies, lidar};
use wayfield::task::{ArenaLayout, Pose};

/// Removes the spatial index of `lab`, which must have one, and the grid. Every query then tests every shape.
fn without_index(mut lab: Lab) -> Lab {
    let world = lab.simulation.world_mut();
    for (mut bodies, mut layout) in world.query::<(&mut Bodies, &mut ArenaLayout)>().iter_mut(world) {
        bodies.remove_grid();
        assert!(layout.index.take().is_some(), "the scenario is large enough for an index");
    }
    lab
}

/// Drives robots with random actions, with and without the index; contacts end episodes. Returns the number of contacts.
fn contacts_with_equal_bits(mut scenario: Scenario, steps: usize) -> usize {
    // Only contact counts as a collision.
    scenario.task.collision_range_m = 0.0;
    let (mut indexed, mut plain) = (Lab::new(&scenario, 8, 1), without_index(Lab::new(&scenario, 8, 1)));
    let mut streams = common::action_streams(8);
    let mut contacts = 0;
    for step in 0..steps {
        let actions = common::random_actions(&mut streams);
        indexed.step(&actions);
        plain.step(&actions);
        for (arena, (state, expected)) in indexed.states().iter().zip(plain.states()).enumerate() {
            let pose_bits = |pose: &Pose| bits(&[pose.x_m, pose.y_m, pose.heading_rad]);
            assert_eq!(pose_bits(&state.pose), pose_bits(&expected.pose), "step {step}, arena {arena}");
            assert_eq!(
                bits(&state.scan.ranges_m),
                bits(&expected.scan.ranges_m),
                "step {step}, arena {arena}"
            );
            assert_eq!((state.goal, state.scan.touching), (expected.goal, expected.scan.touching));
        }
        contacts += indexed.outcomes().iter().filter(|outcome| outcome.collided).count();
    }
    contacts
}

#[test]
fn a_simulation_in_a_field_of_277_circles_has_the_same_bits_with_and_without_the_index() {
    let contacts = contacts_with_equal_bits(large_worlds::barn(), 1_000);
    assert!(contacts > 50, "{contacts}");
}

#[test]
fn a_simulation_in_an_office_with_a_moving_obstacle_has_the_same_bits_with_and_without_the_index() {
    let mut office = large_worlds::office();
    // Robots start around an obstacle on patrol in a room in the middle.
    let region =
        |clearance_m| PlacementRule::Within { min_m: vec2(0.3, 0.3), max_m: vec2(4.7, 4.7), clearance_m };
    (office.starts, office.goals) = (region(0.2), region(0.2));
    let motion = ObstacleMotion::Patrol { waypoints_m: vec![vec2(4.0, 2.5)], speed_m_s: 0.5.into() };
    let patrol = static_obstacle(Shape::Rectangle { width_m: 0.4, height_m: 0.2 }, vec2(1.0, 2.5), 0.3);
    office.obstacles.insert(100, Obstacle { motion, ..patrol });
    let contacts = contacts_with_equal_bits(office, 1_000);
    assert!(contacts > 30, "{contacts}");
}

/// Drives the same robots around a wall of cells, and around static obstacles: the rectangles that the cells form.
#[test]
fn a_wall_of_cells_is_seen_and_touched_as_its_rectangles() {
    let rows = ["#########", "#...#...#", "#.#.#.#.#", "#.#...#.#", "#.##.##.#", "#.......#", "#########"];
    let cells = WallCells::new(rows.map(String::from).to_vec(), 0.75, vec2(0.125, 0.0));
    let wall = Wall { cells: Some(cells), ..Wall::default() };
    let random = PlacementRule::Random { clearance_m: 0.2 };
    let empty = Scenario {
        enclosure: Enclosure::Rectangle { width_m: 7.0, height_m: 5.25 },
        starts: random.clone(),
        goals: random,
        ..Scenario::default()
    };
    let obstacles = wall.pieces().collect();
    let (walled, boxed) = (Scenario { walls: vec![wall], ..empty.clone() }, Scenario { obstacles, ..empty });
    let (mut cells, mut boxes) = (Lab::new(&walled, 8, 1), Lab::new(&boxed, 8, 1));
    let mut streams = common::action_streams(8);
    let mut contacts = 0;
    for step in 0..500 {
        let actions = common::random_actions(&mut streams);
        cells.step(&actions);
        boxes.step(&actions);
        for (state, expected) in cells.states().iter().zip(boxes.states()) {
            let pose_bits = |pose: &Pose| bits(&[pose.x_m, pose.y_m, pose.heading_rad]);
            assert_eq!(pose_bits(&state.pose), pose_bits(&expected.pose), "step {step}");
            assert_eq!(bits(&state.scan.ranges_m), bits(&expected.scan.ranges_m), "step {step}");
            assert_eq!((state.goal, state.scan.touching), (expected.goal, expected.scan.touching));
        }
        contacts += cells.outcomes().iter().filter(|outcome| outcome.collided).count();
    }
    assert!(contacts > 20, "{contacts}");
}

/// A pose anywhere, or on a lattice of 0.5 m so that beams run along sides.
fn pose() -> impl Strategy<Value = Pose> {
    let coordinate = || prop_oneof![-9.9_f32..9.9, (-19_i8..=19).prop_map(|k| 0.5 * f32::from(k))];
    let heading = prop_oneof![-PI..PI, (-4_i8..=4).prop_map(|k| f32::from(k) * PI / 4.0)];
    (coordinate(), coordinate(), heading).prop_map(|(x_m, y_m, heading_rad)| Pose { x_m, y_m, heading_rad })
}

/// A scenario of 20 m x 20 m with 45 to 84 obstacles of all shapes, most of them static, and walls.
fn scenario() -> impl Strategy<Value = Scenario> {
    let coordinate = || prop_oneof![-10.0_f32..10.0, (-20_i8..=20).prop_map(|k| 0.5 * f32::from(k))];
    let point = move || (coordinate(), coordinate()).prop_map(Vec2::from);
    let size = || prop_oneof![(-2.0_f32..0.3).prop_map(|power| 10.0_f32.powf(power)), Just(0.5), Just(9.0)];
    let shape = prop_oneof![
        size().prop_map(|radius_m| Shape::Circle { radius_m: radius_m.min(1.0) }),
        (size(), size()).prop_map(|(width_m, height_m)| Shape::Rectangle { width_m, height_m }),
        (size(), 0.01_f32..0.5).prop_map(|(length_m, radius_m)| Shape::Capsule { length_m, radius_m }),
        size().prop_map(|side| Shape::Polygon {
            corners_m: vec![vec2(0.0, 0.0), vec2(side, 0.0), vec2(0.0, side)]
        }),
    ];
    let orbit = point().prop_map(|centre_m| ObstacleMotion::Orbit { centre_m, speed_rad_s: 0.1.into() });
    let motion = prop_oneof![19 => Just(ObstacleMotion::Static), 1 => orbit];
    let obstacle = (shape, point(), prop_oneof![Just(0.0_f32), -PI..PI], motion).prop_map(
        |(shape, position_m, rotation_rad, motion)| Obstacle { shape, position_m, rotation_rad, motion },
    );
    let wall = (prop::collection::vec(point(), 2..6), 0.01_f32..0.3)
        .prop_map(|(corners_m, thickness_m)| Wall { corners_m, thickness_m, ..Wall::default() });
    let square = Enclosure::Rectangle { width_m: 20.0, height_m: 20.0 };
    let corners_m = vec![vec2(-10.0, -10.0), vec2(10.0, -10.0), vec2(0.0, 10.0)];
    let enclosure = prop_oneof![Just(square), Just(Enclosure::Polygon { corners_m })];
    let obstacles = prop::collection::vec(obstacle, 45..85);
    let range = prop_oneof![Just(3.5_f32), 0.05_f32..50.0];
    (
        enclosure,
        obstacles,
        prop::collection::vec(wall, 0..9),
        range,
        prop_oneof![Just(24_usize), 1_usize..200],
    )
        .prop_map(|(enclosure, obstacles, walls, max_range_m, beams)| {
            // The robots stand in a corner; only rays are cast.
            let position_m = vec2(-9.5, -9.5);
            let starts = PlacementRule::Fixed { position_m, heading_rad: None };
            let goals = PlacementRule::Fixed { position_m: vec2(-9.5, -5.0), heading_rad: None };
            let mut scenario = Scenario { enclosure, obstacles, walls, starts, goals, ..Scenario::default() };
            (scenario.lidar.max_range_m, scenario.lidar.beams) = (max_range_m, beams);
            scenario
        })
}

/// Asserts that ranges from `poses` have the same bits as casts against every shape.
fn assert_ranges_of_all_shapes(lab: &mut Lab, poses: &[Pose]) {
    let beams = lab.scenario.lidar.beam_directions();
    let max_range_m = lab.scenario.lidar.max_range_m;
    for pose in poses {
        let ranges_m = lab.cast(0, pose);
        let mut expected_m = Vec::new();
        lab.with_physics(0, |bodies, _, colliders| {
            lidar::cast(&colliders.colliders, &bodies.solids, pose, &beams, max_range_m, &mut expected_m);
        });
        assert_eq!(bits(&ranges_m), bits(&expected_m), "{pose:?}: {ranges_m:?}, expected {expected_m:?}");
    }
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn ranges_among_many_shapes_equal_casts_against_every_shape(
        scenario in scenario(), poses in prop::collection::vec(pose(), 40),
    ) {
        assert_ranges_of_all_shapes(&mut Lab::new(&scenario, 1, 1), &poses);
    }
}

#[test]
fn many_generated_obstacles_are_indexed_in_every_episode() {
    let circles = Generator {
        count: 120,
        shape: RandomShape::Circle { radius_m: (0.05, 0.2) },
        gap_m: 0.3,
        within: None,
    };
    let enclosure = Enclosure::Rectangle { width_m: 20.0, height_m: 20.0 };
    let scenario = Scenario { enclosure, generators: vec![circles], ..Scenario::default() };
    let mut lab = Lab::new(&scenario, 1, 1);
    let mut layouts = Vec::new();
    let mut stream = wayfield::random::stream(1, "poses", 0);
    for _ in 0..5 {
        let mut coordinate = || wayfield::random::uniform(&mut stream, -9.9, 9.9);
        let poses: Vec<Pose> =
            (0..200).map(|_| Pose { x_m: coordinate(), y_m: coordinate(), heading_rad: 0.3 }).collect();
        assert_ranges_of_all_shapes(&mut lab, &poses);
        let world = lab.simulation.world_mut();
        let mut arenas = world.query::<&ArenaLayout>();
        let layout = arenas.single(world).expect("one arena");
        assert!(layout.index.is_some(), "the obstacles are indexed");
        layouts.push(layout.scenario.obstacles.clone());
        lab.edit(0, |state| state.layout_seed += 1);
    }
    layouts.dedup();
    assert_eq!(layouts.len(), 5, "each episode has a different layout");
}
