//! Tests of the scenario checks: the exact messages for cases that have no fixture, and the time that the checks take.

use std::time::{Duration, Instant};

use glam::{Vec2, Vec2Swizzles, vec2};
use wayfield_scenario::{
    BenchmarkRoute, Enclosure, Generator, KeyFrame, KeyFrameEnd, Motion, Obstacle, ObstacleMotion,
    PlacementRule, RandomShape, Region, Robot, Scenario, Shape, TaskRules, Wall, diagnostics, notes,
};

/// The diagnostics as lines, without a file name.
fn found(scenario: &Scenario) -> Vec<String> {
    diagnostics(scenario).iter().map(ToString::to_string).collect()
}

/// The diagnostics of a scenario with this enclosure.
fn enclosed(corners_m: &[Vec2]) -> Vec<String> {
    let enclosure = Enclosure::Polygon { corners_m: corners_m.into() };
    found(&Scenario { enclosure, ..Scenario::default() })
}

#[test]
fn a_polygonal_enclosure_must_be_an_outline() {
    assert_eq!(
        enclosed(&[vec2(0.0, 0.0), vec2(1.0, 0.0)]),
        ["`enclosure.corners_m` has 2 entries: write 3 to 64"]
    );
    assert_eq!(
        enclosed(&[vec2(0.0, 0.0), vec2(1.0, 0.0), vec2(0.0, 501.0)]),
        ["`enclosure.corners_m[2][1]` is 501: write a number from -500 to 500 (metres)"]
    );
    assert_eq!(
        enclosed(&[vec2(0.0, 0.0), vec2(3.0, 0.0), vec2(3.0, 0.25)]),
        ["`enclosure.corners_m` span only 0.25 m along y: spread them over at least 0.5 m"]
    );
    assert_eq!(
        enclosed(&[vec2(0.0, 0.0), vec2(3.0, 3.0), vec2(3.0, 3.0), vec2(0.0, 3.0)]),
        ["`enclosure.corners_m[2]` repeats the corner before it: remove one of them"]
    );
    // An hourglass, sides that touch, and a side that runs back along the previous one.
    let meet = |second: usize, sides: &str, first: &str| {
        [format!(
            "`enclosure.corners_m[{second}]` starts a side ({sides}) that touches the side from {first}: move a corner, \
             or list the corners in order around the outline"
        )]
    };
    assert_eq!(
        enclosed(&[vec2(-1.0, -1.0), vec2(1.0, 1.0), vec2(1.0, -1.0), vec2(-1.0, 1.0)]),
        meet(2, "corners_m[2] to corners_m[3]", "corners_m[0] to corners_m[1]")
    );
    assert_eq!(
        enclosed(&[vec2(-2.0, -2.0), vec2(2.0, -2.0), vec2(2.0, 2.0), vec2(0.0, -2.0), vec2(-2.0, 2.0)]),
        meet(2, "corners_m[2] to corners_m[3]", "corners_m[0] to corners_m[1]")
    );
    assert_eq!(
        enclosed(&[vec2(0.0, 0.0), vec2(3.0, 0.0), vec2(1.0, 0.0), vec2(1.0, 3.0)]),
        meet(1, "corners_m[1] to corners_m[2]", "corners_m[0] to corners_m[1]")
    );
    // Both orders of the corners are valid, and so is a corner that points inwards.
    let mut l = vec![
        vec2(-2.0, -2.0),
        vec2(2.0, -2.0),
        vec2(2.0, 2.0),
        vec2(0.5, 2.0),
        vec2(0.5, 1.7),
        vec2(-2.0, 1.7),
    ];
    assert_eq!(enclosed(&l), [""; 0]);
    l.reverse();
    assert_eq!(enclosed(&l), [""; 0]);
}

#[test]
fn too_many_walls_and_generators_are_rejected() {
    let wall =
        |corners| Wall { corners_m: vec![vec2(0.0, 0.0); corners], thickness_m: 0.1, ..Wall::default() };
    let generator = |count| Generator {
        count,
        shape: RandomShape::Circle { radius_m: (0.1, 0.1) },
        gap_m: 0.4,
        within: None,
    };
    let found = found(&Scenario {
        walls: vec![wall(12); 1_001],
        generators: vec![generator(12); 17],
        ..Scenario::default()
    });
    assert_eq!(
        found,
        [
            "`walls` has 1001 entries: write 0 to 1000",
            "`walls` have 11011 segments in total: write at most 10000",
            "`generators` has 17 entries: write 0 to 16",
            "`generators` ask for 204 obstacles in total: write counts that add up to at most 200",
        ]
    );
}

