//! The document as a whole: every operation, and undo.
#![expect(clippy::approx_constant, reason = "angles are stored with four decimals")]

mod drags;
mod random_edits;
mod saving;
mod tools;

use std::path::Path;
use std::sync::Arc;

use bevy::math::{Vec2, vec2};

use super::limits::item_count;
use super::points::to_mm;
use super::*;
use crate::scenario::{
    Diagnostic, Enclosure, Generator, Obstacle, ObstacleMotion, PlacementRule, RandomShape, Region, Scenario,
    Shape, Wall, clearance, diagnostics, parse_ron, to_ron,
};

/// An editor of a scenario opened from a file.
fn editor(scenario: Scenario) -> Editor {
    Editor::open(Arc::new(scenario), "scenarios/mine.ron".into(), true)
}

fn static_obstacle(shape: Shape, position_m: Vec2) -> Obstacle {
    Obstacle { shape, position_m, rotation_rad: 0.0, motion: ObstacleMotion::Static }
}

fn circle(x: f32, y: f32) -> Obstacle {
    static_obstacle(Shape::Circle { radius_m: 0.15 }, vec2(x, y))
}

/// A scenario with one item of every kind.
fn full() -> Scenario {
    let patrol = ObstacleMotion::Patrol { waypoints_m: vec![vec2(1.0, 1.5), vec2(0.5, 1.5)], speed_m_s: 0.1 };
    Scenario {
        obstacles: vec![circle(-1.0, -1.0), Obstacle { motion: patrol, ..circle(1.0, 0.0) }],
        walls: vec![Wall {
            corners_m: vec![vec2(-1.5, 0.5), vec2(-1.0, 0.5), vec2(-1.0, 1.0)],
            thickness_m: 0.1,
        }],
        generators: vec![Generator {
            count: 2,
            shape: RandomShape::Circle { radius_m: (0.05, 0.1) },
            gap_m: 0.4,
            within: Some(Region { min_m: vec2(-1.0, -0.5), max_m: vec2(0.0, 0.0) }),
        }],
        goals: PlacementRule::OneOf { positions_m: vec![vec2(0.0, 1.5), vec2(1.5, -1.5)] },
        ..Scenario::default()
    }
}

/// Asserts that `change` is one undo step. Returns the scenario after it.
fn one_step(editor: &mut Editor, change: impl FnOnce(&mut Editor)) -> Scenario {
    let (before, revision) = (Arc::clone(editor.scenario()), editor.revision());
    change(editor);
    let after = Arc::clone(editor.scenario());
    assert_ne!(before, after, "the change has an effect");
    assert_ne!(editor.revision(), revision);
    editor.undo();
    assert_eq!(*editor.scenario(), before, "one undo restores the scenario");
    editor.redo();
    assert_eq!(*editor.scenario(), after, "one redo repeats the change");
    Scenario::clone(&after)
}

#[test]
fn every_operation_is_one_undo_step() {
    type Change = fn(&mut Editor);
    let changes: [(Selection, Change); 17] = [
        (Selection::Nothing, |e| e.add(NewItem::Circle, vec2(0.0, 0.0))),
        (Selection::Nothing, |e| e.add(NewItem::Generator, vec2(0.0, 0.0))),
        (Selection::Obstacle(1), Editor::duplicate),
        (Selection::Wall(0), Editor::duplicate),
        (Selection::Generator(0), Editor::duplicate),
        (Selection::Obstacle(0), Editor::delete),
        (Selection::Wall(0), Editor::delete),
        (Selection::Generator(0), Editor::delete),
        (Selection::Goals, Editor::delete),
        (Selection::Obstacle(0), Editor::cut),
        (Selection::Obstacle(0), |e| e.nudge(1, 0, false)),
        (Selection::Obstacle(0), |e| e.set_motion(MotionKind::Orbit)),
        (Selection::Nothing, |e| e.set_rule(PlacementRole::Starts, PlacementKind::Within)),
        (Selection::Nothing, |e| e.set_enclosure(EnclosureKind::Polygon)),
        (Selection::Nothing, |e| e.edit("name", |s| s.name = "Mine".into())),
        (Selection::Obstacle(1), |e| assert!(e.remove_handle(HandleKind::Waypoint(0)))),
        (Selection::Goals, |e| assert!(e.remove_handle(HandleKind::Position(1)))),
    ];
    for (selection, change) in changes {
        let mut editor = editor(full());
        editor.select(selection);
        one_step(&mut editor, change);
    }
}

