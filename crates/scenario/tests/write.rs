//! Scenarios as text: the canonical form, and small diffs to the text that a scenario was read from.

use std::path::{Path, PathBuf};

use glam::{Vec2, vec2};
use proptest::collection::vec;
use proptest::option;
use proptest::prelude::*;
use wayfield_scenario::{
    BenchmarkRoute, Enclosure, Generator, KeyFrame, KeyFrameEnd, Lidar, Motion, Obstacle, ObstacleMotion,
    OdometryDrift, PlacementRule, RandomShape, Ranged, Region, Robot, Scenario, Shape, Slip, TaskRules, Wall,
    WallCells, parse_ron, to_text,
};

fn read(text: &str) -> Scenario {
    parse_ron(text, "x.ron").unwrap_or_else(|error| panic!("{error}\n{text}"))
}

fn shipped() -> Vec<(PathBuf, String)> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..").join("scenarios");
    let entries = std::fs::read_dir(folder).expect("the folder exists");
    let files = entries.map(|entry| entry.expect("an entry").path());
    files
        .filter(|file| file.is_file())
        .map(|file| (file.clone(), std::fs::read_to_string(file).expect("text")))
        .collect()
}

fn file(name: &str) -> String {
    let (_, text) =
        shipped().into_iter().find(|(path, _)| path.ends_with(name)).expect("a shipped file of this name");
    text
}

/// `text` after `change`.
fn edited(text: &str, change: impl FnOnce(&mut Scenario)) -> String {
    let mut scenario = read(text);
    change(&mut scenario);
    let written = to_text(&scenario, Some(text));
    assert_eq!(read(&written), scenario, "{written}");
    written
}

/// The lines that differ: those of `before` with a `-`, those of `after` with a `+`.
fn diff(before: &str, after: &str) -> String {
    let (a, b): (Vec<_>, Vec<_>) = (before.split('\n').collect(), after.split('\n').collect());
    let shorter = a.len().min(b.len());
    let front = (0..shorter).take_while(|&k| a[k] == b[k]).count();
    let back = (0..shorter - front).take_while(|&k| a[a.len() - 1 - k] == b[b.len() - 1 - k]).count();
    let lines = |sign: &str, lines: &[&str]| lines.iter().map(|l| format!("{sign}{l}\n")).collect::<String>();
    lines("-", &a[front..a.len() - back]) + &lines("+", &b[front..b.len() - back])
}

fn circle(x: f32, y: f32) -> Obstacle {
    Obstacle {
        shape: Shape::Circle { radius_m: 0.15 },
        position_m: vec2(x, y),
        rotation_rad: 0.0,
        motion: ObstacleMotion::Static,
    }
}

fn key_frames(end: KeyFrameEnd) -> ObstacleMotion {
    let frame = |time_s, x, y| KeyFrame { time_s, position_m: vec2(x, y) };
    ObstacleMotion::KeyFrames { frames: vec![frame(0.5, 1.0, 0.0), frame(1.0, 1.25, -0.5)], end }
}

fn cells(rows: &[&str], centre_m: Vec2) -> Wall {
    let rows = rows.iter().map(ToString::to_string).collect();
    Wall { cells: Some(WallCells::new(rows, 0.25, centre_m)), ..Wall::default() }
}