#[test]
fn named_positions_must_be_far_enough_apart() {
    let fixed = |x, heading_rad| PlacementRule::Fixed { position_m: vec2(x, 0.0), heading_rad };
    let one_of =
        |places: &[f32]| PlacementRule::OneOf { positions_m: places.iter().map(|&x| vec2(x, 0.0)).collect() };
    let with = |starts, goals| found(&Scenario { starts, goals, ..Scenario::default() });
    assert_eq!(with(fixed(0.0, Some(1.5)), fixed(0.5, None)), [""; 0]);
    assert_eq!(
        with(fixed(0.0, Some(7.0)), fixed(0.6, Some(1.5))),
        [
            "`starts.heading_rad` is 7: write a number from -6.3 to 6.3 (radians: a full turn is 6.2832)",
            "`goals.heading_rad` has no effect: a goal has no heading; remove it",
        ]
    );
    assert_eq!(
        with(fixed(0.0, None), fixed(0.25, None)),
        ["`goals.position_m` is 0.250 m from the start: move it at least 0.5 m away, or write a smaller \
             task.min_goal_distance_m"]
    );
    assert_eq!(
        with(one_of(&[0.0, 1.0]), one_of(&[0.75, 1.25, 0.8])),
        ["`starts.positions_m[1]` has no goal at least 0.5 m away: move it, or write a smaller \
             task.min_goal_distance_m"]
    );
    assert_eq!(
        with(one_of(&[]), one_of(&[501.0])),
        [
            "`starts.positions_m` has 0 entries: write 1 to 256",
            "`goals.positions_m[0][0]` is 501: write a number from -500 to 500 (metres)",
        ]
    );
    let within = |min_m, max_m| PlacementRule::Within { min_m, max_m, clearance_m: 0.3 };
    assert_eq!(
        with(within(vec2(-1.0, -1.0), vec2(-0.5, 1.0)), within(vec2(0.5, -1.0), vec2(1.0, 1.0))),
        [""; 0]
    );
    // In a square with sides of 1 m, 1 - pi/4 = 21 % of the area is at least 0.5 m from the middle; with 1.04 m, 27 %.
    assert_eq!(with(within(vec2(-0.52, -0.52), vec2(0.52, 0.52)), fixed(0.0, None)), [""; 0]);
    assert_eq!(
        with(within(vec2(-0.5, -0.5), vec2(0.5, 0.5)), fixed(0.0, None)),
        [
            "`goals` are too close to the starts: fewer than one start in 4 has a goal at least 0.5 m away; move \
             them, or write a smaller task.min_goal_distance_m"
        ]
    );
    // In a square, starts near a corner have goals near the opposite one, though nothing is that far from the middle.
    let square = |min_goal_distance_m| {
        let enclosure = Enclosure::Rectangle { width_m: 1.5, height_m: 1.5 };
        let task = TaskRules { min_goal_distance_m, ..TaskRules::default() };
        found(&Scenario { enclosure, task, benchmark_route: None, ..Scenario::default() })
    };
    assert_eq!(square(0.6), [""; 0]);
    assert_eq!(square(1.0).len(), 1, "only starts near a corner have such goals");
    assert_eq!(
        with(within(vec2(1.8, -1.0), vec2(2.0, 1.0)), within(vec2(1.0, 0.5), vec2(0.5, 1.0))),
        [
            "`goals.max_m[0]` is 0.5 and `min_m[0]` is 1: write the lower left corner as min_m and the upper right one \
             as max_m",
            "`starts` has no free space at step 0: no point of its rectangle has a clearance of 0.3 m; move or enlarge it, use \
             fewer or smaller obstacles, or a smaller clearance_m",
        ]
    );
    assert_eq!(
        with(within(vec2(1.8, -1.0), vec2(2.0, 1.0)), PlacementRule::default()),
        [
            "`starts` has no free space at step 0: no point of its rectangle has a clearance of 0.3 m; move or enlarge it, use \
             fewer or smaller obstacles, or a smaller clearance_m"
        ]
    );
}

