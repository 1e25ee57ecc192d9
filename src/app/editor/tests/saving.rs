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
    // After undoing to the previous document, the next one is the other document.
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
