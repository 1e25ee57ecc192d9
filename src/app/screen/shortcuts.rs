//! The keyboard: which key does what, in one table, and the doing of it.
//!
//! In: the keys of this frame. Out: orders, and changes of the desk. The tooltips and the help window read [`KEY_BINDINGS`].
//! Nothing is taken from a text field that is being written in; Tab and Space are left to egui once a control has the
//! focus (Shift+Tab goes there, Escape leaves).

use egui::{Event, Key, Modifiers, Ui};

use super::editor::{self, confirm_exit};
use super::input::ScreenInput;
use super::key_bindings::{KEY_BINDINGS, KeyBinding, PACES, Shortcut};
use crate::app::commands::{Command, SaveKind};
use crate::app::view_state::{ThemeChoice, ViewCamera, ViewState};

/// Does what the keys of this frame ask for.
pub fn handle(ui: &Ui, view: &ScreenInput<'_>, view_state: &mut ViewState, commands: &mut Vec<Command>) {
    let ctx = ui.ctx().clone();
    if ctx.text_edit_focused() {
        return;
    }
    let dialog_open = view_state.help_open || confirm_exit::is_open(view_state);
    if let Some(editor) = view_state.editor.as_mut().filter(|_| !dialog_open) {
        editor::shortcuts::handle(ui, editor, view.status, commands);
    }
    // In the editor the others are the editor's own, or of a world that can't be seen.
    let editing = view_state.editor.is_some();
    let open = |row: &&KeyBinding| {
        !editing
            || matches!(row.shortcut, Shortcut::Fit | Shortcut::Edit | Shortcut::ThemeChoice | Shortcut::Help)
    };
    let focused = ctx.memory(|memory| memory.focused().is_some());
    let pressed = |row: &&KeyBinding| {
        let modifiers = if row.ctrl { Modifiers::COMMAND } else { Modifiers::NONE };
        // A question mark needs Shift on most keyboards.
        let fits = |held: Modifiers, code: Key| {
            if code == Key::Questionmark { !held.command && !held.alt } else { held.matches_exact(modifiers) }
        };
        let ours = !(focused && matches!(row.shortcut, Shortcut::Pause | Shortcut::Next));
        ours && ctx.input(|i| {
            // Held down, only the step goes on and on.
            i.events.iter().any(|event| match *event {
                Event::Key { key, pressed: true, repeat, modifiers, .. } => {
                    row.codes.contains(&key)
                        && fits(modifiers, key)
                        && (!repeat || row.shortcut == Shortcut::Step)
                }
                _ => false,
            })
        })
    };
    for row in KEY_BINDINGS.iter().filter(open).filter(pressed) {
        if row.shortcut == Shortcut::Next {
            // Or egui would give the focus to its first control.
            ctx.memory_mut(|memory| memory.move_focus(egui::FocusDirection::None));
        }
        execute(ui, row.shortcut, view, view_state, commands);
    }
    if editing {
        return;
    }
    let digits = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5];
    for (code, (pace, ..)) in digits.into_iter().zip(PACES) {
        if ctx.input(|i| i.key_pressed(code) && i.modifiers.is_none()) {
            commands.push(Command::SetPace(pace));
        }
    }
}

fn execute(
    ui: &Ui,
    shortcut: Shortcut,
    view: &ScreenInput<'_>,
    view_state: &mut ViewState,
    commands: &mut Vec<Command>,
) {
    let over = &mut view_state.overlays;
    match shortcut {
        Shortcut::Pause => commands.push(Command::Pause(!view.status.paused)),
        Shortcut::Step => commands.push(Command::Step),
        Shortcut::Pace | Shortcut::Steer => {}
        Shortcut::Grid => view_state.grid = !view_state.grid,
        Shortcut::Next => view_state.followed = (view_state.followed + 1) % view.scene.arenas.len().max(1),
        Shortcut::Fit => view_state.camera = ViewCamera::default(),
        Shortcut::Beams => over.beams = !over.beams,
        Shortcut::Path => over.path = !over.path,
        Shortcut::Trails => over.trails = !over.trails,
        Shortcut::Potential => over.potential = !over.potential,
        Shortcut::Value => over.value = !over.value,
        Shortcut::QValues => over.q_values = !over.q_values,
        Shortcut::Edit if view_state.editor.is_some() => {
            confirm_exit::request_exit(view_state, None, commands)
        }
        Shortcut::Edit => confirm_exit::enter_editor(view, view_state, commands),
        Shortcut::ThemeChoice => {
            view_state.theme = if ui.visuals().dark_mode { ThemeChoice::Light } else { ThemeChoice::Dark }
        }
        Shortcut::Help => view_state.help_open = !view_state.help_open,
        Shortcut::Open => commands.push(Command::OpenDialog),
        Shortcut::Save => commands.push(Command::SaveDialog(SaveKind::Policy)),
    }
}