#[test]
fn generators_that_may_fill_the_enclosure_are_reported() {
    let generator = |count, within| Generator {
        count,
        shape: RandomShape::Circle { radius_m: (0.1, 0.12) },
        gap_m: 0.3,
        within,
    };
    let messages = |what: &str| {
        [format!(
            "`generators` may leave no free space {what}: generate fewer or smaller obstacles, restrict them with \
             `within`, or write a smaller clearance_m"
        )]
    };
    let nowhere = Generator { gap_m: 3.0, ..generator(8, None) };
    assert_eq!(
        found(&Scenario { generators: vec![nowhere], ..Scenario::default() }),
        [
            "`generators` have no space for any obstacle: write a smaller gap_m, smaller sizes, or a larger `within`"
        ]
    );
    let crowded = Scenario { generators: vec![generator(100, None)], ..Scenario::default() };
    assert_eq!(found(&Scenario { generators: vec![generator(8, None)], ..crowded.clone() }), [""; 0]);
    let far = PlacementRule::Random { clearance_m: 0.6 };
    assert_eq!(found(&Scenario { goals: far.clone(), ..crowded.clone() }), messages("for a goal"));
    assert_eq!(found(&Scenario { starts: far, ..crowded }), messages("for a start"));
    // The obstacles fill the enclosure except for its left end.
    let right = Region { min_m: vec2(-1.0, -0.75), max_m: vec2(3.0, 0.75) };
    let mut hall = Scenario {
        enclosure: Enclosure::Rectangle { width_m: 6.0, height_m: 1.5 },
        generators: vec![generator(60, Some(right))],
        goals: PlacementRule::Random { clearance_m: 0.5 },
        ..Scenario::default()
    };
    let route = hall.benchmark_route.get_or_insert_default();
    (route.start_m, route.goal_m) = (vec2(-2.5, 0.0), vec2(-2.0, 0.0));
    hall.task.min_goal_distance_m = 1.3;
    assert_eq!(found(&hall), messages("for a goal that is task.min_goal_distance_m away"));
}

#[test]
fn unreachable_goals_are_reported_with_two_points() {
    let wall = |corners: &[Vec2]| Wall { corners_m: corners.into(), thickness_m: 0.1, ..Wall::default() };
    // A closed area in the upper right corner, 1 m x 1 m inside.
    let closet = wall(&[vec2(0.95, 2.0), vec2(0.95, 0.95), vec2(2.0, 0.95)]);
    let needs = "the robot needs a gap of more than 0.26 m, twice the collision range; widen a gap";
    let mut scenario = Scenario { walls: vec![closet], ..Scenario::default() };
    scenario.benchmark_route.get_or_insert_default().goal_m = vec2(1.0, -1.0);
    let messages = found(&scenario);
    assert_eq!(messages.len(), 1, "{messages:?}");
    assert!(messages[0].starts_with("`goals` includes (1.5"), "{messages:?}");
    assert!(messages[0].contains(", which the robot can't reach from ("), "{messages:?}");
    assert!(
        messages[0].ends_with(&format!(": {needs}, block that area, or exclude it from the rule")),
        "{messages:?}"
    );
    // The goals are outside the closed area now, so the starts must be reported.
    let elsewhere =
        PlacementRule::Within { min_m: vec2(-2.0, -2.0), max_m: vec2(2.0, 0.9), clearance_m: 0.35 };
    scenario.goals = elsewhere.clone();
    let messages = found(&scenario);
    assert_eq!(messages.len(), 1, "{messages:?}");
    assert!(messages[0].starts_with("`starts` includes (1.5"), "{messages:?}");
    assert!(messages[0].contains(", from which the robot can't reach ("), "{messages:?}");
    scenario.starts = elsewhere;
    assert_eq!(found(&scenario), [""; 0]);
    // A fixed start in the closed area is reported, wherever the goals are.
    scenario.starts = PlacementRule::Fixed { position_m: vec2(1.25, 1.25), heading_rad: None };
    scenario.goals = PlacementRule::default();
    assert!(
        found(&scenario)[0].starts_with("`starts` includes (1.25, 1.25), from which"),
        "{:?}",
        found(&scenario)
    );
    scenario.goals = PlacementRule::OneOf { positions_m: vec![vec2(1.3, 1.8), vec2(1.75, 1.7)] };
    assert_eq!(found(&scenario), [""; 0], "the start and the goals are in the closed area");
    scenario.benchmark_route.get_or_insert_default().goal_m = vec2(1.5, 1.5);
    assert_eq!(
        found(&scenario),
        [format!(
            "`benchmark_route.goal_m` can't be reached from benchmark_route.start_m: {needs}, or move one of them"
        )]
    );
}

