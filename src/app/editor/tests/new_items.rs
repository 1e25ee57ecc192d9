//! New items and copies: where they are placed.

use super::*;

#[test]
fn a_new_item_is_placed_in_free_space() {
    let mut editor = editor(Scenario::default());
    for (name, shape) in Shape::templates() {
        editor.add_obstacle(shape, vec2(0.0, 0.0));
        let (mut others, k) = (Scenario::clone(editor.scenario()), editor.scenario().obstacles.len() - 1);
        assert_eq!(editor.selection(), Selection::Obstacle(k));
        let added = others.obstacles.remove(k);
        assert!(
            clearance(&others, added.position_m, 0) >= added.shape.bounding_radius_m(),
            "{name} {added:?}"
        );
        let on_grid = (added.position_m.x / 0.05).round() * 0.05;
        assert!((added.position_m.x - on_grid).abs() < 1e-5);
    }
    assert_eq!(editor.diagnostics(), [], "five items are valid");
    // Without free space the item is added all the same, with a diagnostic.
    for _ in 0..80 {
        editor.add_obstacle(new_shape("Box"), vec2(0.0, 0.0));
    }
    assert_eq!(editor.scenario().obstacles.len(), 85);
    assert!(!editor.diagnostics().is_empty());
}

#[test]
fn new_polygons_are_regular() {
    let mut editor = editor(Scenario::default());
    editor.add_obstacle(new_shape("Triangle"), vec2(1.0, -1.0));
    let corners_m = vec![vec2(0.0, 0.25), vec2(-0.217, -0.125), vec2(0.217, -0.125)];
    assert_eq!(editor.scenario().obstacles[0].shape, Shape::Polygon { corners_m });
    editor.add_obstacle(new_shape("Hexagon"), vec2(1.0, -1.0));
    let Shape::Polygon { corners_m } = &editor.scenario().obstacles[1].shape else { panic!("a polygon") };
    assert_eq!(corners_m[..3], [vec2(0.2, 0.0), vec2(0.1, 0.173), vec2(-0.1, 0.173)]);
}

#[test]
fn a_copy_is_placed_next_to_the_original() {
    let mut editor = editor(full());
    editor.select(Selection::Obstacle(1));
    editor.duplicate();
    assert_eq!(editor.selection(), Selection::Obstacle(2));
    let [_, first, copy] = &editor.scenario().obstacles[..] else { panic!("three obstacles") };
    let by = copy.position_m - first.position_m;
    assert!(by.x.hypot(by.y) >= 0.3, "they do not overlap");
    let ObstacleMotion::Patrol { waypoints_m, .. } = &copy.motion else { panic!("a patrol") };
    let expected = vec2(to_mm(1.0 + by.x), to_mm(1.5 + by.y));
    assert_eq!(waypoints_m[0], expected, "the path moves with it");
    // Pasted at a position, after the original is deleted.
    editor.select(Selection::Wall(0));
    editor.cut();
    assert!(editor.scenario().walls.is_empty() && editor.can_paste());
    editor.paste(Some(vec2(0.02, 0.51)));
    assert_eq!(editor.scenario().walls[0].corners_m, [vec2(0.0, 0.5), vec2(0.5, 0.5), vec2(0.5, 1.0)]);
    assert_eq!(editor.selection(), Selection::Wall(0));
    // Pasted repeatedly, each copy is next to the last.
    editor.paste(None);
    editor.paste(None);
    assert_eq!(editor.scenario().walls[1].corners_m[0], vec2(0.2, 0.3));
    assert_eq!(editor.scenario().walls[2].corners_m[0], vec2(0.4, 0.1));
}

#[test]
fn no_two_random_walks_have_the_same_seed() {
    let mut editor = editor(Scenario::default());
    editor.add_obstacle(new_shape("Circle"), vec2(1.0, -1.0));
    editor.set_motion(MotionKind::RandomWalk);
    editor.duplicate();
    editor.copy();
    editor.paste(None);
    editor.paste(Some(vec2(-1.0, 1.0)));
    editor.paste(None);
    editor.select(Selection::Obstacle(0));
    editor.duplicate();
    editor.select(Selection::Obstacle(0));
    editor.delete();
    editor.add_obstacle(new_shape("Circle"), vec2(1.0, 1.0));
    editor.set_motion(MotionKind::RandomWalk);
    let seed = |obstacle: &Obstacle| match obstacle.motion {
        ObstacleMotion::RandomWalk { seed, .. } => seed,
        _ => panic!("a random walk"),
    };
    let seeds: Vec<_> = editor.scenario().obstacles.iter().map(seed).collect();
    assert_eq!(seeds, [1, 2, 3, 4, 5, 6]);
}

#[test]
fn a_benchmark_route_is_added_in_free_space_and_deleted_with_both_ends() {
    let pillar = static_obstacle(Shape::Circle { radius_m: 0.3 }, vec2(-1.2, -1.2));
    let mut editor = editor(Scenario { obstacles: vec![pillar], ..Scenario::default() });
    editor.select(Selection::BenchmarkStart);
    assert!(!editor.can_delete() && editor.handles().is_empty(), "there is no route yet");
    editor.add_benchmark_route();
    assert_eq!((editor.diagnostics(), editor.selection()), (&[][..], Selection::BenchmarkGoal));
    let route = editor.scenario().benchmark_route.expect("a route");
    assert!(route.start_m != vec2(-1.2, -1.2), "the pillar is there");
    editor.delete();
    assert_eq!((editor.scenario().benchmark_route, editor.selection()), (None, Selection::Nothing));
    editor.undo();
    assert_eq!(editor.scenario().benchmark_route, Some(route));
}
