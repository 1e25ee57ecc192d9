//! Drags of every handle, with results calculated by hand.

use super::*;
use bevy::math::{Vec2, vec2};

/// Drags a handle of the selected item by `by`, in two steps.
fn drag(editor: &mut Editor, kind: HandleKind, by: Vec2, free: bool) {
    let from = position(editor, kind);
    assert!(editor.begin_drag(kind, from), "{kind:?}");
    editor.drag_to(vec2(from.x + by.x / 3.0, from.y - by.y), free);
    editor.drag_to(vec2(from.x + by.x, from.y + by.y), free);
    editor.end_drag();
}

fn position(editor: &Editor, kind: HandleKind) -> Vec2 {
    let handles = editor.handles();
    handles.iter().find(|handle| handle.kind == kind).unwrap_or_else(|| panic!("{kind:?}")).position_m
}

fn with(obstacle: Obstacle) -> Editor {
    let mut editor = editor(Scenario { obstacles: vec![obstacle], ..Scenario::default() });
    editor.select(Selection::Obstacle(0));
    editor
}

fn near(a: Vec2, b: Vec2, within: f32) -> bool {
    (a.x - b.x).abs() <= within && (a.y - b.y).abs() <= within
}

#[test]
fn a_drag_is_one_undo_step_and_none_if_nothing_changed() {
    let mut editor = with(circle(1.0, -1.0));
    one_step(&mut editor, |editor| drag(editor, HandleKind::Middle, vec2(-0.3, 0.1), false));
    let revision = editor.revision();
    assert!(editor.begin_drag(HandleKind::Middle, vec2(0.7, -0.9)));
    editor.drag_to(vec2(0.75, -0.9), false);
    editor.drag_to(vec2(0.7, -0.9), false);
    editor.end_drag();
    editor.undo();
    assert!(!editor.can_undo(), "a drag back to its origin adds no undo step");
    assert_ne!(editor.revision(), revision);
    assert!(editor.begin_drag(HandleKind::Middle, vec2(1.0, -1.0)));
    editor.drag_to(vec2(0.0, 0.5), false);
    assert_ne!(editor.scenario().obstacles[0], circle(1.0, -1.0));
    editor.undo();
    assert_eq!(editor.scenario().obstacles[0], circle(1.0, -1.0), "undo during a drag cancels it");
    assert_eq!(editor.dragged(), None);
    editor.drag_to(vec2(0.0, 0.5), false);
    assert_eq!(editor.scenario().obstacles[0], circle(1.0, -1.0), "the drag has ended");
}

#[test]
fn the_centre_snaps_to_the_grid_wherever_the_item_was_pressed() {
    let mut editor = with(circle(1.0, -1.0));
    assert!(editor.begin_drag(HandleKind::Middle, vec2(1.1, -0.95)));
    editor.drag_to(vec2(1.332, -0.95), false);
    assert_eq!(editor.scenario().obstacles[0].position_m, vec2(1.25, -1.0), "1.232 is nearest to 1.25");
    editor.drag_to(vec2(1.332_4, -0.95), true);
    assert_eq!(
        editor.scenario().obstacles[0].position_m,
        vec2(1.232, -1.0),
        "without snapping, to the millimetre"
    );
    editor.drag_to(vec2(f32::NAN, 0.0), true);
    assert_eq!(editor.scenario().obstacles[0].position_m, vec2(1.232, -1.0));
}

#[test]
fn circles_and_capsules_are_resized() {
    let mut editor = with(circle(0.5, 0.0));
    drag(&mut editor, HandleKind::Radius, vec2(0.12, 0.0), false);
    assert_eq!(editor.scenario().obstacles[0].shape, Shape::Circle { radius_m: 0.25 });
    // A capsule along y, from (0, -0.5) to (0, 0.5): its right end is the upper one.
    let capsule = Obstacle {
        rotation_rad: 1.5708,
        ..static_obstacle(Shape::Capsule { length_m: 1.0, radius_m: 0.1 }, vec2(0.0, 0.0))
    };
    let mut editor = with(capsule);
    assert!(near(position(&editor, HandleKind::End(1)), vec2(0.0, 0.6), 1e-5));
    drag(&mut editor, HandleKind::End(1), vec2(0.3, 0.4), false);
    let capsule = &editor.scenario().obstacles[0];
    assert_eq!(capsule.shape, Shape::Capsule { length_m: 1.4, radius_m: 0.1 });
    assert_eq!(capsule.position_m, vec2(0.0, 0.2), "the lower end stays at -0.5");
    drag(&mut editor, HandleKind::End(-1), vec2(0.0, 5.0), false);
    let capsule = &editor.scenario().obstacles[0];
    assert_eq!(capsule.shape, Shape::Capsule { length_m: 0.05, radius_m: 0.1 }, "at least one grid step");
    assert_eq!(capsule.position_m, vec2(0.0, 0.875), "the upper end stays at 0.9");
    drag(&mut editor, HandleKind::Radius, vec2(-0.1, 0.0), false);
    assert_eq!(editor.scenario().obstacles[0].shape, Shape::Capsule { length_m: 0.05, radius_m: 0.2 });
}