#[test]
fn a_gap_must_be_at_least_twice_the_collision_range() {
    // The robot needs 2 x 0.13 m. Moving obstacles do not block a path permanently.
    let wall = |from, to| Wall { corners_m: vec![from, to], thickness_m: 0.02, ..Wall::default() };
    for (gap_m, turned, passes) in
        [(0.25, false, false), (0.25, true, false), (0.262, false, true), (0.262, true, true)]
    {
        let half = gap_m / 2.0 + 0.01;
        let ends = [(vec2(0.003, -2.0), vec2(0.003, -half)), (vec2(0.003, half), vec2(0.003, 2.0))];
        let walls = ends.map(|(from, to)| if turned { wall(from.yx(), to.yx()) } else { wall(from, to) });
        let in_the_door = Obstacle {
            shape: Shape::Circle { radius_m: 0.2 },
            position_m: vec2(0.0, 0.0),
            rotation_rad: 0.0,
            motion: ObstacleMotion::BackAndForth { waypoints_m: vec![vec2(0.1, 0.0)], speed_m_s: 0.1.into() },
        };
        let mut scenario =
            Scenario { walls: walls.into(), obstacles: vec![in_the_door], ..Scenario::default() };
        scenario.benchmark_route.get_or_insert_default().start_m = vec2(-1.2, -1.2);
        assert_eq!(
            found(&scenario).is_empty(),
            passes,
            "{gap_m} m, turned: {turned}: {:?}",
            found(&scenario)
        );
        scenario.obstacles[0].motion = ObstacleMotion::Static;
        assert_eq!(found(&scenario).len(), 2, "a static obstacle closes the gap: {:?}", found(&scenario));
    }
}

/// The notes of a valid scenario as lines, without a file name.
fn noted(scenario: &Scenario) -> Vec<String> {
    assert_eq!(found(scenario), [""; 0], "{}", scenario.name);
    notes(scenario).iter().map(ToString::to_string).collect()
}

fn robot(motions: &[(f32, f32)]) -> Robot {
    let motions = motions.iter().map(|&(v_m_s, w_rad_s)| Motion { v_m_s, w_rad_s }).collect();
    Robot { motions, ..Robot::default() }
}

fn square(side_m: f32) -> Enclosure {
    Enclosure::Rectangle { width_m: side_m, height_m: side_m }
}

fn obstacle(shape: Shape, position_m: Vec2, motion: ObstacleMotion) -> Obstacle {
    Obstacle { shape, position_m, rotation_rad: 0.0, motion }
}

#[test]
fn a_robot_that_never_moves_and_a_time_limit_too_short_for_any_goal_are_rejected() {
    let top = Scenario { robot: robot(&[(0.0, 1.0), (0.0, -1.0)]), ..Scenario::default() };
    assert_eq!(
        found(&top),
        ["`robot.motions` never move the robot: write a v_m_s other than 0 for at least one of them"]
    );
    // A goal 0.5 m away counts as reached within 0.2 m: the 0.3 m left take 10 steps of 0.03 m.
    let limited = |max_episode_steps| {
        let task = TaskRules { max_episode_steps, ..TaskRules::default() };
        found(&Scenario { task, ..Scenario::default() })
    };
    assert_eq!(
        limited(3),
        [
            "`task.max_episode_steps` is 3: in this time the robot covers at most 0.090 m, but goals are at least 0.5 m \
             away: write at least 10, or make the robot faster"
        ]
    );
    assert_eq!(limited(9).len(), 1);
    assert_eq!(limited(10), [""; 0]);
    let crawling = Scenario { robot: robot(&[(1e-7, 1.0)]), ..Scenario::default() };
    assert!(
        found(&crawling)[0].ends_with("at least 0.5 m away: make the robot faster"),
        "{:?}",
        found(&crawling)
    );
}

#[test]
fn goals_beyond_the_time_limit_are_noted_with_their_percentage() {
    let hangar = Scenario { enclosure: square(30.0), ..Scenario::default() };
    let notes = noted(&hangar);
    let [note] = notes.as_slice() else { panic!("{notes:?}") };
    let start =
        "warning: `task.max_episode_steps` is 500: in this time the robot covers at most 15.0 m, but ";
    assert!(note.starts_with(start), "{note}");
    // In a square of 29.3 m, the free space, 49 % of all pairs of points are more than 15.2 m apart.
    let percent: f32 =
        note[start.len()..].split(' ').next().and_then(|n| n.parse().ok()).expect("a percentage");
    assert!((46.0..=56.0).contains(&percent), "{note}");
    // The diagonal of the free space is 41.4 m. Less 0.2 m, that is 1,375 steps of 0.03 m.
    let steps: u32 =
        note.split("write at least ").nth(1).and_then(|n| n.split(',').next()?.parse().ok()).expect("steps");
    assert!((1320..=1375).contains(&steps), "{note}");
    let longer = TaskRules { max_episode_steps: steps, ..TaskRules::default() };
    assert_eq!(noted(&Scenario { task: longer, ..hangar.clone() }), [""; 0]);
    // Named goals within reach are fine in any hall.
    let goals = PlacementRule::OneOf { positions_m: vec![vec2(3.0, 0.0), vec2(-3.0, 1.0)] };
    let starts = PlacementRule::Fixed { position_m: vec2(0.0, 0.0), heading_rad: None };
    assert_eq!(noted(&Scenario { starts, goals, ..hangar }), [""; 0]);
}