/// A scenario with every top-level field, and every kind of wall, shape and motion.
fn everything() -> Scenario {
    let moving = |shape, motion| Obstacle { shape, position_m: vec2(1.0, -2.5), rotation_rad: 0.1, motion };
    Scenario {
        name: "All of it".into(),
        about: "Said \"so\", with a \\ and a line's end\nin it.".into(),
        enclosure: Enclosure::Polygon { corners_m: vec![vec2(-3.0, -3.0), vec2(3.0, -3.0), vec2(0.0, 1e-7)] },
        walls: vec![
            Wall { corners_m: vec![vec2(0.0, 0.0), vec2(1.0, 0.0)], thickness_m: 0.1, ..Wall::default() },
            Wall {
                corners_m: (0..8).map(|k| vec2(k as f32, 0.25)).collect(),
                thickness_m: 0.3,
                ..Wall::default()
            },
            cells(&["#..", "..#"], vec2(0.5, -0.25)),
        ],
        obstacles: vec![
            circle(0.6, 0.6),
            moving(Shape::Rectangle { width_m: 1.0, height_m: 0.5 }, ObstacleMotion::Static),
            moving(
                Shape::Polygon { corners_m: vec![vec2(0.0, 0.0), vec2(1.0, 0.0), vec2(0.0, 1.0)] },
                ObstacleMotion::Orbit { centre_m: vec2(0.0, 0.5), speed_rad_s: (-0.15).into() },
            ),
            moving(
                Shape::Capsule { length_m: 0.3, radius_m: 0.1 },
                ObstacleMotion::Patrol {
                    waypoints_m: vec![vec2(1.0, 1.0), vec2(2.0, 1.0)],
                    speed_m_s: 0.1.into(),
                },
            ),
            Obstacle {
                motion: ObstacleMotion::BackAndForth {
                    waypoints_m: vec![vec2(1.0, 1.0)],
                    speed_m_s: 0.1.into(),
                },
                ..circle(0.0, 0.0)
            },
            Obstacle {
                motion: ObstacleMotion::Pedestrian {
                    goals_m: vec![vec2(1.0, 1.0)],
                    speed_m_s: 0.1.into(),
                    loops: false,
                    sees_robot: true,
                },
                ..circle(0.0, 0.0)
            },
            Obstacle {
                motion: ObstacleMotion::RandomWalk { radius_m: 0.8, speed_m_s: 0.1.into(), seed: 0 },
                ..circle(0.0, 0.0)
            },
            Obstacle {
                motion: ObstacleMotion::RandomWalk { radius_m: 0.8, speed_m_s: 0.1.into(), seed: 7 },
                ..circle(-0.0, 3e20)
            },
            Obstacle { motion: key_frames(KeyFrameEnd::Stop), ..circle(0.0, 0.0) },
            Obstacle { motion: key_frames(KeyFrameEnd::Loop { period_s: 2.5 }), ..circle(0.0, 0.0) },
        ],
        generators: vec![
            Generator {
                count: 6,
                shape: RandomShape::Circle { radius_m: (0.1, 0.25) },
                gap_m: 0.4,
                within: None,
            },
            Generator {
                count: 4,
                shape: RandomShape::Rectangle { width_m: (0.2, 0.6), height_m: (0.2, 0.4) },
                gap_m: 0.45,
                within: Some(Region { min_m: vec2(-1.6, -1.6), max_m: vec2(1.6, 1.6) }),
            },
        ],
        robot: Robot {
            radius_m: 0.12,
            shape: Some(Shape::Rectangle { width_m: 0.25, height_m: 0.2 }),
            min_turning_radius_m: Some(0.5),
            motions: vec![Motion { v_m_s: 0.2, w_rad_s: 0.0 }, Motion { v_m_s: 0.0, w_rad_s: -1.0 }],
            actuator_lag_s: 0.5.into(),
            ..Robot::default()
        },
        lidar: Lidar {
            beams: 36,
            field_of_view_rad: 4.712,
            max_range_m: 10.0,
            noise_std_m: 0.01.into(),
            dropout: 0.02.into(),
            latency_steps: 2.into(),
        },
        task: TaskRules {
            goal_radius_m: 0.3,
            collision_range_m: 0.15,
            max_episode_steps: 1000,
            control_period_s: 0.1,
            min_goal_distance_m: 0.6,
        },
        starts: PlacementRule::Within { min_m: vec2(-1.0, -1.0), max_m: vec2(1.0, 1.0), clearance_m: 0.35 },
        goals: PlacementRule::Fixed { position_m: vec2(1.0, 1.0), heading_rad: Some(1.5) },
        benchmark_route: Some(BenchmarkRoute {
            start_m: vec2(0.0, 1.0),
            heading_rad: 0.785,
            goal_m: vec2(1.2, -1.2),
        }),
    }
}