#[test]
fn resizing_a_box_keeps_the_opposite_side() {
    let mut editor = with(static_obstacle(Shape::Rectangle { width_m: 0.6, height_m: 0.4 }, vec2(0.3, 0.2)));
    // Its lower left corner is (0, 0). The upper right goes to (0.95, 0.8).
    drag(&mut editor, HandleKind::Side(1, 1), vec2(0.36, 0.41), false);
    let o = &editor.scenario().obstacles[0];
    assert_eq!(o.shape, Shape::Rectangle { width_m: 0.95, height_m: 0.8 });
    assert_eq!(o.position_m, vec2(0.475, 0.4));
    drag(&mut editor, HandleKind::Side(-1, 0), vec2(0.45, 0.3), false);
    let o = &editor.scenario().obstacles[0];
    assert_eq!(o.shape, Shape::Rectangle { width_m: 0.5, height_m: 0.8 }, "a side changes one dimension");
    assert_eq!(o.position_m, vec2(0.7, 0.4));
    drag(&mut editor, HandleKind::Side(0, 1), vec2(0.0, -9.0), true);
    let o = &editor.scenario().obstacles[0];
    assert_eq!(o.shape, Shape::Rectangle { width_m: 0.5, height_m: 0.01 }, "at least one centimetre");
    assert_eq!(o.position_m, vec2(0.7, 0.005));
}

#[test]
fn resizing_a_moving_obstacle_moves_its_path() {
    let shape = Shape::Rectangle { width_m: 0.6, height_m: 0.4 };
    let motion = ObstacleMotion::Orbit { centre_m: vec2(0.3, 1.2), speed_rad_s: 0.15.into() };
    let mut editor = with(Obstacle { motion, ..static_obstacle(shape, vec2(0.3, 0.2)) });
    // The right side goes from 0.6 to 1.0, the upper side from 0.4 to 0.8: the centre moves by (0.2, 0.2).
    drag(&mut editor, HandleKind::Side(1, 1), vec2(0.4, 0.4), false);
    let o = &editor.scenario().obstacles[0];
    assert_eq!(o.position_m, vec2(0.5, 0.4));
    let expected = ObstacleMotion::Orbit { centre_m: vec2(0.5, 1.4), speed_rad_s: 0.15.into() };
    assert_eq!(o.motion, expected, "the radius is still 1 m");
    let shape = Shape::Capsule { length_m: 1.0, radius_m: 0.1 };
    let motion = ObstacleMotion::BackAndForth {
        waypoints_m: vec![vec2(0.0, 1.0), vec2(1.0, 1.0)],
        speed_m_s: 0.1.into(),
    };
    let mut editor = with(Obstacle { motion, ..static_obstacle(shape, vec2(0.0, 0.0)) });
    // The left end goes from -0.5 to -0.9.
    drag(&mut editor, HandleKind::End(-1), vec2(-0.4, 0.0), false);
    let o = &editor.scenario().obstacles[0];
    assert_eq!(o.position_m, vec2(-0.2, 0.0));
    let waypoints_m = vec![vec2(-0.2, 1.0), vec2(0.8, 1.0)];
    assert_eq!(o.motion, ObstacleMotion::BackAndForth { waypoints_m, speed_m_s: 0.1.into() });
}