#[test]
fn a_robot_without_space_to_turn_round_is_noted() {
    let with = |motions: &[(f32, f32)], side_m| {
        noted(&Scenario { robot: robot(motions), enclosure: square(side_m), ..Scenario::default() })
    };
    // The robot turns with a radius of 2.5 m; the square of 4 m has a free disc of 2 m radius.
    let lorry = [(0.5, 0.2), (0.5, -0.2)];
    let notes = with(&lorry, 4.0);
    let [note] = notes.as_slice() else { panic!("{notes:?}") };
    let start = "warning: `robot.motions` turn the robot with a radius of at least 2.50 m, which needs a free disc of 2.63 m \
                 radius, but the largest here has at most 2.0";
    assert!(note.starts_with(start), "{note}");
    assert_eq!(with(&lorry, 5.5), [""; 0]);
    assert_eq!(with(&[(0.5, 0.2), (-0.5, 0.2)], 4.0), [""; 0], "it can turn by driving back and forth");
    assert_eq!(with(&[(0.5, 0.0), (0.0, 0.2)], 4.0), [""; 0], "it turns on the spot");
    assert_eq!(
        with(&[(0.5, 0.0), (-0.5, 0.0)], 4.0),
        [
            "warning: `robot.motions` never turn the robot, so it misses every goal that is not on its straight line: \
          write a w_rad_s other than 0"
        ]
    );
}

#[test]
fn obstacles_faster_than_the_robot_are_noted() {
    let ball = Shape::Circle { radius_m: 0.1 };
    let patrol =
        |speed: f32| ObstacleMotion::Patrol { waypoints_m: vec![vec2(1.0, 0.5)], speed_m_s: speed.into() };
    let orbit = |speed: f32| ObstacleMotion::Orbit { centre_m: vec2(0.0, 0.0), speed_rad_s: speed.into() };
    let with = |motion| {
        let obstacles = vec![obstacle(ball.clone(), vec2(-1.0, 0.5), motion)];
        let mut scenario = Scenario { obstacles, ..Scenario::default() };
        let route = scenario.benchmark_route.get_or_insert_default();
        (route.start_m, route.goal_m) = (vec2(0.0, -1.5), vec2(1.5, -1.5));
        noted(&scenario)
    };
    assert_eq!(with(patrol(0.15)), [""; 0]);
    assert_eq!(
        with(patrol(0.3)),
        [
            "note: `obstacles[0].motion.speed_m_s` moves the obstacle at up to 0.300 m/s, faster than the robot at 0.150 \
          m/s, which can't evade it: slow it down, unless that is intended"
        ]
    );
    assert_eq!(with(orbit(0.13)), [""; 0], "1.118 m from the centre, that is 0.145 m/s");
    let notes = with(orbit(-0.2));
    assert!(
        notes.len() == 1 && notes[0].contains("motion.speed_rad_s` moves the obstacle at up to 0.224 m/s"),
        "{notes:?}"
    );
}

#[test]
fn the_suggested_orbit_speed_is_within_all_limits() {
    let task = TaskRules { control_period_s: 0.05, ..TaskRules::default() };
    let motion = ObstacleMotion::Orbit { centre_m: vec2(0.0, 0.0), speed_rad_s: 15.0.into() };
    let obstacles = vec![obstacle(Shape::Circle { radius_m: 0.1 }, vec2(0.0, 1.0), motion)];
    // 10 rad/s would be within the limit of 0.5 m per step, but not within that of 5 m/s.
    assert_eq!(
        found(&Scenario { task, obstacles, ..Scenario::default() }),
        [
            "`obstacles[0].motion.speed_rad_s` moves the obstacle 0.750 m in one control step, above the limit of 0.5 m: \
             write at most 5.000, or a smaller task.control_period_s"
        ]
    );
}

