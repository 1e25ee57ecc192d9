//! The shipped scenarios: each loads, is documented, has a route to the goal, is shown in docs/worlds.md, and
//! can be trained in.

use std::collections::{BTreeSet, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use bevy::ecs::message::Messages;
use bevy::math::{Vec2, vec2};
use wayfield::agent::ActiveLearner;
use wayfield::learning::Learner;
use wayfield::run::{scenario_image, shipped, training_setup};
use wayfield::scenario::{Enclosure, ObstacleMotion, PlacementRule, Scenario, Shape, clearance, diagnostics};
use wayfield::simulation::Extensions;
use wayfield::task::{EpisodeEnded, observation};

fn project(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

#[test]
fn every_scenario_file_is_shipped_under_its_name_and_is_valid() {
    let entries = std::fs::read_dir(project("scenarios")).expect("the folder exists");
    let files: BTreeSet<String> = entries
        .map(|entry| entry.expect("a readable entry").file_name().to_string_lossy().into_owned())
        .filter(|name| !["generators", "sets", "suites"].contains(&name.as_str()))
        .collect();
    let names: Vec<&str> = shipped::scenarios().map(|(name, _)| name).collect();
    assert_eq!(names.len(), 12, "{names:?}");
    assert_eq!(
        files,
        names.iter().map(|name| format!("{name}.ron")).collect::<BTreeSet<_>>(),
        "every file is shipped and loads"
    );
    for (name, scenario) in shipped::scenarios() {
        assert!(diagnostics(&scenario).is_empty(), "{name}: {:?}", diagnostics(&scenario));
        let text =
            std::fs::read_to_string(project(&format!("scenarios/{name}.ron"))).expect("the file exists");
        assert_eq!(shipped::scenario_text(name), Some(text.as_str()), "{name}");
        assert_eq!(Scenario::load(project(&format!("scenarios/{name}.ron"))), Ok(scenario.clone()));
        assert!(text.starts_with("// "), "{name}: the file starts with a comment");
        assert!(
            (20..=400).contains(&scenario.about.len()),
            "{name}: `about` must fit into a few lines of the window"
        );
        assert_eq!(scenario.lidar.beams, 24, "{name}: policies must be transferable between scenarios");
        assert_eq!(
            scenario.robot.motions.len(),
            5,
            "{name}: policies must be transferable between scenarios"
        );
    }
}

#[test]
fn the_shipped_scenarios_use_every_listed_part_of_the_format() {
    let mut unused = BTreeSet::from([
        "a wall",
        "a polygonal enclosure",
        "a circle",
        "a rectangle",
        "a polygon",
        "a capsule",
        "an orbit",
        "a patrol",
        "back and forth",
        "a random walk",
        "a generator",
        "actuator lag",
        "noise",
        "dropout",
        "latency",
        "a field of view",
        "random starts or goals",
        "starts or goals within a region",
        "a fixed start or goal",
        "one of several starts or goals",
    ]);
    let mut mark = |what: &'static str, is_used: bool| {
        if is_used {
            unused.remove(what);
        }
    };
    for (_, scenario) in shipped::scenarios() {
        mark("a wall", !scenario.walls.is_empty());
        mark("a polygonal enclosure", matches!(scenario.enclosure, Enclosure::Polygon { .. }));
        mark("a generator", !scenario.generators.is_empty());
        mark("actuator lag", scenario.robot.actuator_lag_s != 0.0.into());
        mark("noise", scenario.lidar.noise_std_m != 0.0.into());
        mark("dropout", scenario.lidar.dropout != 0.0.into());
        mark("latency", scenario.lidar.latency_steps != 0.into());
        mark("a field of view", !scenario.lidar.is_all_around());
        for obstacle in &scenario.obstacles {
            let shape = match obstacle.shape {
                Shape::Circle { .. } => "a circle",
                Shape::Rectangle { .. } => "a rectangle",
                Shape::Polygon { .. } => "a polygon",
                Shape::Capsule { .. } => "a capsule",
            };
            mark(shape, true);
            match obstacle.motion {
                ObstacleMotion::Static
                | ObstacleMotion::Pedestrian { .. }
                | ObstacleMotion::KeyFrames { .. } => {}
                ObstacleMotion::Orbit { .. } => mark("an orbit", true),
                ObstacleMotion::Patrol { .. } => mark("a patrol", true),
                ObstacleMotion::BackAndForth { .. } => mark("back and forth", true),
                ObstacleMotion::RandomWalk { .. } => mark("a random walk", true),
            }
        }
        for rule in [&scenario.starts, &scenario.goals] {
            let rule = match rule {
                PlacementRule::Random { .. } => "random starts or goals",
                PlacementRule::Within { .. } => "starts or goals within a region",
                PlacementRule::Fixed { .. } => "a fixed start or goal",
                PlacementRule::OneOf { .. } => "one of several starts or goals",
            };
            mark(rule, true);
        }
    }
    assert!(unused.is_empty(), "no file in scenarios/ uses {unused:?}");
}

/// Whether the benchmark route's start and goal are connected around all static obstacles, on a grid of 5 cm.
fn route_is_open(scenario: &Scenario) -> bool {
    let mut scenario = scenario.clone();
    scenario.obstacles.retain(|obstacle| obstacle.motion == ObstacleMotion::Static);
    let side = 0.05_f32;
    let (low, high) = scenario.enclosure.bounds_m();
    let columns = ((high.x - low.x) / side) as usize + 1;
    let rows = ((high.y - low.y) / side) as usize + 1;
    let position = |column: usize, row: usize| vec2(low.x + column as f32 * side, low.y + row as f32 * side);
    let cell =
        |Vec2 { x, y }: Vec2| (((x - low.x) / side).round() as usize, ((y - low.y) / side).round() as usize);
    let free = |column, row| clearance(&scenario, position(column, row), 0) > scenario.task.collision_range_m;
    let route = scenario.benchmark_route.expect("every shipped scenario has a benchmark route");
    let (start, goal) = (cell(route.start_m), cell(route.goal_m));
    let mut seen = vec![false; columns * rows];
    let mut open = VecDeque::from([start]);
    while let Some((column, row)) = open.pop_front() {
        if (column, row) == goal {
            return true;
        }
        if column >= columns || row >= rows || seen[row * columns + column] || !free(column, row) {
            continue;
        }
        seen[row * columns + column] = true;
        open.extend([(column + 1, row), (column, row + 1)]);
        open.extend(column.checked_sub(1).map(|left| (left, row)));
        open.extend(row.checked_sub(1).map(|below| (column, below)));
    }
    false
}

#[test]
fn start_and_goal_of_every_benchmark_route_are_connected() {
    for (name, scenario) in shipped::scenarios() {
        for layout_seed in 0..20 {
            assert!(
                route_is_open(&scenario.with_generated_obstacles(layout_seed)),
                "{name}, layout seed {layout_seed}"
            );
            if scenario.generators.is_empty() {
                break;
            }
        }
    }
    let mut closed = shipped::scenario("doorway").expect("shipped");
    closed.walls[0].corners_m = vec![vec2(0.0, 2.0), vec2(0.0, -2.0)];
    assert!(!route_is_open(&closed), "a closed doorway blocks the route");
}

#[test]
fn the_gallery_shows_every_scenario_as_it_is_drawn_today() {
    let page = std::fs::read_to_string(project("docs/worlds.md")).expect("the file exists");
    let folder = tempfile::tempdir().expect("a folder");
    for (name, scenario) in shipped::scenarios() {
        let help =
            format!("help: renew it with wayfield --scenario {name} --plain --draw docs/worlds/{name}.png");
        assert!(page.contains(&format!("worlds/{name}.png")), "docs/worlds.md shows {name}");
        assert!(page.contains(&format!("scenarios/{name}.ron")), "docs/worlds.md names {name}");
        let drawn = folder.path().join(format!("{name}.png"));
        scenario_image::draw(&scenario, &drawn).expect("a drawing");
        let committed = project(&format!("docs/worlds/{name}.png"));
        let read = |path: &Path| image::open(path).unwrap_or_else(|e| panic!("{help}: {e}")).to_rgb8();
        let (drawn, committed) = (read(&drawn), read(&committed));
        assert_eq!((committed.width(), committed.height()), (480, 360), "{help}");
        // The sine of another machine may move a corner by a pixel.
        let changed = drawn.pixels().zip(committed.pixels()).filter(|(a, b)| a != b).count();
        assert!(changed < 200, "{changed} pixels differ; {help}");
    }
}

#[test]
fn every_scenario_can_be_trained_in() {
    let preset = shipped::preset("fast").expect("shipped");
    for (name, scenario) in shipped::scenarios() {
        let scenario = Arc::new(scenario);
        let inputs = observation::width(scenario.lidar.beams);
        let actions = scenario.robot.motions.len();
        let learner =
            Learner::new(&preset.learning, inputs, actions, preset.arenas, 7).expect("a valid configuration");
        let first = learner.network().parameters().to_vec();
        let mut simulation = training_setup::training(&scenario, &preset, 7, learner, &Extensions::default());
        let mut ended = 0;
        for step in 0..600 {
            simulation.step().unwrap_or_else(|error| panic!("{name}, step {step}: {error}"));
            ended += simulation.world_mut().resource_mut::<Messages<EpisodeEnded>>().drain().count();
        }
        let learner = &simulation.world().resource::<ActiveLearner>().0;
        let weights = learner.network().parameters();
        assert!(weights.iter().all(|weight| weight.is_finite()), "{name}");
        assert_ne!(weights, first, "{name}: the weights have changed");
        assert!(learner.gradient_steps() > 1_000, "{name}: {} gradient steps", learner.gradient_steps());
        assert!(ended > 10, "{name}: {ended} episodes have ended");
    }
}