#[test]
fn many_steps_can_be_undone_and_redone() {
    let mut editor = editor(full());
    let first = Arc::clone(editor.scenario());
    let mut versions = vec![Arc::clone(&first)];
    for k in 0..40 {
        match k % 4 {
            0 => editor.add(NewItem::Box, vec2(0.3, 0.3)),
            1 => editor.nudge(1, 2, true),
            2 => editor.duplicate(),
            _ => editor.delete(),
        }
        versions.push(Arc::clone(editor.scenario()));
    }
    for version in versions.iter().rev().skip(1) {
        editor.undo();
        assert_eq!(editor.scenario(), version);
    }
    assert!(!editor.can_undo() && !editor.is_modified());
    for version in &versions[1..] {
        editor.redo();
        assert_eq!(editor.scenario(), version);
    }
    assert!(!editor.can_redo());
    editor.undo();
    editor.add(NewItem::Circle, vec2(0.0, 0.0));
    assert!(!editor.can_redo(), "a new change drops the steps to redo");
}

#[test]
fn typing_in_a_field_is_one_step_until_another_field() {
    let mut editor = editor(full());
    editor.select(Selection::Obstacle(0));
    for width in [1.0, 1.2, 1.25] {
        editor.edit("wall 0 thickness", |s| s.walls[0].thickness_m = width);
    }
    editor.edit("goal", |s| s.task.goal_radius_m = 0.3);
    editor.edit("goal", |s| s.task.goal_radius_m = 0.3);
    editor.close_group();
    editor.edit("goal", |s| s.task.goal_radius_m = 0.25);
    editor.undo();
    assert_eq!(editor.scenario().task.goal_radius_m, 0.3, "the group was closed in between");
    editor.undo();
    assert_eq!((editor.scenario().task.goal_radius_m, editor.scenario().walls[0].thickness_m), (0.2, 1.25));
    editor.undo();
    assert_eq!(editor.scenario().walls[0].thickness_m, 0.1);
    assert!(!editor.can_undo(), "an edit without effect is no step");
    // The same field after another selection is another step.
    editor.edit("radius", |s| s.robot.radius_m = 0.11);
    editor.select(Selection::Obstacle(1));
    editor.edit("radius", |s| s.robot.radius_m = 0.12);
    editor.undo();
    assert_eq!(editor.scenario().robot.radius_m, 0.11);
}

#[test]
fn undo_restores_the_selection_if_its_item_exists() {
    let mut editor = editor(full());
    editor.select(Selection::Obstacle(1));
    editor.delete();
    assert_eq!(editor.selection(), Selection::Nothing);
    editor.undo();
    assert_eq!(editor.selection(), Selection::Obstacle(1));
    editor.add(NewItem::Circle, vec2(0.0, 0.0));
    assert_eq!(editor.selection(), Selection::Obstacle(2));
    editor.undo();
    assert_eq!(editor.selection(), Selection::Obstacle(1));
    editor.select(Selection::Obstacle(7));
    assert_eq!(editor.selection(), Selection::Nothing);
}