#[test]
fn key_frames_have_increasing_times_and_no_jumps() {
    let with = |frames: &[(f32, f32, f32)], end| {
        let frame = |&(time_s, x, y): &(f32, f32, f32)| KeyFrame { time_s, position_m: vec2(x, y) };
        let motion = ObstacleMotion::KeyFrames { frames: frames.iter().map(frame).collect(), end };
        let obstacles = vec![obstacle(Shape::Circle { radius_m: 0.1 }, vec2(-1.5, 0.5), motion)];
        let mut scenario = Scenario { obstacles, ..Scenario::default() };
        let route = scenario.benchmark_route.get_or_insert_default();
        (route.start_m, route.goal_m) = (vec2(0.0, -1.5), vec2(1.5, -1.5));
        scenario
    };
    let loop_of = |period_s| KeyFrameEnd::Loop { period_s };
    let there = [(10.0, -0.5, 0.5), (20.0, -0.5, 0.5)];
    assert_eq!(found(&with(&there, loop_of(30.0))), [""; 0]);
    assert_eq!(noted(&with(&there, loop_of(30.0))), [""; 0]);
    for (frames, end, problem) in [
        (&[][..], KeyFrameEnd::Stop, "frames` has 0 entries: write 1 to 10000"),
        (
            &[(3.0, 0.0, 0.5), (3.0, 0.1, 0.5)],
            KeyFrameEnd::Stop,
            "frames[1].time_s` is 3: write more than the time of the previous frame, 3 s",
        ),
        (
            &[(0.0, 0.0, 0.5)],
            KeyFrameEnd::Stop,
            "frames[0].time_s` is 0: write a number from 0.001 to 100000 (seconds)",
        ),
        (
            &[(900.0, 501.0, 0.5)],
            KeyFrameEnd::Stop,
            "frames[0].position_m[0]` is 501: write a number from -500 to 500 (metres)",
        ),
        (&there, loop_of(20.0), "end.period_s` is 20: write more than the time of the previous frame, 20 s"),
        (
            &there,
            loop_of(20.25),
            "end.period_s` moves the obstacle 0.800 m in one control step, above the limit of 0.5 m: make the leg of \
             1.000 m last at least 0.400 s",
        ),
        (
            &[(20.0, -0.5, 0.5), (20.1, 0.5, 0.5)],
            KeyFrameEnd::Stop,
            "frames[1].time_s` moves the obstacle at 10.000 m/s, above the limit of 5 m/s: make the leg of 1.000 m last \
             at least 0.400 s",
        ),
        (
            &[(20.0, -0.5, 0.5), (20.1, 0.501, 0.5)],
            KeyFrameEnd::Stop,
            "make the leg of 1.001 m last at least 0.401 s",
        ),
        (&[(30.0, 5.0, 0.5)], KeyFrameEnd::Stop, "extends 3.100 m outside the enclosure while it moves"),
    ] {
        let problems = found(&with(frames, end));
        assert!(problems.len() == 1 && problems[0].contains(problem), "{frames:?}: {problems:?}");
    }
    let mut crowded = with(&vec![(1.0, 0.0, 0.0); 6_000], KeyFrameEnd::Stop);
    crowded.obstacles.push(crowded.obstacles[0].clone());
    let problems = found(&crowded);
    let total = "`obstacles` have 12000 key frames in total: write at most 10000";
    assert!(problems.iter().any(|problem| problem == total), "{problems:?}");
    assert_eq!(
        noted(&with(&[(4.0, -0.5, 0.5)], KeyFrameEnd::Stop)),
        [
            "note: `obstacles[0].motion` moves the obstacle at up to 0.250 m/s, faster than the robot at 0.150 m/s, which \
             can't evade it: slow it down, unless that is intended",
            "note: `obstacles[0].motion` stops after 4 s, but the obstacles' clock runs on between episodes, and evaluations \
             begin at random times: write end: Loop(period_s: ...), unless that is intended"
        ]
    );
}

