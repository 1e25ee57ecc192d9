//! Tools end with what they are for, and what is drawn is not lost unnoticed.

use super::*;
use bevy::math::vec2;

fn path() -> Tool {
    Tool::Path { waypoints_m: Vec::new() }
}

/// With the goals selected, and the tool for their places.
fn placing() -> Editor {
    let mut editor = editor(full());
    editor.select(Selection::Goals);
    editor.set_tool(Tool::Places);
    assert_eq!(*editor.tool(), Tool::Places);
    editor
}

#[test]
fn places_go_to_no_other_rule_than_the_one_they_are_for() {
    let changes: [fn(&mut Editor); 6] = [
        Editor::delete,
        |e| e.add(NewItem::Circle, vec2(0.0, 0.0)),
        |e| e.set_rule(PlacementRole::Starts, PlacementKind::OneOf),
        |e| e.set_rule(PlacementRole::Goals, PlacementKind::Within),
        |e| e.set_enclosure(EnclosureKind::Polygon),
        |e| e.edit("rule", |s| s.goals = PlacementRule::default()),
    ];
    for (k, change) in changes.into_iter().enumerate() {
        let mut editor = placing();
        change(&mut editor);
        assert_eq!(*editor.tool(), Tool::Select, "change {k}");
        let before = Arc::clone(editor.scenario());
        editor.click_with_tool(vec2(0.5, 0.5), false);
        assert_eq!(*editor.scenario(), before, "change {k}");
    }
    // The enclosure is a rectangle already: nothing changes but the selection.
    let mut editor = placing();
    editor.set_enclosure(EnclosureKind::Rectangle);
    assert_eq!((editor.selection(), editor.tool()), (Selection::Enclosure, &Tool::Select));
}

#[test]
fn places_go_on_while_their_rule_is_selected() {
    let mut editor = placing();
    editor.click_with_tool(vec2(0.5, 0.5), false);
    editor.edit("name", |s| s.name = "Mine".into());
    assert!(editor.remove_handle(HandleKind::Place(0)));
    editor.click_with_tool(vec2(1.0, 0.5), false);
    let positions_m = vec![vec2(1.5, -1.5), vec2(0.5, 0.5), vec2(1.0, 0.5)];
    assert_eq!(editor.scenario().goals, PlacementRule::OneOf { positions_m });
    assert_eq!(*editor.tool(), Tool::Places);
    // Of a rule of another kind the first click makes one of places.
    editor.set_rule(PlacementRole::Starts, PlacementKind::Within);
    editor.set_tool(Tool::Places);
    editor.edit("name", |s| s.name = "Another".into());
    editor.click_with_tool(vec2(0.5, 0.5), false);
    assert_eq!(editor.scenario().starts, PlacementRule::OneOf { positions_m: vec![vec2(0.5, 0.5)] });
}

#[test]
fn a_path_is_for_one_obstacle_only() {
    let changes: [fn(&mut Editor); 4] = [
        Editor::duplicate,
        Editor::delete,
        |e| e.add(NewItem::Circle, vec2(0.0, 0.0)),
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
    assert_ne!(*editor.tool(), Tool::Select, "it is the same obstacle");
}
