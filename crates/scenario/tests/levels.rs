//! Level generators: every level is a valid scenario that the robot can solve, and depends on its seed alone.

use std::f32::consts::TAU;

use glam::{Vec2, vec2};
use proptest::collection::vec;
use proptest::prelude::*;
use wayfield_scenario::{
    Clutter, LevelGenerator, Obstacle, ObstacleMotion, RandomShape, Route, Scenario, Shape, Traffic,
    WallLayout, clearance, diagnostics, level_generator_diagnostics, parse_ron, polygon, to_ron, to_text,
};

/// Number of seeds tested per generator.
const SEEDS: u64 = 200;

fn generator(text: &str) -> LevelGenerator {
    LevelGenerator::parse(text, "test.ron").unwrap_or_else(|error| panic!("{error}"))
}

fn level(generator: &LevelGenerator, seed: u64) -> Scenario {
    generator.level(seed).unwrap_or_else(|error| panic!("{error}"))
}

const AUTOMATON: &str = "(name: \"Automaton\", clutter: [Automaton()])";
const ACROSS: &str =
    "(name: \"Across\", width_m: (4.5, 4.5), height_m: (6.5, 6.5), clutter: [Automaton()], route: Across())";
const SCATTER: &str = "(name: \"Scatter\", clutter: [Scatter(count: (5, 20), shapes: [
    Circle(radius_m: (0.02, 0.2)),
    Rectangle(width_m: (0.2, 0.6), height_m: (0.2, 0.4)),
    Rectangle(width_m: (0.5, 1.5), height_m: (0.03, 0.06)),
])])";

const CELLS: &str = "(name: \"Cells\", wall_layouts: [Cells()])";
const GRID: &str = "(name: \"Grid\", wall_layouts: [Grid(rows: [\"....\", \".##.\", \"..#.\", \"....\"])])";
const ROOMS: &str = "(name: \"Rooms\", wall_layouts: [Rooms()])";
const MAZE: &str = "(name: \"Maze\", wall_layouts: [Maze()])";
const CORRIDORS: &str = "(name: \"Corridors\", wall_layouts: [Maze(wall_m: (0.5, 1.2))])";
const TRAPS: &str = "(name: \"Traps\", wall_layouts: [Traps()])";

const LANES: &str = "(name: \"Lanes\", traffic: [Lanes()])";
const CIRCLE: &str = "(name: \"Circle\", traffic: [CircleCrossing()])";
const CROSSING: &str = "(name: \"Crossing\", traffic: [RandomCrossing()])";
const WALKS: &str = "(name: \"Walks\", traffic: [RandomWalks()])";
const ORBITS: &str = "(name: \"Orbits\", traffic: [Orbits()])";
const MIXED: &str =
    "(name: \"Mixed\", gap_m: 0.45, route: Random(clearance_m: 0.3), wall_layouts: [Cells(), Rooms(), Traps()],
    clutter: [Scatter(count: (2, 6), shapes: [Circle(radius_m: (0.05, 0.2))])],
    traffic: [Lanes(), CircleCrossing(), RandomCrossing(), RandomWalks(), Orbits()])";

const PEDESTRIANS: &str = "(name: \"Pedestrians\", width_m: (12.0, 12.0), height_m: (12.0, 12.0),
    traffic: [PedestrianCircle(circle_m: (4.0, 4.0), noise_m: 0.5, loops: false)],
    route: Fixed(start_m: (0.0, -4.0), heading_rad: 1.5708, goal_m: (0.0, 4.0)))";
const CROWD: &str =
    "(name: \"Crowd\", wall_layouts: [Traps()], traffic: [PedestrianCrowd(sees_robot: true)])";

/// Generators with each kind of walls, clutter and traffic, alone and mixed.
const ALL: [&str; 17] = [
    AUTOMATON,
    ACROSS,
    SCATTER,
    CELLS,
    GRID,
    ROOMS,
    MAZE,
    CORRIDORS,
    TRAPS,
    LANES,
    CIRCLE,
    CROSSING,
    WALKS,
    ORBITS,
    MIXED,
    PEDESTRIANS,
    CROWD,
];

#[test]
fn every_level_is_a_valid_scenario() {
    for text in ALL {
        let generator = generator(text);
        for seed in 0..SEEDS {
            let level = level(&generator, seed);
            let found = diagnostics(&level);
            assert!(found.is_empty(), "{}: {found:?}", level.name);
        }
    }
}

