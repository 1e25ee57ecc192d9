//! Saved and unsaved changes of a document.

use super::*;
use bevy::math::vec2;

#[test]
fn a_late_save_of_the_previous_document_is_ignored() {
    let mut editor = editor(full());
    editor.edit("name", |s| s.name = "Mine".into());
    let late = Arc::clone(editor.scenario());
    editor.open_other("empty", &Arc::new(Scenario::default()));
    editor.edit("name", |s| s.name = "Ours".into());
    editor.mark_saved("scenarios/other.ron", &late);
    assert_eq!(editor.from(), "empty", "the file holds another document");
    assert!(editor.is_modified());
    // After undoing to the previous document, a late save of the next one is ignored too.
    let ours = Arc::clone(editor.scenario());
    editor.undo();
    editor.undo();
    assert_eq!(editor.scenario().name, "Mine");
    editor.mark_saved("scenarios/ours.ron", &ours);
    assert_eq!(editor.from(), "scenarios/mine.ron");
}

#[test]
fn a_save_may_be_confirmed_after_further_changes() {
    let mut editor = editor(full());
    editor.edit("name", |s| s.name = "Mine".into());
    let late = Arc::clone(editor.scenario());
    editor.close_group();
    editor.edit("name", |s| s.name = "Ours".into());
    editor.mark_saved("scenarios/other.ron", &late);
    assert_eq!(editor.from(), "scenarios/other.ron");
    assert!(editor.is_modified());
    editor.undo();
    assert!(!editor.is_modified());
    // It may also be confirmed after an undo.
    editor.redo();
    let late = Arc::clone(editor.scenario());
    editor.undo();
    editor.mark_saved("scenarios/third.ron", &late);
    assert_eq!(editor.from(), "scenarios/third.ron");
    editor.redo();
    assert!(!editor.is_modified());
}

#[test]
fn undo_stops_at_the_saved_scenario() {
    let mut editor = editor(full());
    editor.select(Selection::Obstacle(0));
    editor.nudge(1, 0, false);
    let saved = Arc::clone(editor.scenario());
    editor.mark_saved("scenarios/mine.ron", &saved);
    editor.nudge(1, 0, false);
    editor.undo();
    assert_eq!(*editor.scenario(), saved);
    assert!(!editor.is_modified());
}

#[test]
fn an_unfinished_drawing_counts_as_an_unsaved_change() {
    let mut editor = editor(full());
    editor.select(Selection::Obstacle(0));
    for tool in [Tool::Wall { corners_m: Vec::new() }, Tool::Path { waypoints_m: Vec::new() }] {
        editor.set_tool(tool);
        assert!(!editor.is_drafting() && !editor.is_modified(), "the drawing has no point yet");
        editor.click_with_tool(vec2(0.5, 0.5), false);
        assert!(editor.is_drafting() && editor.is_modified());
        editor.undo_tool_point();
        assert!(!editor.is_drafting() && !editor.is_modified());
        editor.click_with_tool(vec2(0.5, 0.5), false);
        editor.cancel_tool();
        assert!(!editor.is_drafting() && !editor.is_modified());
    }
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
fn another_scenario_can_be_opened_and_undo_brings_the_previous_one_back() {
    let mut editor = editor(full());
    editor.select(Selection::Wall(0));
    editor.copy();
    editor.nudge(1, 0, false);
    let revision = editor.revision();
    editor.open_other("empty", &Arc::new(Scenario::default()));
    assert_eq!((editor.from(), &**editor.scenario()), ("empty", &Scenario::default()));
    assert!(!editor.is_modified() && editor.revision() != revision);
    assert_eq!(editor.selection(), Selection::Nothing);
    // Undo brings the previous scenario back, with its changes.
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
    editor.add_obstacle(new_shape("Capsule"), vec2(0.0, -1.5));
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