#[test]
fn resizing_a_rotated_box_keeps_the_opposite_corner() {
    // 30 degrees. The lower left corner is at (1 - 0.3 cos + 0.2 sin, -0.3 sin - 0.2 cos) = (0.8402, -0.3232).
    let rotated = Obstacle {
        rotation_rad: 0.5236,
        ..static_obstacle(Shape::Rectangle { width_m: 0.6, height_m: 0.4 }, vec2(1.0, 0.0))
    };
    // The lower left corner (-1) or the upper right one (1).
    let corner = |editor: &Editor, side: f32| {
        let o = &editor.scenario().obstacles[0];
        let Shape::Rectangle { width_m, height_m } = o.shape else { panic!("a box") };
        let ((sin, cos), (x, y)) = (o.rotation_rad.sin_cos(), (side * width_m / 2.0, side * height_m / 2.0));
        vec2(o.position_m.x + x * cos - y * sin, o.position_m.y + x * sin + y * cos)
    };
    let mut editor = with(rotated);
    assert!(near(corner(&editor, -1.0), vec2(0.8402, -0.3232), 1e-4));
    // By 0.4 along its own x, and 0.1 along its own y: (0.4 cos - 0.1 sin, 0.4 sin + 0.1 cos).
    drag(&mut editor, HandleKind::Side(1, 1), vec2(0.2964, 0.2866), false);
    let o = &editor.scenario().obstacles[0];
    assert_eq!(o.shape, Shape::Rectangle { width_m: 1.0, height_m: 0.5 });
    assert!(near(corner(&editor, -1.0), vec2(0.8402, -0.3232), 6e-4), "up to rounding to 1 mm");
    // Dragging the lower left corner keeps the upper right one.
    let fixed = corner(&editor, 1.0);
    drag(&mut editor, HandleKind::Side(-1, -1), vec2(0.1, 0.3), true);
    assert!(near(corner(&editor, 1.0), fixed, 6e-4));
    let after = Arc::clone(editor.scenario());
    // Errors do not add up while the pointer moves back and forth.
    assert!(editor.begin_drag(HandleKind::Side(-1, 0), vec2(0.0, 0.0)));
    for k in 0..200 {
        editor.drag_to(vec2(0.01 * (k % 7) as f32, 0.02), true);
    }
    editor.drag_to(vec2(0.0, 0.0), true);
    editor.end_drag();
    assert_eq!(*editor.scenario(), after);
}

#[test]
fn rotation_snaps_to_fifteen_degrees_wherever_the_drag_began() {
    let mut editor = with(static_obstacle(Shape::Rectangle { width_m: 0.6, height_m: 0.4 }, vec2(1.0, 0.0)));
    assert_eq!(editor.rotation_of(), Some((vec2(1.0, 0.0), 0.0)));
    // Dragged from 90 to 128 degrees: 38 degrees, snapped to 45.
    assert!(editor.begin_drag(HandleKind::Rotate, vec2(1.0, 2.0)));
    let at = |degrees: f32| vec2(1.0 + degrees.to_radians().cos(), degrees.to_radians().sin());
    editor.drag_to(at(128.0), false);
    assert_eq!(editor.scenario().obstacles[0].rotation_rad, 0.7854);
    editor.drag_to(at(128.0), true);
    assert_eq!(editor.scenario().obstacles[0].rotation_rad, 0.6632);
    editor.drag_to(at(-60.0), false);
    assert_eq!(editor.scenario().obstacles[0].rotation_rad, -2.618, "150 degrees clockwise");
    editor.end_drag();
    // A circle cannot be rotated.
    assert!(!with(circle(0.5, 0.5)).begin_drag(HandleKind::Rotate, vec2(0.6, 0.5)));
}