#[test]
fn the_same_seed_gives_the_same_file() {
    for text in ALL {
        let generator = generator(text);
        for seed in [0, 1, 1_000_000, u64::MAX] {
            let text = to_text(&level(&generator, seed), None);
            assert_eq!(text, to_text(&level(&generator, seed), None));
            assert_eq!(Scenario::parse(&text, "level.ron").expect("valid"), level(&generator, seed));
        }
        let (one, other) = (level(&generator, 0), level(&generator, 1));
        assert_ne!((one.walls, one.obstacles), (other.walls, other.obstacles));
    }
}

/// Whether a path on a grid of 4 cm leads from the start to the goal of the benchmark route, at least `clear_m` from
/// everything static.
fn has_path(level: &Scenario, clear_m: f32) -> bool {
    const CELL_M: f32 = 0.04;
    let still = Scenario {
        obstacles: level.obstacles.iter().filter(|o| o.motion == ObstacleMotion::Static).cloned().collect(),
        ..level.clone()
    };
    let (low, high) = level.enclosure.bounds_m();
    let columns = ((high.x - low.x) / CELL_M) as usize + 1;
    let count = columns * (((high.y - low.y) / CELL_M) as usize + 1);
    let point = |cell: usize| low + CELL_M * vec2((cell % columns) as f32, (cell / columns) as f32);
    let cell_at = |point: Vec2| {
        let at = ((point - low) / CELL_M).round();
        at.y as usize * columns + at.x as usize
    };
    let route = level.benchmark_route.expect("every level has one");
    let (start, goal) = (cell_at(route.start_m), cell_at(route.goal_m));
    let mut seen = vec![false; count];
    let mut open = vec![start];
    while let Some(cell) = open.pop() {
        if cell == goal {
            return true;
        }
        if !std::mem::replace(&mut seen[cell], true) && clearance(&still, point(cell), 0) >= clear_m {
            open.extend([cell.wrapping_sub(1), cell + 1, cell.wrapping_sub(columns), cell + columns]);
            open.retain(|&next| next < count);
        }
    }
    false
}

#[test]
fn the_passages_to_the_goal_are_as_wide_as_the_gap() {
    for text in ALL {
        let generator = generator(text);
        for seed in 0..10 {
            let level = level(&generator, seed);
            // The grid may miss the middle of the narrowest passage by half a cell.
            assert!(has_path(&level, generator.gap_m / 2.0 - 0.02), "{}", level.name);
        }
    }
}

#[test]
fn scattered_obstacles_and_traps_keep_the_gap() {
    for text in [SCATTER, TRAPS] {
        let generator = generator(text);
        for seed in 0..SEEDS {
            let level = level(&generator, seed);
            let mut groups: Vec<Vec<Obstacle>> = level.obstacles.iter().map(|o| vec![o.clone()]).collect();
            groups.extend(level.walls.iter().map(|wall| wall.pieces().collect()));
            for (k, group) in groups.iter().enumerate() {
                let others = groups.iter().enumerate().filter(|(other, _)| *other != k);
                let others: Vec<Obstacle> = others.flat_map(|(_, group)| group.clone()).collect();
                let rest = Scenario { walls: Vec::new(), obstacles: others, ..level.clone() };
                let nearest = group.iter().flat_map(rim).map(|point| clearance(&rest, point, 0));
                let gap_m = nearest.fold(f32::INFINITY, f32::min);
                assert!(gap_m >= generator.gap_m - 1e-4, "{}: {gap_m} m around {group:?}", level.name);
            }
        }
    }
}

/// Points on the rim of a circle or a rectangle.
fn rim(obstacle: &Obstacle) -> Vec<Vec2> {
    let (points, radius) = obstacle.shape.support_points(obstacle.rotation_rad);
    let corners: Vec<Vec2> = points.iter().map(|&point| obstacle.position_m + point).collect();
    if radius > 0.0 {
        return (0..64).map(|k| corners[0] + radius * Vec2::from_angle(k as f32 * TAU / 64.0)).collect();
    }
    let sides = polygon::sides(&corners);
    sides.flat_map(|(from, to)| (0..20).map(move |k| from.lerp(to, k as f32 / 20.0))).collect()
}