#[test]
fn a_new_item_is_placed_in_free_space() {
    let mut editor = editor(Scenario::default());
    for item in [NewItem::Circle, NewItem::Box, NewItem::Capsule, NewItem::Triangle, NewItem::Hexagon] {
        editor.add(item, vec2(0.0, 0.0));
        let (mut others, k) = (Scenario::clone(editor.scenario()), editor.scenario().obstacles.len() - 1);
        assert_eq!(editor.selection(), Selection::Obstacle(k));
        let added = others.obstacles.remove(k);
        assert!(
            clearance(&others, added.position_m, 0) >= added.shape.bounding_radius_m(),
            "{item:?} {added:?}"
        );
        let on_grid = (added.position_m.x / 0.05).round() * 0.05;
        assert!((added.position_m.x - on_grid).abs() < 1e-5);
    }
    assert_eq!(editor.diagnostics(), [], "five items are valid");
    // Without free space the item is added all the same, with a diagnostic.
    for _ in 0..80 {
        editor.add(NewItem::Box, vec2(0.0, 0.0));
    }
    assert_eq!(editor.scenario().obstacles.len(), 85);
    assert!(!editor.diagnostics().is_empty());
}

#[test]
fn new_polygons_are_regular() {
    let mut editor = editor(Scenario::default());
    editor.add(NewItem::Triangle, vec2(1.0, -1.0));
    let corners_m = vec![vec2(0.0, 0.25), vec2(-0.217, -0.125), vec2(0.217, -0.125)];
    assert_eq!(editor.scenario().obstacles[0].shape, Shape::Polygon { corners_m });
    editor.add(NewItem::Hexagon, vec2(1.0, -1.0));
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
    // To a position, after the original is deleted.
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
fn copies_of_a_random_walk_have_other_seeds() {
    let mut editor = editor(Scenario::default());
    editor.add(NewItem::Circle, vec2(1.0, -1.0));
    editor.set_motion(MotionKind::RandomWalk);
    editor.duplicate();
    editor.copy();
    editor.paste(None);
    editor.paste(Some(vec2(-1.0, 1.0)));
    editor.paste(None);
    let seed = |obstacle: &Obstacle| match obstacle.motion {
        ObstacleMotion::RandomWalk { seed, .. } => seed,
        _ => panic!("a random walk"),
    };
    let seeds: Vec<_> = editor.scenario().obstacles.iter().map(seed).collect();
    assert_eq!(seeds, [0, 1, 2, 3, 4]);
}

#[test]
fn every_new_motion_fits_the_scenario() {
    for at in [vec2(0.0, -0.6), vec2(-1.7, -1.7), vec2(1.0, 1.8), vec2(0.6, 0.0)] {
        for kind in MotionKind::ALL {
            for shape in [Shape::Circle { radius_m: 0.1 }, Shape::Rectangle { width_m: 0.2, height_m: 0.1 }] {
                let mut scenario =
                    Scenario { obstacles: vec![static_obstacle(shape, at)], ..Scenario::default() };
                scenario.benchmark_route.start_m = vec2(-1.5, 1.5);
                scenario.benchmark_route.goal_m = vec2(-1.5, 0.5);
                let mut editor = editor(scenario);
                editor.select(Selection::Obstacle(0));
                editor.set_motion(kind);
                assert_eq!(MotionKind::from_motion(&editor.scenario().obstacles[0].motion), kind);
                let of_obstacles = |problem: &&Diagnostic| problem.path.starts_with("obstacles");
                assert_eq!(editor.diagnostics().iter().find(of_obstacles), None, "{kind:?} at {at:?}");
            }
        }
    }
}

#[test]
fn changing_between_patrol_and_back_and_forth_keeps_the_path() {
    let mut editor = editor(full());
    editor.select(Selection::Obstacle(1));
    editor.set_motion(MotionKind::BackAndForth);
    let expected =
        ObstacleMotion::BackAndForth { waypoints_m: vec![vec2(1.0, 1.5), vec2(0.5, 1.5)], speed_m_s: 0.1 };
    assert_eq!(editor.scenario().obstacles[1].motion, expected);
    editor.set_motion(MotionKind::Patrol);
    assert_eq!(editor.scenario().obstacles[1], full().obstacles[1]);
}

#[test]
fn a_new_orbit_is_centred_in_the_scenario_if_it_fits() {
    let mut editor = editor(full());
    editor.select(Selection::Obstacle(0));
    editor.set_motion(MotionKind::Orbit);
    let expected = ObstacleMotion::Orbit { centre_m: vec2(0.0, 0.0), speed_rad_s: 0.15 };
    assert_eq!(editor.scenario().obstacles[0].motion, expected);
    // From so far out it would cross the boundary; half a metre to the left it fits.
    editor.edit("x", |s| s.obstacles[0] = circle(1.5, 1.3));
    editor.set_motion(MotionKind::Orbit);
    let expected = ObstacleMotion::Orbit { centre_m: vec2(1.0, 1.3), speed_rad_s: 0.15 };
    assert_eq!(editor.scenario().obstacles[0].motion, expected);
}

#[test]
fn changing_a_rule_keeps_what_both_kinds_have() {
    let mut editor = editor(full());
    editor.set_rule(PlacementRole::Goals, PlacementKind::Fixed);
    assert_eq!(editor.selection(), Selection::Goals);
    assert_eq!(
        editor.scenario().goals,
        PlacementRule::Fixed { position_m: vec2(0.0, 1.5), heading_rad: None }
    );
    editor.set_rule(PlacementRole::Goals, PlacementKind::OneOf);
    assert_eq!(editor.scenario().goals, PlacementRule::OneOf { positions_m: vec![vec2(0.0, 1.5)] });
    editor.edit("clearance", |s| s.starts = PlacementRule::Random { clearance_m: 0.5 });
    editor.set_rule(PlacementRole::Starts, PlacementKind::Within);
    let (min_m, max_m) = (vec2(-1.0, -1.0), vec2(1.0, 1.0));
    assert_eq!(editor.scenario().starts, PlacementRule::Within { min_m, max_m, clearance_m: 0.5 });
    editor.set_rule(PlacementRole::Starts, PlacementKind::Fixed);
    assert_eq!(
        editor.scenario().starts,
        PlacementRule::Fixed { position_m: vec2(0.0, 0.0), heading_rad: None }
    );
    editor.delete();
    assert_eq!(editor.scenario().starts, PlacementRule::default());
    assert!(!editor.can_delete(), "the default rule cannot be deleted");
}

#[test]
fn an_enclosure_can_become_a_polygon_and_a_rectangle_again() {
    let mut editor = editor(full());
    editor.set_enclosure(EnclosureKind::Polygon);
    let corners_m = vec![vec2(-2.0, -2.0), vec2(2.0, -2.0), vec2(2.0, 2.0), vec2(-2.0, 2.0)];
    assert_eq!(editor.scenario().enclosure, Enclosure::Polygon { corners_m });
    editor.edit("corner", |s| {
        if let Enclosure::Polygon { corners_m } = &mut s.enclosure {
            corners_m[2] = vec2(3.0, 2.0);
        }
    });
    editor.set_enclosure(EnclosureKind::Rectangle);
    assert_eq!(editor.scenario().enclosure, Enclosure::Rectangle { width_m: 6.0, height_m: 4.0 });
}

#[test]
fn drawing_a_wall_is_one_undo_step() {
    let mut editor = editor(Scenario::default());
    editor.set_tool(Tool::Wall { corners_m: Vec::new() });
    for at in [vec2(0.01, 0.52), vec2(0.01, 0.52), vec2(1.02, 0.49), vec2(1.0, 1.0)] {
        editor.click_with_tool(at, false);
    }
    editor.click_with_tool(vec2(1.234_56, 1.0), true);
    editor.undo_tool_point();
    assert!(!editor.can_undo(), "the scenario is unchanged so far");
    let after = one_step(&mut editor, Editor::finish_tool);
    assert_eq!(
        after.walls,
        [Wall { corners_m: vec![vec2(0.0, 0.5), vec2(1.0, 0.5), vec2(1.0, 1.0)], thickness_m: 0.1 }]
    );
    assert_eq!(*editor.tool(), Tool::Select);
    // One corner does not make a wall.
    editor.set_tool(Tool::Wall { corners_m: Vec::new() });
    editor.click_with_tool(vec2(0.0, 0.0), false);
    editor.finish_tool();
    assert_eq!(editor.scenario().walls.len(), 1);
    editor.set_tool(Tool::Wall { corners_m: Vec::new() });
    editor.undo_tool_point();
    assert_eq!(*editor.tool(), Tool::Select, "without a corner the tool is put away");
}

#[test]
fn paths_and_positions_are_drawn_for_the_selected_item() {
    let mut editor = editor(full());
    editor.set_tool(Tool::Path { waypoints_m: Vec::new() });
    assert_eq!(*editor.tool(), Tool::Select, "no obstacle is selected");
    editor.select(Selection::Obstacle(0));
    editor.set_tool(Tool::Path { waypoints_m: Vec::new() });
    editor.click_with_tool(vec2(-1.0, 0.0), false);
    editor.click_with_tool(vec2(0.0, 0.0), false);
    let after = one_step(&mut editor, Editor::finish_tool);
    let waypoints_m = vec![vec2(-1.0, 0.0), vec2(0.0, 0.0)];
    assert_eq!(after.obstacles[0].motion, ObstacleMotion::Patrol { waypoints_m, speed_m_s: 0.1 });
    editor.select(Selection::Starts);
    editor.set_tool(Tool::Positions);
    for at in [vec2(0.5, 0.5), vec2(0.51, 0.5), vec2(-0.5, 0.0)] {
        editor.click_with_tool(at, false);
    }
    assert_eq!(
        editor.scenario().starts,
        PlacementRule::OneOf { positions_m: vec![vec2(0.5, 0.5), vec2(-0.5, 0.0)] }
    );
    editor.undo();
    assert_eq!(editor.scenario().starts, PlacementRule::OneOf { positions_m: vec![vec2(0.5, 0.5)] });
    editor.set_tool(Tool::Positions);
    editor.select(Selection::Wall(0));
    assert_eq!(*editor.tool(), Tool::Select, "the tool does not fit a wall");
}

#[test]
fn nudging_moves_the_item_and_its_path_by_grid_steps() {
    let mut editor = editor(full());
    editor.select(Selection::Obstacle(1));
    editor.nudge(0, -1, false);
    editor.nudge(2, 0, false);
    editor.nudge(1, 0, true);
    let moved = &editor.scenario().obstacles[1];
    assert_eq!(moved.position_m, vec2(1.11, -0.05));
    let ObstacleMotion::Patrol { waypoints_m, .. } = &moved.motion else { panic!("a patrol") };
    assert_eq!(waypoints_m[..], [vec2(1.11, 1.45), vec2(0.61, 1.45)]);
    editor.undo();
    assert_eq!(
        editor.scenario().obstacles[1].position_m,
        vec2(1.0, -0.05),
        "repeated nudges along x are one step"
    );
    editor.undo();
    assert_eq!(**editor.scenario(), full());
    for (selection, moves) in
        [(Selection::Nothing, false), (Selection::Enclosure, false), (Selection::Wall(0), true)]
    {
        let revision = editor.revision();
        editor.select(selection);
        editor.nudge(0, 1, false);
        assert_eq!(editor.revision() != revision, moves, "{selection:?}");
    }
}

#[test]
fn diagnostics_are_up_to_date_after_every_change() {
    let mut editor = editor(Scenario { obstacles: vec![circle(1.0, -1.0)], ..Scenario::default() });
    assert_eq!(editor.diagnostics(), []);
    editor.select(Selection::Obstacle(0));
    assert!(editor.begin_drag(HandleKind::Middle, vec2(1.0, -1.0)));
    editor.drag_to(vec2(1.95, -1.0), false);
    assert!(editor.has_error(Selection::Obstacle(0)), "it crosses the boundary");
    assert!(!editor.has_error(Selection::Wall(0)) && !editor.has_error(Selection::Nothing));
    editor.drag_to(vec2(1.5, -1.0), false);
    assert_eq!(editor.diagnostics(), []);
    editor.drag_to(vec2(1.95, -1.0), false);
    editor.cancel_drag();
    assert_eq!(editor.diagnostics(), []);
    editor.edit("name", |s| s.name.clear());
    assert_eq!(editor.diagnostics()[0].path, "name");
    editor.undo();
    assert_eq!(editor.diagnostics(), []);
}

#[test]
fn the_editor_knows_its_file_and_whether_it_is_saved() {
    let mut editor = editor(full());
    assert!(!editor.is_modified());
    assert_eq!(editor.file().as_deref(), Some(Path::new("scenarios/mine.ron")));
    editor.edit("name", |s| s.name = "Mine".into());
    assert!(editor.is_modified());
    let saved = Arc::clone(editor.scenario());
    editor.mark_saved("scenarios/other.ron", &saved);
    assert!(!editor.is_modified());
    assert_eq!(editor.from(), "scenarios/other.ron");
    editor.undo();
    assert!(editor.is_modified());
    editor.redo();
    assert!(!editor.is_modified());
    assert_eq!(
        Editor::open(Arc::default(), "empty".into(), true).file(),
        None,
        "a built-in scenario has no file"
    );
    assert!(Editor::open(Arc::default(), "empty".into(), false).is_modified());
}

#[test]
fn another_scenario_can_be_opened_and_undo_brings_the_former_back() {
    let mut editor = editor(full());
    editor.select(Selection::Wall(0));
    editor.copy();
    editor.nudge(1, 0, false);
    let revision = editor.revision();
    editor.open_other("empty", &Arc::new(Scenario::default()));
    assert_eq!((editor.from(), &**editor.scenario()), ("empty", &Scenario::default()));
    assert!(!editor.is_modified() && editor.revision() != revision);
    assert_eq!(editor.selection(), Selection::Nothing);
    // Undo brings the former scenario back, with its changes.
    editor.undo();
    assert_eq!((editor.from(), editor.scenario().walls.len()), ("scenarios/mine.ron", 1));
    assert!(editor.is_modified());
    editor.redo();
    assert_eq!((editor.from(), &**editor.scenario()), ("empty", &Scenario::default()));
    assert!(!editor.is_modified());
    editor.paste(None);
    assert_eq!(editor.scenario().walls.len(), 1, "the clipboard is kept");
}

#[test]
fn an_edited_scenario_survives_saving_and_loading() {
    let mut editor = editor(full());
    editor.add(NewItem::Capsule, vec2(0.0, -1.5));
    assert!(editor.begin_drag(HandleKind::Rotate, vec2(1.0, -1.5)));
    editor.drag_to(vec2(0.123, 0.456), true);
    editor.end_drag();
    editor.set_motion(MotionKind::BackAndForth);
    editor.set_rule(PlacementRole::Starts, PlacementKind::Within);
    let text = to_ron(&**editor.scenario()).expect("RON");
    let back: Scenario = parse_ron(&text, "mine.ron").expect("a saved scenario can be parsed");
    assert_eq!(back, **editor.scenario());
    let digits = |word: &str| word.split('.').nth(1).map_or(0, |part| part.trim_end_matches(')').len());
    let longest = text
        .split([' ', ',', '(', '\n'])
        .filter(|word| word.trim_end_matches(')').parse::<f32>().is_ok() && !word.starts_with("6.283"))
        .map(digits)
        .max();
    assert!(longest <= Some(4), "numbers have at most four decimals:\n{text}");
}