#[test]
fn corners_of_a_polygon_are_dragged_inserted_and_removed() {
    let corners_m = vec![vec2(-0.2, -0.2), vec2(0.2, -0.2), vec2(0.0, 0.2)];
    let triangle =
        Obstacle { rotation_rad: 1.5708, ..static_obstacle(Shape::Polygon { corners_m }, vec2(1.0, 0.0)) };
    let mut editor = with(triangle);
    // In world coordinates: (1.2, -0.2), (1.2, 0.2), (0.8, 0).
    assert!(near(position(&editor, HandleKind::Corner(2)), vec2(0.8, 0.0), 1e-5));
    drag(&mut editor, HandleKind::Corner(2), vec2(-0.1, 0.05), false);
    let corners = |editor: &Editor| match &editor.scenario().obstacles[0].shape {
        Shape::Polygon { corners_m } => corners_m.clone(),
        _ => Vec::new(),
    };
    assert_eq!(corners(&editor)[2], vec2(0.05, 0.3), "in local coordinates");
    // A new corner between the first two, dragged from (1.2, 0) to (1.3, 0).
    let after = one_step(&mut editor, |editor| {
        assert!(editor.begin_drag(HandleKind::InsertCorner(1), vec2(1.2, 0.0)));
        assert_eq!(editor.dragged(), Some(HandleKind::Corner(1)));
        editor.drag_to(vec2(1.3, 0.0), false);
        editor.end_drag();
    });
    let Shape::Polygon { corners_m } = &after.obstacles[0].shape else { panic!("a polygon") };
    assert_eq!(corners_m[..], [vec2(-0.2, -0.2), vec2(0.0, -0.3), vec2(0.2, -0.2), vec2(0.05, 0.3)]);
    assert!(editor.remove_handle(HandleKind::Corner(1)));
    assert_eq!(corners(&editor).len(), 3);
    assert!(!editor.remove_handle(HandleKind::Corner(1)), "a polygon keeps three corners");
    // Cancelling the drag removes the inserted corner.
    editor.begin_drag(HandleKind::InsertCorner(3), vec2(0.0, 0.0));
    assert_eq!(corners(&editor).len(), 4);
    editor.cancel_drag();
    assert_eq!(corners(&editor).len(), 3);
}

#[test]
fn a_wall_is_dragged_by_its_corners_or_as_a_whole() {
    let mut editor = editor(full());
    editor.select(Selection::Wall(0));
    let kinds: Vec<_> = editor.handles().iter().map(|handle| handle.kind).collect();
    use HandleKind::{Corner, InsertCorner};
    assert_eq!(kinds, [InsertCorner(1), InsertCorner(2), Corner(0), Corner(1), Corner(2)]);
    drag(&mut editor, HandleKind::Corner(1), vec2(0.26, 0.0), false);
    drag(&mut editor, HandleKind::InsertCorner(2), vec2(0.0, 0.2), false);
    let corners = |editor: &Editor| editor.scenario().walls[0].corners_m.clone();
    // The middle of (-0.75, 0.5) and (-1, 1) is (-0.875, 0.75); 0.2 up and snapped; halves round away from zero.
    let [first, second, third, fourth] = corners(&editor)[..] else { panic!("four corners") };
    assert_eq!((first, second, fourth), (vec2(-1.5, 0.5), vec2(-0.75, 0.5), vec2(-1.0, 1.0)));
    assert!(near(third, vec2(-0.875, 0.95), 0.026));
    // As a whole: the first corner snaps, the others keep their offsets.
    let before = corners(&editor);
    assert!(editor.begin_drag(HandleKind::Middle, vec2(-1.2, 0.5)));
    editor.drag_to(vec2(-0.98, 0.21), false);
    editor.end_drag();
    for (corner, before) in corners(&editor).iter().zip(before) {
        assert!(near(*corner, vec2(before.x + 0.2, before.y - 0.3), 1e-5), "{corner:?} {before:?}");
    }
    assert!(editor.remove_handle(Corner(0)) && editor.remove_handle(Corner(0)));
    assert!(!editor.remove_handle(Corner(0)), "a wall keeps two corners");
    let corner = corners(&editor)[0];
    assert!(editor.begin_drag(Corner(0), corner));
    editor.drag_to(corner + vec2(0.4, 0.0), false);
    assert!(!editor.remove_handle(Corner(0)), "two corners remain: only the drag ends");
    assert_ne!(corners(&editor)[0], corner, "the drag has moved it");
}

#[test]
fn a_wall_of_cells_is_picked_dragged_copied_and_deleted_as_a_whole() {
    let rows = vec!["#.".to_owned(), "##".to_owned()];
    let cells = WallCells::new(rows, 0.5, vec2(1.0, 1.0));
    let wall = Wall { cells: Some(cells.clone()), ..Wall::default() };
    let mut editor = editor(Scenario { walls: vec![wall], ..Scenario::default() });
    let at = |point| editor.pick(point, 0.02);
    assert_eq!((at(vec2(0.75, 1.25)), at(vec2(1.25, 1.25))), (Selection::Wall(0), Selection::Nothing));
    editor.select(Selection::Wall(0));
    assert!(editor.handles().is_empty() && editor.begin_drag(HandleKind::Middle, vec2(0.75, 0.75)));
    editor.drag_to(vec2(0.25, 0.25), false);
    editor.end_drag();
    let found = |editor: &Editor, wall: usize| editor.scenario().walls[wall].cells.clone();
    assert_eq!(found(&editor, 0), Some(cells.clone().with_centre(vec2(0.5, 0.5))));
    editor.duplicate();
    assert_eq!(found(&editor, 1).map(|copy| copy.rows().to_vec()), Some(cells.rows().to_vec()));
    one_step(&mut editor, Editor::delete);
    assert_eq!(editor.scenario().walls.len(), 1);
}

