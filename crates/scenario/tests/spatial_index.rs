//! The spatial index gives the same clearances, starts and goals as a test of every wall and obstacle, bit for bit.

use proptest::prelude::*;
use wayfield_random::stream;
use wayfield_scenario::{
    Enclosure, IndexedScenario, Obstacle, ObstacleMotion, PlacementRule, Scenario, Shape, SpatialIndex,
    UniformGrid, Vec2, Wall, clearance, draw_start_and_goal, nearest, vec2,
};

/// A point anywhere, or on a lattice of 0.5 m, where walls and obstacles touch and distances are equal.
fn point(reach_m: f32) -> impl Strategy<Value = Vec2> {
    let lattice = (-20_i8..=20, -20_i8..=20).prop_map(|(x, y)| vec2(f32::from(x), f32::from(y)) * 0.5);
    prop_oneof![lattice, (-reach_m..reach_m, -reach_m..reach_m).prop_map(Vec2::from)]
}

fn obstacle() -> impl Strategy<Value = Obstacle> {
    let size = || prop_oneof![0.01_f32..1.0, Just(0.5), Just(6.0)];
    let shape = prop_oneof![
        size().prop_map(|radius_m| Shape::Circle { radius_m }),
        (size(), size()).prop_map(|(width_m, height_m)| Shape::Rectangle { width_m, height_m }),
        (size(), size()).prop_map(|(length_m, radius_m)| Shape::Capsule { length_m, radius_m }),
        size().prop_map(|side| Shape::Polygon {
            corners_m: vec![vec2(0.0, 0.0), vec2(side, 0.0), vec2(0.0, side)]
        }),
    ];
    let motion = prop_oneof![
        9 => Just(ObstacleMotion::Static),
        1 => point(5.0).prop_map(|centre_m| ObstacleMotion::Orbit { centre_m, speed_rad_s: 0.5.into() }),
    ];
    let rotation = prop_oneof![Just(0.0_f32), -3.0_f32..3.0];
    (shape, point(10.0), rotation, motion).prop_map(|(shape, position_m, rotation_rad, motion)| Obstacle {
        shape,
        position_m,
        rotation_rad,
        motion,
    })
}

/// A scenario of 20 m x 20 m with some walls and 60 to 119 obstacles, of which enough are static for an index.
fn large_scenario() -> impl Strategy<Value = Scenario> {
    let wall = (prop::collection::vec(point(10.0), 2..6), prop_oneof![0.01_f32..0.5, Just(3.0)])
        .prop_map(|(corners_m, thickness_m)| Wall { corners_m, thickness_m, ..Wall::default() });
    let parts = (prop::collection::vec(obstacle(), 60..120), prop::collection::vec(wall, 0..9));
    parts.prop_map(|(obstacles, walls)| Scenario {
        enclosure: Enclosure::Rectangle { width_m: 20.0, height_m: 20.0 },
        obstacles,
        walls,
        starts: PlacementRule::Random { clearance_m: 0.1 },
        ..Scenario::default()
    })
}

proptest! {
    #[test]
    fn clearances_and_placements_are_those_without_an_index(
        scenario in large_scenario(), points in prop::collection::vec(point(15.0), 40), step in 0_u64..100, seed in 0_u64..9,
    ) {
        let index = SpatialIndex::new(&scenario).expect("there are enough parts");
        let indexed = IndexedScenario { index: Some(&index), ..(&scenario).into() };
        for point in points {
            let (part, distance_m) = nearest(&scenario, point, step);
            let found = indexed.nearest(point, step);
            prop_assert_eq!((part, distance_m.to_bits()), (found.0, found.1.to_bits()), "{:?}", point);
            for asked_m in [0.0, 0.1, 0.35, 2.0, distance_m, distance_m.next_up(), distance_m.next_down()] {
                let expected = clearance(&scenario, point, step) >= asked_m;
                prop_assert_eq!(indexed.is_clear(point, step, asked_m), expected, "{} m at {:?}", asked_m, point);
            }
        }
        let drawn = draw_start_and_goal(&scenario, step, &mut stream(seed, "places", 0));
        prop_assert_eq!(drawn, draw_start_and_goal(indexed, step, &mut stream(seed, "places", 0)));
    }
}

#[test]
fn a_scenario_with_few_parts_or_a_non_finite_number_has_no_index() {
    assert!(SpatialIndex::new(&Scenario::default()).is_none());
    let circle = |x: f32| Obstacle {
        shape: Shape::Circle { radius_m: 0.1 },
        position_m: vec2(x, 0.0),
        rotation_rad: 0.0,
        motion: ObstacleMotion::Static,
    };
    let mut scenario =
        Scenario { obstacles: (0..100).map(|k| circle(k as f32)).collect(), ..Scenario::default() };
    assert!(SpatialIndex::new(&scenario).is_some());
    scenario.obstacles[50].position_m.x = f32::NAN;
    assert!(SpatialIndex::new(&scenario).is_none());
}

/// With the most obstacles allowed, all of them large, the grid is so coarse that it takes neither much memory nor much time.
#[test]
fn the_index_of_ten_thousand_large_obstacles_is_small_and_exact() {
    let large = |k: u16| Obstacle {
        shape: Shape::Rectangle { width_m: 900.0, height_m: 900.0 },
        position_m: vec2(f32::from(k) * 0.01, 0.0),
        rotation_rad: 0.3,
        motion: ObstacleMotion::Static,
    };
    let enclosure = Enclosure::Rectangle { width_m: 1000.0, height_m: 1000.0 };
    let scenario = Scenario { enclosure, obstacles: (0..10_000).map(large).collect(), ..Scenario::default() };
    let index = SpatialIndex::new(&scenario).expect("there are enough parts");
    let indexed = IndexedScenario { index: Some(&index), ..(&scenario).into() };
    let point = vec2(-480.0, 480.0);
    assert_eq!(indexed.nearest(point, 0), nearest(&scenario, point, 0));
    let boxes = vec![(Vec2::splat(-450.0), Vec2::splat(450.0)); 10_000];
    let grid = UniformGrid::new(&boxes, |_, _| 0.0).expect("finite boxes");
    let entries: usize = grid.cells().map(<[u32]>::len).sum();
    assert!(entries < 300_000, "{entries} entries in all cells");
}
