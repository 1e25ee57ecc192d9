//! The keyboard in the editor.
//!
//! In: the keys of this frame, while no text is being edited. Out: the editor's changes, and commands to save or open.

use egui::{Event, Key, Modifiers, Ui};

use super::actions::save_command;
use super::framing::canvas_id;
use crate::app::app_status::AppStatus;
use crate::app::commands::Command;
use crate::app::editor::{Editor, Selection, Tool};

/// The keys and their actions, in the order of the help window.
pub const KEY_HELP: [(&str, &str); 12] = [
    ("Delete", "Delete the item (also Backspace)"),
    ("Ctrl+Z", "Undo; Ctrl+Y or Ctrl+Shift+Z: redo"),
    ("Ctrl+C", "Copy; Ctrl+X: cut; Ctrl+V: paste"),
    ("Ctrl+D", "Duplicate the item"),
    ("Arrows", "Move the item one step; with Shift 1 cm"),
    ("Alt", "While dragging: no snapping"),
    ("Shift", "On the start of a path: move the obstacle alone"),
    ("Enter", "Finish the wall or path"),
    ("Escape", "Cancel, or deselect"),
    ("F", "Show the whole scenario"),
    ("Ctrl+S", "Save the scenario"),
    ("Ctrl+O", "Open a scenario"),
];

/// The gestures of the mouse, in the order of the help window.
pub const MOUSE_HELP: [(&str, &str); 4] = [
    ("Click", "Select an item"),
    ("Drag", "Move an item or a handle; on the floor: pan"),
    ("Scroll", "Zoom"),
    ("Double-click", "On a waypoint or corner: remove it"),
];

/// Handles the keys of this frame.
pub fn handle(ui: &Ui, editor: &mut Editor, status: &AppStatus, commands: &mut Vec<Command>) {
    let pressed: Vec<(Key, Modifiers, bool)> = ui.input(|input| {
        let keys = input.events.iter().filter_map(|event| match *event {
            Event::Key { key, pressed: true, modifiers, repeat, .. } => Some((key, modifiers, repeat)),
            _ => None,
        });
        keys.collect()
    });
    // A focused control keeps the keys without Ctrl.
    let focused = ui.ctx().memory(|memory| memory.focused().is_some_and(|id| id != canvas_id()));
    // Escape closes an open list and does nothing else.
    let list_open = egui::Popup::is_any_open(ui.ctx());
    for (key, held, repeat) in pressed.into_iter().filter(|&(key, ..)| !(list_open && key == Key::Escape)) {
        if held.command {
            with_command(key, held, repeat, editor, status, commands);
        } else if !focused {
            plain(key, held, repeat, editor);
        }
    }
}

/// Handles a key with Ctrl (Command on a Mac).
fn with_command(
    key: Key,
    held: Modifiers,
    repeat: bool,
    editor: &mut Editor,
    status: &AppStatus,
    commands: &mut Vec<Command>,
) {
    match key {
        Key::Z if held.shift => editor.redo(),
        Key::Z => editor.undo(),
        Key::Y => editor.redo(),
        // Of the keys with Ctrl, only undo and redo repeat while they are held down.
        _ if repeat || held.shift => {}
        Key::C => editor.copy(),
        Key::X => editor.cut(),
        Key::V => editor.paste(None),
        Key::D => editor.duplicate(),
        Key::S => commands.push(save_command(editor, status)),
        Key::O => commands.push(Command::OpenInEditor(None)),
        _ => {}
    }
}

/// Handles a key without Ctrl.
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
