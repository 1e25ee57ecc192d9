//! Drawing with tools. A tool is deselected when it no longer fits the selected item.

use super::*;
use bevy::math::vec2;

fn path() -> Tool {
    Tool::Path { waypoints_m: Vec::new() }
}

/// An editor with the goals selected and the tool that adds positions.
fn placing_goals() -> Editor {
    let mut editor = editor(full());
    editor.select(Selection::Goals);
    editor.set_tool(Tool::Positions);
    assert_eq!(*editor.tool(), Tool::Positions);
    editor
}

#[test]
fn the_positions_tool_is_deselected_when_its_rule_is_deselected_or_changes_kind() {
    let changes: [fn(&mut Editor); 6] = [
        Editor::delete,
        |e| e.add_obstacle(new_shape("Circle"), vec2(0.0, 0.0)),
        |e| e.set_rule(PlacementRole::Starts, PlacementKind::OneOf),
        |e| e.set_rule(PlacementRole::Goals, PlacementKind::Within),
        |e| e.set_enclosure(EnclosureKind::Polygon),
        |e| e.edit("rule", |s| s.goals = PlacementRule::default()),
    ];
    for (k, change) in changes.into_iter().enumerate() {
        let mut editor = placing_goals();
        change(&mut editor);
        assert_eq!(*editor.tool(), Tool::Select, "change {k}");
        let before = Arc::clone(editor.scenario());
        editor.click_with_tool(vec2(0.5, 0.5), false);
        assert_eq!(*editor.scenario(), before, "change {k}");
    }
    // The enclosure is a rectangle already; only the selection changes.
    let mut editor = placing_goals();
    editor.set_enclosure(EnclosureKind::Rectangle);
    assert_eq!((editor.selection(), editor.tool()), (Selection::Enclosure, &Tool::Select));
}

#[test]
fn the_positions_tool_stays_while_its_rule_is_selected() {
    let mut editor = placing_goals();
    editor.click_with_tool(vec2(0.5, 0.5), false);
    editor.edit("name", |s| s.name = "Mine".into());
    assert!(editor.remove_handle(HandleKind::Position(0)));
    editor.click_with_tool(vec2(1.0, 0.5), false);
    let positions_m = vec![vec2(1.5, -1.5), vec2(0.5, 0.5), vec2(1.0, 0.5)];
    assert_eq!(editor.scenario().goals, PlacementRule::OneOf { positions_m });
    assert_eq!(*editor.tool(), Tool::Positions);
    // The first click turns a rule of another kind into a list of positions.
    editor.set_rule(PlacementRole::Starts, PlacementKind::Within);
    editor.set_tool(Tool::Positions);
    editor.edit("name", |s| s.name = "Another".into());
    editor.click_with_tool(vec2(0.5, 0.5), false);
    assert_eq!(editor.scenario().starts, PlacementRule::OneOf { positions_m: vec![vec2(0.5, 0.5)] });
}

#[test]
fn the_path_tool_is_deselected_when_its_obstacle_is_deselected() {
    let changes: [fn(&mut Editor); 4] = [
        Editor::duplicate,
        Editor::delete,
        |e| e.add_obstacle(new_shape("Circle"), vec2(0.0, 0.0)),
        |e| e.edit("all", |s| s.obstacles.clear()),
    ];
    for (k, change) in changes.into_iter().enumerate() {
        let mut editor = editor(full());
        editor.select(Selection::Obstacle(1));
        editor.set_tool(path());
        editor.click_with_tool(vec2(0.0, 0.0), false);
        change(&mut editor);
        assert_eq!(*editor.tool(), Tool::Select, "change {k}");
        let before = Arc::clone(editor.scenario());
        editor.finish_tool();
        assert_eq!(*editor.scenario(), before, "change {k}");
    }
    let mut editor = editor(full());
    editor.select(Selection::Obstacle(0));
    editor.set_tool(path());
    editor.click_with_tool(vec2(0.0, 0.0), false);
    editor.set_motion(MotionKind::Orbit);
    editor.nudge(1, 0, false);
    assert_ne!(*editor.tool(), Tool::Select, "the same obstacle is selected");
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
        [Wall {
            corners_m: vec![vec2(0.0, 0.5), vec2(1.0, 0.5), vec2(1.0, 1.0)],
            thickness_m: 0.1,
            ..Wall::default()
        }]
    );
    assert_eq!(*editor.tool(), Tool::Select);
    // One corner does not make a wall.
    editor.set_tool(Tool::Wall { corners_m: Vec::new() });
    editor.click_with_tool(vec2(0.0, 0.0), false);
    editor.finish_tool();
    assert_eq!(editor.scenario().walls.len(), 1);
    editor.set_tool(Tool::Wall { corners_m: Vec::new() });
    editor.undo_tool_point();
    assert_eq!(*editor.tool(), Tool::Select, "without a corner the tool is deselected");
}

#[test]
fn choosing_another_tool_finishes_the_current_drawing() {
    let mut editor = editor(full());
    editor.select(Selection::Obstacle(0));
    editor.set_tool(path());
    editor.click_with_tool(vec2(-1.0, 0.0), false);
    let wall = Tool::Wall { corners_m: Vec::new() };
    let after = one_step(&mut editor, |editor| {
        editor.set_tool(wall.clone());
        assert_eq!(*editor.tool(), wall);
    });
    let waypoints_m = vec![vec2(-1.0, 0.0)];
    assert_eq!(after.obstacles[0].motion, ObstacleMotion::Patrol { waypoints_m, speed_m_s: 0.1.into() });
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
    assert_eq!(after.obstacles[0].motion, ObstacleMotion::Patrol { waypoints_m, speed_m_s: 0.1.into() });
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
