//! Property tests with random scenarios (without pedestrians, values drawn from ranges, slip or odometry drift): a written
//! scenario is read back, the checks never panic, and a scenario that passes them can be run.

mod scenario_strategies;

use std::collections::VecDeque;

use glam::{Vec2, vec2};
use proptest::collection::vec;
use proptest::prelude::*;
use scenario_strategies::{ValueRange, valid_scenario, without_moving_obstacles};
use wayfield_random::stream;
use wayfield_scenario::{
    BenchmarkRoute, Obstacle, PlacementRule, Scenario, Shape, Wall, clearance, diagnostics, draw_goal,
    draw_start, draw_start_and_goal, enclosure_distance, notes, parse_ron, pose_at, shape_distance, to_ron,
};

/// The outline of a shape at a pose: its corners, and the radius around them.
fn outline(shape: &Shape, (x, y, rotation): (f32, f32, f32)) -> (Vec<Vec2>, f32) {
    let (points, radius) = match shape {
        Shape::Circle { radius_m } => (vec![Vec2::ZERO], *radius_m),
        Shape::Rectangle { width_m: w, height_m: h } => (
            vec![
                vec2(-w / 2.0, -h / 2.0),
                vec2(w / 2.0, -h / 2.0),
                vec2(w / 2.0, h / 2.0),
                vec2(-w / 2.0, h / 2.0),
            ],
            0.0,
        ),
        Shape::Polygon { corners_m } => (corners_m.clone(), 0.0),
        Shape::Capsule { length_m, radius_m } => {
            (vec![vec2(-length_m / 2.0, 0.0), vec2(length_m / 2.0, 0.0)], *radius_m)
        }
    };
    let (sin, cos) = rotation.sin_cos();
    (
        points
            .into_iter()
            .map(|Vec2 { x: a, y: b }| vec2(x + a * cos - b * sin, y + a * sin + b * cos))
            .collect(),
        radius,
    )
}

