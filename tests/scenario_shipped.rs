//! The shipped worlds: each loads, teaches, can be solved, is shown in docs/worlds.md, and trains a little.

use std::collections::{BTreeSet, VecDeque};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use bevy::math::{Vec2, vec2};
use bevy::ecs::message::Messages;
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
fn every_file_of_the_folder_is_shipped_under_its_name_and_has_no_findings() {
    let entries = std::fs::read_dir(project("scenarios")).expect("the folder is there");
    let files: BTreeSet<String> =
        entries.map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned()).collect();
    let names: Vec<&str> = shipped::scenarios().map(|(name, _)| name).collect();
    assert_eq!(names.len(), 12, "{names:?}");
    assert_eq!(
        files,
        names.iter().map(|name| format!("{name}.ron")).collect::<BTreeSet<_>>(),
        "each loads, none is left out"
    );
    for (name, scenario) in shipped::scenarios() {
        assert!(diagnostics(&scenario).is_empty(), "{name}: {:?}", diagnostics(&scenario));
        let text = std::fs::read_to_string(project(&format!("scenarios/{name}.ron"))).expect("it is there");
        assert_eq!(shipped::scenario_text(name), Some(text.as_str()), "{name}");
        assert_eq!(Scenario::load(project(&format!("scenarios/{name}.ron"))), Ok(scenario.clone()));
        assert!(text.starts_with("// "), "{name}: a comment says what the file teaches");
        assert!(
            (20..=400).contains(&scenario.about.len()),
            "{name}: the window shows `about` in a few lines"
        );
        assert_eq!(scenario.lidar.beams, 24, "{name}: a policy can be taken from world to world");
        assert_eq!(scenario.robot.motions.len(), 5, "{name}: a policy can be taken from world to world");
    }
}

#[test]
fn the_shipped_worlds_show_every_part_of_the_format() {
    let mut unseen = BTreeSet::from([
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
        "a lag",
        "noise",
        "dropout",
        "latency",
        "a field of view",
        "places anywhere",
        "places within a region",
        "a fixed place",
        "one of several places",
    ]);
    let mut see = |what: &'static str, there: bool| {
        if there {
            unseen.remove(what);
        }
    };
    for (_, world) in shipped::scenarios() {
        see("a wall", !world.walls.is_empty());
        see("a polygonal enclosure", matches!(world.enclosure, Enclosure::Polygon { .. }));
        see("a generator", !world.generators.is_empty());
        see("a lag", world.robot.actuator_lag_s > 0.0);
        see("noise", world.lidar.noise_std_m > 0.0);
        see("dropout", world.lidar.dropout > 0.0);
        see("latency", world.lidar.latency_steps > 0);
        see("a field of view", !world.lidar.is_all_around());
        for obstacle in &world.obstacles {
            let shape = match obstacle.shape {
                Shape::Circle { .. } => "a circle",
                Shape::Rectangle { .. } => "a rectangle",
                Shape::Polygon { .. } => "a polygon",
                Shape::Capsule { .. } => "a capsule",
            };
            see(shape, true);
            match obstacle.motion {
                ObstacleMotion::Static => {}
                ObstacleMotion::Orbit { .. } => see("an orbit", true),
                ObstacleMotion::Patrol { .. } => see("a patrol", true),
                ObstacleMotion::BackAndForth { .. } => see("back and forth", true),
                ObstacleMotion::RandomWalk { .. } => see("a random walk", true),
            }
        }
        for rule in [&world.starts, &world.goals] {
            let rule = match rule {
                PlacementRule::Random { .. } => "places anywhere",
                PlacementRule::Within { .. } => "places within a region",
                PlacementRule::Fixed { .. } => "a fixed place",
                PlacementRule::OneOf { .. } => "one of several places",
            };
            see(rule, true);
        }
    }
    assert!(unseen.is_empty(), "no file of scenarios/ shows {unseen:?}");
}

/// Whether the robot gets from the benchmark route's start to its goal around all that stands still, on a grid of 5 cm.
fn course_is_open(world: &Scenario) -> bool {
    let mut world = world.clone();
    world.obstacles.retain(|obstacle| obstacle.motion == ObstacleMotion::Static);
    let side = 0.05_f32;
    let (low, high) = world.enclosure.bounds_m();
    let columns = ((high.x - low.x) / side) as usize + 1;
    let rows = ((high.y - low.y) / side) as usize + 1;
    let place = |column: usize, row: usize| vec2(low.x + column as f32 * side, low.y + row as f32 * side);
    let cell =
        |Vec2 { x, y }: Vec2| (((x - low.x) / side).round() as usize, ((y - low.y) / side).round() as usize);
    let free = |column, row| clearance(&world, place(column, row), 0) > world.task.collision_range_m;
    let (start, goal) = (cell(world.benchmark_route.start_m), cell(world.benchmark_route.goal_m));
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
fn the_ends_of_each_course_are_connected() {
    for (name, scenario) in shipped::scenarios() {
        for layout_seed in 0..20 {
            assert!(
                course_is_open(&scenario.with_generated_obstacles(layout_seed)),
                "{name}, layout {layout_seed}"
            );
            if scenario.generators.is_empty() {
                break;
            }
        }
    }
    let mut shut = shipped::scenario("doorway").expect("it is shipped");
    shut.walls[0].corners_m = vec![vec2(0.0, 2.0), vec2(0.0, -2.0)];
    assert!(!course_is_open(&shut), "a shut door is seen");
}

#[test]
fn the_gallery_shows_every_world_as_it_is() {
    let page = std::fs::read_to_string(project("docs/worlds.md")).expect("it is there");
    let folder = tempfile::tempdir().expect("a folder");
    for (name, scenario) in shipped::scenarios() {
        let draw_it = format!("draw it anew: wayfield --scenario {name} --draw docs/worlds/{name}.png");
        assert!(page.contains(&format!("worlds/{name}.png")), "docs/worlds.md shows {name}");
        assert!(page.contains(&format!("scenarios/{name}.ron")), "docs/worlds.md names {name}");
        let drawn = folder.path().join(format!("{name}.png"));
        scenario_image::draw(&scenario, &drawn).expect("is drawn");
        let kept = project(&format!("docs/worlds/{name}.png"));
        let read = |path: &Path| image::open(path).unwrap_or_else(|e| panic!("{draw_it}: {e}")).to_rgb8();
        let (drawn, kept) = (read(&drawn), read(&kept));
        assert_eq!((kept.width(), kept.height()), (480, 360), "{draw_it}");
        // (Another machine's sine may move a corner by a pixel.)
        let other = drawn.pixels().zip(kept.pixels()).filter(|(a, b)| a != b).count();
        assert!(other < 200, "{other} pixels are not as drawn today; {draw_it}");
    }
}

#[test]
fn every_world_trains_a_little() {
    let preset = shipped::preset("fast").expect("it is shipped");
    for (name, scenario) in shipped::scenarios() {
        let scenario = Arc::new(scenario);
        let inputs = observation::width(scenario.lidar.beams);
        let actions = scenario.robot.motions.len();
        let learner = Learner::new(&preset.learning, inputs, actions, preset.arenas, 7).expect("it is sound");
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
        assert_ne!(weights, first, "{name}: it has learnt something");
        assert!(learner.gradient_steps() > 1_000, "{name}: {} gradient steps", learner.gradient_steps());
        assert!(ended > 10, "{name}: {ended} episodes have ended");
    }
}