#[test]
fn the_parameters_of_levels_are_uniform_over_their_ranges() {
    let count = 400;
    let text = "(name: \"a\", width_m: (4.0, 6.0), height_m: (4.0, 4.0),)";
    let levels: Vec<Scenario> = (0..count).map(|seed| level(&generator(text), seed)).collect();
    let width = |level: &Scenario| level.enclosure.bounds_m().1.x * 2.0;
    let mean = levels.iter().map(width).sum::<f32>() / count as f32;
    assert!((mean - 5.0).abs() < 0.1, "{mean}");
    assert!(levels.iter().all(|level| (4.0..=6.0).contains(&width(level))));
    for low in [4.0_f32, 4.5, 5.0, 5.5] {
        let in_quarter =
            levels.iter().map(width).filter(|width_m| (low..low + 0.5).contains(width_m)).count();
        assert!(
            (60..140).contains(&in_quarter),
            "{in_quarter} of {count} widths in the quarter from {low} m"
        );
    }
}

#[test]
fn the_layouts_of_a_list_are_equally_likely() {
    let text = "(name: \"a\", wall_layouts: [Rooms(), Traps(count: (0, 0)), Maze()])";
    let levels: Vec<Scenario> = (0..600).map(|seed| level(&generator(text), seed)).collect();
    let rooms = levels.iter().filter(|level| !level.walls.is_empty()).count();
    let mazes = levels.iter().filter(|level| !level.obstacles.is_empty()).count();
    assert!((160..240).contains(&rooms) && (160..240).contains(&mazes), "{rooms} {mazes}");
}

#[test]
fn an_automaton_fills_the_given_fraction_of_the_cells() {
    let text = "(name: \"a\", width_m: (5.0, 5.0), height_m: (5.0, 5.0), route: Across(),
        clutter: [Automaton(fill: (0.02, 0.04), smoothings: (0, 0), cell_m: (0.1, 0.1))])";
    let circles = |seed| level(&generator(text), seed).obstacles.len();
    let counts: Vec<usize> = (0..SEEDS).map(circles).collect();
    let mean = counts.iter().sum::<usize>() as f32 / SEEDS as f32;
    // Of the 50 x 50 cells, 10 rows at the start and 10 at the goal are free: the default `margin_m` of `Across` is 1 m.
    assert!((mean / 1_500.0 - 0.03).abs() < 0.002, "{mean} of 1,500 cells");
}

#[test]
fn parameters_without_space_give_one_clear_error() {
    let crowded = generator("(name: \"Full\", clutter: [Automaton(fill: (0.5, 0.5), smoothings: (0, 0))])");
    let error = crowded.level(3).expect_err("there is no space").to_string();
    assert!(
        error.starts_with("no level of \"Full\" for seed 3 in 100 attempts: in the last one, "),
        "{error}"
    );
    assert!(error.contains("help: write a smaller fill"), "{error}");
}

#[test]
fn a_grid_of_text_gives_few_rectangles_in_the_right_positions() {
    // The free cell in the upper right corner is cut off, and becomes solid.
    let rows = r#"["..#.", ".###", "....", "...."]"#;
    let text =
        format!("(name: \"G\", width_m: (4, 4), height_m: (6, 6), wall_layouts: [Grid(rows: {rows})])");
    let level = level(&generator(&text), 0);
    let found: Vec<_> = level.obstacles.iter().map(|o| (o.shape.clone(), o.position_m)).collect();
    let rectangle = |width_m, height_m| Shape::Rectangle { width_m, height_m };
    assert_eq!(found, [(rectangle(3.0, 1.5), vec2(0.5, 0.75)), (rectangle(2.0, 1.5), vec2(1.0, 2.25))]);
}

#[test]
fn an_invalid_grid_of_text_is_reported_with_row_and_column() {
    for (rows, expected) in [
        ("[]", "`wall_layouts[0].rows` has 0 cells: write 1 to 4000"),
        (
            r#"["..", "..."]"#,
            "`wall_layouts[0].rows[1]` has 3 cells, but the first row has 2: write rows of the same length",
        ),
        (
            r#"["..", ".x"]"#,
            "`wall_layouts[0].rows[1]` has `x` in column 2: write # for a solid cell, or . for a free one",
        ),
    ] {
        let text = format!("(name: \"G\", wall_layouts: [Grid(rows: {rows})])");
        let error = LevelGenerator::parse(&text, "g.ron").expect_err(rows).to_string();
        assert!(error.contains(expected), "{error}");
    }
    let rows: Vec<_> = [".".repeat(300)].into();
    let text = format!("(name: \"G\", wall_layouts: [Grid(rows: {rows:?})])");
    let error = LevelGenerator::parse(&text, "g.ron").expect_err("narrow").to_string();
    assert!(error.contains("`wall_layouts[0].rows` has cells only 0.01333"), "{error}");
}

