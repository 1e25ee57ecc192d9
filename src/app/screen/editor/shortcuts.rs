//! The keyboard of the editor.
//!
//! In: the keys of this frame, where no text is being written. Out: the editor's changes, and orders to save or open.

use egui::{Event, Key, Modifiers, Ui};

use super::finish_drawing;
use crate::app::app_snapshot::AppSnapshot;
use crate::app::commands::Command;
use crate::app::editor::{Editor, Selection, Tool};

/// The keys and what they do, in the order in which they are listed.
pub const KEY_HELP: [(&str, &str); 12] = [
    ("Delete", "Delete it"),
    ("Ctrl+Z", "Undo; with Shift, or Ctrl+Y, do it again"),
    ("Ctrl+C", "Copy; Ctrl+X cuts, Ctrl+V pastes"),
    ("Ctrl+D", "Another one like it"),
    ("Arrows", "Move it a step; with Shift 1 cm"),
    ("Alt", "While dragging: without snapping"),
    ("Shift", "On a path's begin: move the obstacle alone"),
    ("Enter", "The wall or path is done"),
    ("Escape", "Back; select nothing"),
    ("F", "Show the whole world"),
    ("Ctrl+S", "Save the world"),
    ("Ctrl+O", "Open a world"),
];

/// Does what the keys of this frame ask for.
pub fn handle(ui: &Ui, editor: &mut Editor, status: &AppSnapshot, commands: &mut Vec<Command>) {
    let pressed: Vec<(Key, Modifiers, bool)> = ui.input(|input| {
        let keys = input.events.iter().filter_map(|event| match *event {
            Event::Key { key, pressed: true, modifiers, repeat, .. } => Some((key, modifiers, repeat)),
            _ => None,
        });
        keys.collect()
    });
    // Arrows, Enter and Escape belong to a control that has the focus.
    let focused = ui.ctx().memory(|memory| memory.focused().is_some_and(|id| id != super::canvas_id()));
    // It closes a list that is open, and nothing more.
    let listed = egui::Popup::is_any_open(ui.ctx());
    for (key, held, repeat) in pressed.into_iter().filter(|&(key, ..)| !(listed && key == Key::Escape)) {
        if held.command {
            with_command(key, held, repeat, editor, status, commands);
        } else if !focused {
            plain(key, held, repeat, editor);
        }
    }
}

fn with_command(
    key: Key,
    held: Modifiers,
    repeat: bool,
    editor: &mut Editor,
    status: &AppSnapshot,
    commands: &mut Vec<Command>,
) {
    match key {
        Key::Z if held.shift => editor.redo(),
        Key::Z => editor.undo(),
        Key::Y => editor.redo(),
        // Held down, only undo and redo go on and on.
        _ if repeat || held.shift => {}
        Key::C => editor.copy(),
        Key::X => editor.cut(),
        Key::V => editor.paste(None),
        Key::D => editor.duplicate(),
        Key::S => {
            finish_drawing(editor);
            commands.push(Command::SaveScenario {
                scenario: editor.scenario().clone(),
                based_on: editor.from().to_owned(),
                path: editor.file().filter(|_| status.has_disk),
            });
        }
        Key::O => commands.push(Command::OpenInEditor(None)),
        _ => {}
    }
}

fn plain(key: Key, held: Modifiers, repeat: bool, editor: &mut Editor) {
    let drawing = *editor.tool() != Tool::Select;
    match key {
        Key::ArrowLeft => editor.nudge(-1, 0, held.shift),
        Key::ArrowRight => editor.nudge(1, 0, held.shift),
        Key::ArrowUp => editor.nudge(0, 1, held.shift),
        Key::ArrowDown => editor.nudge(0, -1, held.shift),
        _ if repeat => {}
        Key::Escape if drawing => editor.cancel_tool(),
        Key::Escape if editor.dragged().is_some() => editor.cancel_drag(),
        Key::Escape => editor.select(Selection::Nothing),
        Key::Enter if drawing => editor.finish_tool(),
        Key::Backspace if drawing => editor.undo_tool_point(),
        Key::Delete | Key::Backspace if editor.can_delete() => editor.delete(),
        _ => {}
    }
}
