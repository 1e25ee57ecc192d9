//! Property tests of placement: starts and goals keep their clearance in any scenario, and no text or number causes a panic.

use glam::{Vec2, vec2};
use proptest::prelude::*;
use wayfield_random::stream;
use wayfield_scenario::{
    Enclosure, Obstacle, ObstacleMotion, PlacementRule, Scenario, Shape, clearance, diagnostics, draw_goal,
    draw_start, pose_at, to_ron,
};

/// A valid scenario with most of the fields.
const EVERYTHING: &str = include_str!("fixtures/everything.ron");

fn shape() -> impl Strategy<Value = Shape> {
    prop_oneof![
        (0.05_f32..0.5).prop_map(|radius_m| Shape::Circle { radius_m }),
        (0.05_f32..1.5, 0.05_f32..0.5).prop_map(|(width_m, height_m)| Shape::Rectangle { width_m, height_m }),
    ]
}

/// A point whose coordinates are less than `reach` from 0.
fn point(reach: f32) -> impl Strategy<Value = Vec2> {
    (-reach..reach, -reach..reach).prop_map(Vec2::from)
}

fn motion() -> impl Strategy<Value = ObstacleMotion> {
    let point = || point(2.0);
    prop_oneof![
        Just(ObstacleMotion::Static),
        (point(), -1.0_f32..1.0).prop_map(|(centre_m, speed_rad_s)| ObstacleMotion::Orbit {
            centre_m,
            speed_rad_s: speed_rad_s.into()
        }),
        (prop::collection::vec(point(), 1..4), 0.0_f32..1.0).prop_map(|(waypoints_m, speed_m_s)| {
            ObstacleMotion::Patrol { waypoints_m, speed_m_s: speed_m_s.into() }
        }),
    ]
}

/// A scenario whose obstacles may be anywhere, even outside the enclosure.
fn scenario() -> impl Strategy<Value = Scenario> {
    let obstacle = (shape(), point(2.5), -6.0_f32..6.0, motion()).prop_map(
        |(shape, position_m, rotation_rad, motion)| Obstacle { shape, position_m, rotation_rad, motion },
    );
    (prop::collection::vec(obstacle, 0..8), 2.0_f32..8.0, 2.0_f32..8.0, 0.15_f32..0.6).prop_map(
        |(obstacles, width_m, height_m, clearance_m)| Scenario {
            enclosure: Enclosure::Rectangle { width_m, height_m },
            obstacles,
            starts: PlacementRule::Random { clearance_m },
            goals: PlacementRule::Random { clearance_m: clearance_m + 0.05 },
            ..Scenario::default()
        },
    )
}

proptest! {
    #[test]
    fn drawn_starts_and_goals_are_clear_distant_and_reproducible(
        scenario in scenario(), seed: u64, step in 0_u64..1_000_000_000,
    ) {
        let draw = || {
            let mut s = stream(seed, "places", 0);
            let start = draw_start(&scenario, step, &mut s);
            let robot = start.map_or(Vec2::ZERO, |(x, y, _)| vec2(x, y));
            (start, draw_goal(&scenario, step, robot, &mut s))
        };
        let (start, goal) = draw();
        prop_assert_eq!((start, goal), draw(), "the same stream gives the same places");
        let (PlacementRule::Random { clearance_m: least }, PlacementRule::Random { clearance_m: more }) =
            (&scenario.starts, &scenario.goals)
        else {
            panic!("random places");
        };
        let mut robot = Vec2::ZERO;
        if let Ok((x, y, _)) = start {
            robot = vec2(x, y);
            prop_assert!(clearance(&scenario, robot, step) >= *least);
        }
        if let Ok(goal) = goal {
            prop_assert!(clearance(&scenario, goal, step) >= *more);
            prop_assert!(goal.distance(robot) > 0.4999);
        }
    }

    #[test]
    fn in_a_valid_scenario_a_start_and_a_goal_are_found(scenario in scenario(), seed: u64) {
        let found = diagnostics(&scenario);
        prop_assume!(found.iter().all(|f| f.path.starts_with("obstacles") || f.path.starts_with("benchmark_route")));
        // Free space is checked only if all numbers are valid, the speeds of obstacles included.
        prop_assume!(!found.iter().any(|f| f.path.contains(".motion")));
        let mut s = stream(seed, "places", 0);
        let start = draw_start(&scenario, 0, &mut s);
        prop_assert!(start.is_ok());
        let robot = start.map_or(Vec2::ZERO, |(x, y, _)| vec2(x, y));
        prop_assert!(draw_goal(&scenario, 0, robot, &mut s).is_ok());
    }

    #[test]
    fn a_written_scenario_is_read_back_unchanged(scenario in scenario()) {
        let text = to_ron(&scenario).expect("it can be written");
        let read: Scenario = wayfield_scenario::parse_ron(&text, "w.ron").expect("and read");
        prop_assert_eq!(read, scenario);
    }

    #[test]
    fn arbitrary_text_causes_no_panic(text in "[ -~\n\u{e9}]{0,200}") {
        let _ = Scenario::parse(&text, "w.ron").map_err(|error| error.to_string());
    }

    #[test]
    fn damaged_valid_text_causes_no_panic(at in 0..EVERYTHING.len(), cut in 0_usize..12, put in "[\\[\\](){},:\"'/*#r.0-9é-]{0,4}") {
        let from = EVERYTHING.floor_char_boundary(at);
        let to = EVERYTHING.floor_char_boundary(from + cut);
        let damaged = format!("{}{put}{}", &EVERYTHING[..from], &EVERYTHING[to..]);
        let _ = Scenario::parse(&damaged, "w.ron").map_err(|error| error.to_string());
    }

    #[test]
    fn arbitrary_numbers_cause_no_panic_in_poses(
        position in any::<(f32, f32)>(), rotation_rad: f32, centre in any::<(f32, f32)>(), speed: f32,
        waypoints: Vec<(f32, f32)>,
        step: u64, period: f32,
    ) {
        let (position_m, centre_m) = (Vec2::from(position), Vec2::from(centre));
        let waypoints_m = waypoints.into_iter().map(Vec2::from).collect();
        for motion in [
            ObstacleMotion::Static,
            ObstacleMotion::Orbit { centre_m, speed_rad_s: speed.into() },
            ObstacleMotion::Patrol { waypoints_m, speed_m_s: speed.into() },
        ] {
            let shape = Shape::Circle { radius_m: 1.0 };
            let _ = pose_at(&Obstacle { shape, position_m, rotation_rad, motion }, step, period);
        }
    }
}