/// Whether a path connects two points on a coarse grid, at least `clear` m from all static objects.
fn has_path(scenario: &Scenario, from: Vec2, to: Vec2, clear: f32) -> bool {
    const CELL_M: f32 = 0.05;
    let (low, high) = scenario.enclosure.bounds_m();
    let (columns, rows) =
        (((high.x - low.x) / CELL_M) as usize + 1, ((high.y - low.y) / CELL_M) as usize + 1);
    let nearest = |Vec2 { x, y }: Vec2| {
        (((x - low.x) / CELL_M).round() as usize, ((y - low.y) / CELL_M).round() as usize)
    };
    let without_moving_obstacles = without_moving_obstacles(scenario);
    let mut free: Vec<bool> = (0..columns * rows)
        .map(|k| {
            let point = vec2(low.x + (k % columns) as f32 * CELL_M, low.y + (k / columns) as f32 * CELL_M);
            clearance(&without_moving_obstacles, point, 0) >= clear
        })
        .collect();
    let mut due = VecDeque::from([nearest(from)]);
    while let Some((x, y)) = due.pop_front() {
        if (x, y) == nearest(to) {
            return true;
        }
        if x >= columns || y >= rows || !std::mem::take(&mut free[y * columns + x]) {
            continue;
        }
        due.extend([(x + 1, y), (x.wrapping_sub(1), y), (x, y + 1), (x, y.wrapping_sub(1))]);
    }
    false
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(128))]

    #[test]
    fn a_written_scenario_is_read_back(scenario in ValueRange::Finite.scenario()) {
        let text = to_ron(&scenario).expect("it can be written");
        let read: Scenario = parse_ron(&text, "w.ron").expect("and read");
        prop_assert_eq!(&read, &scenario);
        prop_assert_eq!(to_ron(&read).expect("and written again"), text);
    }

    #[test]
    fn arbitrary_numbers_cause_no_panic_in_the_checks(scenario in ValueRange::Any.scenario(), step: u64) {
        let noted = notes(&scenario).into_iter().map(|note| note.diagnostic);
        let found: Vec<_> = diagnostics(&scenario).into_iter().chain(noted).collect();
        prop_assert!(found.iter().all(|finding| !finding.path.is_empty() && !finding.message.is_empty()));
        let route = scenario.benchmark_route.unwrap_or_default();
        let _ = clearance(&scenario, route.start_m, step);
        for obstacle in &scenario.obstacles {
            let pose = pose_at(obstacle, step, scenario.task.control_period_s);
            let _ = shape_distance(&obstacle.shape, pose, route.goal_m);
        }
    }

    #[test]
    fn damaged_text_causes_no_panic(
        which in 0_usize..4,
        edits in vec(
            (0.0_f32..1.0, 0_usize..30, "[\\[\\](){},:\"'/*#r.0-9é-]{0,4}", 0.0_f32..1.0, 0_usize..60), 1..4,
        ),
    ) {
        let good = [
            include_str!("fixtures/everything.ron"),
            include_str!("fixtures/everything-else.ron"),
            include_str!("fixtures/obstacles.ron"),
            include_str!("fixtures/beyond.ron"),
        ][which];
        let mut text = good.to_owned();
        for (at, cut, put, from, length) in edits {
            // A part is cut out, and replaced by random characters and a copy of another part.
            let piece = |fraction: f32, length: usize| {
                let start = text.floor_char_boundary((fraction * text.len() as f32) as usize);
                start..text.floor_char_boundary(start + length)
            };
            let (gone, copied) = (piece(at, cut), piece(from, length));
            text = format!("{}{put}{}{}", &text[..gone.start], &text[copied], &text[gone.end..]);
        }
        let _ = Scenario::parse(&text, "w.ron").map_err(|error| error.to_string());
    }

    #[test]
    fn a_valid_scenario_has_starts_and_goals(scenario in valid_scenario(), seed: u64, later in 0_u64..100_000) {
        let task = &scenario.task;
        let without_moving_obstacles = without_moving_obstacles(&scenario);
        // A position drawn from free space has the rule's clearance; a listed one only avoids collisions with static objects.
        let keeps = |rule: &PlacementRule, position: Vec2, step: u64| match rule {
            PlacementRule::Random { clearance_m } => clearance(&scenario, position, step) >= *clearance_m,
            PlacementRule::Within { min_m, max_m, clearance_m } => {
                clearance(&scenario, position, step) >= *clearance_m
                    && (min_m.x..=max_m.x).contains(&position.x)
                    && (min_m.y..=max_m.y).contains(&position.y)
            }
            PlacementRule::Fixed { position_m, .. } => {
                position == *position_m && clearance(&without_moving_obstacles, position, 0) >= task.collision_range_m
            }
            PlacementRule::OneOf { positions_m } => {
                positions_m.contains(&position) && clearance(&without_moving_obstacles, position, 0) >= task.collision_range_m
            }
        };
        let mut s = stream(seed, "places", 0);
        for round in 0..8 {
            let step = if round < 4 { 0 } else { later + round };
            let drawn = draw_start_and_goal(&scenario, step, &mut s);
            prop_assert!(drawn.is_ok() || step > 0, "{drawn:?}");
            let Ok(((x, y, heading), goal)) = drawn else { continue };
            prop_assert!(keeps(&scenario.starts, vec2(x, y), step), "{:?}", (x, y));
            prop_assert!(keeps(&scenario.goals, goal, step), "{goal:?}");
            prop_assert!(heading.abs() <= 6.3);
            prop_assert!((goal.x - x).hypot(goal.y - y) > task.min_goal_distance_m - 1e-4);
            prop_assert!(has_path(&scenario, vec2(x, y), goal, task.collision_range_m - 0.05), "to {goal:?}");
            if matches!(scenario.goals, PlacementRule::Random { .. }) {
                prop_assert!(draw_goal(&scenario, 0, goal, &mut s).is_ok(), "and on from there");
            }
        }
        prop_assert!(draw_start(&scenario, 0, &mut s).is_ok());
        if let Some(BenchmarkRoute { start_m, goal_m, .. }) = scenario.benchmark_route {
            prop_assert!(has_path(&scenario, start_m, goal_m, task.collision_range_m - 0.05));
        }
    }

    #[test]
    fn a_valid_scenario_stays_valid_with_generated_obstacles(scenario in valid_scenario(), layout_seed: u64) {
        let generated = scenario.with_generated_obstacles(layout_seed);
        prop_assert!(generated.generators.is_empty());
        prop_assert!(generated.obstacles.len() <= scenario.max_obstacles());
        prop_assert_eq!(&generated, &scenario.with_generated_obstacles(layout_seed), "the same seed gives the same layout");
        for finding in diagnostics(&generated) {
            // A crowded layout may leave no free space for a rule: the checks of the scenario try only a few layouts.
            let allowed = ["has no free space", "the free space for goals extends over less", "too close to the starts"];
            prop_assert!(allowed.iter().any(|it| finding.message.contains(it)), "{finding} in {generated:?}");
        }
    }

    #[test]
    fn an_obstacle_that_enters_a_static_one_or_a_wall_is_noted(scenario in valid_scenario()) {
        let noted: Vec<String> = notes(&scenario).into_iter().map(|note| note.diagnostic.to_string()).collect();
        let period = scenario.task.control_period_s;
        let walls: Vec<_> = scenario.walls.iter().enumerate().flat_map(|(k, wall)| {
            wall.pieces().map(move |piece| (format!("`walls[{k}]`"), piece))
        }).collect();
        let still = |(k, o): (usize, &Obstacle)| (!o.motion.is_moving()).then(|| (format!("`obstacles[{k}]`"), o.clone()));
        let solids = scenario.obstacles.iter().enumerate().filter_map(still).chain(walls);
        for (name, solid) in solids {
            let at = pose_at(&solid, 0, period);
            for (k, obstacle) in scenario.obstacles.iter().enumerate().filter(|(_, o)| o.motion.is_moving()) {
                let enters = (0..2_000).any(|step| {
                    let (points, radius) = outline(&obstacle.shape, pose_at(obstacle, step, period));
                    points.iter().any(|&point| shape_distance(&solid.shape, at, point) < radius - 0.02)
                });
                let is_noted = noted.iter().any(|note| {
                    note.starts_with(&format!("`obstacles[{k}].motion` ")) && note.contains(&name)
                });
                prop_assert!(is_noted || !enters, "obstacle {k} enters {name}: {noted:?}");
            }
        }
    }

    #[test]
    fn in_a_valid_scenario_no_obstacle_leaves_the_enclosure_or_jumps(scenario in valid_scenario()) {
        let period = scenario.task.control_period_s;
        let corners = scenario.enclosure.corners_m();
        for obstacle in &scenario.with_generated_obstacles(0).obstacles {
            let mut before = pose_at(obstacle, 0, period);
            for step in 0..2_000 {
                let pose = pose_at(obstacle, step, period);
                let (points, radius) = outline(&obstacle.shape, pose);
                for point in points {
                    let inside = enclosure_distance(&scenario.enclosure, point) - radius;
                    prop_assert!(inside > -2e-4, "{inside} m at step {step}: {obstacle:?}");
                }
                for &corner in &corners {
                    let apart = shape_distance(&obstacle.shape, pose, corner);
                    prop_assert!(apart > -0.01, "a corner is {apart} m from it at step {step}: {obstacle:?}");
                }
                prop_assert!((pose.0 - before.0).hypot(pose.1 - before.1) < 0.501, "step {step}: {obstacle:?}");
                before = pose;
            }
        }
    }

    #[test]
    fn a_wall_is_reported_only_if_it_separates_start_and_goal(
        mut scenario in valid_scenario(), across in 0.2_f32..0.8, gap_m in 0.0_f32..0.6,
    ) {
        // The wall rises from the bottom of the enclosure and leaves a gap at the top.
        let (low, high) = scenario.enclosure.bounds_m();
        let x = low.x + across * (high.x - low.x);
        let mut top = low.y + 0.001;
        while enclosure_distance(&scenario.enclosure, vec2(x, top)) > 0.0 {
            top += 0.001;
        }
        scenario.walls.push(Wall { corners_m: vec![vec2(x, low.y), vec2(x, top - gap_m - 0.01)], thickness_m: 0.02, ..Wall::default() });
        prop_assume!(scenario.benchmark_route.is_some());
        let BenchmarkRoute { start_m, goal_m, .. } = scenario.benchmark_route.unwrap_or_default();
        scenario.starts = PlacementRule::Fixed { position_m: start_m, heading_rad: None };
        scenario.goals = PlacementRule::Fixed { position_m: goal_m, heading_rad: None };
        scenario.generators.clear();
        let found = diagnostics(&scenario);
        let room = scenario.task.collision_range_m;
        if found.iter().any(|finding| finding.message.contains("can't")) {
            prop_assert_eq!(found.len(), 2, "the rules and the benchmark route agree");
            prop_assert!(!has_path(&scenario, start_m, goal_m, room), "{found:?}");
        } else if found.is_empty() {
            prop_assert!(has_path(&scenario, start_m, goal_m, room - 0.05));
        }
    }
}
