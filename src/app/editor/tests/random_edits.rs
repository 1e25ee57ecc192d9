//! Whatever is done in whatever order: nothing breaks, and all of it can be undone.

use super::*;
use crate::random::{Stream, stream, uniform};
use bevy::math::{Vec2, vec2};

/// One of `count`.
fn one_of(stream: &mut Stream, count: usize) -> usize {
    (uniform(stream, 0.0, count as f32) as usize).min(count.saturating_sub(1))
}

fn somewhere(stream: &mut Stream) -> Vec2 {
    // Also outside the walls.
    vec2(uniform(stream, -3.0, 3.0), uniform(stream, -3.0, 3.0))
}

/// Drags a handle of what is selected to and fro, and lets go of it, or not.
fn drag(editor: &mut Editor, stream: &mut Stream) {
    let handles = editor.handles();
    let kind = match handles.get(one_of(stream, handles.len().max(1))) {
        Some(handle) if uniform(stream, 0.0, 1.0) < 0.8 => handle.kind,
        _ => HandleKind::Middle,
    };
    editor.begin_drag(kind, somewhere(stream));
    for _ in 0..3 {
        editor.drag_to(somewhere(stream), uniform(stream, 0.0, 1.0) < 0.5);
    }
    match one_of(stream, 4) {
        0 => editor.cancel_drag(),
        // It goes on in the midst of what comes next.
        1 => {}
        _ => editor.end_drag(),
    }
}

/// A click with the tool, whichever it is, changes the rule that is selected at most.
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

/// What the tool is for is selected, and the same as before, when something else was.
fn assert_tool_fits(editor: &Editor, before: Selection) {
    let now = editor.selection();
    match editor.tool() {
        Tool::Select | Tool::Wall { .. } => {}
        Tool::Path { .. } => assert!(matches!(now, Selection::Obstacle(_)) && now == before, "{now:?}"),
        Tool::Places => {
            assert!(matches!(now, Selection::Starts | Selection::Goals) && now == before, "{now:?}");
        }
    }
}

fn anything(editor: &mut Editor, stream: &mut Stream) {
    const FORMS: [NewItem; 6] = [
        NewItem::Circle,
        NewItem::Box,
        NewItem::Capsule,
        NewItem::Triangle,
        NewItem::Hexagon,
        NewItem::Generator,
    ];
    let at = somewhere(stream);
    let rule = [PlacementRole::Starts, PlacementRole::Goals][one_of(stream, 2)];
    match one_of(stream, 28) {
        0 | 26 => editor.add(FORMS[one_of(stream, 6)], at),
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
        14 => editor.set_motion(MotionKind::ALL[one_of(stream, 5)]),
        15 => editor.set_rule(rule, PlacementKind::ALL[one_of(stream, 4)]),
        16 => editor.set_enclosure([EnclosureKind::Rectangle, EnclosureKind::Polygon][one_of(stream, 2)]),
        17 => {
            let handles = editor.handles();
            if let Some(handle) = handles.get(one_of(stream, handles.len().max(1))) {
                editor.remove_handle(handle.kind);
            }
        }
        // Anything else may come between taking a tool and ending it.
        18..=20 => {
            let tools =
                [Tool::Wall { corners_m: Vec::new() }, Tool::Path { waypoints_m: Vec::new() }, Tool::Places];
            editor.set_tool(tools[one_of(stream, 3)].clone());
        }
        21..=24 => click(editor, at),
        25 => [Editor::finish_tool, Editor::undo_tool_point, Editor::cancel_tool][one_of(stream, 3)](editor),
        _ => [Editor::undo, Editor::redo, Editor::end_drag][one_of(stream, 3)](editor),
    }
}

#[test]
fn whatever_is_done_can_be_undone_and_written_down() {
    let (mut led, mut placed) = (0, 0);
    for seed in 0..6 {
        let mut stream = stream(seed, "anything", 0);
        let mut editor = editor(full());
        let mut most = 0;
        for _ in 0..400 {
            let before = editor.selection();
            anything(&mut editor, &mut stream);
            assert_tool_fits(&editor, before);
            led += usize::from(matches!(editor.tool(), Tool::Path { .. }));
            placed += usize::from(*editor.tool() == Tool::Places);
            assert_eq!(editor.selection(), editor.selection().if_present(editor.scenario()));
            most = most.max(things(editor.scenario()));
            if editor.dragged().is_none() {
                assert_eq!(editor.diagnostics(), diagnostics(editor.scenario()), "of the world as it is");
            }
        }
        assert!(most > 8, "something was made: {most}");
        let text = to_ron(&**editor.scenario()).expect("RON");
        let back: Scenario = parse_ron(&text, "mine.ron").expect("what was written can be read");
        assert_eq!(back, **editor.scenario());
        editor.end_drag();
        // Whatever was undone is done again, to have the whole way before it.
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
    assert!(led > 10 && placed > 10, "tools were in hand: {led} {placed}");
}