#[test]
fn a_path_is_dragged_by_its_waypoints_or_as_a_whole() {
    let mut editor = editor(full());
    editor.select(Selection::Obstacle(1));
    assert_eq!(
        full().obstacles[1].path_m(),
        Some((vec![vec2(1.0, 0.0), vec2(1.0, 1.5), vec2(0.5, 1.5)], true))
    );
    drag(&mut editor, HandleKind::Waypoint(0), vec2(0.3, -0.1), false);
    drag(&mut editor, HandleKind::PathStart, vec2(0.1, 0.1), false);
    drag(&mut editor, HandleKind::InsertWaypoint(2), vec2(-0.2, 0.0), false);
    let path = |editor: &Editor| editor.scenario().obstacles[1].path_m().expect("a path").0;
    // Halfway between (0.5, 1.5) and (1.1, 0.1) is (0.8, 0.8).
    assert_eq!(path(&editor), [vec2(1.1, 0.1), vec2(1.3, 1.4), vec2(0.5, 1.5), vec2(0.6, 0.8)]);
    drag(&mut editor, HandleKind::Middle, vec2(-0.1, -0.1), false);
    assert_eq!(path(&editor), [vec2(1.0, 0.0), vec2(1.2, 1.3), vec2(0.4, 1.4), vec2(0.5, 0.7)]);
    for left in [2, 1] {
        assert!(editor.remove_handle(HandleKind::Waypoint(0)));
        assert_eq!(path(&editor).len(), 1 + left);
    }
    assert!(!editor.remove_handle(HandleKind::Waypoint(0)), "a path keeps one waypoint");
    let kinds: Vec<_> = editor.handles().iter().map(|handle| handle.kind).filter(|k| k.is_insert()).collect();
    assert_eq!(kinds, [HandleKind::InsertWaypoint(0)], "one leg, there and back");
}

#[test]
fn dragged_key_frames_keep_their_times() {
    let mut editor = editor(full());
    editor.select(Selection::Obstacle(1));
    // The patrol from (1, 0) via (1, 1.5) and (0.5, 1.5) at 0.1 m/s.
    editor.set_motion(MotionKind::KeyFrames);
    let frames = |editor: &Editor| match &editor.scenario().obstacles[1].motion {
        ObstacleMotion::KeyFrames { frames, .. } => {
            frames.iter().map(|frame| (frame.time_s, frame.position_m)).collect::<Vec<_>>()
        }
        other => panic!("{other:?}"),
    };
    assert_eq!(frames(&editor), [(15.0, vec2(1.0, 1.5)), (20.0, vec2(0.5, 1.5))]);
    drag(&mut editor, HandleKind::Waypoint(0), vec2(0.3, -0.1), false);
    drag(&mut editor, HandleKind::InsertWaypoint(1), vec2(-0.2, 0.0), false);
    let changed = [(15.0, vec2(1.3, 1.4)), (17.5, vec2(0.7, 1.45)), (20.0, vec2(0.5, 1.5))];
    assert_eq!(frames(&editor), changed);
    assert!(editor.remove_handle(HandleKind::Waypoint(0)) && editor.remove_handle(HandleKind::Waypoint(0)));
    assert!(!editor.remove_handle(HandleKind::Waypoint(0)), "one frame remains");
    drag(&mut editor, HandleKind::Middle, vec2(-0.1, 0.0), false);
    assert_eq!(frames(&editor), [(20.0, vec2(0.4, 1.5))]);
    editor.set_motion(MotionKind::Patrol);
    assert_eq!(editor.scenario().obstacles[1].path_m(), Some((vec![vec2(0.9, 0.0), vec2(0.4, 1.5)], true)));
}