const EVERYTHING: &str = r##"(
    name: "All of it",
    about: "Said \"so\", with a \\ and a line's end\nin it.",

    enclosure: Polygon(corners_m: [(-3.0, -3.0), (3.0, -3.0), (0.0, 1e-7)]),

    walls: [
        (corners_m: [(0.0, 0.0), (1.0, 0.0)]),
        (
            corners_m: [
                (0.0, 0.25),
                (1.0, 0.25),
                (2.0, 0.25),
                (3.0, 0.25),
                (4.0, 0.25),
                (5.0, 0.25),
                (6.0, 0.25),
                (7.0, 0.25),
            ],
            thickness_m: 0.3,
        ),
        (
            cells: (
                rows: [
                    "#..",
                    "..#",
                ],
                cell_m: 0.25,
                centre_m: (0.5, -0.25),
            ),
        ),
    ],

    obstacles: [
        (shape: Circle(radius_m: 0.15), position_m: (0.6, 0.6)),
        (shape: Rectangle(width_m: 1.0, height_m: 0.5), position_m: (1.0, -2.5), rotation_rad: 0.1),
        (
            shape: Polygon(corners_m: [(0.0, 0.0), (1.0, 0.0), (0.0, 1.0)]),
            position_m: (1.0, -2.5),
            rotation_rad: 0.1,
            motion: Orbit(centre_m: (0.0, 0.5), speed_rad_s: -0.15),
        ),
        (
            shape: Capsule(length_m: 0.3, radius_m: 0.1),
            position_m: (1.0, -2.5),
            rotation_rad: 0.1,
            motion: Patrol(waypoints_m: [(1.0, 1.0), (2.0, 1.0)], speed_m_s: 0.1),
        ),
        (
            shape: Circle(radius_m: 0.15),
            position_m: (0.0, 0.0),
            motion: BackAndForth(waypoints_m: [(1.0, 1.0)], speed_m_s: 0.1),
        ),
        (
            shape: Circle(radius_m: 0.15),
            position_m: (0.0, 0.0),
            motion: Pedestrian(goals_m: [(1.0, 1.0)], speed_m_s: 0.1, loops: false, sees_robot: true),
        ),
        (
            shape: Circle(radius_m: 0.15),
            position_m: (0.0, 0.0),
            motion: RandomWalk(radius_m: 0.8, speed_m_s: 0.1),
        ),
        (
            shape: Circle(radius_m: 0.15),
            position_m: (-0.0, 3e20),
            motion: RandomWalk(radius_m: 0.8, speed_m_s: 0.1, seed: 7),
        ),
        (
            shape: Circle(radius_m: 0.15),
            position_m: (0.0, 0.0),
            motion: KeyFrames(
                frames: [
                    (time_s: 0.5, position_m: (1.0, 0.0)),
                    (time_s: 1.0, position_m: (1.25, -0.5)),
                ],
            ),
        ),
        (
            shape: Circle(radius_m: 0.15),
            position_m: (0.0, 0.0),
            motion: KeyFrames(
                frames: [
                    (time_s: 0.5, position_m: (1.0, 0.0)),
                    (time_s: 1.0, position_m: (1.25, -0.5)),
                ],
                end: Loop(period_s: 2.5),
            ),
        ),
    ],

    generators: [
        (count: 6, shape: Circle(radius_m: (0.1, 0.25))),
        (
            count: 4,
            shape: Rectangle(width_m: (0.2, 0.6), height_m: (0.2, 0.4)),
            gap_m: 0.45,
            within: (min_m: (-1.6, -1.6), max_m: (1.6, 1.6)),
        ),
    ],

    robot: (
        radius_m: 0.12,
        shape: Rectangle(width_m: 0.25, height_m: 0.2),
        min_turning_radius_m: 0.5,
        motions: [
            (v_m_s: 0.2, w_rad_s: 0.0),
            (v_m_s: 0.0, w_rad_s: -1.0),
        ],
        actuator_lag_s: 0.5,
    ),

    lidar: (
        beams: 36,
        field_of_view_rad: 4.712,
        max_range_m: 10.0,
        noise_std_m: 0.01,
        dropout: 0.02,
        latency_steps: 2,
    ),

    task: (
        goal_radius_m: 0.3,
        collision_range_m: 0.15,
        max_episode_steps: 1000,
        control_period_s: 0.1,
        min_goal_distance_m: 0.6,
    ),

    starts: Within(min_m: (-1.0, -1.0), max_m: (1.0, 1.0)),
    goals: Fixed(position_m: (1.0, 1.0), heading_rad: 1.5),

    benchmark_route: (start_m: (0.0, 1.0), heading_rad: 0.785, goal_m: (1.2, -1.2)),
)
"##;

#[test]
fn the_canonical_text_has_all_parts_and_leaves_out_defaults() {
    assert_eq!(to_text(&everything(), None), EVERYTHING);
    assert_eq!(to_text(&Scenario::default(), None), "(\n    name: \"Empty\",\n)\n", "defaults are left out");
    let motion = ObstacleMotion::Pedestrian {
        goals_m: vec![vec2(1.0, 1.0)],
        speed_m_s: 0.5.into(),
        loops: true,
        sees_robot: false,
    };
    let obstacles = vec![Obstacle { motion, ..circle(0.0, 0.0) }];
    let text = to_text(&Scenario { obstacles, ..Scenario::default() }, None);
    assert!(text.contains("Pedestrian(goals_m: [(1.0, 1.0)], speed_m_s: 0.5)"), "{text}");
}

#[test]
fn the_canonical_text_is_stable() {
    let scenario = read(EVERYTHING);
    assert_eq!(scenario, everything());
    assert_eq!(to_text(&scenario, None), EVERYTHING);
    assert_eq!(to_text(&scenario, Some(EVERYTHING)), EVERYTHING);
    assert!(scenario.obstacles[7].position_m.x.is_sign_negative(), "-0.0 keeps its sign");
}

#[test]
fn every_shipped_file_keeps_its_bytes() {
    for (path, text) in shipped() {
        assert_eq!(to_text(&read(&text), Some(&text)), text, "{}", path.display());
        let canonical = to_text(&read(&text), None);
        assert_eq!(read(&canonical), read(&text), "{}", path.display());
    }
}