#[test]
fn an_invalid_generator_is_reported_with_line_and_fix() {
    for (text, expected) in [
        ("(name: \"\")", "`name` must have 1 to 100 characters"),
        ("(name: \"a\", gap_m: 0.2)", "`gap_m` is 0.2: write more than twice the collision range, 0.26 m"),
        ("(name: \"a\", width_m: (5.0, 4.0))", "`width_m` is (5, 4): write the smaller number first"),
        ("(name: \"a\", route: Random(clearance_m: 0.18))", "write at least 0.1925, 0.55 times gap_m"),
        ("(name: \"a\", route: Across(margin_m: 3.0))", "a third of the smallest height"),
        (
            "(name: \"a\", gap_m: 0.5, height_m: (2.0, 6.0), route: Across())",
            "`height_m` can be as small as 2 m, too small for a route: its margin_m must be at least twice gap_m and at most a \
             third of the height; write a smallest height of more than 3.00 m, or a smaller gap_m",
        ),
        (
            "(name: \"a\", gap_m: 0.442, height_m: (2.0, 6.0), route: Across())",
            "write a smallest height of more than 2.66 m, or a smaller gap_m",
        ),
        (
            "(name: \"a\", width_m: (9.0, 100.0), height_m: (9.0, 100.0), route: Random(clearance_m: 0.1925))",
            "`width_m` is too large for such a small clearance_m: write a smaller enclosure, or a larger clearance_m",
        ),
        ("(name: \"a\", clutter: [Automaton(cell_m: (0.03, 0.1))])", "more than 4000"),
        ("(name: \"a\", wall_layouts: [Rooms(door_m: (0.3, 0.5))])", "write more than gap_m, 0.35 m"),
        (
            "(name: \"a\", wall_layouts: [Rooms(side_m: (0.8, 1.8))])",
            "`wall_layouts[0].side_m[0]` is 0.8: write more than twice the sum of gap_m and a wall's thickness, 0.9 m",
        ),
        (
            "(name: \"a\", wall_layouts: [Rooms(side_m: (0.4, 1.8), loops: (0.0, 0.0))])",
            "is 0.4: write more than the sum of gap_m and a wall's thickness, 0.45 m",
        ),
        ("(name: \"a\", traffic: [Lanes(speed_m_s: (0.1, 4.0))])", "write a number from 0 to 2.5"),
        (
            "(name: \"a\", traffic: [PedestrianCrowd(goals: (0, 1))])",
            "`traffic[0].goals[0]` is 0: write a number from 1",
        ),
        (
            "(name: \"a\", traffic: [PedestrianCircle(noise_m: -1.0)])",
            "`traffic[0].noise_m` is -1: write a number from 0",
        ),
        ("(name: \"a\", wall_layouts: [Romms()])", "did you mean `Rooms`"),
        (
            "(name: \"a\", route: Fixed(start_m: (0.0, -4.0), heading_rad: 0.0, goal_m: (0.0, 1.0)))",
            "`route.start_m` is outside the smallest enclosure",
        ),
        (
            "(name: \"a\", robot: (motions: [(v_m_s: 0.0, w_rad_s: 1.0)]))",
            "`robot.motions` never move the robot",
        ),
    ] {
        let error = LevelGenerator::parse(text, "yard.ron").expect_err(text).to_string();
        assert!(error.starts_with("yard.ron:1:") && error.contains(expected), "{text}: {error}");
    }
}

#[test]
fn the_clearance_that_an_error_asks_for_is_accepted() {
    for (gap_m, clearance_m) in [("0.35", "0.1925"), ("0.333", "0.1832")] {
        let text =
            |clearance_m| format!("(name: \"a\", gap_m: {gap_m}, route: Random(clearance_m: {clearance_m}))");
        let error = LevelGenerator::parse(&text("0.18"), "g.ron").expect_err("too little").to_string();
        assert!(error.contains(&format!("write at least {clearance_m}, ")), "{error}");
        generator(&text(clearance_m));
    }
}