#[test]
fn the_centre_of_an_orbit_and_the_radius_of_a_random_walk_are_dragged() {
    let motion = ObstacleMotion::Orbit { centre_m: vec2(0.0, 0.0), speed_rad_s: 0.15.into() };
    let mut editor = with(Obstacle { motion, ..circle(0.6, 0.8) });
    let text = |editor: &Editor, kind| {
        editor.handles().into_iter().find(|handle| handle.kind == kind).map(|handle| handle.text)
    };
    assert_eq!(text(&editor, HandleKind::Centre).as_deref(), Some("r 1.00 m"));
    drag(&mut editor, HandleKind::Centre, vec2(0.0, 0.52), false);
    let expected = ObstacleMotion::Orbit { centre_m: vec2(0.0, 0.5), speed_rad_s: 0.15.into() };
    assert_eq!(editor.scenario().obstacles[0].motion, expected);
    drag(&mut editor, HandleKind::Middle, vec2(0.1, 0.0), false);
    let expected = ObstacleMotion::Orbit { centre_m: vec2(0.1, 0.5), speed_rad_s: 0.15.into() };
    assert_eq!(editor.scenario().obstacles[0].motion, expected, "the orbit moves with the obstacle");
    let motion = ObstacleMotion::RandomWalk { radius_m: 0.5, speed_m_s: 0.1.into(), seed: 0 };
    let mut editor = with(Obstacle { motion, ..circle(0.6, 0.8) });
    drag(&mut editor, HandleKind::Reach, vec2(0.0, -0.2), false);
    assert_eq!(text(&editor, HandleKind::Reach).as_deref(), Some("0.30 m"));
}

#[test]
fn a_rectangular_enclosure_keeps_its_centre_and_a_polygon_is_dragged_by_corners() {
    let mut editor = editor(Scenario::default());
    editor.select(Selection::Enclosure);
    drag(&mut editor, HandleKind::Side(1, 0), vec2(0.5, 0.7), false);
    assert_eq!(editor.scenario().enclosure, Enclosure::Rectangle { width_m: 5.0, height_m: 4.0 });
    drag(&mut editor, HandleKind::Side(-1, -1), vec2(9.0, 0.5), false);
    assert_eq!(editor.scenario().enclosure, Enclosure::Rectangle { width_m: 0.5, height_m: 3.0 });
    editor.set_enclosure(EnclosureKind::Polygon);
    assert!(editor.begin_drag(HandleKind::InsertCorner(4), vec2(-0.25, 0.0)));
    editor.drag_to(vec2(-2.0, 0.1), false);
    editor.end_drag();
    let Enclosure::Polygon { corners_m } = &editor.scenario().enclosure else { panic!("a polygon") };
    assert_eq!(corners_m[3..], [vec2(-0.25, 1.5), vec2(-2.0, 0.1)]);
    assert!(!editor.begin_drag(HandleKind::Middle, vec2(0.0, 0.0)), "the enclosure cannot be moved");
}

#[test]
fn regions_are_moved_and_resized() {
    let mut editor = editor(full());
    editor.select(Selection::Generator(0));
    drag(&mut editor, HandleKind::Side(1, 1), vec2(0.52, 0.31), false);
    drag(&mut editor, HandleKind::Middle, vec2(0.0, -0.5), false);
    let region = editor.scenario().generators[0].within;
    assert_eq!(region, Some(Region { min_m: vec2(-1.0, -1.0), max_m: vec2(0.5, -0.2) }));
    drag(&mut editor, HandleKind::Side(-1, 0), vec2(9.0, 0.0), false);
    let region = editor.scenario().generators[0].within;
    assert_eq!(
        region,
        Some(Region { min_m: vec2(0.45, -1.0), max_m: vec2(0.5, -0.2) }),
        "at least one grid step"
    );
    editor.set_rule(PlacementRole::Starts, PlacementKind::Within);
    drag(&mut editor, HandleKind::Side(0, -1), vec2(0.0, 0.5), false);
    let (min_m, max_m) = (vec2(-1.0, -0.5), vec2(1.0, 1.0));
    assert_eq!(editor.scenario().starts, PlacementRule::Within { min_m, max_m, clearance_m: 0.35 });
    editor.edit("anywhere", |s| s.generators[0].within = None);
    editor.select(Selection::Generator(0));
    assert!(!editor.begin_drag(HandleKind::Middle, vec2(0.0, 0.0)) && editor.handles().is_empty());
}