#[test]
fn an_invalid_old_text_is_ignored() {
    for broken in ["", "(", "(name: 3)", "(name: \"x\") // and no more\n)"] {
        assert_eq!(to_text(&everything(), Some(broken)), EVERYTHING, "{broken:?}");
    }
}

#[test]
fn moving_an_obstacle_changes_one_line() {
    let text = file("scenario-1.ron");
    assert_eq!(
        diff(&text, &edited(&text, |scenario| scenario.obstacles[1].position_m = vec2(-0.75, 0.6))),
        "-        (shape: Circle(radius_m: 0.15), position_m: (-0.6, 0.6)),\n\
         +        (shape: Circle(radius_m: 0.15), position_m: (-0.75, 0.6)),\n"
    );
    let text = file("scenario-2.ron");
    assert_eq!(
        diff(&text, &edited(&text, |scenario| scenario.obstacles[3].position_m = vec2(0.7, -0.6))),
        "-            position_m: (0.6, -0.6),\n+            position_m: (0.7, -0.6),\n"
    );
}

#[test]
fn removing_and_adding_an_obstacle_changes_one_line() {
    let text = file("scenario-1.ron");
    assert_eq!(
        diff(&text, &edited(&text, |scenario| drop(scenario.obstacles.remove(2)))),
        "-        (shape: Circle(radius_m: 0.15), position_m: (-0.6, -0.6)),\n"
    );
    let more = edited(&text, |scenario| scenario.obstacles.push(circle(1.0, 1.5)));
    assert_eq!(diff(&text, &more), "+        (shape: Circle(radius_m: 0.15), position_m: (1.0, 1.5)),\n");
    let between = edited(&text, |scenario| scenario.obstacles.insert(1, circle(1.0, 1.5)));
    assert_eq!(diff(&text, &between), "+        (shape: Circle(radius_m: 0.15), position_m: (1.0, 1.5)),\n");
    assert_eq!(edited(&between, |scenario| drop(scenario.obstacles.remove(1))), text);
    // Without obstacles, the field and its comment stay.
    let none = edited(&text, |scenario| scenario.obstacles.clear());
    assert!(
        none.contains(
            "The first one blocks the straight line of the benchmark route.\n    obstacles: [],\n\n    // Tables"
        ),
        "{none}"
    );
}

#[test]
fn changing_one_number_keeps_everything_else() {
    let text = file("empty.ron");
    let (before, after) = ("max_range_m: 3.5,", "max_range_m: 4.25,");
    assert_eq!(text.matches(before).count(), 1);
    assert_eq!(edited(&text, |scenario| scenario.lidar.max_range_m = 4.25), text.replace(before, after));
    // In an aligned line with a comment after it.
    assert_eq!(
        diff(&text, &edited(&text, |scenario| scenario.task.max_episode_steps = 800)),
        "-        max_episode_steps: 500,     // the episode is truncated after this\n\
         +        max_episode_steps: 800,     // the episode is truncated after this\n"
    );
}

#[test]
fn a_new_field_is_inserted_in_the_order_of_the_schema() {
    let text = file("scenario-1.ron");
    let wall = Wall { corners_m: vec![vec2(0.0, 0.0), vec2(1.0, 0.0)], thickness_m: 0.1, ..Wall::default() };
    let walled = edited(&text, |scenario| scenario.walls.push(wall));
    assert_eq!(
        diff(&text, &walled),
        "+    walls: [\n+        (corners_m: [(0.0, 0.0), (1.0, 0.0)]),\n+    ],\n+\n",
        "{walled}"
    );
    assert!(walled.contains("round.\",\n\n    walls: [\n"), "after `about`: {walled}");
    assert_eq!(edited(&walled, |scenario| scenario.walls.clear()), text, "removing it restores the text");

    let limited = edited(&text, |scenario| scenario.task.max_episode_steps = 800);
    assert_eq!(diff(&text, &limited), "+    task: (max_episode_steps: 800),\n+\n");
    let rotated = edited(&text, |scenario| scenario.obstacles[0].rotation_rad = 0.5);
    assert_eq!(
        diff(&text, &rotated),
        "-        (shape: Circle(radius_m: 0.15), position_m: (0.6, 0.6)),\n\
         +        (shape: Circle(radius_m: 0.15), position_m: (0.6, 0.6), rotation_rad: 0.5),\n"
    );
}