#[test]
fn obstacles_that_overlap_or_cross_something_are_noted_with_the_place() {
    let wall = Wall {
        corners_m: vec![vec2(-0.5, 0.0), vec2(0.5, 0.0), vec2(0.5, 0.5)],
        thickness_m: 0.1,
        ..Wall::default()
    };
    let (ball, crate_) = (Shape::Circle { radius_m: 0.2 }, Shape::Rectangle { width_m: 0.4, height_m: 0.4 });
    let with = |obstacles: Vec<Obstacle>| {
        let mut scenario = Scenario { walls: vec![wall.clone()], obstacles, ..Scenario::default() };
        let route = scenario.benchmark_route.get_or_insert_default();
        (route.start_m, route.goal_m) = (vec2(-1.5, -1.7), vec2(1.5, -1.7));
        noted(&scenario)
    };
    let still = |shape: &Shape, x, y| obstacle(shape.clone(), vec2(x, y), ObstacleMotion::Static);
    let overlaps = |k: usize, what: &str, at: &str| {
        format!(
            "note: `obstacles[{k}]` overlaps {what} at {at}: move one of them, unless they form one shape"
        )
    };
    let crosses = |verb: &str, what: &str, at: &str| {
        [format!(
            "note: `obstacles[0].motion` {verb} {what} at {at}: moving obstacles pass through everything; change the \
             path, unless that is intended"
        )]
    };
    assert_eq!(
        with(vec![still(&ball, -0.7, 0.3), still(&crate_, -0.3, 0.25)]),
        [""; 0],
        "side by side, and flush"
    );
    assert_eq!(
        with(vec![still(&ball, -0.3, 0.2), still(&ball, 1.0, 1.0), still(&crate_, 1.2, 1.0)]),
        [
            overlaps(0, "wall 1 (`walls[0]`)", "(-0.30, 0.05)"),
            overlaps(2, "obstacle 2 (`obstacles[1]`)", "(1.10, 1.00)")
        ]
    );
    let moving = |motion| vec![obstacle(crate_.clone(), vec2(0.0, -1.0), motion)];
    let (speed_m_s, wall_1) = (0.1.into(), "wall 1 (`walls[0]`)");
    let there = |waypoints_m| moving(ObstacleMotion::BackAndForth { waypoints_m, speed_m_s });
    assert_eq!(with(there(vec![vec2(0.0, -0.3)])), [""; 0], "it stops before the wall");
    assert_eq!(with(there(vec![vec2(0.0, 1.0)])), crosses("crosses", wall_1, "(0.00, 0.00)"));
    // A path around the wall; a patrol returns straight through it.
    let around = vec![vec2(-1.2, -1.0), vec2(-1.2, 1.0), vec2(0.0, 1.0)];
    assert_eq!(with(there(around.clone())), [""; 0]);
    let patrol = ObstacleMotion::Patrol { waypoints_m: around, speed_m_s };
    assert_eq!(with(moving(patrol)), crosses("crosses", wall_1, "(0.00, 0.00)"));
    let walk = |radius_m| moving(ObstacleMotion::RandomWalk { radius_m, speed_m_s, seed: 1 });
    assert_eq!(with(walk(0.6)), [""; 0]);
    assert_eq!(with(walk(0.8)).len(), 1);
    assert!(with(walk(0.8))[0].contains("may cross wall 1"), "{:?}", with(walk(0.8)));
    let orbit = |centre_m| moving(ObstacleMotion::Orbit { centre_m, speed_rad_s: 0.1.into() });
    assert_eq!(with(orbit(vec2(0.0, 0.1))), [""; 0], "the wall is within the orbit");
    assert!(with(orbit(vec2(0.5, -0.6)))[0].contains("crosses wall 1"), "{:?}", with(orbit(vec2(0.5, -0.6))));
    // Two moving obstacles may cross each other.
    let mut two = there(vec![vec2(0.0, -0.4)]);
    two.push(obstacle(
        ball.clone(),
        vec2(-1.0, -1.0),
        ObstacleMotion::BackAndForth { waypoints_m: vec![vec2(1.0, -1.0)], speed_m_s },
    ));
    assert_eq!(with(two), [""; 0]);
}

#[test]
fn notes_on_large_scenarios_are_found_quickly() {
    // The maximum number of static obstacles, each overlapping its neighbours; and 2,000 moving ones with the longest paths,
    // through walls.
    let ball = |k: usize, motion: ObstacleMotion| {
        obstacle(
            Shape::Circle { radius_m: 1.0 },
            vec2(k as f32 % 100.0 - 50.0, k as f32 / 200.0 - 25.0),
            motion,
        )
    };
    let waypoints_m: Vec<Vec2> =
        (0..256).map(|k| vec2(k as f32 % 90.0 - 45.0, k as f32 % 50.0 - 25.0)).collect();
    let patrol = ObstacleMotion::Patrol { waypoints_m, speed_m_s: 0.1.into() };
    let walls = (0..1_000).map(|k| Wall {
        corners_m: vec![vec2(k as f32 / 10.0 - 50.0, -20.0); 11],
        thickness_m: 0.01,
        ..Wall::default()
    });
    let large = Scenario { enclosure: square(200.0), robot: robot(&[(0.5, 1e-3)]), ..Scenario::default() };
    let still = Scenario {
        obstacles: (0..10_000).map(|k| ball(k, ObstacleMotion::Static)).collect(),
        ..large.clone()
    };
    let moving = Scenario {
        obstacles: (0..2_000).map(|k| ball(k, patrol.clone())).collect(),
        walls: walls.collect(),
        ..large
    };
    for scenario in [still, moving] {
        let start = Instant::now();
        let count = notes(&scenario).len();
        assert!((1..=103).contains(&count), "{count} notes");
        assert!(start.elapsed() < Duration::from_secs(5), "{:?}", start.elapsed());
    }
}