#[test]
fn an_invalid_control_period_is_the_only_problem_of_a_generator_with_traffic() {
    let text = "(name: \"a\", task: (control_period_s: -1.0), traffic: [Lanes()])";
    let error = LevelGenerator::parse(text, "g.ron").expect_err("no period").to_string();
    assert!(error.contains("`task.control_period_s` is -1") && error.lines().count() == 1, "{error}");
}

#[test]
fn obstacles_on_orbits_drive_one_after_the_other_around_a_common_centre() {
    let text = "(name: \"a\", traffic: [Orbits(circles: (1, 1), count: (3, 3), radius_m: (0.1, 0.1),
        speed_m_s: (0.12, 0.12), orbit_m: (0.5, 0.8))])";
    let levels =
        (0..SEEDS).map(|seed| level(&generator(text), seed)).filter(|level| !level.obstacles.is_empty());
    let (mut clockwise, mut count) = (0, 0);
    for level in levels {
        assert_eq!(level.obstacles.len(), 3, "{}", level.name);
        let orbit = |obstacle: &Obstacle| {
            let ObstacleMotion::Orbit { centre_m, speed_rad_s } = &obstacle.motion else {
                panic!("an orbit")
            };
            (*centre_m, speed_rad_s.value(), obstacle.position_m.distance(*centre_m))
        };
        let (centre_m, speed_rad_s, radius_m) = orbit(&level.obstacles[0]);
        assert!((0.5 - 1e-5..=0.8 + 1e-5).contains(&radius_m), "{radius_m}");
        assert!((speed_rad_s.abs() * radius_m - 0.12).abs() < 1e-5, "{speed_rad_s}");
        for (k, obstacle) in level.obstacles.iter().enumerate() {
            let other = orbit(obstacle);
            assert_eq!((other.0, other.1), (centre_m, speed_rad_s));
            assert!((other.2 - radius_m).abs() < 1e-5, "{}", other.2);
            let next = &level.obstacles[(k + 1) % 3];
            assert!(next.position_m.distance(obstacle.position_m) > 0.2, "{}: they overlap", level.name);
        }
        clockwise += usize::from(speed_rad_s < 0.0);
        count += 1;
    }
    assert!(4 * clockwise > count && 4 * clockwise < 3 * count, "{clockwise} of {count} turn clockwise");
}

#[test]
fn a_circle_has_no_more_obstacles_than_fit_without_overlap() {
    // Random shifts leave at least 0.4 of the even spacing of n obstacles, which is 2 pi / n. Neighbours with a radius of 0.1 m on a
    // circle with a radius of 0.3 m overlap if they are less than 2 asin(0.1 / 0.3) apart, so at most 3 fit.
    for (radius_m, most) in [("0.1", 3), ("0.3", 1), ("0.5", 1)] {
        let text = format!(
            "(name: \"a\", traffic: [Orbits(circles: (1, 1), count: (20, 20), radius_m: ({radius_m}, {radius_m}), orbit_m: (0.3, 0.3))])"
        );
        let counts = (0..SEEDS).map(|seed| level(&generator(&text), seed).obstacles.len());
        assert_eq!(counts.max(), Some(most), "obstacles of {radius_m} m");
    }
}

#[test]
fn pedestrians_start_apart_near_the_circle_and_cross_it() {
    let generator = generator(PEDESTRIANS);
    let mut angles_rad = Vec::new();
    for seed in 0..SEEDS {
        let level = level(&generator, seed);
        assert!(level.obstacles.len() >= 3, "{}: {} pedestrians", level.name, level.obstacles.len());
        let mut ends = vec![(vec2(0.0, -4.0), 0.1), (vec2(0.0, 4.0), 0.1)];
        for obstacle in &level.obstacles {
            let (start, radius_m) = (obstacle.position_m, obstacle.shape.bounding_radius_m());
            let ObstacleMotion::Pedestrian { goals_m, loops: false, .. } = &obstacle.motion else {
                panic!("a pedestrian who stops")
            };
            assert_eq!(goals_m, &[-start]);
            assert!((start.length() - 4.0).abs() < 0.71, "{start}");
            let gap_m = |&(end, other_m): &(Vec2, f32)| start.distance(end) - radius_m - other_m;
            assert!(ends.iter().all(|end| gap_m(end) >= 0.2 - 1e-5), "{}", level.name);
            ends.extend([(start, radius_m), (-start, radius_m)]);
            angles_rad.push(start.to_angle());
        }
    }
    for quarter in 0..4 {
        let low = (f64::from(quarter) - 2.0) * f64::from(TAU) / 4.0;
        let fraction =
            angles_rad.iter().filter(|a| (low..low + f64::from(TAU) / 4.0).contains(&f64::from(**a))).count()
                as f32
                / angles_rad.len() as f32;
        assert!((fraction - 0.25).abs() < 0.05, "all around: {fraction} in quarter {quarter}");
    }
}