#[test]
fn written_defaults_stay_and_comments_stay_aligned() {
    let text = file("empty.ron");
    assert_eq!(
        diff(&text, &edited(&text, |scenario| scenario.robot.motions[0].w_rad_s = 2.0)),
        "-            (v_m_s: 0.15, w_rad_s: 1.5),\n+            (v_m_s: 0.15, w_rad_s: 2.0),\n"
    );
    let (before, after) =
        ("benchmark_route: (start_m: (0.0, 0.0),", "benchmark_route: (start_m: (1.0, 0.0),");
    assert_eq!(
        edited(&text, |scenario| scenario.benchmark_route.get_or_insert_default().start_m.x = 1.0),
        text.replace(before, after)
    );
    let (before, after) = ("6.2831855, // a full", "3.0,       // a full");
    assert_eq!(edited(&text, |scenario| scenario.lidar.field_of_view_rad = 3.0), text.replace(before, after));
    let tabbed = text.replace("0.0,             // standard", "0.0,\t\t\t\t\t\t\t\t\t\t\t\t\t// standard");
    assert_ne!(tabbed, text);
    let changed = edited(&tabbed, |scenario| scenario.lidar.beams = 36);
    assert_eq!(changed, tabbed.replace("beams: 24", "beams: 36"), "an unchanged line keeps its tabs");
    let (before, after) = ("0.0,             // standard", "0.0125,          // standard");
    assert_eq!(
        edited(&text, |scenario| scenario.lidar.noise_std_m = 0.0125.into()),
        text.replace(before, after)
    );
}

/// A file with comments and spaces in unusual places.
const ODD: &str = "// Head (with a bracket)\n#![enable(implicit_some)] /* so */\nScenario(\n\
  \tlidar: ( beams : 30 /* not ( 24 */ , dropout:0.1),// why: \"it\" rains\n\
  \tname: r#\"An \"odd\" one\"#, /* a /* nested */ one */ obstacles: [ // three\n\
  \t\t// The first.\n\t\t// It is round.\n\t\t(shape: Circle(radius_m: 15e-2), position_m: (0, 0.50)), // one\n\
  \n\t\t// A row:\n\n\t\t// The second.\n\
  \t\t(position_m: (1., 1.), /* here */ shape: Circle(radius_m: 0.15)), // two\n\n\
  \t\t(shape: Circle(radius_m: 0.2), position_m: (-1.0, 1.0)) // three, without a comma\n\
  \t\t// the end\n\t],\n\
  \tstarts: OneOf(positions_m: [(0.0, 0.0), /* b */ (1.0, 1.0) /* c */, (2.0, 2.0)]),\n\
  \tgoals: Fixed(position_m: (1.0, 1.0), heading_rad: Some(1.0)) /* last */\n) // done\n/* really */";

#[test]
fn comments_in_unusual_places_stay() {
    let same = |change: &dyn Fn(&mut Scenario), from: &str, to: &str| {
        assert_eq!(ODD.matches(from).count(), 1, "{from}");
        assert_eq!(edited(ODD, change), ODD.replace(from, to));
    };
    assert_eq!(to_text(&read(ODD), Some(ODD)), ODD);
    same(&|s| s.lidar.beams = 31, "30", "31");
    same(&|s| s.lidar.dropout = 0.0.into(), "dropout:0.1", "dropout:0.0");
    same(&|s| s.name = "Odd".into(), "r#\"An \"odd\" one\"#", "\"Odd\"");
    same(&|s| s.obstacles[0].position_m.y = 0.75, "0.50", "0.75");
    same(&|s| s.obstacles[1].position_m.x = 2.0, "(1., 1.)", "(2.0, 1.)");
    same(&|s| s.obstacles[1].rotation_rad = 0.5, ")), // two", "), rotation_rad: 0.5), // two");
    same(&|s| s.obstacles[2].shape = Shape::Circle { radius_m: 0.3 }, "0.2)", "0.3)");
    same(&|s| s.lidar.noise_std_m = 0.1.into(), "/* not ( 24 */ ,", "/* not ( 24 */ , noise_std_m: 0.1,");
    same(
        &|s| s.goals = PlacementRule::Fixed { position_m: vec2(1.0, 1.0), heading_rad: Some(2.0) },
        "Some(1.0)",
        "Some(2.0)",
    );
    same(
        &|s| s.goals = PlacementRule::OneOf { positions_m: vec![vec2(3.0, 3.0)] },
        "Fixed(position_m: (1.0, 1.0), heading_rad: Some(1.0))",
        "OneOf(positions_m: [(3.0, 3.0)])",
    );
    same(
        &|s| s.benchmark_route.get_or_insert_default().heading_rad = 0.5,
        " /* last */\n)",
        ", /* last */\n\tbenchmark_route: (heading_rad: 0.5),\n)",
    );
}