#[test]
fn both_ends_of_a_benchmark_route_need_free_space() {
    let pillar = obstacle(Shape::Circle { radius_m: 0.3 }, vec2(0.0, 0.0), ObstacleMotion::Static);
    let mut office = Scenario { obstacles: vec![pillar], ..Scenario::default() };
    assert_eq!(found(&office), [""; 0], "without a route");
    office.benchmark_route = Some(BenchmarkRoute { goal_m: vec2(1.0, 1.0), ..BenchmarkRoute::default() });
    let blocked = "`benchmark_route.start_m` is 0.300 m inside `obstacles[0]`: keep it at least 0.13 m away from \
                   everything";
    assert_eq!(found(&office), [blocked]);
    office.benchmark_route.get_or_insert_default().start_m = vec2(-1.0, 1.0);
    assert_eq!(found(&office), [""; 0]);
    office.benchmark_route.get_or_insert_default().goal_m = vec2(0.0, 0.0);
    assert_eq!(found(&office), [blocked.replace("start_m", "goal_m")]);
}

/// Asserts that the check of `text` takes at most 20 s, and that its messages contain `needle`.
fn assert_reported_quickly(what: &str, text: &str, needle: &str) {
    assert!(text.len() <= 1 << 20, "{what}: {} bytes are over the limit", text.len());
    let start = Instant::now();
    let messages = Scenario::parse(text, "w.ron").expect_err(what).to_string();
    assert!(
        messages.contains(needle),
        "{what}: `{needle}` is not in: {}",
        &messages[..messages.len().min(1000)]
    );
    assert!(start.elapsed() < Duration::from_secs(20), "{what} took {:?}", start.elapsed());
}

#[test]
fn hostile_files_are_reported_quickly() {
    // As many obstacles as fit in a file. All but the last one move, and only the last one blocks all goals.
    let mut text = String::from("(name: \"a\", obstacles: [");
    for _ in 0..9_999 {
        text.push_str("(shape: Rectangle(width_m: 1, height_m: 1), position_m: (0, 0), rotation_rad: 1,");
        text.push_str("motion:Orbit(centre_m:(0,0),speed_rad_s:1)),");
    }
    text.truncate(text.len().min(1_000_000));
    let text = &text[..=text.rfind("),(").expect("some fit")];
    let text = format!("{text}, (shape: Rectangle(width_m: 3.99, height_m: 3.99), position_m: (0, 0))])");
    assert_reported_quickly("a crowd that moves", &text, "`goals` has no free space");
    for text in ["(".repeat(1 << 20), "/*".repeat(1 << 19), "(name:\"".repeat(1 << 17)] {
        let start = Instant::now();
        assert!(Scenario::parse(&text, "w.ron").is_err());
        assert!(start.elapsed() < Duration::from_secs(20), "{} took {:?}", &text[..20], start.elapsed());
    }
}

#[test]
fn hostile_outlines_are_reported_quickly() {
    // Thin polygons of 32 corners across an enclosure of 60 m, and a wall that divides it.
    let mut sliver = String::from("(shape:Polygon(corners_m:[");
    for k in 0..31 {
        sliver.push_str(&format!("({},{:.3}),", 20 - k, 20.001 - f64::from(k)));
    }
    sliver.push_str("(20,20)]),position_m:(0,0)),");
    let slivers = sliver.repeat(1_000_000 / sliver.len());
    let text = format!(
        "(name:\"a\",enclosure:Rectangle(width_m:60,height_m:60),walls:[(corners_m:[(-30,25),(30,25)])],\
         obstacles:[{slivers}],benchmark_route:(start_m:(-20,0),goal_m:(0,-20)))"
    );
    assert_reported_quickly("slivers", &text, "`goals` includes");
    // Almost the maximum number of wall segments, up and down across the enclosure, without a gap; and patrols along similar
    // paths in an enclosure of 64 corners.
    let zigzag: String =
        (0..250).map(|k| format!("({}.{},{}),", k % 20, k, if k % 2 == 0 { -25 } else { 25 })).collect();
    let walls = format!("(corners_m:[{zigzag}]),").repeat(40);
    let text = format!(
        "(name:\"a\",enclosure:Rectangle(width_m:60,height_m:60),walls:[{walls}],benchmark_route:(start_m:(-20,0),goal_m:(-20,\
         -20)))"
    );
    assert_reported_quickly("walls", &text, "`goals` includes");
    let mut comb = String::from("(-30,-30),(30,-30),");
    for k in 0..31 {
        comb.push_str(&format!("({},30),({}.5,-20),", 30 - k, 29 - k));
    }
    let patrol = format!(
        "(shape:Circle(radius_m:0.4),position_m:(-10,-25),motion:Patrol(speed_m_s:1,waypoints_m:[{zigzag}])),"
    );
    let patrols = patrol.repeat(1_000_000 / patrol.len());
    let text = format!(
        "(name:\"a\",enclosure:Polygon(corners_m:[{comb}]),obstacles:[{patrols}],benchmark_route:(start_m:(-20,-28),goal_m:(0,\
         -28)))"
    );
    assert_reported_quickly("a comb", &text, "while it moves");
}
