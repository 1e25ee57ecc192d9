//! The keyboard: which key does what, in one table, and the doing of it.
//!
//! In: the keys of this frame. Out: orders, and changes of the desk. The tooltips and the help window read [`KEY_BINDINGS`].
//! Nothing is taken from a text field that is being written in; Tab and Space are left to egui once a control has the
//! focus (Shift+Tab goes there, Escape leaves).

use egui::{Event, Key, Modifiers, Ui};

use super::ScreenInput;
use super::editor::{self, confirm_exit};
use crate::app::commands::{Command, Pace, SaveKind};
use crate::app::view_state::{ThemeChoice, ViewCamera, ViewState};

/// The paces that can be chosen, and how they are written.
pub const PACES: [(Pace, &str, &str); 5] = [
    (Pace::Times(1.0), "1×", "As it would be in reality"),
    (Pace::Times(5.0), "5×", "Five times as quickly as in reality"),
    (Pace::Times(20.0), "20×", "Twenty times as quickly"),
    (Pace::Times(100.0), "100×", "A hundred times as quickly"),
    (Pace::Full, "Full", "As quickly as it goes: to learn, not to watch"),
];

/// What a key does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shortcut {
    /// Pause, or run.
    Pause,
    /// One control step.
    Step,
    /// One of [`PACES`]; with the digits, not in the table one by one.
    Pace,
    /// Arrow keys, in Drive mode.
    Steer,
    /// All arenas, or one.
    Grid,
    /// The next arena.
    Next,
    /// The whole enclosure.
    Fit,
    /// An overlay.
    Beams,
    /// An overlay.
    Path,
    /// An overlay.
    Trails,
    /// An overlay.
    Potential,
    /// An overlay.
    Value,
    /// An overlay.
    QValues,
    /// Into the editor, or out of it.
    Edit,
    /// Light or dark.
    ThemeChoice,
    /// The help window.
    Help,
    /// Open a file.
    Open,
    /// Save the policy.
    Save,
}

/// A row of the table: what it does, the key as it is written, and in words.
pub struct KeyBinding {
    /// What it does.
    pub shortcut: Shortcut,
    /// As it stands on the keyboard.
    pub key: &'static str,
    /// In words.
    pub description: &'static str,
    /// For `Ctrl` and the key (Command on a Mac).
    ctrl: bool,
    codes: &'static [Key],
}

const fn plain(
    shortcut: Shortcut,
    codes: &'static [Key],
    key: &'static str,
    description: &'static str,
) -> KeyBinding {
    KeyBinding { shortcut, key, description, ctrl: false, codes }
}

/// All of them, in the order in which they are listed.
pub const KEY_BINDINGS: [KeyBinding; 18] = [
    plain(Shortcut::Pause, &[Key::Space], "Space", "Run or pause"),
    plain(Shortcut::Step, &[Key::Period], ".", "One control step, then stand still"),
    plain(Shortcut::Pace, &[], "1 … 5", "How quickly time passes"),
    plain(Shortcut::Steer, &[], "← ↑ →", "In Drive: steer; ↑ with ← or → turns gently"),
    plain(Shortcut::Grid, &[Key::G], "G", "All arenas, or one"),
    plain(Shortcut::Next, &[Key::Tab], "Tab", "Follow the next arena"),
    plain(Shortcut::Fit, &[Key::F], "F", "Show the whole enclosure"),
    plain(Shortcut::Beams, &[Key::B], "B", "LIDAR beams"),
    plain(Shortcut::Path, &[Key::W], "W", "Way driven"),
    plain(Shortcut::Trails, &[Key::T], "T", "Trails by outcome"),
    plain(Shortcut::Potential, &[Key::P], "P", "Potential field"),
    plain(Shortcut::Value, &[Key::V], "V", "Value by the network"),
    plain(Shortcut::QValues, &[Key::Q], "Q", "Q-values"),
    plain(Shortcut::Edit, &[Key::E], "E", "Edit the world, or leave the editor"),
    plain(Shortcut::ThemeChoice, &[Key::L], "L", "Light or dark"),
    plain(Shortcut::Help, &[Key::H, Key::Questionmark], "H or ?", "This list"),
    KeyBinding {
        shortcut: Shortcut::Open,
        key: "Ctrl+O",
        description: "Open a policy or a run",
        ctrl: true,
        codes: &[Key::O],
    },
    KeyBinding {
        shortcut: Shortcut::Save,
        key: "Ctrl+S",
        description: "Save the policy",
        ctrl: true,
        codes: &[Key::S],
    },
];

/// How the key for `shortcut` is written.
pub fn key_label(shortcut: Shortcut) -> &'static str {
    KEY_BINDINGS.iter().find(|row| row.shortcut == shortcut).map_or("", |row| row.key)
}

/// `text`, and the key for `shortcut` after it.
pub fn with_key_hint(text: &str, shortcut: Shortcut) -> String {
    format!("{text}  ({})", key_label(shortcut))
}

/// Does what the keys of this frame ask for.
pub fn handle(ui: &mut Ui, view: &ScreenInput<'_>, view_state: &mut ViewState, commands: &mut Vec<Command>) {
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