#[test]
fn a_removed_element_takes_only_its_own_comments() {
    let keeping = |text: &str, keep: &[usize]| {
        edited(text, |scenario| {
            let points = [vec2(0.0, 0.0), vec2(1.0, 1.0), vec2(2.0, 2.0)];
            scenario.starts = PlacementRule::OneOf { positions_m: keep.iter().map(|&k| points[k]).collect() };
        })
    };
    for (keep, expected) in [
        (&[1, 2][..], "[/* b */ (1.0, 1.0) /* c */, (2.0, 2.0)]"),
        (&[0, 2], "[(0.0, 0.0), (2.0, 2.0)]"),
        (&[0, 1], "[(0.0, 0.0), /* b */ (1.0, 1.0) /* c */]"),
        (&[2], "[(2.0, 2.0)]"),
    ] {
        let text = keeping(ODD, keep);
        assert!(text.contains(&format!("OneOf(positions_m: {expected}),")), "{expected} in {text}");
    }
    let without = |k: usize| edited(ODD, |scenario| drop(scenario.obstacles.remove(k)));
    assert!(without(0).contains("[ // three\n\t\t// A row:\n\n\t\t// The second.\n"), "{}", without(0));
    assert!(
        without(1).contains("// one\n\n\t\t// A row:\n\n\t\t(shape: Circle(radius_m: 0.2)"),
        "{}",
        without(1)
    );
    assert!(without(2).contains("// two\n\t\t// the end\n\t],"), "{}", without(2));
    let more = edited(ODD, |scenario| scenario.obstacles.push(circle(9.0, 9.0)));
    let line = "\t\t(shape: Circle(radius_m: 0.15), position_m: (9.0, 9.0)),\n";
    assert!(
        more.contains(&format!("(-1.0, 1.0)), // three, without a comma\n{line}\t\t// the end\n")),
        "{more}"
    );
    let none = edited(ODD, |scenario| scenario.obstacles.clear());
    assert!(none.contains("[ // three\n\n\t\t// A row:\n\n\t\t// the end\n\t],"), "{none}");
}

#[test]
fn a_file_keeps_its_line_endings() {
    let text = file("scenario-1.ron").replace('\n', "\r\n");
    assert_eq!(to_text(&read(&text), Some(&text)), text);
    let written = edited(&text, |scenario| {
        scenario.obstacles[2].position_m = vec2(-0.5, -0.5);
        scenario.obstacles.push(circle(1.0, 1.5));
        scenario.walls = everything().walls;
        scenario.about = "word ".repeat(40);
        scenario.lidar.beams = 36;
    });
    assert_eq!(written.matches('\n').count(), written.matches("\r\n").count(), "{written:?}");
    assert!(written.len() > text.len());
    let bare = file("scenario-1.ron");
    let bare = bare.trim_end();
    assert_eq!(to_text(&read(bare), Some(bare)), bare);
    assert!(
        edited(bare, |scenario| scenario.lidar.beams = 36)
            .contains("    lidar: (beams: 36),\n\n    // Tables")
    );
}

#[test]
fn a_list_of_ten_thousand_obstacles_changes_in_one_line() {
    let scenario = Scenario {
        obstacles: (0..10_000_u16).map(|k| circle(f32::from(k), 0.5)).collect(),
        ..Scenario::default()
    };
    let text = to_text(&scenario, None);
    let line = "        (shape: Circle(radius_m: 0.15), position_m: (7000.0, 0.5)),\n";
    assert_eq!(edited(&text, |scenario| drop(scenario.obstacles.remove(7000))), text.replace(line, ""));
    // After this many changes, elements are matched by their order only.
    edited(&text, |scenario| {
        scenario.obstacles.retain(|obstacle| obstacle.position_m.x % 3.0 != 0.0);
        scenario.obstacles.iter_mut().for_each(|obstacle| obstacle.position_m.y = 0.75);
    });
}

fn number() -> impl Strategy<Value = f32> {
    prop_oneof![any::<f32>(), (-40_i16..40).prop_map(|k| f32::from(k) / 20.0), Just(-0.0), Just(f32::NAN)]
}

fn pair() -> impl Strategy<Value = (f32, f32)> {
    (number(), number())
}

fn point() -> impl Strategy<Value = Vec2> {
    pair().prop_map(Vec2::from)
}

fn points() -> impl Strategy<Value = Vec<Vec2>> {
    vec(point(), 0..9)
}

fn shape() -> impl Strategy<Value = Shape> {
    prop_oneof![
        number().prop_map(|radius_m| Shape::Circle { radius_m }),
        pair().prop_map(|(width_m, height_m)| Shape::Rectangle { width_m, height_m }),
        points().prop_map(|corners_m| Shape::Polygon { corners_m }),
        pair().prop_map(|(length_m, radius_m)| Shape::Capsule { length_m, radius_m }),
    ]
}

