//! The keyboard: handles the keys of a frame according to the table in `key_bindings.rs`.
//!
//! In: key events. Out: commands, and changes of the [`ViewState`]. Keys are ignored while a text field is being
//! edited, and while a dialog asks the user a question, because it handles its own keys. Space and Tab are left to egui while
//! a widget has the focus (Shift+Tab focuses one, Escape removes the focus).

use egui::{Context, Event, Key, Modifiers, Ui};

use super::editor::{self, confirm_exit};
use super::input::ScreenInput;
use super::key_bindings::{KEY_BINDINGS, KeyBinding, PACES, Shortcut};
use crate::app::commands::{Command, SaveKind, SessionMode};
use crate::app::view_state::{ThemeChoice, ViewCamera, ViewState};

/// Handles the keys of this frame.
pub fn handle(ui: &Ui, view: &ScreenInput<'_>, view_state: &mut ViewState, commands: &mut Vec<Command>) {
    let ctx = ui.ctx().clone();
    if ctx.text_edit_focused() || question_is_open(view, view_state) {
        return;
    }
    let help_open = view_state.help_open;
    if let Some(editor) = view_state.editor.as_mut().filter(|_| !help_open) {
        editor::shortcuts::handle(ui, editor, view.status, commands);
    }
    let editing = view_state.editor.is_some();
    let available = |row: &&KeyBinding| !editing || works_in_editor(row.shortcut);
    for row in KEY_BINDINGS.iter().filter(available).filter(|row| is_pressed(&ctx, row)) {
        if row.shortcut == Shortcut::Next {
            // Otherwise egui would focus its first widget.
            ctx.memory_mut(|memory| memory.move_focus(egui::FocusDirection::None));
        }
        execute(ui, row.shortcut, view, view_state, commands);
    }
    if !editing {
        handle_digits(&ctx, commands);
    }
}

/// Whether a dialog in the middle of the window is asking the user a question.
pub fn question_is_open(view: &ScreenInput<'_>, view_state: &ViewState) -> bool {
    view.status.quit_question || view_state.interaction.set_question || confirm_exit::is_open(view_state)
}

/// Whether `shortcut` works in the editor. The others would act on hidden arenas, or mean something else there.
fn works_in_editor(shortcut: Shortcut) -> bool {
    matches!(shortcut, Shortcut::Fit | Shortcut::Edit | Shortcut::Theme | Shortcut::Help)
}

fn is_pressed(ctx: &Context, row: &KeyBinding) -> bool {
    let focused = ctx.memory(|memory| memory.focused().is_some());
    if focused && matches!(row.shortcut, Shortcut::Pause | Shortcut::Next) {
        return false;
    }
    let modifiers = if row.ctrl { Modifiers::COMMAND } else { Modifiers::NONE };
    // A question mark needs Shift on most keyboards, a full stop on French ones.
    let fits = |held: Modifiers, key: Key| match key {
        Key::Questionmark | Key::Period => !held.command && !held.alt,
        _ => held.matches_exact(modifiers),
    };
    ctx.input(|i| {
        i.events.iter().any(|event| match *event {
            // While a key is held down, only the step repeats.
            Event::Key { key, pressed: true, repeat, modifiers, .. } => {
                row.codes.contains(&key)
                    && fits(modifiers, key)
                    && (!repeat || row.shortcut == Shortcut::Step)
            }
            _ => false,
        })
    })
}

fn handle_digits(ctx: &Context, commands: &mut Vec<Command>) {
    let digits = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5];
    for (key, (pace, ..)) in digits.into_iter().zip(PACES) {
        if ctx.input(|i| i.key_pressed(key) && i.modifiers.is_none()) {
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
    let overlays = &mut view_state.overlays;
    match shortcut {
        Shortcut::Pause => commands.push(Command::Pause(!view.status.paused)),
        Shortcut::Step => commands.push(Command::Step),
        Shortcut::Pace | Shortcut::Steer | Shortcut::Scale => {}
        Shortcut::Grid if view.status.mode != SessionMode::Train => {}
        Shortcut::Grid => view_state.grid = !view_state.grid,
        Shortcut::Next => view_state.followed = (view_state.followed + 1) % view.scene.arenas.len().max(1),
        Shortcut::Fit => view_state.camera = ViewCamera::default(),
        Shortcut::Beams => overlays.beams = !overlays.beams,
        Shortcut::Path => overlays.path = !overlays.path,
        Shortcut::Trails => overlays.trails = !overlays.trails,
        Shortcut::Potential => overlays.potential = !overlays.potential,
        Shortcut::Value => overlays.value = !overlays.value,
        Shortcut::QValues => overlays.q_values = !overlays.q_values,
        Shortcut::Edit if view_state.editor.is_some() => {
            confirm_exit::request_exit(view_state, None, commands);
        }
        Shortcut::Edit => confirm_exit::enter_editor(view, view_state, commands),
        Shortcut::Theme => {
            view_state.theme = if ui.visuals().dark_mode { ThemeChoice::Light } else { ThemeChoice::Dark }
        }
        Shortcut::Help => view_state.help_open = !view_state.help_open,
        Shortcut::Open => commands.push(Command::OpenDialog),
        Shortcut::Save => commands.push(Command::SaveDialog(SaveKind::Policy)),
    }
}
