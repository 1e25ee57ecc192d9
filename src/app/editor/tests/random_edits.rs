//! Random sequences of edits: every sequence can be undone, redone and saved.

use super::*;
use crate::random::{Stream, stream, uniform};
use bevy::math::{Vec2, vec2};

/// A random index below `count`.
fn one_of(stream: &mut Stream, count: usize) -> usize {
    (uniform(stream, 0.0, count as f32) as usize).min(count.saturating_sub(1))
}

fn random_position(stream: &mut Stream) -> Vec2 {
    // Also outside the enclosure.
    vec2(uniform(stream, -3.0, 3.0), uniform(stream, -3.0, 3.0))
}

/// Drags a random handle of the selected item; sometimes the drag is not ended.
fn drag(editor: &mut Editor, stream: &mut Stream) {
    let handles = editor.handles();
    let kind = match handles.get(one_of(stream, handles.len().max(1))) {
        Some(handle) if uniform(stream, 0.0, 1.0) < 0.8 => handle.kind,
        _ => HandleKind::Middle,
    };
    editor.begin_drag(kind, random_position(stream));
    for _ in 0..3 {
        editor.drag_to(random_position(stream), uniform(stream, 0.0, 1.0) < 0.5);
    }
    match one_of(stream, 4) {
        0 => editor.cancel_drag(),
        // The next edit happens during the drag.
        1 => {}
        _ => editor.end_drag(),
    }
}

/// Clicks with the current tool. Nothing in the scenario may change, except the starts or the goals if they are selected.
fn click(editor: &mut Editor, at: Vec2) {
    let before = Scenario::clone(editor.scenario());
    editor.click_with_tool(at, false);
    let mut expected = Scenario::clone(editor.scenario());
    match editor.selection() {
        Selection::Starts => expected.starts.clone_from(&before.starts),
        Selection::Goals => expected.goals.clone_from(&before.goals),
        _ => {}
    }
    assert_eq!(expected, before);
}

/// Asserts that a tool for one kind of item is active only if such an item is selected, the same one as `before` the last edit.
fn assert_tool_fits(editor: &Editor, before: Selection) {
    let now = editor.selection();
    match editor.tool() {
        Tool::Select | Tool::Wall { .. } => {}
        Tool::Path { .. } => assert!(matches!(now, Selection::Obstacle(_)) && now == before, "{now:?}"),
        Tool::Positions => {
            assert!(matches!(now, Selection::Starts | Selection::Goals) && now == before, "{now:?}");
        }
    }
}

fn random_edit(editor: &mut Editor, stream: &mut Stream) {
    let at = random_position(stream);
    let role = [PlacementRole::Starts, PlacementRole::Goals][one_of(stream, 2)];
    match one_of(stream, 28) {
        0 | 26 => match Shape::templates().get(one_of(stream, 6)) {
            Some((_, shape)) => editor.add_obstacle(shape.clone(), at),
            None => editor.add_generator(),
        },
        1..=3 => {
            let found = editor.pick(at, 0.3);
            editor.select(found);
        }
        4 => editor.select(
            [Selection::Starts, Selection::Goals, Selection::Enclosure, Selection::Generator(0)]
                [one_of(stream, 4)],
        ),
        5..=8 => drag(editor, stream),
        9 => editor.duplicate(),
        10 => editor.delete(),
        11 => [Editor::copy, Editor::cut][one_of(stream, 2)](editor),
        12 => editor.paste([None, Some(at)][one_of(stream, 2)]),
        13 => editor.nudge(1, -2, uniform(stream, 0.0, 1.0) < 0.5),
        14 => editor.set_motion(MotionKind::ALL[one_of(stream, MotionKind::ALL.len())].0),
        15 => editor.set_rule(role, PlacementKind::ALL[one_of(stream, 4)]),
        16 => editor.set_enclosure([EnclosureKind::Rectangle, EnclosureKind::Polygon][one_of(stream, 2)]),
        17 => {
            let handles = editor.handles();
            if let Some(handle) = handles.get(one_of(stream, handles.len().max(1))) {
                editor.remove_handle(handle.kind);
            }
        }
        // Any other edit may happen before the tool is finished.
        18..=20 => {
            let tools = [
                Tool::Wall { corners_m: Vec::new() },
                Tool::Path { waypoints_m: Vec::new() },
                Tool::Positions,
            ];
            editor.set_tool(tools[one_of(stream, 3)].clone());
        }
        21..=24 => click(editor, at),
        25 => [Editor::finish_tool, Editor::undo_tool_point, Editor::cancel_tool][one_of(stream, 3)](editor),
        _ => [Editor::undo, Editor::redo, Editor::end_drag][one_of(stream, 3)](editor),
    }
}

#[test]
fn random_edits_can_be_undone_redone_and_saved() {
    let (mut paths, mut positions) = (0, 0);
    for seed in 0..6 {
        let mut stream = stream(seed, "anything", 0);
        let mut editor = editor(full());
        let mut most = 0;
        for _ in 0..400 {
            let before = editor.selection();
            random_edit(&mut editor, &mut stream);
            assert_tool_fits(&editor, before);
            paths += usize::from(matches!(editor.tool(), Tool::Path { .. }));
            positions += usize::from(*editor.tool() == Tool::Positions);
            assert_eq!(editor.selection(), editor.selection().if_present(editor.scenario()));
            most = most.max(item_count(editor.scenario()));
            if editor.dragged().is_none() {
                assert_eq!(
                    editor.diagnostics(),
                    diagnostics(editor.scenario()),
                    "diagnostics are up to date"
                );
            }
        }
        assert!(most > 8, "items were added: {most}");
        let text = to_ron(&**editor.scenario()).expect("RON");
        let back: Scenario = parse_ron(&text, "mine.ron").expect("a saved scenario can be parsed");
        assert_eq!(back, **editor.scenario());
        editor.end_drag();
        // Redo everything, so that all steps can be undone.
        while editor.can_redo() {
            editor.redo();
        }
        let last = Arc::clone(editor.scenario());
        while editor.can_undo() {
            editor.undo();
        }
        assert_eq!(**editor.scenario(), full());
        while editor.can_redo() {
            editor.redo();
        }
        assert_eq!(*editor.scenario(), last);
    }
    assert!(paths > 10 && positions > 10, "tools were used: {paths} {positions}");
}