fn motion() -> impl Strategy<Value = ObstacleMotion> {
    prop_oneof![
        Just(ObstacleMotion::Static),
        (point(), number()).prop_map(|(centre_m, speed_rad_s)| ObstacleMotion::Orbit {
            centre_m,
            speed_rad_s: speed_rad_s.into()
        }),
        (points(), number()).prop_map(|(waypoints_m, speed_m_s)| ObstacleMotion::Patrol {
            waypoints_m,
            speed_m_s: speed_m_s.into()
        }),
        (points(), number()).prop_map(|(waypoints_m, speed_m_s)| ObstacleMotion::BackAndForth {
            waypoints_m,
            speed_m_s: speed_m_s.into()
        }),
        (proptest::collection::vec((number(), point()), 0..4), number(), any::<bool>()).prop_map(
            |(frames, period_s, is_loop)| ObstacleMotion::KeyFrames {
                frames: frames
                    .into_iter()
                    .map(|(time_s, position_m)| KeyFrame { time_s, position_m })
                    .collect(),
                end: if is_loop { KeyFrameEnd::Loop { period_s } } else { KeyFrameEnd::Stop },
            }
        ),
        (number(), number(), 0_u32..3).prop_map(|(radius_m, speed_m_s, seed)| ObstacleMotion::RandomWalk {
            radius_m,
            speed_m_s: speed_m_s.into(),
            seed
        }),
        (points(), number(), any::<(bool, bool)>()).prop_map(|(goals_m, speed_m_s, (loops, sees_robot))| {
            ObstacleMotion::Pedestrian { goals_m, speed_m_s: speed_m_s.into(), loops, sees_robot }
        }),
    ]
}

fn obstacle() -> impl Strategy<Value = Obstacle> {
    // Few different obstacles, so that two lists share some.
    let few = (0_u8..5).prop_map(|k| circle(f32::from(k), 0.0));
    let any = (shape(), point(), number(), motion()).prop_map(|(shape, position_m, rotation_rad, motion)| {
        Obstacle { shape, position_m, rotation_rad, motion }
    });
    prop_oneof![3 => few, 1 => any]
}

fn generator() -> impl Strategy<Value = Generator> {
    let shape = prop_oneof![
        pair().prop_map(|radius_m| RandomShape::Circle { radius_m }),
        (pair(), pair()).prop_map(|(width_m, height_m)| RandomShape::Rectangle { width_m, height_m }),
    ];
    let within = option::of((point(), point()).prop_map(|(min_m, max_m)| Region { min_m, max_m }));
    (any::<u32>(), shape, prop_oneof![Just(0.4), number()], within)
        .prop_map(|(count, shape, gap_m, within)| Generator { count, shape, gap_m, within })
}

fn placement_rule() -> impl Strategy<Value = PlacementRule> {
    let clearance = || prop_oneof![Just(0.35), number()];
    prop_oneof![
        clearance().prop_map(|clearance_m| PlacementRule::Random { clearance_m }),
        (point(), point(), clearance()).prop_map(|(min_m, max_m, clearance_m)| PlacementRule::Within {
            min_m,
            max_m,
            clearance_m
        }),
        (point(), option::of(number()))
            .prop_map(|(position_m, heading_rad)| PlacementRule::Fixed { position_m, heading_rad }),
        points().prop_map(|positions_m| PlacementRule::OneOf { positions_m }),
    ]
}

fn robot() -> impl Strategy<Value = Robot> {
    let motion = pair().prop_map(|(v_m_s, w_rad_s)| Motion { v_m_s, w_rad_s });
    prop_oneof![
        Just(Robot::default()),
        (number(), option::of(shape()), vec(motion, 0..4), number(), number(), number()).prop_map(
            |(radius_m, shape, motions, actuator_lag_s, limit, error)| Robot {
                radius_m,
                shape,
                min_turning_radius_m: Some(limit),
                motions,
                actuator_lag_s: Ranged::Range(actuator_lag_s, error),
                max_acceleration_m_s2: Some(limit),
                slip: Some(Slip { forward: limit.into(), std: error.into(), ..Slip::default() }),
                odometry_drift: Some(OdometryDrift {
                    distance_error: Ranged::Range(error, limit),
                    rotation_error: error.into(),
                    heading_drift_rad_m: limit.into(),
                }),
                ..Robot::default()
            }
        ),
    ]
}

fn lidar() -> impl Strategy<Value = Lidar> {
    prop_oneof![
        Just(Lidar::default()),
        (0_usize..50).prop_map(|beams| Lidar { beams, ..Lidar::default() }),
        (number(), number(), 0_u32..3).prop_map(|(max_range_m, dropout, latency_steps)| Lidar {
            max_range_m,
            dropout: dropout.into(),
            latency_steps: latency_steps.into(),
            ..Lidar::default()
        }),
    ]
}