#[test]
fn given_positions_and_the_ends_of_the_benchmark_route_are_dragged() {
    let mut editor = editor(full());
    editor.select(Selection::Goals);
    drag(&mut editor, HandleKind::Position(1), vec2(-0.5, 0.1), false);
    assert_eq!(
        editor.scenario().goals,
        PlacementRule::OneOf { positions_m: vec![vec2(0.0, 1.5), vec2(1.0, -1.4)] }
    );
    assert!(editor.remove_handle(HandleKind::Position(0)) && !editor.remove_handle(HandleKind::Position(0)));
    editor.select(Selection::BenchmarkGoal);
    drag(&mut editor, HandleKind::Middle, vec2(0.1, -0.2), false);
    assert_eq!(editor.scenario().benchmark_route.expect("a benchmark route").goal_m, vec2(1.3, 1.0));
    editor.select(Selection::BenchmarkStart);
    drag(&mut editor, HandleKind::Rotate, vec2(-0.3, 0.3), false);
    assert_eq!(editor.scenario().benchmark_route.expect("a benchmark route").heading_rad, 1.5708);
    editor.edit("fixed", |s| {
        s.starts = PlacementRule::Fixed { position_m: vec2(0.0, -1.0), heading_rad: Some(0.0) }
    });
    editor.select(Selection::Starts);
    drag(&mut editor, HandleKind::Rotate, vec2(-0.3, -0.3), false);
    // The start can also be dragged by its body.
    assert!(editor.begin_drag(HandleKind::Middle, vec2(0.05, -1.0)));
    editor.drag_to(vec2(0.55, -1.2), false);
    editor.end_drag();
    let expected = PlacementRule::Fixed { position_m: vec2(0.5, -1.2), heading_rad: Some(-1.5708) };
    assert_eq!(editor.scenario().starts, expected);
}

#[test]
fn every_handle_can_be_dragged() {
    let mut scenario = full();
    scenario
        .obstacles
        .push(static_obstacle(Shape::Rectangle { width_m: 0.3, height_m: 0.2 }, vec2(0.5, -1.0)));
    scenario
        .obstacles
        .push(static_obstacle(Shape::Capsule { length_m: 0.3, radius_m: 0.1 }, vec2(0.5, -1.5)));
    let motion = ObstacleMotion::Orbit { centre_m: vec2(0.0, 0.0), speed_rad_s: 0.1.into() };
    scenario.obstacles.push(Obstacle { motion, ..circle(0.0, 1.0) });
    let motion = ObstacleMotion::RandomWalk { radius_m: 0.2, speed_m_s: 0.1.into(), seed: 0 };
    scenario.obstacles.push(Obstacle { motion, ..circle(0.0, -1.0) });
    scenario.starts =
        PlacementRule::Within { min_m: vec2(-1.0, -1.0), max_m: vec2(1.0, 1.0), clearance_m: 0.2 };
    let obstacles = (0..scenario.obstacles.len()).map(Selection::Obstacle);
    let others = [
        Selection::Enclosure,
        Selection::Wall(0),
        Selection::Generator(0),
        Selection::Starts,
        Selection::Goals,
        Selection::BenchmarkStart,
        Selection::BenchmarkGoal,
    ];
    let mut dragged = 0;
    for selection in obstacles.chain(others) {
        let mut editor = editor(scenario.clone());
        editor.select(selection);
        for handle in editor.handles() {
            assert!(editor.begin_drag(handle.kind, handle.position_m), "{handle:?}");
            editor.drag_to(vec2(handle.position_m.x + 0.31, handle.position_m.y + 0.37), false);
            assert!(editor.scenario().as_ref() != &scenario, "{selection:?} {handle:?}");
            editor.cancel_drag();
            assert_eq!(**editor.scenario(), scenario, "{handle:?}");
            assert!(!handle.text.is_empty() && !handle.about.is_empty());
            dragged += 1;
        }
    }
    assert!(dragged > 50, "{dragged}");
}

#[test]
fn dragging_a_rule_by_its_body_drags_the_nearest_position() {
    let mut editor = editor(full());
    editor.select(Selection::Goals);
    assert!(editor.begin_drag(HandleKind::Middle, vec2(1.45, -1.5)));
    assert_eq!(editor.dragged(), Some(HandleKind::Position(1)));
    editor.drag_to(vec2(1.25, -1.5), false);
    editor.end_drag();
    assert_eq!(
        editor.scenario().goals,
        PlacementRule::OneOf { positions_m: vec![vec2(0.0, 1.5), vec2(1.3, -1.5)] }
    );
}
