//! What was saved, of which world; and what is not saved yet.

use bevy::math::vec2;
use super::*;

fn saved(path: &str, world: &Arc<Scenario>) -> (String, Arc<Scenario>) {
    (path.to_owned(), Arc::clone(world))
}

/// Like [`editor`], and it has looked at the status once.
fn followed() -> Editor {
    let mut editor = editor(full());
    editor.sync_with_session(None, None);
    editor
}

#[test]
fn an_answer_about_the_world_before_is_not_about_this_one() {
    let mut editor = followed();
    editor.edit("name", |s| s.name = "Mine".into());
    let late = saved("worlds/other.ron", editor.scenario());
    let draft = (1, "empty".to_owned(), Arc::new(Scenario::default()));
    editor.sync_with_session(None, Some(&draft));
    editor.edit("name", |s| s.name = "Ours".into());
    editor.sync_with_session(Some(&late), Some(&draft));
    assert_eq!(editor.from(), "empty", "that file holds another world");
    assert!(editor.is_modified());
    // Back in the world before, the way forward is not its own either.
    let ours = saved("worlds/ours.ron", editor.scenario());
    editor.undo();
    editor.undo();
    assert_eq!(editor.scenario().name, "Mine");
    editor.sync_with_session(Some(&ours), Some(&draft));
    assert_eq!(editor.from(), "worlds/mine.ron");
}

#[test]
fn an_answer_may_come_after_further_changes() {
    let mut editor = followed();
    editor.edit("name", |s| s.name = "Mine".into());
    let late = saved("worlds/other.ron", editor.scenario());
    editor.close_group();
    editor.edit("name", |s| s.name = "Ours".into());
    editor.sync_with_session(Some(&late), None);
    assert_eq!(editor.from(), "worlds/other.ron");
    assert!(editor.is_modified());
    editor.undo();
    assert!(!editor.is_modified());
    // Or after a step back.
    editor.redo();
    let late = saved("worlds/third.ron", editor.scenario());
    editor.undo();
    editor.sync_with_session(Some(&late), None);
    assert_eq!(editor.from(), "worlds/third.ron");
    editor.redo();
    assert!(!editor.is_modified());
}

#[test]
fn undo_stops_at_what_was_saved() {
    let mut editor = followed();
    editor.select(Selection::Obstacle(0));
    editor.nudge(1, 0, false);
    let now = saved("worlds/mine.ron", editor.scenario());
    editor.sync_with_session(Some(&now), None);
    editor.nudge(1, 0, false);
    editor.undo();
    assert_eq!(*editor.scenario(), now.1);
    assert!(!editor.is_modified());
}

#[test]
fn what_is_half_drawn_is_not_saved() {
    let mut editor = editor(full());
    editor.select(Selection::Obstacle(0));
    for tool in [Tool::Wall { corners_m: Vec::new() }, Tool::Path { waypoints_m: Vec::new() }] {
        editor.set_tool(tool);
        assert!(!editor.is_drafting() && !editor.is_modified(), "nothing is drawn yet");
        editor.click_with_tool(vec2(0.5, 0.5), false);
        assert!(editor.is_drafting() && editor.is_modified());
        editor.undo_tool_point();
        assert!(!editor.is_drafting() && !editor.is_modified());
        editor.click_with_tool(vec2(0.5, 0.5), false);
        editor.cancel_tool();
        assert!(!editor.is_drafting() && !editor.is_modified());
    }
}