fn scenario() -> impl Strategy<Value = Scenario> {
    let enclosure = prop_oneof![
        pair().prop_map(|(width_m, height_m)| Enclosure::Rectangle { width_m, height_m }),
        points().prop_map(|corners_m| Enclosure::Polygon { corners_m }),
    ];
    let wall = (points(), prop_oneof![Just(0.1), number()]).prop_map(|(corners_m, thickness_m)| Wall {
        corners_m,
        thickness_m,
        ..Wall::default()
    });
    let cells = (vec("[#. x\"]{0,4}", 0..3), number(), point()).prop_map(|(rows, cell_m, centre_m)| Wall {
        cells: Some(WallCells::new(rows, cell_m, centre_m)),
        ..Wall::default()
    });
    let wall = prop_oneof![2 => wall, 1 => cells];
    let task = (number(), any::<u32>()).prop_map(|(control_period_s, max_episode_steps)| TaskRules {
        control_period_s,
        max_episode_steps,
        ..TaskRules::default()
    });
    let benchmark_route = prop_oneof![
        Just(None),
        Just(Some(BenchmarkRoute::default())),
        point().prop_map(|goal_m| Some(BenchmarkRoute { goal_m, ..BenchmarkRoute::default() }))
    ];
    let lists = (vec(wall, 0..3), vec(obstacle(), 0..7), vec(generator(), 0..3));
    let placement_rules = (placement_rule(), placement_rule());
    let texts = (any::<String>(), prop_oneof![Just(String::new()), "[ a\n]{0,300}", any::<String>()]);
    (texts, enclosure, lists, robot(), lidar(), task, placement_rules, benchmark_route).prop_map(
        |(
            (name, about),
            enclosure,
            (walls, obstacles, generators),
            robot,
            lidar,
            task,
            (starts, goals),
            benchmark_route,
        )| {
            Scenario {
                name,
                about,
                enclosure,
                walls,
                obstacles,
                generators,
                robot,
                lidar,
                task,
                starts,
                goals,
                benchmark_route,
            }
        },
    )
}

/// A scenario as text in which 0.0 and -0.0 differ and NaN equals NaN.
fn spelled(scenario: &Scenario) -> String {
    format!("{scenario:?}")
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 500, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn any_scenario_is_read_back_bit_identically(scenario in scenario(), other in scenario()) {
        let text = to_text(&scenario, None);
        prop_assert_eq!(spelled(&read(&text)), spelled(&scenario), "{}", text);
        prop_assert_eq!(to_text(&read(&text), None), text.clone());

        // Comments in another scenario's text, so that it is not canonical.
        let marked = to_text(&other, None).replace("(\n", "( // in\n").replace("lidar: (", "lidar: ( /* l */");
        let marked = format!("// head\n{} // end", marked.trim_end());
        prop_assert_eq!(to_text(&read(&marked), Some(&marked)), marked.clone());
        let written = to_text(&scenario, Some(&marked));
        prop_assert_eq!(spelled(&read(&written)), spelled(&scenario), "{}\nold text: {}", written, marked);
        let keeps_comments = written.starts_with("// head\n( // in\n") && written.ends_with(") // end");
        prop_assert!(keeps_comments, "the old text is used: {}", written);
        prop_assert_eq!(to_text(&scenario, Some(&written)), written.clone());
        // And back again.
        let back = to_text(&other, Some(&written));
        prop_assert_eq!(spelled(&read(&back)), spelled(&other), "{}", back);
        prop_assert!(back.starts_with("// head\n( // in\n"), "the old text is used: {}", back);
    }

    #[test]
    fn comments_may_be_anywhere(
        scenario in scenario(),
        other in scenario(),
        seeds in vec(0_usize..40, 1..60),
    ) {
        let plain = Scenario { name: "x".into(), about: String::new(), ..other };
        let old_text = with_trivia(&to_text(&plain, None), &seeds);
        prop_assert_eq!(spelled(&read(&old_text)), spelled(&plain), "{}", old_text);
        let written = to_text(&scenario, Some(&old_text));
        prop_assert_eq!(spelled(&read(&written)), spelled(&scenario), "{}\nold text: {}", written, old_text);
        prop_assert!(written.starts_with("// head\n"), "the old text is used: {}\nold text: {}", written, old_text);
    }
}

/// `text`, whose strings contain no brackets, with comments and line breaks after some brackets, commas and colons.
fn with_trivia(text: &str, seeds: &[usize]) -> String {
    const TRIVIA: [&str; 8] =
        ["// c )\n", " /* a, ( */ ", "\n", "\n\n\n", "/* a\n\n b */", " // d\n\n// e\n", "/*/**/*/", " "];
    let mut seeds = seeds.iter().cycle();
    let mut out = String::from("// head\n");
    for c in text.chars() {
        out.push(c);
        if matches!(c, '(' | ')' | '[' | ']' | ',' | ':') {
            let seed = seeds.next().copied().unwrap_or_default();
            out += TRIVIA.get(seed).copied().unwrap_or_default();
        }
    }
    out
}
