//! The document as a whole: every operation, and undo.
#![expect(clippy::approx_constant, reason = "angles are stored with four decimals")]

mod drags;
mod kinds;
mod new_items;
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
    BenchmarkRoute, Diagnostic, Enclosure, Generator, MotionKind, Obstacle, ObstacleMotion, PlacementRule,
    RandomShape, Ranged, Region, Scenario, Shape, Wall, WallCells, clearance, diagnostics, parse_ron, to_ron,
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

/// The shape that the button of this name adds.
fn new_shape(name: &str) -> Shape {
    let found = Shape::templates().into_iter().find(|(of, _)| *of == name);
    found.unwrap_or_else(|| panic!("no shape {name}")).1
}

/// A scenario with items of every kind.
fn full() -> Scenario {
    let patrol =
        ObstacleMotion::Patrol { waypoints_m: vec![vec2(1.0, 1.5), vec2(0.5, 1.5)], speed_m_s: 0.1.into() };
    Scenario {
        obstacles: vec![circle(-1.0, -1.0), Obstacle { motion: patrol, ..circle(1.0, 0.0) }],
        walls: vec![Wall {
            corners_m: vec![vec2(-1.5, 0.5), vec2(-1.0, 0.5), vec2(-1.0, 1.0)],
            thickness_m: 0.1,
            ..Wall::default()
        }],
        generators: vec![Generator {
            count: 2,
            shape: RandomShape::Circle { radius_m: (0.05, 0.1) },
            gap_m: 0.4,
            within: Some(Region { min_m: vec2(-1.0, -0.5), max_m: vec2(0.0, 0.0) }),
        }],
        goals: PlacementRule::OneOf { positions_m: vec![vec2(0.0, 1.5), vec2(1.5, -1.5)] },
        benchmark_route: Some(BenchmarkRoute::default()),
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
        (Selection::Nothing, |e| e.add_obstacle(new_shape("Circle"), vec2(0.0, 0.0))),
        (Selection::Nothing, Editor::add_generator),
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
            0 => editor.add_obstacle(new_shape("Box"), vec2(0.3, 0.3)),
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
    editor.add_obstacle(new_shape("Circle"), vec2(0.0, 0.0));
    assert!(!editor.can_redo(), "a new change drops the steps to redo");
}

#[test]
fn typing_in_a_field_is_one_step_until_another_field_is_edited() {
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
    assert!(!editor.can_undo(), "an edit without effect adds no step");
    // Another selection starts a new step, even in the same field.
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
    editor.add_obstacle(new_shape("Circle"), vec2(0.0, 0.0));
    assert_eq!(editor.selection(), Selection::Obstacle(2));
    editor.undo();
    assert_eq!(editor.selection(), Selection::Obstacle(1));
    editor.select(Selection::Obstacle(7));
    assert_eq!(editor.selection(), Selection::Nothing);
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