#[test]
fn pedestrians_of_a_crowd_walk_on_paths_that_are_clear_of_walls() {
    let generator = generator(CROWD);
    let mut count = 0;
    for seed in 0..20 {
        let level = level(&generator, seed);
        let found = wayfield_scenario::notes(&level);
        let crossing = found.iter().find(|note| note.to_string().contains("find a way around"));
        assert_eq!(crossing, None, "{}", level.name);
        count += level.obstacles.iter().filter(|obstacle| obstacle.motion.is_pedestrian()).count();
    }
    assert!(count > 20, "only {count} pedestrians");
}

fn range(low: f32, high: f32) -> impl Strategy<Value = (f32, f32)> {
    (low..high, low..high).prop_map(|(a, b)| (a.min(b), a.max(b)))
}

fn whole_range(most: u32) -> impl Strategy<Value = (u32, u32)> {
    (0..=most, 0..=most).prop_map(|(a, b)| (a.min(b), a.max(b)))
}

/// A layout with the widths of its passages in units of the gap; see [`scale_passages`].
fn any_walls() -> impl Strategy<Value = WallLayout> {
    prop_oneof![
        (range(0.2, 2.0), range(0.0, 0.8)).prop_map(|(cell_m, fill)| WallLayout::Cells { cell_m, fill }),
        (1..10_usize, 1..10_usize, vec(0..3_usize, 100)).prop_map(|(columns, rows, cells)| {
            let cell = |k: usize| ["#", ".", "."][cells[k]];
            let row = |row| (0..columns).map(|column| cell(10 * row + column)).collect();
            WallLayout::Grid { rows: (0..rows).map(row).collect() }
        }),
        (range(0.6, 4.0), range(1.01, 4.0), range(0.0, 1.0))
            .prop_map(|(side_m, door_m, loops)| WallLayout::Rooms { side_m, door_m, loops }),
        (range(1.01, 6.0), range(0.02, 3.0), range(0.0, 1.0))
            .prop_map(|(passage_m, wall_m, loops)| WallLayout::Maze { passage_m, wall_m, loops }),
        (whole_range(20), range(1.01, 6.0), range(0.02, 3.0))
            .prop_map(|(count, width_m, depth_m)| WallLayout::Traps { count, width_m, depth_m }),
    ]
}

fn any_clutter() -> impl Strategy<Value = Clutter> {
    let shape = prop_oneof![
        range(0.001, 1.0).prop_map(|radius_m| RandomShape::Circle { radius_m }),
        (range(0.001, 3.0), range(0.001, 1.0))
            .prop_map(|(width_m, height_m)| RandomShape::Rectangle { width_m, height_m }),
    ];
    prop_oneof![
        (range(0.0, 0.5), whole_range(10), range(0.1, 1.0))
            .prop_map(|(fill, smoothings, cell_m)| Clutter::Automaton { fill, smoothings, cell_m }),
        (whole_range(30), vec(shape, 1..4)).prop_map(|(count, shapes)| Clutter::Scatter { count, shapes }),
    ]
}

