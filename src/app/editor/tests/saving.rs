//! Saved and unsaved changes, and late reports from the session.

use bevy::math::vec2;
use super::*;

fn saved(path: &str, scenario: &Arc<Scenario>) -> (String, Arc<Scenario>) {
    (path.to_owned(), Arc::clone(scenario))
}

/// An editor that has seen the state of the session once.
fn synced() -> Editor {
    let mut editor = editor(full());
    editor.sync_with_session(None, None);
    editor
}

#[test]
fn a_late_save_report_about_another_document_is_ignored() {
    let mut editor = synced();
    editor.edit("name", |s| s.name = "Mine".into());
    let late = saved("scenarios/other.ron", editor.scenario());
    let draft = (1, "empty".to_owned(), Arc::new(Scenario::default()));
    editor.sync_with_session(None, Some(&draft));
    editor.edit("name", |s| s.name = "Ours".into());
    editor.sync_with_session(Some(&late), Some(&draft));
    assert_eq!(editor.from(), "empty", "that file holds another scenario");
    assert!(editor.is_modified());
    // After undo, a save report about the document to redo is ignored too.
    let ours = saved("scenarios/ours.ron", editor.scenario());
    editor.undo();
    editor.undo();
    assert_eq!(editor.scenario().name, "Mine");
    editor.sync_with_session(Some(&ours), Some(&draft));
    assert_eq!(editor.from(), "scenarios/mine.ron");
}

#[test]
fn a_save_report_may_come_after_further_changes() {
    let mut editor = synced();
    editor.edit("name", |s| s.name = "Mine".into());
    let late = saved("scenarios/other.ron", editor.scenario());
    editor.close_group();
    editor.edit("name", |s| s.name = "Ours".into());
    editor.sync_with_session(Some(&late), None);
    assert_eq!(editor.from(), "scenarios/other.ron");
    assert!(editor.is_modified());
    editor.undo();
    assert!(!editor.is_modified());
    // Or after undo.
    editor.redo();
    let late = saved("scenarios/third.ron", editor.scenario());
    editor.undo();
    editor.sync_with_session(Some(&late), None);
    assert_eq!(editor.from(), "scenarios/third.ron");
    editor.redo();
    assert!(!editor.is_modified());
}

#[test]
fn undo_stops_at_the_saved_scenario() {
    let mut editor = synced();
    editor.select(Selection::Obstacle(0));
    editor.nudge(1, 0, false);
    let now = saved("scenarios/mine.ron", editor.scenario());
    editor.sync_with_session(Some(&now), None);
    editor.nudge(1, 0, false);
    editor.undo();
    assert_eq!(*editor.scenario(), now.1);
    assert!(!editor.is_modified());
}

#[test]
fn an_unfinished_drawing_is_an_unsaved_change() {
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