fn any_traffic() -> impl Strategy<Value = Traffic> {
    let (count, radius, speed) = (|| whole_range(20), || range(0.01, 1.0), || range(0.0, 2.5));
    prop_oneof![
        (whole_range(10), count(), radius(), speed()).prop_map(|(pairs, count, radius_m, speed_m_s)| {
            Traffic::Lanes { pairs, count, radius_m, speed_m_s }
        }),
        (count(), radius(), speed(), range(0.1, 5.0)).prop_map(|(count, radius_m, speed_m_s, circle_m)| {
            Traffic::CircleCrossing { count, radius_m, speed_m_s, circle_m }
        }),
        (count(), radius(), speed()).prop_map(|(count, radius_m, speed_m_s)| {
            Traffic::RandomCrossing { count, radius_m, speed_m_s }
        }),
        (count(), radius(), speed(), range(0.01, 2.0)).prop_map(|(count, radius_m, speed_m_s, reach_m)| {
            Traffic::RandomWalks { count, radius_m, speed_m_s, reach_m }
        }),
        (whole_range(10), count(), radius(), speed(), range(0.25, 5.0)).prop_map(
            |(circles, count, radius_m, speed_m_s, orbit_m)| {
                Traffic::Orbits { circles, count, radius_m, speed_m_s, orbit_m }
            }
        ),
        (count(), radius(), speed(), range(0.1, 5.0), 0.0_f32..2.0, any::<(bool, bool)>()).prop_map(
            |(count, radius_m, speed_m_s, circle_m, noise_m, (loops, sees_robot))| {
                Traffic::PedestrianCircle { count, radius_m, speed_m_s, circle_m, noise_m, loops, sees_robot }
            }
        ),
        (count(), radius(), speed(), (1_u32..3, 3_u32..9), any::<bool>()).prop_map(
            |(count, radius_m, speed_m_s, goals, sees_robot)| {
                Traffic::PedestrianCrowd { count, radius_m, speed_m_s, goals, sees_robot }
            }
        ),
    ]
}

/// Multiplies the widths of passages, which are in units of the gap, by the gap.
fn scale_passages(layout: &mut WallLayout, gap_m: f32) {
    match layout {
        WallLayout::Cells { .. } | WallLayout::Grid { .. } => {}
        WallLayout::Rooms { door_m: width_m, .. }
        | WallLayout::Maze { passage_m: width_m, .. }
        | WallLayout::Traps { width_m, .. } => *width_m = (width_m.0 * gap_m, width_m.1 * gap_m),
    }
}

fn any_generator() -> impl Strategy<Value = LevelGenerator> {
    let route = prop_oneof![
        (0.56_f32..2.0).prop_map(|clearance_m| Route::Random { clearance_m }),
        (2.0_f32..4.0).prop_map(|margin_m| Route::Across { margin_m }),
        (-4.0_f32..4.0, -4.0_f32..4.0, -4.0_f32..4.0).prop_map(|(x, y, heading_rad)| Route::Fixed {
            start_m: vec2(x, y),
            heading_rad,
            goal_m: vec2(y, x)
        }),
    ];
    let sizes = (range(1.0, 10.0), range(1.0, 10.0), 0.262_f32..1.0);
    let lists = (vec(any_walls(), 0..3), vec(any_clutter(), 0..3), vec(any_traffic(), 0..3));
    (sizes, lists, route).prop_map(
        |((width_m, height_m, gap_m), (mut wall_layouts, clutter, traffic), route)| {
            wall_layouts.iter_mut().for_each(|layout| scale_passages(layout, gap_m));
            let route = match route {
                Route::Random { clearance_m } => Route::Random { clearance_m: clearance_m * gap_m },
                Route::Across { margin_m } => Route::Across { margin_m: margin_m * gap_m },
                fixed @ Route::Fixed { .. } => fixed,
            };
            let empty = generator("(name: \"Any\")");
            LevelGenerator { width_m, height_m, gap_m, wall_layouts, clutter, traffic, route, ..empty }
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(100))]

    #[test]
    fn any_valid_generator_gives_valid_levels_or_an_error(generator in any_generator(), seed: u64) {
        prop_assume!(level_generator_diagnostics(&generator).is_empty());
        match generator.level(seed) {
            Ok(level) => {
                let found = diagnostics(&level);
                prop_assert!(found.is_empty(), "{:?}", found);
                prop_assert_eq!(generator.level(seed), Ok(level));
            }
            // A generator fails only if its obstacles do not fit, so only if it has any.
            Err(problem) => {
                let LevelGenerator { wall_layouts, clutter, traffic, .. } = &generator;
                prop_assert!(!(wall_layouts.is_empty() && clutter.is_empty() && traffic.is_empty()), "{problem}");
            }
        }
    }

    #[test]
    fn a_written_generator_is_read_back(generator in any_generator()) {
        let text = to_ron(&generator).expect("RON");
        prop_assert_eq!(parse_ron::<LevelGenerator>(&text, "any.ron"), Ok(generator));
    }
}
